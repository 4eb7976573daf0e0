"""Files that are written whole or not at all, and what goes wrong with files, said as the program says it."""
from __future__ import annotations

import errno
import os
import shlex
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Iterator

from .errors import StorageError

HELP = {errno.ENOSPC: "free some space or choose another place", errno.EDQUOT: "free some space or choose another place",
        errno.EFBIG: "raise the limit on file sizes (ulimit -f) or choose another place", errno.ENAMETOOLONG: "choose a shorter name"}
WORDS = {errno.ENOENT: "there is no such file", errno.EISDIR: "this is a folder, not a file"}  # of what is read


@contextmanager
def whole(path: Path | str) -> Iterator[Path]:
    """A new file beside `path`, which takes its place when all is written; pipes and devices are written to. Raises StorageError."""
    path = Path(path)
    require_place(path)
    new = path.with_name(f".{path.name}.{os.getpid()}") if path.is_file() or not path.exists() else path
    try:
        yield new
        new.replace(path)
    except StorageError:
        raise
    except OSError as problem:
        raise _refused(path, problem.strerror or str(problem), HELP.get(problem.errno, "choose another place")) from None
    finally:
        if new != path:
            with suppress(OSError):  # of a folder that nothing is written to: what is wrong has been said
                new.unlink(missing_ok=True)


def require_place(path: Path) -> None:
    """Raises StorageError where no file can be written: there is no folder for it, it is one itself, or it is write-protected."""
    folder = path.parent
    try:
        if path.is_dir():
            raise _refused(path, "it is a folder", f"name a file in it, e.g. {path / 'name'}")
        if not folder.exists():
            raise _refused(path, f"the folder {folder} does not exist", f"create it with: mkdir -p {shlex.quote(str(folder))}")
        if not folder.is_dir():
            raise _refused(path, f"{folder} is not a folder", "choose another place")
        if path.exists() and not os.access(path, os.W_OK):
            raise _refused(path, os.strerror(errno.EACCES), "choose another place")
    except StorageError:
        raise
    except OSError as problem:  # of a folder that nobody may look into, or a long name
        raise _refused(path, problem.strerror, HELP.get(problem.errno, "choose another place")) from None


def explained(problem: OSError) -> str:
    """What the system says of a file that is read, or of what is printed, in a line."""
    if problem.filename is None:  # such as what is printed
        if problem.errno == errno.EBADF:
            return "what was to be printed could not be written to the standard output (it is closed)"
        return f"the output cannot be written ({problem.strerror}); {HELP[problem.errno]}" if problem.errno in HELP else problem.strerror or str(problem)
    return f"{problem.filename}: {WORDS.get(problem.errno) or f'cannot be read ({problem.strerror})'}"


def _refused(path: Path, why: str, advice: str) -> StorageError:
    return StorageError(f"{path}: cannot be written ({why}); {advice}")

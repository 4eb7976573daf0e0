"""What the program wrote, whatever it is."""
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from . import asked, motions, results, tracks
from .hdf5 import open_entry

if TYPE_CHECKING:
    from .motions import Motions
    from .results import Results
    from .tracks import Tracks


def open(path: Path | str) -> Results | Motions | Tracks:  # noqa: A001  (as users call it: rabiline.open)
    """Reads a result, the motions of a model, or tracks. Raises InputError with the file and the reason, which is a StorageError too where the
    file cannot be read, and TypeError."""
    asked.path("path", path)
    with open_entry(path) as entry:
        kind = motions if "findings" in entry else \
            tracks if any(name.startswith("particle_") for name in entry.names()) else results
    return kind.read(path)

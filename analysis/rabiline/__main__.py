"""The command line: `rabiline plot | summary | compare | export | fit ...`, or `python3 -m rabiline` with these.

Exit codes: 0 done; 2 bad input or arguments, with one line on stderr; 3 a file could not be written, or a result not read; 128 and a
signal's number, as shells have it, where that stopped it; 1 a mistake of the program.
"""
from __future__ import annotations

import os
import signal
import sys

STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGXCPU, signal.SIGUSR1, signal.SIGUSR2, signal.SIGALRM)
UNMAPPED = "failed to map segment"  # of a library that memory has no room for


class Stopped(KeyboardInterrupt):
    """A signal that stops the program, by its number."""


def _leave(number: int, _: object) -> None:
    os.write(2, b"rabiline: stopped\n")
    os._exit(128 + number)


def _stop(number: int, _: object) -> None:
    raise Stopped(number)


def _leave_at_once() -> None:
    """At Ctrl-C and the like, until modules are imported: these would make errors of their own of it. The program holds signals back
    that come while Python starts."""
    for number in STOPPING:
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, _leave)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPPING)


if __name__ == "__main__":
    _leave_at_once()

import argparse
import re
import warnings
from contextlib import redirect_stderr, redirect_stdout
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import NoReturn, Sequence, TextIO

from .argument_types import file_name
from .errors import printable

VERBS = {  # and the module of each, imported when it is called
    "new": ("starters", "write a starter file for an experiment"),
    "draw": ("apparatus", "the apparatus to scale, with a few paths, before a run"),
    "plot": ("pictures", "the picture that fits a file"),
    "plot-scan": ("pictures", "curves of one or several files in one picture"),
    "plot-levels": ("pictures", "populations of the spin levels at a detector, over the scan"),
    "plot-image": ("pictures", "a detector's images off and on resonance"),
    "plot-profiles": ("pictures", "profiles on a detector, in one picture"),
    "plot-tally": ("pictures", "a tally over one or two of its axes"),
    "plot-angles": ("pictures", "angles of the spin along the planes of a monitor"),
    "plot-transit": ("pictures", "times of flight to a detector"),
    "plot-tracks": ("pictures", "paths of single particles"),
    "plot-motion": ("pictures", "motions of a model, or its findings over a scan"),
    "plot-field": ("pictures", "the field along a line"),
    "summary": ("reports", "what a file holds, in words"),
    "export": ("reports", "the numbers of a scan as CSV"),
    "compare": ("compare_commands", "whether two results of one scan agree"),
    "compare-scans": ("compare_commands", "the same"),
    "compare-laws": ("laws_commands", "how well laws of motion can be told apart"),
    "bound-kappa": ("laws_commands", "which strengths of the hypothesis counts allow"),
    "fit": ("fit_commands", "parameters of an experiment from measured counts"),
    "fit-line": ("fit_commands", "a closed form of a line to a result or to measured counts"),
    "forecast": ("fit_commands", "how well a measurement will know parameters"),
}
DRAWING = {"pictures", "apparatus", "compare_commands", "fit_commands", "laws_commands"}  # what they give back is written to --output
PICTURES = {"pictures": "", "apparatus": "-apparatus"}  # always drawn, and what is added to the file's name


class Once(argparse._StoreAction):
    """An option with one value: given twice, the second would undo the first, and an empty one is no name."""

    given = False

    def __call__(self, parser: argparse.ArgumentParser, *rest: object) -> None:
        if self.given and self.option_strings:
            parser.error(f"{self.option_strings[-1]} is given twice")
        if rest[1] == "" and self.dest != "title":
            parser.error(f"argument {'/'.join(self.option_strings) or self.metavar}: it is empty")
        self.given = True
        super().__call__(parser, *rest)


class Printable:
    """A stream without the control characters of names and tables, which would steer a terminal."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """As that of the stream."""
        return self._stream.write("\r".join(map(printable, text.split("\r"))))  # of progress lines

    def __getattr__(self, name: str) -> object:
        return getattr(self._stream, name)


class Messages(Printable):
    """The same; where nobody can read them, the exit code is left to tell what they would."""

    def write(self, text: str) -> int:
        """As that of the stream, but without errors."""
        try:
            return super().write(text)
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self._stream.fileno())
            return len(text)


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one line; options are written out, and given once unless they say that they may be repeated. No name is empty."""

    def __init__(self, **about: object) -> None:
        super().__init__(**about, allow_abbrev=False)
        self.register("action", None, Once)
        self.register("type", Path, file_name)

    def parse_args(self, words: Sequence[str]) -> argparse.Namespace:  # type: ignore[override]
        """A misspelt option is told before what is missing for it."""
        unknown = [word for word in words if word.startswith("--") and word != "--" and word.partition("=")[0] not in self._option_string_actions]
        if unknown:
            self.error(f"unrecognized arguments: {' '.join(unknown)}")
        table = next((word for word in words if word.endswith(".csv")), None)
        if table and "--data" in self._option_string_actions and not any(word.startswith("--data") or word in ("-o", "--output") for word in words):
            self.error(f"{table} is a table of counts: write --data {table}")
        return super().parse_args(words)

    def error(self, message: str) -> NoReturn:
        unknown = next((word for word in message.split() if word.startswith("--")), "") if message.startswith("unrecognized") else ""
        option, known = unknown.partition("=")[0], list(self._option_string_actions)
        if chosen := re.search(r"invalid choice: '(.*)' \(choose from (.*)\)", message):
            option, known = chosen[1].lower(), re.findall(r"'([^']*)'", chosen[2])
            message = f"{message[:chosen.start()]}`{chosen[1]}` is none of {', '.join(known)}"
        near = get_close_matches(option, known, 1, 0.5 if chosen else 0.6)
        others = [] if near or not unknown else _verbs_with(option)
        self.exit(2, f"rabiline: {message} " + (f"(did you mean {near[0]}?)\n" if near else
                                                f"({option} is an option of {', '.join(others)})\n" if others else "(see --help)\n"))


def _verbs_with(option: str) -> list[str]:
    """Commands that draw files and have it."""
    from .picture_options import OWN_OPTIONS, add_options
    found = []
    for verb in OWN_OPTIONS:
        parser = Parser()
        add_options(verb, parser)
        found += [verb] if option in parser._option_string_actions else []
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command; returns the exit code. What it draws is written to its --output."""
    words = _with_negative_values(list(sys.argv[1:] if arguments is None else arguments))
    os.environ.setdefault("MPLBACKEND", "Agg")
    _open_streams()
    with redirect_stdout(Printable(sys.stdout)), redirect_stderr(Messages(sys.stderr)):
        try:
            return _explained(words)
        except KeyboardInterrupt as stop:
            print("rabiline: stopped", file=sys.stderr)
            return 128 + (stop.args[0] if isinstance(stop, Stopped) else signal.SIGINT)


def _explained(words: list[str]) -> int:
    """Runs it; what went wrong is told in a line."""
    from .errors import InputError, StorageError
    from .writing import explained
    try:
        try:
            _run(words)
        finally:  # of --help too
            sys.stdout.flush()
    except BrokenPipeError:  # `summary | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (InputError, StorageError) as problem:
        told = str(problem).strip()
        print(told if getattr(problem, "diagnostics", ()) else f"rabiline: {told}", file=sys.stderr)  # these have place and caret
        return problem.exit_code
    except OSError as problem:
        print(f"rabiline: {explained(problem)}", file=sys.stderr)
        return 3
    except Exception as problem:
        # Modules that find no memory while they are loaded end in a SystemError, too.
        if isinstance(problem, (MemoryError, SystemError)) or isinstance(problem, ImportError) and UNMAPPED in str(problem):
            print("rabiline: not enough memory", file=sys.stderr)
            return 2
        if _is_of_backend(problem):
            print(f"rabiline: MPLBACKEND is `{os.environ['MPLBACKEND']}`, which matplotlib cannot load here\n  help: unset it, or set it to Agg", file=sys.stderr)
            return 2
        print(f"rabiline: {type(problem).__name__}: {problem}\n  help: this is a mistake of the program: please report it", file=sys.stderr)
        return 1
    return 0


def _is_of_backend(problem: Exception) -> bool:
    """Whether matplotlib does not know what the user has it draw with, or cannot load it."""
    backend = os.environ["MPLBACKEND"].removeprefix("module://")
    return isinstance(problem, (ValueError, ImportError)) and backend not in ("", "Agg") and f"'{backend}'" in str(problem)


def _run(words: list[str]) -> None:
    verb, parser = _parser(words)
    for number in STOPPING:
        if signal.getsignal(number) is _leave:
            signal.signal(number, _stop)
    options = parser.parse_args(words[1:] if verb else words)
    drawing = verb and VERBS[verb][0] in DRAWING and hasattr(options, "output")
    if drawing and options.output:
        from . import style
        style.require_name(options.output)
    elif verb and VERBS[verb][0] in PICTURES:
        first = options.files[0] if hasattr(options, "files") else options.file
        options.output = Path(f"{first.stem}{PICTURES[VERBS[verb][0]] or verb.removeprefix('plot')}.png")
        options.told = True
    _keep_inputs(options)
    if not (drawing and options.output):
        options.command(options)
        return
    from . import style
    with style.here(getattr(options, "size", None)):
        figure = options.command(options)
        if VERBS[verb][0] == "pictures":
            figure = import_module(".pictures", __package__).limited(figure, options)
        _save(figure, options.output, options.dpi)
    if getattr(options, "told", False):
        print(f"wrote {options.output}")


def _open_streams() -> None:
    """Both write something, whatever they are: nowhere where they are closed, and what their encoding lacks as a question mark."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w"))
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")


def _with_negative_values(words: list[str]) -> list[str]:
    """argparse takes `-2:2` for an option: it is joined to the one in front."""
    out: list[str] = []
    for word in words:
        if out and re.match(r"--[a-z-]+$", out[-1]) and re.match(r"-\.?\d", word):
            out[-1] += f"={word}"
        else:
            out.append(word)
    return out


def _keep_inputs(options: argparse.Namespace) -> None:
    """Raises InputError where the output is a file that is read, and StorageError where it cannot be written."""
    output = getattr(options, "output", None)
    if not output:
        return
    from .writing import require_place
    require_place(output)
    if not output.exists():
        return
    given = [value for name, value in vars(options).items() if name != "output"]
    paths = [path for value in given for path in (value if isinstance(value, list) else [value]) if isinstance(path, Path)]
    if any(path.exists() and path.samefile(output) for path in paths):
        from .errors import InputError
        raise InputError(f"--output: {output} is what is read; name another file")


def program() -> int:
    """The command `rabiline` of an installation by pip: everything that is not of this package is the program's."""
    words = sys.argv[1:]
    if words and words[0] in VERBS:
        _leave_at_once()
        return main(words)
    from . import _core
    return _core.main(words)


def _parser(words: Sequence[str]) -> tuple[str | None, Parser]:
    if words and words[0] in VERBS:
        parser = Parser(prog=f"rabiline {words[0]}", formatter_class=argparse.RawDescriptionHelpFormatter)
        import_module(f".{VERBS[words[0]][0]}", __package__).arguments(words[0], parser)
        if VERBS[words[0]][0] in DRAWING and "--output" in parser._option_string_actions:
            from .picture_options import dots, size_of
            parser.add_argument("--dpi", type=dots, default=200, metavar="N", help="dots per inch of a PNG, 10 to 2400; 200 by default")
            parser.add_argument("--size", metavar="WxH", type=size_of,
                                help="of the picture in mm, such as 86x60; what has a shape of its own fills it one way")
        return words[0], parser
    listed = "\n".join(f"  {verb:<15} {about}" for verb, (_, about) in VERBS.items())
    parser = Parser(prog="rabiline", description="Pictures, figures and fits from rabiline's HDF5 files.",
                    epilog=f"commands:\n{listed}", formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", metavar="COMMAND", choices=list(VERBS))
    return None, parser


def _save(figure: object, path: Path, dpi: float) -> None:
    from . import style
    from .errors import InputError
    try:
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always", style.PictureWarning)
            style.save(figure, path, dpi)
        for one in told:
            print(f"rabiline: warning: {one.message}", file=sys.stderr)
    except ValueError as problem:  # more pixels than matplotlib can draw
        raise InputError(f"{path}: {problem}") from None


if __name__ == "__main__":
    sys.exit(main())

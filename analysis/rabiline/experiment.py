"""Experiments and models in Python: loaded, changed, checked and flown by the program itself."""
from __future__ import annotations

import json
import re
import sys
import warnings
from dataclasses import dataclass, field, replace
from inspect import signature
from math import isclose
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Callable, Iterable, Mapping, Sequence, Union

try:
    from . import _core
except ImportError as problem:  # a build without pybind11
    raise ImportError("this package reads and draws results, but has not the program in it (rabiline._core): build with "
                      f"pybind11, or set PYTHONPATH to the folder `python` of the build ({problem})") from None

from . import asked
from .errors import as_keywords, printable

if TYPE_CHECKING:
    import numpy as np
    import pandas
    from matplotlib.figure import Figure

    from .fitting import CountsFit
    from .motions import Motions
    from .results import Results
    from .tracks import Tracks

__version__ = _core.version
Value = Union[str, float, int, bool, Sequence, Mapping]  # numbers are in SI; texts have their unit


class ExperimentWarning(UserWarning):
    """What the program warns of, with line and caret."""


@dataclass(frozen=True)
class Report:
    """What is known before a run; prints as `rabiline check` does. Of an experiment also about what a run takes here: the time
    on one core [s], and the memory for each thread [bytes]."""

    plan: str
    warnings: tuple[str, ...]
    seconds: float | None = None
    memory: float | None = None

    def __str__(self) -> str:
        return printable(self.plan + "".join(self.warnings))

    __repr__ = __str__


def load(source: str | Path) -> Experiment:
    """An experiment or a model from a file, or from its text, which has several lines. Raises InputError with everything
    that is wrong, each with its line, and TypeError."""
    text = asked.text("the text of an experiment", source) if isinstance(source, str) and "\n" in source else None
    return Experiment(text, Path() if text else Path(asked.path("source", source)))


@dataclass(frozen=True)
class Experiment:
    """An experiment or a model with its changes; each method that changes something returns a new one."""

    text: str | None  # None: read from `path`
    path: Path  # the file, or the folder where paths in the text begin
    changes: tuple[str, ...] = ()  # "B.field=9 mT"
    scans: tuple[str, ...] = ()  # "H0.frequency=280 kHz:300 kHz:21"
    without_scan: bool = False
    origin: object = field(default=None, repr=False, compare=False)  # as it was loaded, before any change

    def __post_init__(self) -> None:
        if self.origin is None:
            none = _core.Changes([], [], False)
            origin = _core.load(self.path, none) if self.text is None else _core.load_text(self.text, self.path, none)
            object.__setattr__(self, "origin", origin)
        is_changed = self.changes or self.scans or self.without_scan
        changes = _core.Changes(list(self.changes), list(self.scans), self.without_scan)
        object.__setattr__(self, "_setup", _core.load_again(self.origin, changes) if is_changed else self.origin)

    def __reduce__(self) -> tuple[type[Experiment], tuple[object, ...]]:
        """Copies and other processes read it again."""
        return Experiment, (self.text, self.path, self.changes, self.scans, self.without_scan)

    def __repr__(self) -> str:
        return f"<experiment {printable(self.title)}>"

    @property
    def title(self) -> str:
        """The file's."""
        return self._setup.title

    @property
    def points(self) -> int:
        """Of its scan; 1 where nothing is scanned."""
        return self._setup.points

    @property
    def is_model(self) -> bool:
        """Whether it is solved, not flown."""
        return self._setup.is_model

    def value(self, name: str) -> float:
        """The number called `name`, in SI, without the scan; raises KeyError where it is none."""
        return self._number(name)[0]

    def unit(self, name: str) -> str:
        """Its unit in SI; empty for a plain number. Raises KeyError where it is none."""
        return self._number(name)[1]

    def written_unit(self, name: str) -> tuple[str, float] | None:
        """The unit in which the number called `name` is written, in the latest change of it or in the file, and how much that is in SI. None
        where it is not found in a unit that tables are read in."""
        from .units import QUANTITY, base_of
        value, unit = self._known(name) or (0.0, "")
        changed = [change.partition("=")[2] for change in self.changes if change.startswith(f"{name}=")]
        place, text = ("", changed[-1]) if changed else (_place(name), self.origin.text)
        for number, written in re.findall(place + QUANTITY, text, re.DOTALL | re.MULTILINE):
            base, factor = base_of(written)
            if base == unit and unit and isclose(float(number) * factor, value, rel_tol=1e-9):
                return written.replace("u", "µ", 1) if written[0] == "u" else written, factor
        return None

    def set(self, changes: Mapping[str, Value] | None = None, **more: Value) -> Experiment:
        """With other values: `{"B.field": "9 mT", "law": "quantum"}`; a number is in SI. A word such as `particles=1000`
        may be given by itself. The latest change of a name counts. Raises InputError as `load` does, and TypeError."""
        if not isinstance(changes, (Mapping, type(None))):
            raise TypeError(f'changes are a mapping such as {{"B.field": "9 mT"}}, not {type(changes).__name__}')
        made = {name: f"{name}={self._text(name, value)}" for name, value in {**(changes or {}), **more}.items()}
        kept = tuple(text for text in self.changes if text.partition("=")[0] not in made)
        return replace(self, changes=(*kept, *made.values()))

    def scan(self, names: str | None = None, values: str | Iterable[Value] = ()) -> Experiment:
        """With a scan more, inside of those made here before and outside of the file's own: over a range, "280 kHz:300 kHz:21" with `:log` behind it for
        equal ratios, or over a list, `["9 mT", "10 mT"]` or numbers in SI. "a,b" scans two parameters together. One text
        may be as on the command line, "B.field=9 mT:11 mT:3". Without arguments: without any scan, the file's own included.
        Raises InputError as `load` does, and TypeError."""
        if names is None:
            if not isinstance(values, (str, Sequence)) or len(values) > 0:
                raise TypeError("values of a scan belong to a parameter, and `names` says none")
            return replace(self, scans=(), without_scan=True)
        if "=" in asked.text("`names`", names):
            if values:
                raise TypeError(f"`{names}` has its values already, and no others are taken")
            return replace(self, scans=(*self.scans, names))
        if not isinstance(values, Iterable) or isinstance(values, (bytes, bytearray, Mapping)):
            raise TypeError(f'the values of a scan are a list, or a range such as "280 kHz:300 kHz:21", not {type(values).__name__}')
        if not isinstance(values, str):
            values = ",".join(_quoted(self._text(names.split(",")[0], value), ",") for value in values)
        return replace(self, scans=(*self.scans, f"{names}={values}"))

    def check(self) -> Report:
        """The plan with its derived numbers, and what deserves a word."""
        return Report(*(tuple(part) if isinstance(part, list) else part for part in _core.check(self._setup)))

    def run(self, *, threads: int | None = None, isa: str = "", transit: str = "auto", max_memory: str = "",
            progress: Callable[[float, float], None] | bool | None = None) -> Results | Motions:
        """Flies it, or solves the model. `progress` is called with what is done (0 to 1) and the seconds left; True shows a
        bar, None shows one for runs of over two seconds on a terminal or in a notebook. Ctrl-C stops the run.
        `threads`, all that there are by default, and `isa` never change a result; `max_memory` ("2GiB", as of the command) has slabs of a long scan follow from
        kept moments, to 1e-12. Warnings are given as ExperimentWarning. Raises InputError where something is wrong that only a
        flight tells, or for a size that is none, and TypeError."""
        if self.is_model:
            from . import motions
            return motions.read(_core.solve(self._setup).image())
        result = _fly(self._setup, threads, isa, transit, max_memory, progress)
        for text in result.warnings:
            warnings.warn(text, ExperimentWarning, stacklevel=2)
        from .flown import Flown
        return Flown(result)

    def fly(self, threads: int | None = None, progress: Callable[[float, float], None] | bool = False) -> Results:
        """As `run`, for who flies it many times: without a word, and nothing is kept for `rescan`."""
        from .flown import Flown
        return Flown(_fly(self._setup, threads, "", "none", "", progress, silent=True))

    def field(self, places: Sequence[Sequence[float]], times: Sequence[float] | None = None) -> dict[str, np.ndarray]:
        """The magnetic field [n, 3] in T of each part that has one, at `places` [n, 3] in m, x across, y along the beam, z up,
        and `times` [n] in s, all 0 where they are missing; without the scan."""
        return {part: B for part, B, E in self._probed(places, times) if B.any() or not E.any()}

    def electric_field(self, places: Sequence[Sequence[float]]) -> dict[str, np.ndarray]:
        """The electric field [n, 3] in V/m of each part that has one there, as `field`."""
        return {part: E for part, _, E in self._probed(places, None) if E.any()}

    def _probed(self, places: Sequence[Sequence[float]], times: Sequence[float] | None) -> list[tuple[str, np.ndarray, np.ndarray]]:
        where = asked.places(places)
        return _core.probe(self._setup, where, asked.times(times, len(where)))

    def trace(self, count: int = 5, first: int = 0) -> Tracks:
        """The paths of `count` particles from number `first` on, or as many as there are, without the scan: positions [n, 3] in m, velocities in m/s,
        times in s. Raises TypeError, and ValueError for a model, a negative number and for none or too many particles."""
        from . import tracks
        return tracks.read(_core.trace(self._setup, asked.whole_number("first", first, 0, 2**63), asked.whole_number("count", count, 1, asked.MOST_TRACKS)))

    def draw(self, output: str | Path | None = None, *, paths: int | None = None, size: str | tuple[float, float] | None = None,
             title: str | None = None, dpi: float = 200) -> Figure:
        """The picture of `rabiline draw`: the apparatus with some paths, 50 by default; written to `output` where that is given. `size` in mm, "86x60"
        or a pair. Raises InputError for a model, an ending that is no picture's and a size that has no room, StorageError, TypeError and ValueError."""
        from .apparatus import draw_apparatus
        from .picture_options import drawn
        paths = None if paths is None else asked.whole_number("paths", paths, 0, asked.MOST_TRACKS)
        title = None if title is None else asked.text("`title`", title)
        with as_keywords():
            return drawn(lambda: draw_apparatus(self, paths, title), output, size, dpi)

    def fit(self, data: str | Path | pandas.DataFrame, free: Sequence[str], **options: object) -> CountsFit:
        """Parameters from measured counts, a table or a frame with its columns; see `rabiline.fitting.fit_counts` for the options, and what it raises."""
        from .fitting import fit_counts
        known = signature(fit_counts).parameters
        if unknown := [name for name in options if name not in known]:
            raise TypeError(f"`fit` has no option `{unknown[0]}`; it has {', '.join(list(known)[3:])}")
        with as_keywords():
            return fit_counts(self, data, free, **options)

    def _number(self, name: str) -> tuple[float, str]:
        asked.text("`name`", name)
        found = self._known(name)
        if found is None:
            raise KeyError(f"`{name}` is no number of {self.title}")
        return found

    def _known(self, name: str) -> tuple[float, str] | None:
        """A number and its unit in SI; None where it is none."""
        asked.text("the name of a number", name)
        return self._variable(name.removeprefix("variables.")) if name.startswith("variables.") else self._setup.value(name)

    def _variable(self, name: str) -> tuple[float, str] | None:
        """That of the file's `variables`."""
        block = re.search(r"^variables:((?:[^\n]*\n)(?:[ \t]+[^\n]*\n|\n)*)", self.origin.text + "\n", re.MULTILINE)
        written = [change.partition("=")[2] for change in self.changes if change.startswith(f"variables.{name}=")]
        found = re.search(rf"(?<![\w.]){name}\s*:\s*([^,}}#\n]+)", block[1]) if block else None
        return _core.in_si((written[-1:] or [found[1] if found else ""])[0].strip().strip("'\""))

    def _text(self, name: str, value: Value) -> str:
        """As the file would have it."""
        asked.text("the name of what is changed", name)
        value = asked.plain(value)
        if isinstance(value, str):
            return _quoted(asked.text(f"`{name}`", value), r"(^|\s)#|:(\s|$)|^[@`%&*!|>]")
        if isinstance(value, (bool, Mapping)) or (isinstance(value, Sequence) and not isinstance(value, (str, bytes))):
            try:
                return json.dumps(value, default=asked.plain)
            except (TypeError, ValueError, RecursionError):
                raise TypeError(f"`{name}` is a list or a mapping of numbers, texts, lists and mappings, which do not hold one another") from None
        if not isinstance(value, Real):
            raise TypeError(f"`{name}` is a number in SI, a text with its unit, a list or a mapping, not {type(value).__name__}")
        if isinstance(value, int) or float(value).is_integer() and (self._known(name) or (0, ""))[1] == "":
            number = str(int(value))
        else:
            number = repr(float(value))
        unit = (self._known(name) or (0.0, ""))[1]
        return f"{number} {unit}".strip()


def _place(name: str) -> str:
    """A pattern of what may stand in front of the number called `name` in a file: the last of its words, below the others in turn."""
    first, *rest = map(re.escape, name.split("."))
    below = "".join(rf"(?:(?!\bname:|\n\S).){{0,600}}?\b{key}:\s*" for key in rest)
    return rf"(?:\bname:\s*['\"]?{first}\b|^{first}:){below}['\"]?"


def _quoted(text: str, special: str) -> str:
    """Within quotes, where YAML would read something else in it, as `special` says; lists, mappings and what has quotes stand as they are."""
    return json.dumps(text, ensure_ascii=False) if re.search(special, text) and text[0] not in "[{\"'" else text


def _fly(setup: object, threads: int | None, isa: str, transit: str, max_memory: str, progress: Callable | bool | None, silent: bool = False) -> object:
    if not (callable(progress) or progress in (None, True, False)):
        raise TypeError(f"`progress` is a function, True, False or None, not {type(progress).__name__}")
    bar = progress if callable(progress) else None if progress is False else _Bar(progress is True)
    words = (asked.text(f"`{name}`", value) for name, value in (("isa", isa), ("transit", transit), ("max_memory", max_memory)))
    return _core.fly(setup, asked.threads(threads), *words, bar, ["import rabiline"], silent)


class _Bar:
    """A line that renews itself; in a notebook a bar."""

    def __init__(self, wanted: bool) -> None:
        self.notebook = "ipykernel" in sys.modules
        self.wanted = wanted or self.notebook or sys.stderr is not None and sys.stderr.isatty()
        self.shown = False

    def __call__(self, done: float, left: float) -> None:
        if self.notebook:
            self._display(done, left)
        elif done >= 1:
            if self.shown:
                print("\r" + 60 * " " + "\r", end="", file=sys.stderr, flush=True)
        elif self.wanted and (self.shown or done > 0 and left > 2):
            self.shown = True
            full = round(30 * done)
            print(f"\r[{full * '#'}{(30 - full) * ' '}] {done:6.1%}, {left:.0f} s left  ", end="", file=sys.stderr,
                  flush=True)

    def _display(self, done: float, left: float) -> None:
        from IPython.display import ProgressBar
        if not self.shown:
            if done >= 1 or left <= 2:
                return
            self.shown, self.bar = True, ProgressBar(100)
            self.bar.display()
        self.bar.progress = round(100 * done)

"""Measured counts over one scanned parameter."""
from __future__ import annotations

import difflib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .argument_types import SECONDS
from .csv_table import Table, read_table
from .hdf5 import FileError
from .units import parse_quantity

if TYPE_CHECKING:
    import pandas

ERRORS = " Leave it out: errors are those of the counts"
MISNAMED = {"time": " Write `seconds`, with a unit if it is another one", "seconds": " Write `seconds`", "emitted": " Write `emitted`",
            **dict.fromkeys(("err", "error", "errors", "sigma", "uncertainty"), ERRORS)}
COLUMNS = ("one or two scanned parameters, such as `first.frequency [kHz]`, and `counts`; if wanted `seconds` (time at each "
           "point), `emitted` (particles) and `detector`")
SPARSE = 0.2  # a Gaussian of two points' width; fringes of six points each


@dataclass(frozen=True, eq=False)
class Across:
    """A second scanned parameter: its value at each row of the table."""

    parameter: str  # several with commas between where they are scanned together
    places: tuple[str, ...]  # [n]
    x: np.ndarray  # [n]
    unit: str


@dataclass(frozen=True, eq=False)
class Counts:
    """What one detector counted, in the order of the table."""

    path: str
    parameter: str
    places: tuple[str, ...]  # [n] the parameter's values with their unit, as the program reads them
    x: np.ndarray  # [n] the same as numbers, in `unit`
    unit: str
    counts: np.ndarray  # [n]
    seconds: np.ndarray | None  # [n] time at each point
    emitted: np.ndarray | None  # [n] particles that left the source, or started towards its target
    detector: str | None
    across: Across | None = None  # a second scanned parameter

    def are_sparse(self, curve: np.ndarray, covariance: np.ndarray) -> bool:
        """Whether what a curve [n] with errors of its own [n, n] shows is narrower than about two points: it is then far off the
        straight lines between neighbours."""
        others = np.zeros(self.x.size) if self.across is None else np.unique(self.across.places, return_inverse=True)[1]
        order = np.lexsort((self.x, others))
        left, here, right = order[:-2], order[1:-1], order[2:]
        alike = (others[left] == others[right]) & (self.x[left] < self.x[here]) & (self.x[here] < self.x[right])
        left, here, right = left[alike], here[alike], right[alike]
        part = (self.x[here] - self.x[left]) / (self.x[right] - self.x[left])
        off = np.zeros((here.size, self.x.size))
        rows = np.arange(here.size)
        off[rows, here], off[rows, left], off[rows, right] = 1.0, part - 1, -part
        noise = np.sum((off @ covariance) * off)
        return bool(np.sum((off @ curve)**2) - noise > SPARSE * np.sum((curve - curve.mean())**2))


def read_counts(source: Path | str | pandas.DataFrame, detector: str | None = None) -> Counts:
    """From a table: a file, or a frame with the same columns. Of several detectors in it, one is chosen. Raises FileError, and TypeError
    for what is no table."""
    table = read_table(source)
    others = [(name, unit) for name, unit in table.columns if name not in ("counts", "seconds", "emitted", "detector")]
    # As a part has keys; and what another word of a table looks like.
    unknown = [name for name, _ in others if "." not in name and
               (any("." in other for other, _ in others) or len(others) > 1 and name.lower() in MISNAMED)]
    if "counts" not in table.names or len(others) not in (1, 2) or unknown:
        near = difflib.get_close_matches("counts", [name.lower() for name in table.names], 1, 0.4)
        written = [name for name in table.names if name.lower() in near]
        wrong = f"no column `counts`{f', but `{written[0]}`' if written else ''}" if "counts" not in table.names else \
            "no column of the scanned parameter" if not others else \
            f"what is the column `{unknown[0]}`?{next((told for word, told in MISNAMED.items() if word in unknown[0].lower()), '')}" if unknown else \
            f"two parameters are scanned at most, and there are {', '.join(name for name, _ in others)}"
        raise FileError(table.path, f"line {table.header}: {wrong} (columns: {COLUMNS})")
    for name, unit in table.columns:
        if unit and name in ("counts", "emitted"):
            raise FileError(table.path, f"line {table.header}: `{name}` has the unit `{unit}`: "
                            "write what was counted, which has none, and of a rate the time at each point in a column `seconds`")
    if not table.rows:
        raise FileError(table.path, f"line {table.header}: nothing stands below the names of the columns")
    if len(others) == 2:  # along the one that has more values
        others.sort(key=lambda one: -len(set(table.column(one[0]))))
    parameter, unit = others[0]
    kept = np.ones(len(table.rows), dtype=bool)
    if "detector" in table.names:
        named = table.column("detector")
        chosen, detector = detector, detector or named[0]
        kept = np.array([name == detector for name in named])
        if not kept.any() or (chosen is None and len(set(named)) > 1):
            raise FileError(table.path, f"there is {', '.join(dict.fromkeys(named))}: choose one with --detector")
    x = np.array(table.numbers(parameter))[kept]
    counts = _column(table, "counts", kept, 0.0, ": counts are what was counted, and a background that was taken off belongs back, as the parameter `background`")
    _require(table, kept, counts == np.rint(counts), "counts must be whole numbers, as they were counted, background included")
    if not counts.any():
        raise FileError(table.path, "nothing was counted at any point")
    columns = [np.array(table.numbers(name))[kept] for name, _ in others]
    if x.size < 2:
        raise FileError(table.path, "a scan has two points or more")
    places = list(zip(*(column.tolist() for column in columns)))
    _require(table, kept, np.array([places.index(place) == i for i, place in enumerate(places)]), "a point that has been counted before\n  help: add up what was counted at it, and its `seconds` or `emitted`")
    written = [tuple(f"{text} {unit}".strip() for text, use in zip(table.column(name), kept) if use) for name, unit in others]
    across = Across(",".join(names_of(others[1][0])), written[1], columns[1], others[1][1]) if len(others) == 2 else None
    optional = {name: _column(table, name, kept, 1e-300) if name in table.names else None for name in ("seconds", "emitted")}
    if optional["seconds"] is not None:
        optional["seconds"] = optional["seconds"] * _seconds(table)
    if optional["emitted"] is not None and optional["seconds"] is None:  # over a time there may be a background
        _require(table, kept, counts <= optional["emitted"], "more counts than particles were emitted")
    return Counts(str(table.path), ",".join(names_of(parameter)), written[0], x, unit, counts, optional["seconds"], optional["emitted"],
                  detector if "detector" in table.names else None, across)


def names_of(parameter: str) -> list[str]:
    """Those that are scanned together, with commas or + between."""
    return [name.strip() for name in parameter.replace("+", ",").split(",")]


def _seconds(table: Table) -> float:
    """How much the times of the table are in."""
    unit = dict(table.columns)["seconds"] or "s"
    try:
        return SECONDS[unit] if unit in SECONDS else parse_quantity(f"1 {unit}", "s")
    except ValueError as problem:
        raise FileError(table.path, f"line {table.header}: `seconds` has the unit `{unit}`: {problem}\n  help: write `seconds [s]`") from None


def _column(table: Table, name: str, kept: np.ndarray, least: float, help_of_range: str = "") -> np.ndarray:
    values = np.array(table.numbers(name))[kept]
    good = (values >= least) & (values <= 2**53)
    _require(table, kept, good, f"`{name}` is {values[np.argmin(good)]:g}, which is out of range{help_of_range}")
    return values


def _require(table: Table, kept: np.ndarray, good: np.ndarray, wrong: str) -> None:
    """Raises FileError with the line of the first row, of those that are kept, that is not good."""
    if not good.all():
        line = table.rows[int(np.flatnonzero(kept)[np.argmin(good)])][0]
        raise FileError(table.path, f"line {line}: {wrong}")

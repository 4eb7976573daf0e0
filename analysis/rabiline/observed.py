"""Measured counts, from a table or from another result, in the cells of the templates that they are held against."""
from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from . import results
from .csv_table import read_table
from .hdf5 import FileError, is_hdf5
from .likelihood import Model
from .templates import Templates, gather, histogram_of, models, point_of_cell
from .units import format_value, parse_quantity

COLUMNS = "counts; x and z or one of them (bin centres, or x_from and x_to); the scanned parameter; detector; emitted"


@dataclass(frozen=True)
class Observation:
    """Counts of one or several screens, in turn."""

    path: str
    histogram: str
    counts: np.ndarray  # [points, nx, nz] of each screen, in a list
    emitted: np.ndarray | None  # [points] particles, at each scan point; None where it is not known
    measured: np.ndarray  # [points] whether the point was measured
    warnings: tuple[str, ...] = ()

    def of(self, screens: list[int]) -> Observation:
        """That of some of the screens, by number."""
        return replace(self, counts=[self.counts[i] for i in screens])


def in_cells(made: Templates, seen: Observation, backgrounds: list[float] | None, free: bool,
             exposure: np.ndarray) -> tuple[np.ndarray, list[Model]]:
    """Counts [cells] and for each law its model, of the cells that were measured."""
    n = np.concatenate([gather(screen, counts) for screen, counts in zip(made.screens, seen.counts)])
    kept = np.concatenate([seen.measured[point_of_cell(screen)] for screen in made.screens])
    return n[kept], [Model(model.signal[kept], model.background[kept], model.k[kept], free)
                     for model in models(made, exposure, backgrounds, free)]


def histogram_in(path: Path) -> str | None:
    """Which histogram a table holds, by its columns; None for a result, which holds all."""
    if is_hdf5(path):
        return None
    names = {name.removesuffix("_from").removesuffix("_to") for name, _ in _table(path)[0]}
    return "image" if {"x", "z"} <= names else "x" if "x" in names else "z" if "z" in names else "detected"


def read(path: Path, made: Templates) -> Observation:
    """A table (CSV) or a result (HDF5); raises FileError."""
    return _from_result(path, made) if is_hdf5(path) else _from_table(path, made)


def _from_result(path: Path, made: Templates) -> Observation:
    data = results.read(path)
    axes = data.scan.axes
    if [axis.parameter for axis in axes] != ([made.axis.parameter] if made.axis else []):
        over = " and ".join(axis.parameter for axis in axes) or "nothing"
        raise FileError(path, f"its scan runs over {over}, and data for {made.path} over "
                              f"{made.axis.parameter if made.axis else 'nothing'}, under one law")
    points = np.argsort(axes[0].values, kind="stable") if made.axis else np.arange(made.points)
    if made.axis and (axes[0].values.shape != made.axis.values.shape
                      or not _close(axes[0].values[points], made.axis.values).all()):
        raise FileError(path, f"the points of its scan over {made.axis.parameter} are not those of {made.path}")
    counts, warnings = [], []
    for screen in made.screens:
        if screen.name not in data.scan.detectors:
            raise FileError(path, f"no detector `{screen.name}` (there is {', '.join(data.scan.detectors)})")
        own, _, edges = histogram_of(data, screen.name, screen.histogram, points)
        if any(mine.shape != its.shape or not np.allclose(mine, its, rtol=1e-9, atol=1e-15)
               for mine, its in zip(edges, screen.edges)):
            raise FileError(path, f"the bins of `{screen.name}` are not those of {made.path}")
        counts.append(own)
    if data.simulation.get("seed") == made.seed is not None:
        warnings.append(f"{path} and {made.path} have the seed {made.seed} and may share their particles: their counts "
                        "agree too well, and p comes out too large; run the data with another --seed")
    if made.points > 1 and data.simulation.get("particles") != "independent":
        warnings.append(f"the scan points of {path} share their particles, and those of an experiment do not: one "
                        "fluctuation is counted many times over, and p and χ² mean little; run the data with "
                        "--set scan.particles=independent")
    if any(np.abs(own - np.rint(own)).max() > 1e-6 for own in counts):
        warnings.append(f"{path} counts in weights, which scatter less than whole counts do: p comes out too large")
    return Observation(str(path), made.screens[0].histogram, counts, data.emitted[points], np.ones(made.points, bool),
                       tuple(warnings))


def _close(values: np.ndarray, wanted: np.ndarray | float) -> np.ndarray:
    size = np.ptp(np.atleast_1d(wanted)) or np.abs(wanted).max() or 1.0
    return np.abs(values - wanted) <= 1e-6 * size


def _table(path: Path) -> tuple[list[tuple[str, float]], list[tuple[int, tuple[str, ...]]]]:
    """Columns with the factors of their units, and rows with the numbers of their lines."""
    table = read_table(path)
    columns = []
    for name, unit in table.columns:
        try:
            columns.append((name, parse_quantity(f"1 {unit}") if unit else 1.0))
        except ValueError as problem:
            raise FileError(path, f"line {table.header}, column `{name}`: {problem}") from None
    if "counts" not in dict(columns):
        raise FileError(path, f"line {table.header}: no column `counts` (columns: {COLUMNS})")
    return columns, list(table.rows)


def _from_table(path: Path, made: Templates) -> Observation:
    columns, rows = _table(path)
    known = {"counts", "detector", "emitted", *(made.axis and [made.axis.parameter] or []),
             *(name + end for name in "xz" for end in ("", "_from", "_to"))}
    for name, _ in columns:
        if name not in known:
            raise FileError(path, f"what is the column `{name}`? (columns: {COLUMNS})")
    names = [name for name, _ in columns]
    if made.axis and made.axis.parameter not in names:
        raise FileError(path, f"no column `{made.axis.parameter}`, over which {made.path} scans")
    if len(made.screens) > 1 and "detector" not in names:
        raise FileError(path, f"no column `detector`, and {made.path} has several: choose one with --detector")
    counts = [np.zeros(screen.cells.shape) for screen in made.screens]
    filled = [np.zeros(screen.cells.shape, dtype=bool) for screen in made.screens]
    emitted = np.full(made.points, np.nan)
    for line, cells in rows:
        row = _Row(path, line, dict(zip(names, cells)), dict(columns))
        number = _screen_number(row, made)
        if number is None:
            continue
        screen = made.screens[number]
        point = row.nearest(made.axis.parameter, made.axis.values, made.axis.units) if made.axis else 0
        i, j = (row.bin_of(name, edges) for name, edges in zip("xz", screen.edges))
        if filled[number][point, i, j]:
            raise FileError(path, f"line {line}: counts for this bin stand in an earlier line too")
        filled[number][point, i, j] = True
        counts[number][point, i, j] = row.number("counts", least=0)
        if "emitted" in names:
            emitted[point] = row.number("emitted", least=0)
    measured = np.any([own.any(axis=(1, 2)) for own in filled], axis=0)
    if not measured.any():
        raise FileError(path, "no counts in it")
    if any(own[measured].any() and np.abs(own - np.rint(own)).max() > 1e-6 for own in counts):
        raise FileError(path, "counts must be whole numbers, as they were counted, background included")
    return Observation(str(path), made.screens[0].histogram, counts,
                       np.where(measured, emitted, 0) if "emitted" in names else None, measured)


def _screen_number(row: _Row, made: Templates) -> int | None:
    if "detector" not in row.values:
        return 0
    found = [i for i, screen in enumerate(made.screens) if screen.name == row.values["detector"]]
    return found[0] if found else None


@dataclass(frozen=True)
class _Row:
    """A line of a table."""

    path: Path
    line: int
    values: dict[str, str]
    factors: dict[str, float]

    def number(self, name: str, least: float = -np.inf) -> float:
        try:
            value = float(self.values[name]) * self.factors[name]
        except (ValueError, KeyError):
            raise FileError(self.path, f"line {self.line}: `{self.values.get(name, '')}` is no number "
                                       f"({name})") from None
        if not np.isfinite(value) or value < least:
            raise FileError(self.path, f"line {self.line}: {name} = {self.values[name]} is out of range")
        return value

    def nearest(self, name: str, wanted: np.ndarray, unit: str) -> int:
        value = self.number(name)
        i = int(np.argmin(np.abs(wanted - value)))
        if np.abs(wanted[i] - value) > 1e-3 * (np.ptp(wanted) / max(wanted.size - 1, 1) or abs(wanted[i])):
            raise FileError(self.path, f"line {self.line}: {name} = {format_value(value, unit)} is no scan point of "
                                       f"the result; the nearest is {format_value(wanted[i], unit)}")
        return i

    def bin_of(self, name: str, edges: np.ndarray) -> int:
        if edges.size == 2 and name not in self.values and f"{name}_from" not in self.values:
            return 0
        centres, width = (edges[:-1] + edges[1:]) / 2, edges[1] - edges[0]
        low, high = (self.number(f"{name}_from"), self.number(f"{name}_to")) if f"{name}_from" in self.values else \
            (self.number(name) - width / 2, self.number(name) + width / 2)
        i = int(np.argmin(np.abs(centres - (low + high) / 2)))
        if abs(edges[i] - low) > 0.01 * width or abs(edges[i + 1] - high) > 0.01 * width:
            raise FileError(self.path, f"line {self.line}: {name} from {format_value(low, 'm')} to "
                                       f"{format_value(high, 'm')} is no bin of the result; the nearest is "
                                       f"{format_value(edges[i], 'm')} to {format_value(edges[i + 1], 'm')}")
        return i

"""Results as tables of other libraries: pandas, xarray, CSV. A column's unit stands behind its name: `speed [m/s]`."""
from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import numpy as np

from . import asked
from .errors import TURNING, InputError
from .writing import whole

if TYPE_CHECKING:
    import pandas
    import xarray

    from .motions import Motions
    from .results import Results
    from .tracks import Tracks

NOT_TABLES = {".h5": "a result", ".yaml": "an experiment", ".yml": "an experiment", ".json": "JSON",
              **dict.fromkeys((".xlsx", ".xls", ".ods"), "a workbook"), **dict.fromkeys((".png", ".pdf", ".svg"), "a picture")}
LINE = 1 << 16  # bytes that are read of one
CONTROL = dict.fromkeys((*range(32), *range(127, 160), *TURNING), " ")


def columns(results: Results | Motions | Tracks) -> dict[tuple[str, str], np.ndarray]:
    """(name, unit) and [rows] of each column: a row for each scan point of each detector, or of a model with what it found, or for each record of each path. Populations
    of levels stand in columns such as `wire: F=4 m=0`, fractions of what that detector caught, NaN in the rows of others and where nothing is caught."""
    if hasattr(results, "findings"):
        return _findings(results)
    if hasattr(results, "tracks"):
        return _paths(results)
    scan = results.scan
    points, detectors = int(np.prod(scan.shape)), len(scan.detectors)
    table: dict[tuple[str, str], np.ndarray] = {}
    for axis, index in zip(scan.axes, np.unravel_index(np.arange(points), scan.shape)):
        values = np.array(axis.labels, dtype=object) if axis.labels else axis.values
        table[axis.parameter, axis.units] = np.tile(values[index], detectors)
    if detectors > 1:
        table["detector", ""] = np.repeat(np.array(scan.detectors, dtype=object), points)
    for name, unit, values in (("detected", "", scan.detected), ("detected_error", "", scan.errors),
                               ("count_rate", "1/s", scan.count_rate),
                               ("count_rate_error", "1/s", scan.count_rate_errors)):
        if values is not None:
            table[name, unit] = values.ravel()
    for number, name in enumerate(scan.detectors):
        rows, levels = slice(number * points, (number + 1) * points), results.detectors[name].levels
        for level, own in enumerate(levels.labels):
            for column, values in ((f"{name}: {own}", levels.fractions), (f"{name}: {own}_error", levels.errors)):
                table[column, ""] = np.full(points * detectors, np.nan)
                table[column, ""][rows] = values[:, level]
    return table


def _findings(results: Motions) -> dict[tuple[str, str], np.ndarray]:
    axis = results.axis
    table = {} if axis is None else {(axis.parameter, axis.units): np.array(axis.labels, dtype=object) if axis.labels else axis.values}
    for finding in results.findings:
        table[finding.name, finding.units] = finding.values
        table[f"{finding.name}_expected", finding.units] = finding.expected
    return table


def _paths(results: Tracks) -> dict[tuple[str, str], np.ndarray]:
    """A row for each record of each particle."""
    def every(name: str) -> np.ndarray:
        return np.concatenate([np.full(track.time.size, getattr(track, name), dtype=object) for track in results.tracks])

    table = {("particle", ""): every("particle").astype(int)}
    for name in ("law", "species", "fate", "where"):
        if any(getattr(track, name) for track in results.tracks):
            table[name, ""] = every(name)
    table["t", "s"] = np.concatenate([track.time for track in results.tracks])
    for attribute, names, unit in (("position", "x y z", "m"), ("velocity", "vx vy vz", "m/s"), ("spin", "sx sy sz", "")):
        values = np.concatenate([getattr(track, attribute) for track in results.tracks])
        table |= {(name, unit): values[:, i] for i, name in enumerate(names.split())}
    table["weight", ""] = np.concatenate([track.weight for track in results.tracks])
    return table


def to_csv(results: Results | Motions | Tracks, to: Path | str | TextIO) -> None:
    """A line for each row of `columns`, numbers in SI. Raises InputError for a file that is no such table, which is not
    written over, and StorageError."""
    if hasattr(to, "write"):
        _write(results, to)
        return
    _require_own(Path(asked.path("path", to)))
    with whole(to) as new, new.open("w", newline="", encoding="utf-8") as file:
        _write(results, file)


def _write(results: Results | Motions | Tracks, file: TextIO) -> None:
    table = columns(results)
    file.write(f"# {_in_one_line(results.title)}\n# {_in_one_line(results.program)}\n")
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow([_in_one_line(f"{name} [{unit}]" if unit else name) for name, unit in table])
    writer.writerows([_in_one_line(value) if isinstance(value, str) else repr(value.item()) for value in row] for row in zip(*table.values()))


def _in_one_line(text: str) -> str:
    """With blanks for control characters: what follows a line break would be read as a row."""
    return text.translate(CONTROL)


def _require_own(path: Path) -> None:
    if path.suffix in NOT_TABLES:
        raise InputError(f"{path} is named like {NOT_TABLES[path.suffix]}, and what is written is CSV; name it {path.with_suffix('.csv')}")
    if path.is_file() and path.stat().st_size:
        with path.open(encoding="utf-8", errors="replace") as file:
            if not file.readline(LINE).startswith("# ") or not file.readline(LINE).startswith("# rabiline"):
                raise InputError(f"{path} is there already, and is no table of a result: it is not written over\n  help: choose another name, "
                                 "or remove it")


def to_dataframe(results: Results | Motions | Tracks) -> pandas.DataFrame:
    """`columns` for pandas, numbers in SI; the units stand in its `attrs["units"]`."""
    import pandas
    table = columns(results)
    frame = pandas.DataFrame({name: values for (name, _), values in table.items()})
    frame.attrs.update(title=results.title, units={name: unit for name, unit in table if unit})
    return frame


def to_xarray(results: Results | Motions) -> xarray.Dataset:
    """Everything over the scan with its axes: `detected`, and for each detector `counts_NAME` over x and z and `levels_NAME` over its levels,
    monitors and tallies; each has its `NAME_error`. Of a model, what it found, each with its `NAME_expected`."""
    import xarray
    about = {"title": results.title, "program": results.program}
    if hasattr(results, "findings"):
        over = [results.axis.parameter] if results.axis else []
        found = {name: (over, values if over else values[0], {"units": unit} if unit else {}) for (name, unit), values in columns(results).items()}
        return xarray.Dataset({name: one for name, one in found.items() if name not in over}, {name: found[name] for name in over}, about)
    scan = results.scan
    over = tuple(axis.parameter for axis in scan.axes)
    shape = scan.shape if over else ()
    coords: dict[str, object] = {
        axis.parameter: (axis.parameter, list(axis.labels) if axis.labels else axis.values,
                         {"units": axis.units} if axis.units else {}) for axis in scan.axes}
    coords["detector"] = list(scan.detectors)
    data: dict[str, object] = {}

    def add(name: str, dims: tuple[str, ...], values: np.ndarray, errors: np.ndarray, units: str = "1") -> None:
        data[name] = (dims, values, {"units": units})
        data[f"{name}_error"] = (dims, errors, {"units": units})

    each = (len(scan.detectors), *shape)
    add("detected", ("detector", *over), scan.detected.reshape(each), scan.errors.reshape(each))
    if scan.count_rate is not None and scan.count_rate_errors is not None:
        add("count_rate", ("detector", *over), scan.count_rate.reshape(each), scan.count_rate_errors.reshape(each), "1/s")
    if scan.covariance is not None:
        behind = tuple(f"{name}'" for name in over)
        data["detected_covariance"] = (("detector", *over, *behind), scan.covariance.reshape(*each, *shape))
    for name, detector in results.detectors.items():
        dims = (f"x_{name}", f"z_{name}")
        for dim, edges in zip(dims, (detector.x_edges, detector.z_edges)):
            coords[dim] = (dim, (edges[:-1] + edges[1:]) / 2, {"units": "m"})
        image = (*shape, *detector.counts.shape[1:])
        add(f"counts_{name}", (*over, *dims), detector.counts.reshape(image), detector.errors.reshape(image))
        coords[f"level_{name}"] = list(detector.levels.labels)
        populations = (*shape, len(detector.levels.labels))
        add(f"levels_{name}", (*over, f"level_{name}"), detector.levels.fractions.reshape(populations), detector.levels.errors.reshape(populations))
    for name, monitor in results.monitors.items():
        planes = (f"plane_{name}",) if monitor.passed.ndim > 1 else ()
        whole = (*shape, *monitor.passed.shape[1:])
        add(f"passed_{name}", (*over, *planes), monitor.passed.reshape(whole), monitor.errors.reshape(whole))
    for name, tally in results.tallies.items():
        dims = tuple(f"{axis.name}_{name}" for axis in tally.axes)
        for dim, axis in zip(dims, tally.axes):
            coords[dim] = (dim, list(axis.labels) if axis.labels else (axis.edges[:-1] + axis.edges[1:]) / 2,
                           {"units": axis.units or "1"})
        whole = (*shape, *tally.counts.shape[1:])
        add(f"tally_{name}", (*over, *dims), tally.counts.reshape(whole), tally.errors.reshape(whole))
    return xarray.Dataset(data, coords, about)

"""What `rabiline run` wrote of a model, as plain values."""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import tables
from .hdf5 import IN_MEMORY, FileError, Group, open_entry
from .results import Axis, program_of

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure

# Motions in which a velocity or an angular momentum turns as the paper has it and established mechanics does not
ON_HYPOTHESIS = {"paper", "euler", "larmor", "torque", "eq74"}
# What the expected value of a finding is
EXPECTATIONS = {"closed_form": "closed form", "conserved": "conserved", "approximate": "to first order",
                "supposed": "the paper supposes"}


@dataclass(frozen=True, eq=False)
class Course:
    """A number over time."""

    name: str
    title: str  # what plots write along its axis, with the unit
    units: str
    values: np.ndarray  # [n]


@dataclass(frozen=True, eq=False)
class Motion:
    """How the model moves under one set of equations."""

    name: str
    meaning: str
    time: np.ndarray  # [n] s
    position: np.ndarray  # [n, 3] m
    courses: tuple[Course, ...]

    @property
    def label(self) -> str:
        """As pictures name it: a hypothesis is called one."""
        return f"{self.name} (hypothesis)" if self.name in ON_HYPOTHESIS else self.name


@dataclass(frozen=True, eq=False)
class Finding:
    """A number that the model found, at each scan point, and what is expected of it."""

    name: str
    meaning: str
    units: str  # empty for a plain number
    values: np.ndarray  # [points]; NaN where a point has none
    expected: np.ndarray  # [points]
    expectation: str = "closed_form"  # one of EXPECTATIONS

    @property
    def basis(self) -> str:
        """What the expected value is, in words."""
        return EXPECTATIONS.get(self.expectation, self.expectation.replace("_", " "))


@dataclass(frozen=True, repr=False, eq=False)
class Motions:
    """One file of a model."""

    path: Path
    title: str
    model: str  # its kind
    axis: Axis | None  # what is scanned
    points: tuple[tuple[Motion, ...], ...]  # [points][motions]
    findings: tuple[Finding, ...]
    program: str = ""  # name and version

    def __repr__(self) -> str:
        return f"<motions of {self.title}>"

    def to_csv(self, path: Path | str) -> None:
        """A line for each scan point with what the model found and what was expected, in SI, with the units in the header. Raises
        StorageError, and InputError for the name of a result or an experiment and a file that is no such table."""
        tables.to_csv(self, path)

    def to_dataframe(self) -> pandas.DataFrame:
        """The same for pandas; units stand in `attrs["units"]`."""
        return tables.to_dataframe(self)

    def to_xarray(self) -> xarray.Dataset:
        """What the model found over the scan, each with its `..._expected`, in SI; units stand in the `attrs` of each."""
        return tables.to_xarray(self)

    def summary(self) -> str:
        """In words."""
        from .motion_report import motion_summary
        return motion_summary(self)

    def plot(self, output: Path | str | None = None, **options: object) -> Figure:
        """The picture of `rabiline plot-motion`, with its options as keywords; written to `output` where that is given. Raises
        InputError for an option that there is not or an ending that is no picture's, and StorageError."""
        from .pictures import picture
        return picture(self, "motion", output, options)


def read(source: Path | str | bytes) -> Motions:
    """Reads the motions of a model; raises FileError."""
    path = IN_MEMORY if isinstance(source, bytes) else Path(source)
    with open_entry(source) as entry:
        if "motions" not in entry or "findings" not in entry:
            raise FileError(path, "no motions in it: not what `rabiline run` writes of a model")
        group = entry.group("findings")
        axis = _read_axis(group)
        points = axis.values.size if axis else 1
        names = entry.texts("motions")
        groups = [entry.group(f"point_{i}") for i in range(points)] if axis else [entry]
        return Motions(path, entry.text("title"), entry.text("model"), axis,
                       tuple(_read_motions(one, names) for one in groups),
                       tuple(_read_findings(group, points)), program_of(entry))


def _read_motions(point: Group, names: list[str]) -> tuple[Motion, ...]:
    """Those of the first scan point in their order, then what this point has besides: a scan may change the model."""
    own = [name for name in point.names() if name not in names
           and point.group(name).attribute("courses")]
    return tuple(_read_motion(point.group(name)) for name in [*names, *own] if name in point)


def _read_axis(group: Group) -> Axis | None:
    names = group.attribute("axes")
    if not names:
        return None
    units = "".join(group.attribute("units", of=names[0]))
    labels = group.texts(f"{names[0]}_labels") if f"{names[0]}_labels" in group else ()
    parameter = "".join(group.attribute("parameter", of=names[0])) or names[0]
    return Axis(parameter, "" if units == "1" else units, group.numbers(names[0]).ravel(), labels)


def _read_findings(group: Group, points: int) -> list[Finding]:
    names, units, meanings = (group.texts(name) for name in ("name", "units", "meaning"))
    if not len(names) == len(units) == len(meanings):
        raise group.error(f"{len(names)} findings with {len(units)} units and {len(meanings)} meanings")
    values, expected = (group.numbers(name, (len(names), points), or_none=True) for name in ("value", "expected"))
    bases = group.texts("expectation") if "expectation" in group else ("closed_form",) * len(names)
    if len(bases) != len(names):
        raise group.error(f"{len(names)} findings with {len(bases)} expectations")
    return [Finding(name, meaning, "" if unit == "1" else unit, *rows)
            for name, meaning, unit, *rows in zip(names, meanings, units, values, expected, bases)]


def _read_motion(group: Group) -> Motion:
    time = group.numbers("time").ravel()
    if time.size == 0:
        raise group.error("the motion is empty")
    position = np.column_stack([group.numbers(name, time.shape) for name in "xyz"])
    courses = tuple(_read_course(group, name, time.shape) for name in group.attribute("courses"))
    return Motion("".join(group.attribute("motion")), group.text("meaning"), time, position, courses)


def _read_course(group: Group, name: str, shape: tuple[int, ...]) -> Course:
    units = "".join(group.attribute("units", of=name))
    title = "".join(group.attribute("long_name", of=name)) or name
    return Course(name, title, "" if units == "1" else units, group.numbers(name, shape, or_none=True))

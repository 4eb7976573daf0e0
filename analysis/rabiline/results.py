"""What `rabiline run` wrote, as plain values.

Scan points are flat and row-major everywhere, as in the file: the last axis changes fastest.
"""
from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Sequence

import numpy as np

from . import tables
from .hdf5 import IN_MEMORY, INTERPOLATED, FileError, Group, open_entry
from .scan_axes import Axis, read_axis, texts_of
from .tallies import Tally, TallyAxis, read_tally

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Scan:
    """The fraction of the emitted particles that each detector caught, over the scan."""

    axes: tuple[Axis, ...]  # the outermost first; none where nothing is scanned
    detectors: tuple[str, ...]  # [detectors]
    detected: np.ndarray  # [detectors, points]
    errors: np.ndarray  # [detectors, points] one standard error
    covariance: np.ndarray | None  # [detectors, points, points] between points; None where the file has none
    detected_of_all: np.ndarray | None = None  # [detectors, points] of all leaving an aimed source; else None
    detected_of_all_errors: np.ndarray | None = None  # [detectors, points]
    count_rate: np.ndarray | None = None  # [detectors, points] 1/s with the background; None without a source's rate
    count_rate_errors: np.ndarray | None = None  # [detectors, points]

    @property
    def shape(self) -> tuple[int, ...]:
        """Points along each axis; (1,) where nothing is scanned."""
        return tuple(axis.values.size for axis in self.axes) or (1,)


@dataclass(frozen=True, eq=False)
class Levels:
    """The spin of what a detector caught: the fraction of the detected weight in each level."""

    labels: tuple[str, ...]  # [levels]
    fractions: np.ndarray  # [points, levels]; NaN where nothing was detected
    errors: np.ndarray  # [points, levels]


@dataclass(frozen=True, eq=False)
class Transit:
    """By their slowness, the particles of one species that a detector catches if they are found on a path."""

    title: str
    paths: tuple[str, ...]  # "+1/2 to -1/2": levels before and behind the fields that turn spins
    edges: np.ndarray  # [n + 1] s/m
    caught: np.ndarray  # [paths, n] particles
    errors: np.ndarray  # [paths, n]
    distance: float  # m, from the source


@dataclass(frozen=True, eq=False)
class Detector:
    """The histograms of one detector, in particles."""

    name: str
    label: str  # as pictures call it
    x_edges: np.ndarray  # [nx + 1] m, from the beam's axis, or from the centre of a detector that the scan moves
    z_edges: np.ndarray  # [nz + 1] m
    offset_x: np.ndarray  # [points] m, from the beam's axis to where the edges are counted from
    offset_z: np.ndarray  # [points] m
    counts: np.ndarray  # [points, nx, nz]
    errors: np.ndarray  # [points, nx, nz]
    counts_x: np.ndarray  # [points, nx]
    errors_x: np.ndarray  # [points, nx]
    counts_z: np.ndarray  # [points, nz]
    errors_z: np.ndarray  # [points, nz]
    levels: Levels
    background: float = 0.0  # 1/s, counts without a beam
    transits: tuple[Transit, ...] = ()  # one for each species whose slowness the file has


@dataclass(frozen=True, eq=False)
class Monitor:
    """The fraction of the emitted particles that passed a monitor."""

    name: str
    passed: np.ndarray  # [points], or [points, planes] of a monitor with several planes
    errors: np.ndarray  # same shape


@dataclass(frozen=True, eq=False)
class Fate:
    """One line of the ledger."""

    fate: str
    where: str  # the part, "chamber" or empty
    particles: np.ndarray  # [points]


@dataclass(frozen=True)
class FieldCheck:
    """Flights through fields, and levels of atoms in them, against an independent integration of a few particles."""

    particles: int  # integrated both ways; 0 where that takes too long, or none gets through
    deviation: float  # the largest of place, direction, spin and probabilities of levels
    tolerance: float  # what steps were chosen for
    approximated: bool = False  # levels are driven in the rotating-wave approximation, and not integrated


@dataclass(frozen=True, repr=False, eq=False)
class Results:
    """One file of `rabiline run`."""

    path: Path
    title: str
    program: str  # name and version
    laws: tuple[str, ...]  # [points]
    species: tuple[str, ...]  # [points]
    particles: np.ndarray  # [points] asked for
    solid_angle: float | None  # sr, of an aimed source
    aimed_fraction: np.ndarray | None  # [points] share of all that leave an aimed source that weight 1 stands for
    rate: float | None  # 1/s, particles that leave the source
    scan: Scan
    detectors: dict[str, Detector]
    monitors: dict[str, Monitor]
    tallies: dict[str, Tally]
    fates: tuple[Fate, ...]
    emitted: np.ndarray  # [points] particles
    simulation: dict[str, str]  # provenance: seed, version, threads, ...
    warnings: tuple[str, ...] = ()  # what the run warned of
    field_check: FieldCheck | None = None  # None where nothing flies in steps or through a magnet

    def __repr__(self) -> str:
        return f"<result of {self.title}>"

    @property
    def covariance_missing(self) -> bool:
        """Whether scan points share particles and the file does not say how they correlate, as with very many
        points."""
        return self.scan.covariance is None and len(self.laws) > 1 and self.simulation.get("particles") == "shared"

    @property
    def detected(self) -> np.ndarray:
        """[axes...] Fractions of the emitted particles that are detected; before the axes the detectors, where there are several."""
        return self._over_scan(self.scan.detected)

    @property
    def errors(self) -> np.ndarray:
        """[axes...] One standard error of each of `detected`."""
        return self._over_scan(self.scan.errors)

    def _over_scan(self, values: np.ndarray) -> np.ndarray:
        several = (len(self.scan.detectors),) if len(self.scan.detectors) > 1 else ()
        return values.reshape(several + tuple(axis.values.size for axis in self.scan.axes))[()]

    def to_csv(self, path: Path | str) -> None:
        """A line for each scan point of each detector, in SI, with the units in the header; columns as `to_dataframe`. Raises StorageError, and InputError
        for the name of a result or an experiment and a file that is no such table."""
        tables.to_csv(self, path)

    def to_dataframe(self) -> pandas.DataFrame:
        """The same for pandas: a row for each scan point of each detector, in SI; units stand in `attrs["units"]`. Levels have a column each, such as
        `wire: F=4 m=0`: the fraction of what this detector caught, with its `..._error`; NaN where nothing was caught, and in rows of other detectors."""
        return tables.to_dataframe(self)

    def to_xarray(self) -> xarray.Dataset:
        """Everything over the scan with its axes, in SI, as `detected`, `counts_NAME` and others, each with its `..._error`; units
        stand in the `attrs` of each."""
        return tables.to_xarray(self)

    def summary(self) -> str:
        """In words, with the fits of its lines."""
        from .report import summary
        return summary(self, self.scan.detectors)

    def plot(self, output: Path | str | None = None, kind: str | None = None, **options: object) -> Figure:
        """The picture of `rabiline plot-KIND`, "scan" where there is one and else "image", with its options as keywords:
        detector="wire", title="...", mark=["Larmor frequency=291.647 kHz"], size="86x60" (mm), dpi=300; written to `output` where that is given. Raises
        InputError for what there is not or an ending that is no picture's, and StorageError."""
        from .pictures import picture
        return picture(self, kind, output, options)


def read(source: Path | str | bytes) -> Results:
    """Reads a file of `rabiline run`, or its bytes; raises FileError with the file and the reason."""
    path = IN_MEMORY if isinstance(source, bytes) else Path(source)
    with open_entry(source) as entry:
        if "findings" in entry:
            raise FileError(path, "holds the motions of a model, not the result of a beamline: see plot-motion")
        if "scan" not in entry:
            raise FileError(path, "no `scan`: not a file of `rabiline run`, or one without a detector")
        scan = _read_scan(entry, texts_of(entry))
        points = int(np.prod(scan.shape))
        fates = entry.group("fates")
        return Results(
            path=path,
            title=entry.text("title"),
            program=program_of(entry),
            laws=_per_point(entry, "law", points),
            species=_per_point(entry, "species", points),
            particles=_particles(entry, scan, points),
            solid_angle=float(entry.sizes("solid_angle", (1,))[0]) if "solid_angle" in entry else None,
            aimed_fraction=entry.sizes("aimed_fraction", (points,)) if "aimed_fraction" in entry else None,
            rate=float(entry.sizes("rate").ravel()[0]) if "rate" in entry else None,
            scan=scan,
            detectors={name: _read_detector(entry, name, points) for name in scan.detectors},
            monitors=_read_monitors(entry, points),
            tallies={name: read_tally(entry.group(name), name, points, texts_of(entry)) for name in entry.names()
                     if entry.group(name).attribute("tally")},
            fates=_read_fates(fates, points),
            emitted=fates.sizes("emitted", (points,)),
            simulation=_read_simulation(entry) if "simulation" in entry else {},
            warnings=read_warnings(entry),
            field_check=_read_field_check(entry.group("field_check")) if "field_check" in entry else None,
        )


def _particles(entry: Group, scan: Scan, points: int) -> np.ndarray:
    """[points] What the file asks for, or what is scanned of it."""
    for axis, number in zip(scan.axes, np.unravel_index(np.arange(points), scan.shape)):
        if axis.parameter == "particles":
            if not (axis.values > 0).all():
                raise entry.error("`particles` is scanned over values that are not above zero")
            return axis.values[number]
    return np.broadcast_to(entry.sizes("particles").ravel(), points)


def program_of(entry: Group) -> str:
    """What wrote the file: its name and version."""
    version = entry.attribute("version", of="program_name") if "program_name" in entry else ()
    return " ".join((entry.text("program_name", "rabiline"), *version)).strip()


def _group_of_detector(entry: Group, name: str) -> str:
    """The group of a detector's image: its name, with underscores behind it where /entry needs the name itself."""
    group = name
    while group in entry:
        if group in entry.names() and "x_edges" in entry.group(group):
            return group
        group += "_"
    raise entry.error(f"the detector `{name}` has no image")


def _per_point(entry: Group, name: str, points: int) -> tuple[str, ...]:
    values = entry.texts(name)
    if len(values) not in (1, points):
        raise entry.error(f"`{name}` has {len(values)} values where {points} belong")
    return values * points if len(values) == 1 else values


def _read_scan(entry: Group, texts: Sequence[str]) -> Scan:
    group = entry.group("scan")
    detectors = group.texts("detector_names")
    names = [name for name in group.attribute("axes") if name not in (".", "detector_index")]
    axes = tuple(read_axis(group, name, texts) for name in names)
    points = int(np.prod([axis.values.size for axis in axes], dtype=int))
    rows = len(detectors)
    has_covariance = "detected_covariance" in group
    detected = group.shares("detected", (rows, points))
    unknown = INTERPOLATED * detected.max(initial=0.0)**2 / float(entry.sizes("particles").min())
    return Scan(
        axes=axes,
        detectors=detectors,
        detected=detected,
        errors=group.amounts("detected_errors", (rows, points)),
        covariance=group.covariance("detected_covariance", (rows, points, points), unknown) if has_covariance else None,
        **{name: group.amounts(name, (rows, points)) for name in
           ("detected_of_all", "detected_of_all_errors", "count_rate", "count_rate_errors") if name in group},
    )


def _read_detector(entry: Group, name: str, points: int) -> Detector:
    stem = _group_of_detector(entry, name)
    image, along_x, along_z, levels = (entry.group(stem + suffix) for suffix in ("", "_x", "_z", "_levels"))
    x_edges, z_edges = image.edges("x_edges"), image.edges("z_edges")
    nx, nz = x_edges.size - 1, z_edges.size - 1
    return Detector(
        name=name,
        label=image.text("title", name).removeprefix(f"{entry.text('title')}: ") or name,
        x_edges=x_edges,
        z_edges=z_edges,
        offset_x=image.numbers("offset_x", (points,)) if "offset_x" in image else np.zeros(points),
        offset_z=image.numbers("offset_z", (points,)) if "offset_z" in image else np.zeros(points),
        counts=image.amounts("counts", (points, nx, nz)),
        errors=image.amounts("counts_errors", (points, nx, nz)),
        counts_x=along_x.amounts("counts", (points, nx)),
        errors_x=along_x.amounts("counts_errors", (points, nx)),
        counts_z=along_z.amounts("counts", (points, nz)),
        errors_z=along_z.amounts("counts_errors", (points, nz)),
        levels=_read_levels(levels, points),
        background=float(image.amounts("background").ravel()[0]) if "background" in image else 0.0,
        transits=tuple(_read_transit(image.group(name)) for name in image.names() if "slowness_edges" in
                       image.group(name)),
    )


def _read_transit(group: Group) -> Transit:
    paths, edges = group.texts("path_labels"), group.edges("slowness_edges")
    shape = (len(paths), edges.size - 1)
    return Transit(group.text("title"), paths, edges, group.amounts("caught", shape),
                   group.amounts("caught_errors", shape), float(group.sizes("distance").ravel()[0]))


def _read_levels(group: Group, points: int) -> Levels:
    labels = group.texts("level_index_labels")
    shape = (points, len(labels))
    return Levels(labels, group.shares("levels", shape, or_none=True), group.amounts("levels_errors", shape, or_none=True))


def _read_monitors(entry: Group, points: int) -> dict[str, Monitor]:
    monitors = {}
    for group in map(entry.group, entry.names()):
        for name in group.attribute("monitor"):
            shape = (points, group.numbers("y").size) if "y" in group else (points,)
            monitors[name] = Monitor(name, group.amounts("passed", shape), group.amounts("passed_errors", shape))
    return monitors


def _read_fates(group: Group, points: int) -> tuple[Fate, ...]:
    fates, places = group.texts("fate"), group.texts("where")
    if len(fates) != len(places):
        raise group.error(f"{len(fates)} fates at {len(places)} places")
    particles = group.amounts("particles", (len(fates), points))
    return tuple(Fate(*line) for line in zip(fates, places, particles))


def _read_field_check(group: Group) -> FieldCheck:
    number = {name: float(group.amounts(name).ravel()[0]) for name in ("particles", "place", "direction", "spin", "levels", "tolerance")}
    return FieldCheck(int(number["particles"]), max(number[name] for name in ("place", "direction", "spin", "levels")), number["tolerance"],
                      "approximated" in group and bool(group.amounts("approximated").ravel()[0]))


def read_warnings(entry: Group) -> tuple[str, ...]:
    """What the run or the solution of a model warned of."""
    if "simulation" not in entry or "warnings" not in entry.group("simulation"):
        return ()
    return entry.group("simulation").texts("warnings")


def _read_simulation(entry: Group) -> dict[str, str]:
    group = entry.group("simulation")
    provenance = {}
    for name in ("seed", "threads"):
        if name in group:
            provenance[name] = str(group.whole_number(name))
    if "seconds" in group:
        provenance["seconds"] = f"{group.numbers('seconds').ravel()[0]:.12g}"
    for name in ("particles", "version", "instruction_set"):
        if name in group:
            provenance[name] = group.text(name)
    if "arguments" in group:
        provenance["arguments"] = shlex.join(group.texts("arguments"))
    return provenance

"""What `rabiline trace` wrote: the paths of single particles."""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import tables
from .hdf5 import IN_MEMORY, FileError, Group, open_entry
from .results import program_of

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

SAME_PLACE = 1e-9  # m
FASTER_THAN_FIELDS = 100  # times the usual rate at which a track's polar angle changes


@dataclass(frozen=True, eq=False)
class Track:
    """The path of one particle."""

    particle: int
    law: str  # empty where the file does not say
    species: str
    fate: str
    where: str  # the part that decided its fate
    time: np.ndarray  # [n] s
    position: np.ndarray  # [n, 3] m, y along the beam
    velocity: np.ndarray  # [n, 3] m/s
    spin: np.ndarray  # [n, 3] unit vector; NaN where it is not followed
    weight: np.ndarray  # [n] what filters, gas and the like have left of it, 1 at first
    polarizers: tuple[float, ...] | None = None  # [m] where spins are aligned; None where the file does not say

    @property
    def ending(self) -> str:
        """Its fate in words, with the place."""
        where = f"{'by' if self.fate == 'stopped' else 'at'} {self.where}" if self.where else ""
        return f"{self.fate.replace('_', ' ')} {where}".strip()

    @property
    def has_spin(self) -> bool:
        """Whether the spin is followed along the whole path."""
        return bool(np.isfinite(self.spin).all())

    @cached_property
    def stretches(self) -> list[slice]:
        """The records between alignments, in which only fields turn the spin; what is before the first one is chance where no
        field turns it. An alignment changes the spin in no time, or in the midst of a field's steps faster by
        far than the field tips spins; along z, about which a static field turns them fast, a field changes them slowly.
        That is a guess, which is made at polarizers only where it is known where they are."""
        polar = np.arctan2(np.hypot(self.spin[:, 0], self.spin[:, 1]), self.spin[:, 2])
        moved, taken = np.abs(np.diff(polar)), np.diff(self.time)
        turned = np.linalg.norm(np.diff(self.spin, axis=0), axis=1)
        at_once = (taken <= 0) & (turned > 1e-9)
        rate = moved / np.where(taken > 0, taken, np.inf)
        by_fields = rate[rate > 0]
        usual = np.median(by_fields) if by_fields.size > 2 else np.inf
        jumps = np.flatnonzero(at_once | (moved > 1e-3) & (rate > FASTER_THAN_FIELDS * usual) & self._passes_polarizer)
        first = jumps.size > 0 and turned[:jumps[0]].max(initial=0.0) < 1e-9  # nothing turned it
        edges = [*([] if first else [0]), *(jumps + 1).tolist(), self.time.size]
        return [slice(*pair) for pair in zip(edges, edges[1:]) if pair[1] > pair[0]]

    @property
    def _passes_polarizer(self) -> np.ndarray:
        """[n - 1] Whether one may stand between a record and the next."""
        if self.polarizers is None:
            return np.ones(self.time.size - 1, bool)
        low, high = np.sort((self.position[:-1, 1], self.position[1:, 1]), axis=0)
        return np.any([(low <= at + SAME_PLACE) & (at - SAME_PLACE <= high) for at in self.polarizers] or [low > high], axis=0)

    @cached_property
    def tilt(self) -> np.ndarray:
        """[n] The angle between the spin and the z axis, +z or -z whichever was nearer at the beginning of the stretch, rad: a spin
        that is flipped comes to 180 degrees."""
        pole = np.ones(self.time.size)
        for part in self.stretches:
            pole[part] = -1.0 if self.spin[part.start, 2] < 0 else 1.0
        return np.arctan2(np.hypot(self.spin[:, 0], self.spin[:, 1]), pole * self.spin[:, 2])


@dataclass(frozen=True)
class Part:
    """A part of the beamline, along the beam."""

    name: str
    kind: str
    label: str
    begin: float  # m
    end: float  # m
    has_field: bool
    drives: bool


@dataclass(frozen=True, repr=False, eq=False)
class Tracks:
    """One file of `rabiline trace`."""

    path: Path
    title: str
    law: str  # empty where the file does not say
    tracks: tuple[Track, ...]  # by particle number
    parts: tuple[Part, ...] = ()  # what they pass
    program: str = ""  # name and version

    def __repr__(self) -> str:
        return f"<{len(self.tracks)} track{'s' if len(self.tracks) > 1 else ''} of {self.title}>"

    def to_csv(self, path: Path | str) -> None:
        """A line for each record of each path, in SI, with the units in the header: time, position, velocity and spin. Raises StorageError,
        and InputError for the name of a result or an experiment and a file that is no such table."""
        tables.to_csv(self, path)

    def to_dataframe(self) -> pandas.DataFrame:
        """The same for pandas; units stand in `attrs["units"]`."""
        return tables.to_dataframe(self)

    def summary(self) -> str:
        """In words."""
        from .track_report import track_summary
        return track_summary(self)

    def plot(self, output: Path | str | None = None, **options: object) -> Figure:
        """The picture of `rabiline plot-tracks`, with its options as keywords; written to `output` where that is given. Raises
        InputError for an option that there is not or an ending that is no picture's, and StorageError."""
        from .pictures import picture
        return picture(self, "tracks", output, options)


def read(source: Path | str | bytes) -> Tracks:
    """Reads a file of `rabiline trace`; raises FileError with the file and the reason."""
    path = IN_MEMORY if isinstance(source, bytes) else Path(source)
    with open_entry(source) as entry:
        names = [name for name in entry.names() if name.startswith("particle_")]
        if not names:
            raise FileError(path, "no tracks in it: not a file of `rabiline trace`")
        parts = _read_parts(entry)
        polarizers = tuple(part.begin for part in parts if part.kind == "polarizer") if parts else None
        tracks = (_read_track(entry.group(name), name, polarizers) for name in names)
        ordered = tuple(sorted(tracks, key=lambda track: track.particle))
        return Tracks(path, entry.text("title"), entry.text("law", ordered[0].law), ordered, parts, program_of(entry))


def _read_parts(entry: Group) -> tuple[Part, ...]:
    if "parts" not in entry:
        return ()
    group = entry.group("parts")
    numbers = [group.numbers(name).ravel() for name in ("begin", "end", "has_field", "drives")]
    if (numbers[0] > numbers[1]).any():
        raise group.error("a part ends before it begins")
    return tuple(Part(*words, begin, end, bool(field), bool(drives)) for *words, begin, end, field, drives in
                 zip(*(group.texts(name) for name in ("name", "kind", "label")), *numbers))


def _read_track(group: Group, name: str, polarizers: tuple[float, ...] | None) -> Track:
    time = group.numbers("t").ravel()
    if time.size == 0:
        raise group.error("the track is empty")

    def vectors(names: str, or_none: bool = False) -> np.ndarray:
        return np.stack([group.numbers(one, time.shape, or_none=or_none) for one in names.split()], axis=1)

    def attribute(key: str) -> str:
        return "".join(group.attribute(key))

    number = attribute("particle") or name.removeprefix("particle_")
    if not number.isdigit():
        raise group.error("the particle has no number")
    return Track(int(number), attribute("law"), attribute("species"), attribute("fate"), attribute("where"), time,
                 vectors("x y z"), vectors("vx vy vz"), vectors("sx sy sz", or_none=True),
                 group.numbers("weight", time.shape) if "weight" in group else np.ones(time.size), polarizers)

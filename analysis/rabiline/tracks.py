"""What `rabiline trace` wrote: the paths of single particles."""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .hdf5 import FileError, Group, open_entry


@dataclass(frozen=True)
class Track:
    """The path of one particle."""

    particle: int
    species: str
    fate: str
    where: str  # the part that decided its fate
    time: np.ndarray  # [n] s
    position: np.ndarray  # [n, 3] m, y along the beam
    velocity: np.ndarray  # [n, 3] m/s
    spin: np.ndarray  # [n, 3] unit vector; NaN where the law has none

    @property
    def has_spin(self) -> bool:
        """Whether the law gives the particle a spin vector."""
        return bool(np.isfinite(self.spin).all())


@dataclass(frozen=True)
class Tracks:
    """One file of `rabiline trace`."""

    path: Path
    title: str
    law: str  # empty where the file does not say
    tracks: tuple[Track, ...]  # by particle number


def read(path: Path | str) -> Tracks:
    """Reads a file of `rabiline trace`; raises FileError with the file and the reason."""
    with open_entry(path) as entry:
        names = [name for name in entry.names() if name.startswith("particle_")]
        if not names:
            raise FileError(path, "no tracks in it: not a file of `rabiline trace`")
        tracks = (_read_track(entry.group(name), name) for name in names)
        ordered = tuple(sorted(tracks, key=lambda track: track.particle))
        return Tracks(Path(path), entry.text("title"), entry.text("law"), ordered)


def _read_track(group: Group, name: str) -> Track:
    time = group.numbers("t").ravel()
    if time.size == 0:
        raise group.error("the track is empty")

    def vectors(names: str) -> np.ndarray:
        return np.stack([group.numbers(one, time.shape) for one in names.split()], axis=1)

    def attribute(key: str) -> str:
        return "".join(group.attribute(key))

    number = attribute("particle") or name.removeprefix("particle_")
    if not number.isdigit():
        raise group.error("the particle has no number")
    return Track(int(number), attribute("species"), attribute("fate"), attribute("where"), time,
                 vectors("x y z"), vectors("vx vy vz"), vectors("sx sy sz"))

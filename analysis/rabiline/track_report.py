"""What a file of `rabiline trace` holds, in words."""
from __future__ import annotations

from collections import Counter
from typing import Iterable

import numpy as np

from .tracks import Tracks
from .units import format_value, law_name


def track_summary(file: Tracks) -> str:
    """Lines about the paths: how they end, and how far they lead."""
    return "\n".join(_lines(file))


def track_numbers(file: Tracks) -> dict[str, object]:
    """The same as numbers in SI, for other programs."""
    return {"title": file.title, "program": file.program, "law": _laws(file),
            "tracks": [{"particle": track.particle, "species": track.species, "fate": track.fate, "where": track.where, "records": int(track.time.size),
                        "time": float(np.ptp(track.time)), "end": track.position[-1].tolist()} for track in file.tracks]}


def _laws(file: Tracks) -> list[str]:
    return list(dict.fromkeys(track.law or file.law for track in file.tracks))


def _lines(file: Tracks) -> Iterable[str]:
    yield file.title or file.path.name
    yield from (f"  {name:<12} {text}" for name, text in (
        ("written by", file.program), ("law", "; ".join(filter(None, map(law_name, _laws(file))))),
        ("species", "; ".join(filter(None, dict.fromkeys(track.species for track in file.tracks)))),
        ("paths", f"{len(file.tracks)}, of {sum(track.time.size for track in file.tracks)} records")) if text)
    for fate, number in Counter(track.ending for track in file.tracks).most_common():
        yield f"  fate         {fate}: {number}"
    ends = np.array([track.position[-1, 1] for track in file.tracks])
    times = np.array([np.ptp(track.time) for track in file.tracks])
    yield f"  end          at y = {_from_to(ends, 'm')}, after {_from_to(times, 's')}"


def _from_to(values: np.ndarray, unit: str) -> str:
    low, high = (format_value(float(f"{value:.4g}"), unit) for value in (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"

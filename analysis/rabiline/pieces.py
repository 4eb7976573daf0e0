"""Scans with gaps, whose stretches between are shown and read each by itself."""
from __future__ import annotations

from typing import Sequence

import numpy as np

from .curves import Curve
from .units import is_logarithmic

GAP = 8.0  # usual steps of a scan, from which on it has a gap
MOST_PIECES = 4


def pieces_of(curves: Sequence[Curve]) -> list[slice]:
    """What of a scan has a panel of its own: all of it, or stretches with gaps between, if they are long and few."""
    whole = [slice(0, curves[0].x.size)]
    if curves[0].axis.labels or len({curve.x.tobytes() for curve in curves}) > 1:
        return whole
    found = runs_of(curves[0].x)
    return found if len(found) <= MOST_PIECES and min(part.stop - part.start for part in found) >= 5 else whole


def runs_of(x: np.ndarray) -> list[slice]:
    """The stretches of a scan between its gaps: steps many times as long as most."""
    steps = np.abs(np.diff(x))
    if steps.size < 4:
        return [slice(0, x.size)]
    ends = [0, *(np.flatnonzero(steps > GAP * np.median(steps)) + 1).tolist(), x.size]
    few = is_logarithmic(x) or len(ends) > x.size // 3 + 2
    return [slice(0, x.size)] if few else [slice(*pair) for pair in zip(ends, ends[1:])]

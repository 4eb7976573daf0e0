"""How far parameters of a fit may go: an efficiency up to 1, a temperature to above 0, a slit to the part in front of it."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Callable

import numpy as np

NARROW = 1e-3  # of the way to where a parameter may not go
USUAL = 0.0, 1.0  # where limits are, as a rule


@dataclass
class Limits:
    """Of parameters [k] in SI, each with the others where they start; found as they are asked for."""

    may_be: Callable[[np.ndarray], bool]
    start: np.ndarray
    _known: dict[tuple[int, bool], float] = field(default_factory=dict)  # by number, and whether upwards

    def beyond(self, values: np.ndarray) -> dict[int, float]:
        """Which of these values are out of reach, and the last one that the parameter may have on the way there."""
        found = {i: self._limit(i, value) for i, value in enumerate(values[:self.start.size])}
        return {i: limit for i, limit in found.items() if limit is not None}

    def _limit(self, number: int, value: float) -> float | None:
        start = self.start[number]
        side = number, bool(value > start)
        if side in self._known:
            return self._known[side] if abs(value - start) > abs(self._known[side] - start) else None
        if self._alone(number, value):
            return None
        inside, outside = start, value
        for usual in USUAL:
            if min(inside, outside) <= usual <= max(inside, outside) and self._alone(number, usual):
                inside = usual
        while abs(outside - inside) > NARROW * abs(value - start):
            middle = (inside + outside) / 2
            inside, outside = (middle, outside) if self._alone(number, middle) else (inside, middle)
        self._known[side] = inside
        return inside

    def _alone(self, number: int, value: float) -> bool:
        values = self.start.copy()
        values[number] = value
        return self.may_be(values)

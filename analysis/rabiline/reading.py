"""What is told of the dips and peaks of a curve, in words and in pictures: decided here and nowhere else.

A fitted centre and width are told only where the fit describes the curve. Where chi² rejects it, or nothing tests it, they would be numbers
of the model; what stands there instead is read off the curve itself, at half maximum, and called so.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .curves import Curve, NoResonance, Resonance, are_fringes, half_maxima
from .fit import Fit, fit
from .pieces import pieces_of
from .swings import maxima

FEWEST, DEEP = 4, 0.4  # maxima and minima of a comb, and how far the curve goes between them, of all that it changes by
EVEN = 1.5  # between the largest and the smallest of their distances, which are those of a comb
ALIKE = 0.2  # relative: by which heights and distances of side lobes on both sides differ at most


@dataclass(frozen=True)
class Reading:
    """The dips or peaks of a curve, by rising x."""

    at_half_maximum: tuple[Resonance, ...]
    fit: Fit | None  # where it describes the curve
    why_no_fit: str = ""
    is_fringe: bool = False

    @property
    def resonances(self) -> tuple[Resonance, ...]:
        """What is told: fitted if possible, else read off."""
        return self.fit.resonances if self.fit else self.at_half_maximum

    @property
    def how(self) -> str:
        """Where the numbers of `resonances` come from, and what they may be."""
        where = "central fringe, half way to the extremes beside it" if self.is_fringe else "fitted" if self.fit else "read off at half maximum"
        return where + (f"; {LOBES}" if self.may_be_lobes else "")

    @property
    def may_be_lobes(self) -> bool:
        """Whether all others stand in pairs about the highest and fall off from it, as side lobes of a strong field do, and multiplets."""
        found, middle = self.at_half_maximum, len(self.at_half_maximum) // 2
        if len(found) < 3 or len(found) % 2 == 0:
            return False
        pairs = [(found[middle - i], found[middle + i], found[middle - i + 1]) for i in range(1, middle + 1)]
        off = found[middle].centre.value
        return all(_alike(left.depth.value, right.depth.value) and _alike(off - left.centre.value, right.centre.value - off)
                   and left.depth.value < (1 - ALIKE) * inner.depth.value for left, right, inner in pairs)


LOBES = "the outer ones may be side lobes of the middle one"


def _alike(one: float, other: float) -> bool:
    return abs(one - other) < ALIKE * max(one, other)


@dataclass(frozen=True)
class Comb:
    """Maxima and minima in turns at even distances, with a long way between: fringes."""

    maxima: int
    distance: float  # in the unit of the curve's axis


def comb_of(curve: Curve) -> Comb | None:
    """None where the curve is no comb."""
    if curve.axis.labels or curve.y.size < 2 * FEWEST or len(pieces_of([curve])) > 1:
        return None
    way = max(DEEP * np.ptp(curve.y), 5 * float(np.median(curve.errors)))
    tops, bottoms = (maxima(sign * curve.y, way) for sign in (1, -1))
    turns = np.sort(np.concatenate([tops, bottoms]))
    if turns.size < FEWEST or np.isin(turns[1:], tops).tolist() != np.isin(turns[:-1], bottoms).tolist():
        return None
    steps = np.diff(curve.x[turns])
    return Comb(tops.size, 2 * float(steps.mean())) if steps.max() < EVEN * steps.min() else None


def readings_of(curve: Curve) -> list[tuple[Curve, Reading | NoResonance]]:
    """Of each stretch of a scan with gaps, or of all of it: what is told, or why nothing is."""
    found: list[tuple[Curve, Reading | NoResonance]] = []
    for part in map(curve.piece, pieces_of([curve])):
        try:
            found.append((part, reading_of(part)))
        except NoResonance as problem:
            found.append((part, problem))
    return found


def reading_of(curve: Curve) -> Reading:
    """Raises NoResonance where the curve shows no dip or peak that could be measured."""
    seen = tuple(half_maxima(curve))
    try:
        found = fit(curve)
    except NoResonance as problem:
        return Reading(seen, None, str(problem), are_fringes(curve))
    if found.weighted:
        return Reading(seen, found)
    tested = found.chi_squared
    return Reading(seen, None, f"no line shape describes this: {tested}" if tested.freedom else f"nothing tests a line shape here: {tested}")

"""What is told of the dips and peaks of a curve, in words and in pictures: decided here and nowhere else.

A fitted centre and width are told only where the fit describes the curve. Where chi² rejects it, or nothing tests it, they would be numbers
of the model; what stands there instead is read off the curve itself, at half maximum, and called so.
"""
from __future__ import annotations

from dataclasses import dataclass

from .curves import Curve, NoResonance, Resonance, half_maxima
from .fit import Fit, fit


@dataclass(frozen=True)
class Reading:
    """The dips or peaks of a curve, by rising x."""

    at_half_maximum: tuple[Resonance, ...]
    fit: Fit | None  # where it describes the curve
    why_no_fit: str = ""

    @property
    def resonances(self) -> tuple[Resonance, ...]:
        """What is told: fitted if possible, else read off."""
        return self.fit.resonances if self.fit else self.at_half_maximum

    @property
    def how(self) -> str:
        """Where the numbers of `resonances` come from."""
        return "fitted" if self.fit else "read off at half maximum"


def reading_of(curve: Curve) -> Reading:
    """Raises NoResonance where the curve shows no dip or peak that could be measured."""
    seen = tuple(half_maxima(curve))
    try:
        found = fit(curve)
    except NoResonance as problem:
        return Reading(seen, None, str(problem))
    if found.weighted:
        return Reading(seen, found)
    tested = found.chi_squared
    return Reading(seen, None, f"no line shape describes this: {tested}" if tested.freedom else f"nothing tests a line shape here: {tested}")

"""What a fit would say with one more parameter of the exposure free.

A chi² over many points hardly sees one direction: a background that makes it rise by 16 of 48 leaves p as it was, while parameters
that imitate a background have moved by many of their errors. So that direction is asked for by itself, on the surface that
the fit has at its end. How far Q falls with the parameter free is distributed as chi² of one degree of freedom where what is held is
right (Wilks, Ann. Math. Stat. 9, 60, 1938). Far from there the surface is not that of the experiment: values are a direction and no result.
A fit that has been led far away may stand where that surface shows nothing; then a search from where it started has the answer.
"""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .counts_problem import Problem
from .curve_model import BACKGROUND, SCALE

LEANS, ASKS = 4.0, 9.0  # falls of Q, of two standard deviations and of three
PART = 0.01  # of the counts
OF_EXPOSURE = (SCALE, BACKGROUND)


@dataclass(frozen=True)
class Held:
    """A parameter that was not free, and the fit with it free."""

    name: str
    value: float  # where Q is least
    fall: float  # of Q
    moved: np.ndarray  # [k] the fit's parameters, in their errors
    by_part: np.ndarray  # [k] the same where this parameter is off by as much as is PART of all counts
    searched: bool = False  # from where the fit started, with a curve flown there: else on the surface where it came to rest

    @property
    def is_wanted(self) -> bool:
        """Whether the counts contradict what it is held at, lean towards something that would move a parameter by its error, or fit as well far away."""
        return self.searched or self.fall > ASKS or self.fall > LEANS and bool((np.abs(self.moved) > 1).any())

    @property
    def is_possible(self) -> bool:
        """Whether it may be so: no background takes counts away."""
        return self.value >= 0

    @property
    def matters(self) -> bool:
        """Whether the errors of the fit hang on its being known."""
        return bool((np.abs(self.by_part) > 1).any())


def held(problem: Problem, values: np.ndarray, errors: np.ndarray) -> tuple[Held, ...]:
    """What of the exposure was not free in a fit that has come to rest at `values` [k] with `errors` [k]."""
    found, k = [], values.size
    surface = replace(problem.surface, noise=np.zeros_like(problem.surface.noise))  # a noisy slope weighs wrongly, but it is one
    for name in filter(lambda name: name not in problem.extra, OF_EXPOSURE):
        freed, start = replace(problem, surface=surface, extra=(*problem.extra, name)), np.append(values, problem.start(name, values))
        mu, slopes, _ = freed.mean(start)
        fisher = freed.fisher(start, freed.modes(start))
        part = PART * mu.sum() / slopes[k].sum()
        moved, least = freed.least(start)
        found.append(Held(name, float(moved[k]), freed.least(start, [k])[1] - least,
                          (moved[:k] - values) / errors, -part * fisher.of(range(k)).inverse @ fisher.matrix[:k, k] / errors))
    return tuple(found)

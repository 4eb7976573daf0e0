"""How far each parameter may go: where Q, least over all others, is one above its least value.

Of a parameter that bends the curve little this is asked of the surface. Where edges or the top of the curve are near, a polynomial is not
believed: many particles fly at places farther and farther off, and what they change is added to the curve of all. Should one of
these places fit better than where the fit is, it was not at the minimum.
"""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import optimize

from .counts_problem import Fisher, Problem, shares_of_simulation
from .curve_model import STRENGTHS, CurveModel, NoFit, meets_an_edge

FARTHEST = 4.0  # standard deviations, on a surface
STRIDES = 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0  # likewise, of a walk
MOST_WALKING = 200000  # particles: what they change from place to place is known far better than what they count
MOSTLY = 0.5  # of a variance: where so much is the simulation's, an interval shorter than the error by the curvature is a minimum that it has by chance
BENT = 0.05  # of what is known of a parameter: so much by its bend
SHORTER = 0.7  # than the error by the curvature where a parameter is: the interval has come to where the curve bends
MIDDLES = 101  # places tried for the least of two halves of parabolas
ENOUGH = 9.0  # of Q, above the least: farther off nobody asks
LOWER = 0.2  # of Q: less may be the noise of what is explored


@dataclass(frozen=True)
class Profiles:
    """What was found."""

    intervals: tuple[tuple[float, float], ...]  # in errors, from where the fit is
    errors: np.ndarray  # times those by the curvature: half the interval, where that was flown or is much shorter
    lower: np.ndarray | None  # values where Q is lower


def profiles(model: CurveModel, problem: Problem, values: np.ndarray, everywhere: bool) -> Profiles:
    """About the `values` [k] of a fit; of parameters that bend the curve and, with `everywhere`, of all."""
    fisher = problem.fisher(values, problem.modes(values))
    if not fisher.directions[2].all():
        return Profiles(((-1.0, 1.0),) * values.size, np.ones(values.size), None)
    errors, k = np.sqrt(np.diag(fisher.covariance)), len(model.names)
    _, least = problem.least(values)
    is_least, bent = problem.least(values, range(k))[1] < least + LOWER, _bent(problem, fisher)
    by_counts = np.append((shares_of_simulation(problem, values) < MOSTLY)[:len(model.names)], [True] * len(problem.extra))
    intervals, factors, lowest = [(-1.0, 1.0)] * values.size, np.ones(values.size), (-LOWER, None)
    for i in range(values.size):
        if i in bent or i < k and not is_least:
            flown, lower = _flown(model, problem, values, i, errors[i])
            lowest = min(lowest, lower, key=lambda one: one[0])
        if i in bent:
            half = np.ptp(flown) / 2 if np.isfinite(flown).all() else 1.0
            # Of two that bend the walk may miss the best of the other.
            factors[i] = half if bent.size == 1 and by_counts[i] else max(half, 1.0)
            intervals[i] = tuple(factors[i] / half * side for side in flown)
        elif everywhere and is_least:
            found = _on_surface(problem, values, i, errors[i], least)
            half = np.ptp(found) / 2
            factors[i] = half if half < SHORTER and by_counts[i] else 1.0
            intervals[i] = found if by_counts[i] else tuple(max(1.0, 1.0 / half) * side for side in found)
    return Profiles(tuple(intervals), factors, lowest[1])


def _bent(problem: Problem, fisher: Fisher) -> np.ndarray:
    """[any] Of which parameters much is known by bends alone, where the exposure's are free, or an edge is within a step."""
    surface, k = problem.surface, problem.surface.centre.size
    edges = [meets_an_edge(np.maximum(surface.y, 0), surface.slopes[i], surface.bends[i, i]) for i in range(k)]
    matrix = fisher.matrix[:k, :k] - fisher.matrix[:k, k:] @ np.linalg.pinv(fisher.matrix[k:, k:], hermitian=True) @ fisher.matrix[k:, :k]
    return np.flatnonzero((np.diag(fisher.bent)[:k] > BENT * np.diag(matrix)) | np.array(edges, dtype=bool))


def _on_surface(problem: Problem, values: np.ndarray, number: int, error: float, least: float) -> tuple[float, float]:
    """Where the surface's Q is one above its `least`, in errors."""
    def beyond(by: float) -> float:
        """By how many standard deviations Q has risen, which is nearly in proportion to `by`, less one."""
        moved = np.array(values)
        moved[number] += by * error
        return float(np.sqrt(max(problem.least(moved, (number,))[1] - least, 0.0))) - 1

    ends = []
    for side in (-1.0, 1.0):
        try:
            ends.append(side * optimize.brentq(lambda by: beyond(side * by), 0.0, FARTHEST, xtol=1e-3))
        except ValueError:
            ends.append(side * np.inf)
    return ends[0], ends[1]


def _flown(model: CurveModel, problem: Problem, values: np.ndarray, number: int, error: float) -> tuple[tuple[float, float], tuple[float, np.ndarray]]:
    """The same of what flies there; and by how much Q is lower where it is least, and that place."""
    def at(by: float) -> tuple[float, np.ndarray]:
        moved = np.array(values)
        moved[number] += by * error
        return flown(problem.least(moved, (number,))[0] if by else moved)

    k, walking = len(model.names), min(model.particles, MOST_WALKING)
    surface = problem.surface

    def flown(place: np.ndarray) -> tuple[float, np.ndarray]:
        """The others follow the slopes, from what flies there."""
        if place[number] * values[number] < 0 and model.names[number].endswith(STRENGTHS):
            return np.inf, place
        try:
            change = model.at(place[:k], walking).y - model.at(surface.centre, walking).y
        except NoFit:  # no such value
            return np.inf, place
        there = replace(surface, centre=place[:k], y=np.maximum(surface.y + change, 0))
        place, badness = replace(problem, surface=there).least(place, (number,))
        return badness, place

    here = at(0.0)
    if not np.isfinite(here[0]):  # beyond what the parameters may be, by far
        return (-np.inf, np.inf), (0.0, values)
    walked = {0.0: here}
    for side in (-1.0, 1.0):
        for stride in STRIDES:
            walked[side * stride] = at(side * stride)
            if walked[side * stride][0] > ENOUGH + min(one[0] for one in walked.values()):
                break
    at_all = np.array(sorted(walked))
    middle, least, ends = halves(at_all, np.array([walked[by][0] for by in at_all]))
    return ends, (least - float(np.interp(0.0, at_all, [walked[by][0] for by in at_all])), at(middle)[1])


def halves(at: np.ndarray, badness: np.ndarray) -> tuple[float, float, tuple[float, float]]:
    """Where Q [n], known `at` rising places, is least, its value there, and where it is one above: of two halves of parabolas, since what flies
    trembles from place to place."""
    known = np.isfinite(badness)
    at, badness = at[known], badness[known]
    weights = 1 / (1 + badness - badness.min())
    best = np.inf, 0.0, np.zeros(3)
    for middle in np.linspace(at[0], at[-1], MIDDLES):
        left, right = np.minimum(at - middle, 0)**2, np.maximum(at - middle, 0)**2
        found, off = optimize.nnls(weights[:, None] * np.stack([np.ones(at.size), left, right], axis=1), weights * (badness - badness.min() + 1))
        best = min(best, (off, middle, found), key=lambda one: one[0])
    _, middle, (level, *bends) = best
    with np.errstate(divide="ignore"):
        low, high = 1 / np.sqrt(bends)
    return float(middle), float(level - 1 + badness.min()), (float(middle - low), float(middle + high))

"""Parameters of an experiment from measured counts, with the simulation itself as line shape.

n_i counts are Poisson about mu_i = E_i s (y_i + d_i) + b t_i: y the simulated fraction, d what it may be off, normal with the
covariance of the simulation; E the exposure, s its factor, which is free unless it is known, and b a background. The fit
minimises Q = 2 sum[mu - n + n ln(n/mu)] + z.z over the parameters, with d = L z and L the root of the covariance, as Conway
(PHYSTAT 2011) does for one factor per bin. Q is that of a polynomial surface about the minimum (`curve_model.Surface`).
"""
from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Callable, Sequence

import numpy as np
from scipy import optimize, stats

from .counts import Counts, read_counts
from .curve_model import CurveModel, NoFit, Surface
from .experiment import Experiment

LEAST_MODE = 1e-4  # of the Poisson variance: smaller modes of the simulation's covariance do not matter
DEGENERATE = 1e-4  # ratio of the eigenvalues of the parameters' correlation, below which a direction is not known
NOISE = 4.0  # likewise, times what the slopes' own noise makes of a direction that changes nothing
MOST_ITERATIONS = 25
REST = 0.1  # standard deviations: nearer than that, the last step was the last
SCALE, BACKGROUND = "scale", "background"  # of the exposure, and counts at each point (per mean time)


@dataclass(frozen=True)
class Exposure:
    """How many counts a detected fraction means."""

    each: np.ndarray  # [n] counts where the fraction is 1
    time: np.ndarray  # [n] in units of the mean time
    background: np.ndarray  # [n] counts, known
    is_known: bool  # else a factor is free


@dataclass(frozen=True)
class Problem:
    """What is fitted: counts and the curve about some place. Parameters are those of the surface, then the free ones of the
    exposure."""

    counts: np.ndarray
    exposure: Exposure
    surface: Surface
    extra: tuple[str, ...]  # SCALE, BACKGROUND

    def mean(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """mu [n], its derivatives [parameters, n], and mu by y [n]."""
        k = self.surface.centre.size
        free = dict(zip(self.extra, values[k:]))
        y, slopes = self.surface.at(values[:k])
        each = self.exposure.each * free.get(SCALE, 1.0)
        mu = each * y + self.exposure.background + free.get(BACKGROUND, 0.0) * self.exposure.time
        rows = [each * slopes]
        rows += [(self.exposure.each * y)[None]] if SCALE in free else []
        rows += [self.exposure.time[None]] if BACKGROUND in free else []
        return np.maximum(mu, 1e-9), np.concatenate(rows), each

    def modes(self, mu: np.ndarray, each: np.ndarray) -> np.ndarray:
        """[n, r] What the simulation may be off, in counts, as columns that are each one standard deviation."""
        root = np.sqrt(np.maximum(mu, 1.0))
        values, vectors = np.linalg.eigh(self.surface.covariance * each[:, None] * each / root[:, None] / root)
        kept = values > LEAST_MODE
        return root[:, None] * vectors[:, kept] * np.sqrt(values[kept])

    @property
    def least_ratio(self) -> float:
        """Of eigenvalues of the parameters' correlation, for a direction to be known."""
        return max(DEGENERATE, NOISE * float(np.max(1 / np.maximum(self.surface.moved, 1), initial=0.0)))

    def badness(self, values: np.ndarray, modes: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Q, its gradient, and half of the expected second derivatives."""
        mu, slopes, _ = self.mean(values)
        z = np.zeros(modes.shape[1])
        for _ in range(20):  # Newton's method with the expected curvature
            shifted = np.maximum(mu + modes @ z, 1e-3 * mu)
            score = modes.T @ (self.counts / shifted - 1) - z
            step = np.linalg.solve(modes.T @ (modes / shifted[:, None]) + np.eye(z.size), score) if z.size else z
            z = z + step
            if np.abs(step).max(initial=0.0) < 1e-6:
                break
        shifted = np.maximum(mu + modes @ z, 1e-3 * mu)
        n = self.counts
        q = 2 * np.sum(shifted - n + n * np.log(np.maximum(n, 1e-300) / shifted)) + z @ z
        weighted = self.weigh(slopes.T, mu, modes)
        return float(q), -2 * slopes @ (n / shifted - 1), slopes @ weighted

    @staticmethod
    def weigh(columns: np.ndarray, mu: np.ndarray, modes: np.ndarray) -> np.ndarray:
        """V^-1 columns, V = diag(mu) + modes modesᵀ."""
        inner = np.eye(modes.shape[1]) + modes.T @ (modes / mu[:, None])
        return columns / mu[:, None] - modes / mu[:, None] @ np.linalg.solve(inner, modes.T @ (columns / mu[:, None]))

    def least(self, values: np.ndarray, fixed: Sequence[int] = ()) -> tuple[np.ndarray, float]:
        """The minimum from `values` on, with some parameters held, and Q there. Directions that are not known stay."""
        mu, _, each = self.mean(values)
        modes = self.modes(mu, each)
        moving = [i for i in range(values.size) if i not in fixed]
        q, gradient, fisher = self.badness(values, modes)
        for _ in range(MOST_ITERATIONS if moving else 0):
            step = np.zeros(values.size)
            step[moving] = _known_step(fisher[np.ix_(moving, moving)], -gradient[moving] / 2, self.least_ratio)
            factor, better = 1.0, None
            while better is None and factor > 1e-3:
                tried = values + factor * step
                found = self.badness(tried, modes)
                better = (tried, found) if found[0] <= q + 1e-12 else None
                factor /= 2
            if better is None:
                break
            gained = q - better[1][0]
            values, (q, gradient, fisher) = better
            if gained < 1e-6:
                break
        return values, q


def share_of_simulation(problem: Problem, values: np.ndarray) -> float:
    """Which part of the variance of a parameter is the simulation's, at most; its next flight may differ by that."""
    mu, slopes, each = problem.mean(values)
    fisher = slopes @ problem.weigh(slopes.T, mu, problem.modes(mu, each))
    counted = slopes @ (slopes.T / mu[:, None])
    whole, part = (np.diag(np.linalg.pinv(matrix, rcond=1e-10, hermitian=True)) for matrix in (fisher, counted))
    return float(np.clip(1 - part / np.maximum(whole, 1e-300), 0, 1).max())


def _known_step(fisher: np.ndarray, score: np.ndarray, least_ratio: float) -> np.ndarray:
    """fisher^-1 score, without the directions that the data do not know."""
    size = np.sqrt(np.maximum(np.diag(fisher), 1e-300))
    values, vectors = np.linalg.eigh(fisher / size[:, None] / size)
    inverse = np.where(values > least_ratio * values.max(), 1 / np.maximum(values, 1e-300), 0.0)
    return vectors @ (inverse * (vectors.T @ (score / size))) / size


@dataclass(frozen=True)
class Direction:
    """A combination of parameters that the data do not know: all changed by these parts of themselves, nothing happens."""

    names: tuple[str, ...]
    parts: np.ndarray  # relative changes, the largest 1

    def __str__(self) -> str:
        changes = ", ".join(f"`{name}` by {100 * part:+.3g} %" for name, part in zip(self.names, self.parts)
                            if abs(part) > 0.02)
        return f"degenerate: {changes} together change next to nothing"


@dataclass(frozen=True)
class CountsFit:
    """What the counts say."""

    names: tuple[str, ...]  # the free parameters, then those of the exposure
    units: tuple[str, ...]
    values: np.ndarray  # SI
    errors: np.ndarray  # one standard deviation, by the curvature
    covariance: np.ndarray
    intervals: tuple[tuple[float, float], ...]  # where Q is one above its least value
    chi_squared: float  # Pearson's, with the covariance of the simulation
    freedom: int
    condition: float  # of the parameters' correlation
    degenerate: tuple[Direction, ...]
    combined: tuple[tuple[str, float, float], ...]  # what is known of what is degenerate: "a/b", value, error
    counts: Counts
    expected: np.ndarray  # [n] counts
    template_errors: np.ndarray  # [n] of `expected`, from the simulation
    detector: str
    title: str
    flights: int
    share_of_simulation: float  # of the variance of a parameter, the largest
    particles: int  # at each point of the simulation
    start: np.ndarray = field(repr=False, default_factory=lambda: np.zeros(0))

    @property
    def p(self) -> float:
        """Of chi²."""
        return float(stats.chi2.sf(self.chi_squared, self.freedom))

    def __getitem__(self, name: str) -> tuple[float, float]:
        """Value and error of a parameter."""
        i = self.names.index(name)
        return float(self.values[i]), float(self.errors[i])

    def __str__(self) -> str:
        from .fit_report import report
        return "\n".join(report(self))

    def plot(self, output: Path | str | None = None) -> object:
        """Counts, the fitted curve and the residuals."""
        from . import style
        from .fit_plots import draw_fit
        with style.here():
            figure = draw_fit(self)
        if output is not None:
            style.save(figure, output)
        return figure


def fit_counts(experiment: Experiment, data: Counts | str | Path, free: Sequence[str], *, detector: str | None = None,
               threads: int = 0, start: dict[str, float] | None = None, intervals: bool = True, explore: int = 0,
               told: Callable[[int, int, float], None] | None = None) -> CountsFit:
    """Fits parameters of the experiment, in SI, from where the file has them or from `start`. `free` may have `scale` and
    `background` too. The exposure is known where the data have `emitted`, or `seconds` and the file the source's `rate`; else
    a scale is free. `explore` particles, by default a quarter of all and 5000 at most, show how the curve changes with the
    parameters; `told` hears of each flight its number, particles and seconds."""
    counts = data if isinstance(data, Counts) else read_counts(data, detector)
    names = [name for name in free if name not in (SCALE, BACKGROUND)]
    model = CurveModel(experiment, counts.parameter, counts.places, names, detector or counts.detector, threads,
                       counts.across and (counts.across.parameter, counts.across.places), explore, told)
    values = model.start()
    for name, value in (start or {}).items():
        values[names.index(name)] = value
    exposure = exposure_of(model, counts, values)
    extra = tuple(name for name in (SCALE, BACKGROUND) if name in free or (name == SCALE and not exposure.is_known))
    values = np.concatenate([values, [_first_scale(model, counts, exposure, values) if name == SCALE else
                                      0.1 * counts.counts.min() for name in extra]])
    values, problem = _settle(model, *_search(model, counts, exposure, extra, values))
    return _conclude(model, counts, problem, values, intervals)


def exposure_of(model: CurveModel, counts: Counts, values: np.ndarray) -> Exposure:
    """From the table and the file."""
    n = counts.counts.size
    time = np.ones(n) if counts.seconds is None else counts.seconds / counts.seconds.mean()
    background, per_second = np.zeros(n), None
    if counts.seconds is not None:
        flown = model.scanned.set({**model.changes(values), "particles": model.explored}).fly()
        background = flown.detectors[model.detector].background * counts.seconds
        i = flown.scan.detectors.index(model.detector)
        if flown.scan.count_rate is not None and counts.emitted is None:
            clean = flown.scan.count_rate[i] - flown.detectors[model.detector].background
            per_second = np.sum(clean) / np.sum(flown.scan.detected[i])
    if counts.emitted is not None:
        return Exposure(counts.emitted, time, background, True)
    if per_second is not None:
        return Exposure(per_second * counts.seconds, time, background, True)
    return Exposure(time, time, background, False)


def _first_scale(model: CurveModel, counts: Counts, exposure: Exposure, values: np.ndarray) -> float:
    seen = np.sum(exposure.each * model.at(values[:len(model.names)]).y)
    if seen <= 0:
        raise NoFit(f"`{model.detector}` counts nothing at the start values: nothing to fit")
    return max(np.sum(counts.counts - exposure.background), 1.0) / seen


def _search(model: CurveModel, counts: Counts, exposure: Exposure, extra: tuple[str, ...],
            values: np.ndarray) -> tuple[np.ndarray, Problem]:
    """Surfaces about better and better places, with steps of one standard deviation and more."""
    k = len(model.names)
    steps = model.first_steps(values[:k])
    reach, near = np.inf, 0
    before = np.inf
    for turn in range(MOST_ITERATIONS):
        crossed = turn > 0 and reach < 3
        problem = Problem(counts.counts, exposure, Surface.about(model, values[:k], steps, crossed), extra)
        mu, _, each = problem.mean(values)
        here = problem.badness(values, problem.modes(mu, each))
        errors = 1 / np.sqrt(np.maximum(np.diag(here[2]), 1e-300))
        found, _ = problem.least(values)
        # As far as the surface is believed: a few steps, less where the last one led uphill.
        moves = (found - values)[:k] / steps
        limit = 4.0 if here[0] < before else 1.0
        short = min(1.0, limit / max(np.abs(moves).max(initial=0.0), 1e-300))
        reach = float(np.sqrt((found - values) @ here[2] @ (found - values) / values.size))  # in standard deviations
        before = here[0]
        if crossed and reach**2 < REST**2 + share_of_simulation(problem, found):
            return found, problem
        # What leads to and fro between two stairs is halved and halved again: they differ by the simulation's own noise.
        near = near + 1 if reach < 3 else 0
        part = 0.5 ** max(near - 2, 0)
        values = values + short * part * (found - values)
        if crossed and part * reach < REST / 2:
            return values, problem
        # Steps of about one standard deviation see the curve as the data do.
        close = np.abs(moves) < 4
        steps = np.array([model.step(values[:k], i, np.clip(errors[i], steps[i] / 10 if close[i] else steps[i], 10 * steps[i]))
                          for i in range(k)])
    raise NoFit("the fit does not come to rest: start nearer, or free fewer parameters")


def _settle(model: CurveModel, values: np.ndarray, problem: Problem) -> tuple[np.ndarray, Problem]:
    """The same with all particles, about where the search came to rest, and then about where that leads, with steps of one
    standard deviation as the counts know it."""
    k = len(model.names)
    for turn in range(MOST_ITERATIONS if model.explored < model.particles else 0):
        problem = replace(problem, surface=problem.surface.whole(model))
        mu, _, each = problem.mean(values)
        fisher = problem.badness(values, problem.modes(mu, each))[2]
        found, _ = problem.least(values)
        reach = float(np.sqrt((found - values) @ fisher @ (found - values) / values.size))
        if turn > 0 and reach < 1:
            return found, problem
        errors = 1 / np.sqrt(np.maximum(np.diag(fisher), 1e-300))
        moves = np.abs((found - values)[:k] / problem.surface.steps).max(initial=0.0)
        values = values + min(1.0, 4 / max(moves, 1e-300)) * (found - values)
        steps = np.array([model.step(values[:k], i, errors[i]) for i in range(k)])
        problem = replace(problem, surface=Surface.about(model, values[:k], steps))
    if model.explored < model.particles:
        raise NoFit("the fit does not come to rest with all particles: start nearer, or free fewer parameters")
    return values, problem


def _conclude(model: CurveModel, counts: Counts, problem: Problem, values: np.ndarray, intervals: bool) -> CountsFit:
    k = len(model.names)
    mu, slopes, each = problem.mean(values)
    modes = problem.modes(mu, each)
    fisher = slopes @ problem.weigh(slopes.T, mu, modes)
    covariance, condition, degenerate, combined = _analysis(fisher, values, model.names, problem.least_ratio)
    residual = counts.counts - mu
    chi_squared = float(residual @ problem.weigh(residual[:, None], mu, modes)[:, 0])
    errors = np.sqrt(np.diag(covariance))
    _, least = problem.least(values)
    found = tuple(_interval(problem, values, i, float(errors[i]), least) if intervals and not degenerate else
                  (float(values[i] - errors[i]), float(values[i] + errors[i])) for i in range(values.size))
    units = (*model.units, *("" for _ in problem.extra))
    return CountsFit((*model.names, *problem.extra), units, values, errors, covariance, found, chi_squared,
                     counts.counts.size - values.size + len(degenerate), condition, degenerate, combined, counts, mu,
                     np.sqrt(np.sum(modes**2, axis=1)), str(model.detector), model.experiment.title, model.flights,
                     share_of_simulation(problem, values), model.particles, model.start()[:k])


def _analysis(fisher: np.ndarray, values: np.ndarray, names: Sequence[str], least_ratio: float
              ) -> tuple[np.ndarray, float, tuple[Direction, ...], tuple[tuple[str, float, float], ...]]:
    """Covariance, condition number, and what is degenerate."""
    size = np.sqrt(np.maximum(np.diag(fisher), 1e-300))
    eigenvalues, vectors = np.linalg.eigh(fisher / size[:, None] / size)
    largest = eigenvalues.max()
    condition = float(largest / max(eigenvalues.min(), 1e-16 * largest))
    known = eigenvalues > least_ratio * largest
    inverse = (vectors[:, known] / eigenvalues[known]) @ vectors[:, known].T
    covariance = inverse / size[:, None] / size
    directions, combined = [], []
    labels = [*names, SCALE, BACKGROUND][:values.size]
    for vector in vectors[:, ~known].T:
        relative = vector / size / np.where(values == 0, 1.0, values)
        relative = relative / relative[np.argmax(np.abs(relative))]
        directions.append(Direction(tuple(labels), relative))
        combined += _combination(labels, relative, values, covariance)
    if not known.all():  # what is not known has no error: as large as the parameter itself, at least
        free = np.abs(vectors[:, ~known]).max(axis=1) > 0.05
        grown = np.where(free, np.abs(values), 0.0)
        covariance = covariance + np.diag(grown**2)
    return covariance, condition, tuple(directions), tuple(combined)


def _combination(labels: Sequence[str], relative: np.ndarray, values: np.ndarray,
                 covariance: np.ndarray) -> list[tuple[str, float, float]]:
    """Of two degenerate parameters, the product of powers that the data do know."""
    involved = [i for i in range(values.size) if abs(relative[i]) > 0.1]
    if len(involved) != 2 or (values[involved] == 0).any():
        return []
    first, second = involved
    power = -relative[first] / relative[second]
    name = f"{labels[first]} × {labels[second]}^{power:.2f}" if abs(power + 1) > 0.02 else \
        f"{labels[first]} / {labels[second]}"
    power = -1.0 if abs(power + 1) <= 0.02 else power
    logarithm = np.zeros(values.size)
    logarithm[first], logarithm[second] = 1 / values[first], power / values[second]
    value = float(values[first] * values[second]**power)
    return [(name, value, abs(value) * float(np.sqrt(logarithm @ covariance @ logarithm)))]


def _interval(problem: Problem, values: np.ndarray, number: int, error: float, least: float) -> tuple[float, float]:
    """Where Q, least over all others, is one above its least value."""
    def rise(by: float) -> float:
        moved = np.array(values)
        moved[number] += by * error
        return problem.least(moved, (number,))[1] - least - 1

    ends = []
    for side in (-1.0, 1.0):
        try:
            ends.append(side * optimize.brentq(lambda by: rise(side * by), 0.0, 4.0, xtol=1e-3))
        except ValueError:
            ends.append(side * np.inf)
    return float(values[number] + ends[0] * error), float(values[number] + ends[1] * error)

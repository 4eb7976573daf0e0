"""How well a measurement that has not been made will know parameters: the expected curvature of its likelihood at the values of
the file."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Callable, Sequence

import numpy as np

from . import asked
from .argument_types import LARGEST
from .counts import names_of
from .counts_problem import REACH, UNSEEN, Exposure, Problem
from .curve_model import BACKGROUND, SCALE, CurveModel, NoFit, require_free
from .experiment import Experiment
from .directions import Direction, analysis
from .fit_report import few_particles
from .surface import Surface
from .units import format_value

TURNS = 3  # for steps of about one standard deviation


@dataclass(frozen=True, repr=False, eq=False)
class Forecast:
    """What is to be expected."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: np.ndarray  # SI, of the file
    errors: np.ndarray
    covariance: np.ndarray
    condition: float
    degenerate: tuple[Direction, ...]
    combined: tuple[tuple[str, float, float], ...]
    bent: tuple[str, ...]  # over whose errors the counts bend more than they change
    particles: int  # of the simulation
    wanted_particles: float  # more than these where what is not known may be for their noise
    counts: np.ndarray  # [n] expected
    problem: Problem
    written: tuple[tuple[str, float] | None, ...]  # units in the file, and how much each is in SI

    def __str__(self) -> str:
        width = max(map(len, self.names))
        lines = [f"{self.counts.size} points with {self.counts.min().round(6):.4g} to {self.counts.max():.4g} counts, "
                 f"{self.counts.sum():.4g} in all"]
        unknown = [any(i in direction.involved for direction in self.degenerate) for i in range(len(self.names))]
        lines += [f"  {name:<{width}}  " + ("not known by itself" if lost else format_value(value, unit, error, written))
                  for name, unit, value, error, lost, written in zip(self.names, self.units, self.values, self.errors, unknown, self.written)]
        lines += [f"  {name}: {value:.6g} ± {error:.2g} in SI" for name, value, error in self.combined]
        lines += [f"  {direction}" for direction in dict.fromkeys(map(str, self.degenerate))]
        if self.wanted_particles > self.particles:
            lines.append(f"  help: {few_particles(self.particles, self.wanted_particles)}")
        else:
            lines += [f"  over such an error of `{name}` the counts do not change in proportion: take it as not known" for name in self.bent]
        return "\n".join([*lines, f"  condition number {self.condition:.3g}"])

    __repr__ = __str__


@np.errstate(all="ignore")  # of steps that lead nowhere
def forecast(experiment: Experiment, free: Sequence[str], *, rate: float | None = None, seconds: float = 1.0,
             background: float | None = None, known_rate: bool = False, detector: str | None = None,
             threads: int | None = None, told: Callable[[int, int, bool, float], None] | None = None) -> Forecast:
    """For the file's one scan, `seconds` at each point. `rate` particles leave the source per second, or start towards the
    target of an aimed one; by default what the file states. `background` counts per second, of the detector by default. The
    factor of the exposure is free unless `known_rate`. `told` hears the flights as that of `CurveModel` does. Raises NoFit where nothing can be forecast, and InputError as `load` does."""
    free = asked.names("free", free)
    for name, value in (("rate", rate), ("seconds", seconds)):
        if value is not None and not 0 < asked.number(name, value) <= LARGEST:
            raise NoFit(f"`{name}` is {value}, and must be above 0, up to {LARGEST:g}")
    if background is not None and not 0 <= asked.number("background", background) <= LARGEST:
        raise NoFit(f"`background` is {background}, and must be 0 or above, up to {LARGEST:g}")
    flown = experiment.set(particles=1000).fly()
    axes = flown.core.axes
    if len(axes) != 1 or axes[0][3]:
        raise NoFit(f"{experiment.path}: a forecast is for one scan over a numeric parameter, and this file has "
                    f"{' and '.join(axis[0] for axis in axes) or 'none'}: name it with --scan, after --no-scan")
    parameter, unit, values, _ = axes[0]
    places = tuple(f"{value!r} {unit}".strip() for value in values.tolist())
    parameter = ",".join(names_of(parameter))
    names = [name for name in free if name not in (SCALE, BACKGROUND)]
    model = CurveModel(experiment, parameter, places, names, asked.name("detector", detector), asked.threads(threads), told=told)
    each = _counts_each(model, flown, rate, seconds)
    if background is None:
        background = flown.detectors[model.detector].background
    n = values.size
    exposure = Exposure(np.full(n, each), np.ones(n), np.full(n, background * seconds), known_rate)
    extra = tuple(name for name in (SCALE, BACKGROUND) if name in free or name == SCALE and not known_rate)
    require_free((*names, *extra))
    start = model.start()
    model.scaled, model.counted = SCALE in extra, each * model.at(start).y
    full = np.concatenate([start, [exposure.start(name) for name in extra]])
    steps = model.first_steps(start)
    turns = TURNS
    while turns > 0:
        problem = Problem(np.zeros(n), exposure, Surface.about(model, start, steps, crossed=False), extra)
        fisher = problem.fisher(full, _unseen(problem))
        steps = np.array([model.step(start, i, error) for i, error in enumerate(fisher.errors[:start.size])])
        turns -= 1
        if turns == 0 and fisher.more_particles > 1 and model.explore_more():
            turns = 1
    problem = replace(problem, surface=problem.surface.whole(model, model.particles))
    mu, _, _ = problem.mean(full)
    fisher = problem.fisher(full, _unseen(problem))
    covariance, condition, degenerate, combined = analysis(fisher, full, (*names, *extra))
    errors = np.sqrt(np.diag(covariance))
    return Forecast((*names, *extra), (*model.units, *("" for _ in extra)), full, errors, covariance, condition, degenerate,
                    combined, _bent(names, problem.surface, errors), model.particles, model.particles * fisher.more_particles, mu, problem,
                    (*(experiment.written_unit(name.split("+")[0]) for name in names), *(None for _ in extra)))


def _unseen(problem: Problem) -> np.ndarray:
    """[n, r] Modes of a simulation without errors, but where it saw nothing."""
    return np.diag(UNSEEN * np.sqrt(np.diag(problem.surface.covariance)))[:, problem.surface.y <= 0]


def _bent(names: Sequence[str], surface: Surface, errors: np.ndarray) -> tuple[str, ...]:
    """The parameters that matter to second order more than to first, over errors beyond where the surface is believed."""
    noise = np.sqrt(np.maximum(surface.y, 1e-3 * surface.y.max()))
    off = errors[:len(names)] / surface.steps  # in steps
    straight, bent = (np.linalg.norm(own / noise, axis=1) for own in (surface.slopes, np.einsum("iin->in", surface.bends)))
    return tuple(name for i, name in enumerate(names) if off[i] > REACH and bent[i] * off[i] > straight[i])


def _counts_each(model: CurveModel, flown: object, rate: float | None, seconds: float) -> float:
    """Counts where the fraction is 1."""
    if rate is not None:
        return rate * seconds
    if flown.scan.count_rate is None:
        raise NoFit("how many particles leave the source per second is not known: --rate, or `rate` in the file's source")
    i = flown.scan.detectors.index(model.detector)
    clean = flown.scan.count_rate[i] - flown.detectors[model.detector].background
    return float(np.sum(clean) / np.sum(flown.scan.detected[i]) * seconds)

"""Parameters of an experiment from measured counts, with the simulation itself as line shape.

The fit minimises Q (`counts_problem`) over the parameters, with a curve that is a polynomial surface about the minimum
(`curve_model.Surface`).
"""
from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Callable, Mapping, Sequence

import numpy as np
from scipy import stats

from . import asked
from .counts import Counts, read_counts
from .counts_problem import Fisher, Problem, shares_of_simulation
from .covariance import LEAST_P
from .curve_model import BACKGROUND, LARGEST_STEP, SCALE, CurveModel, NoFit, check_columns, require_free
from .directions import Direction, analysis
from .errors import as_keywords
from .experiment import Experiment
from .exposures import Exposure, exposure_of, first_scale
from .held import ASKS, Held, held
from .profiles import Profiles, profiles
from .surface import Surface
from .units import format_value

if TYPE_CHECKING:
    import pandas

MOST_ITERATIONS = 25
SLIGHT = 0.1  # of what the counts change
MANY = 20  # times those explored: so many particles fly once
REST = 0.1  # standard deviations: nearer than that, the last step was the last
MOST_MINIMA = 4  # that a walk along the profiles leads to
FAR = 4.0  # steps: as far as a surface is followed, and twice as far each time after that has led to a better place
PARTS_OF_THE_WAY = 1.0, 0.5, 0.25  # to where a surface promises less, beyond its reach


@dataclass(frozen=True)
class Rival:
    """Another minimum, that the counts hardly tell from the one of the fit."""

    values: np.ndarray  # [k]
    rise: float  # of Q


@dataclass(frozen=True, repr=False, eq=False)
class CountsFit:
    """What the counts say."""

    names: tuple[str, ...]  # the free parameters, then those of the exposure
    units: tuple[str, ...]
    values: np.ndarray  # [k] in `units`, which are SI
    errors: np.ndarray  # [k] one standard deviation, by the curvature; as large as the value where it is in what is `degenerate`
    covariance: np.ndarray  # [k, k]
    intervals: tuple[tuple[float, float], ...]  # where Q is one above its least value
    chi_squared: float  # Pearson's, with the covariance of the simulation, and of one count or more at each point
    freedom: int  # of the points, each as a part where less than one count is expected
    condition: float  # of the parameters' correlation
    degenerate: tuple[Direction, ...]
    combined: tuple[tuple[str, float, float], ...]  # what is known of what is degenerate: "a/b", value, error
    counts: Counts
    expected: np.ndarray  # [n] counts
    template_errors: np.ndarray  # [n] of `expected`, from the simulation
    detector: str
    title: str
    flights: int
    shares_of_simulation: np.ndarray  # [parameters of the curve, else of the exposure] of their variance
    particles: int  # at each point of the simulation
    wanted_particles: float  # more than these where what is not known may be for their noise
    beyond: tuple[tuple[str, float], ...] = ()  # parameters that ended beyond what they may be, and their limit in SI
    held: tuple[Held, ...] = ()  # what of the exposure was not free
    start: np.ndarray = field(repr=False, default_factory=lambda: np.zeros(0))  # [free parameters] SI
    written: tuple[tuple[str, float] | None, ...] = ()  # units of the free parameters in the file, and how much each is in SI
    about_background: str = ""  # where it comes from, or why there is none, where the table does not say over which time it was counted
    searches: int = 1  # from so many places, where the points are too sparse for one, or the first came to rest at a curve that is none of the counts'
    sparse: bool = False
    rivals: tuple[Rival, ...] = ()

    @property
    def p(self) -> float:
        """Of chi²."""
        return float(stats.chi2.sf(self.chi_squared, self.freedom))

    @property
    def share_of_simulation(self) -> float:
        """The largest of them."""
        return float(self.shares_of_simulation.max(initial=0.0))

    @property
    def is_flat(self) -> bool:
        """Whether the counts change over the places of the table by more than chance, and the fitted curve by less than a tenth of that."""
        time = next((each for each in (self.counts.emitted, self.counts.seconds) if each is not None), np.ones(self.expected.size))
        changes = []
        for values in (self.counts.counts, self.expected):
            level = time * values.sum() / time.sum()
            changes.append(float(np.sum((values - level)**2 / level)))
        return bool(stats.chi2.sf(changes[0], self.expected.size - 1) < LEAST_P and changes[1] < SLIGHT**2 * changes[0])

    def __getitem__(self, name: str) -> tuple[float, float]:
        """Value and error of a parameter; the error is infinite where the counts do not know it."""
        i = asked.place_of(name, self.names)
        return float(self.values[i]), np.inf if any(i in direction.involved for direction in self.degenerate) else float(self.errors[i])

    def __repr__(self) -> str:
        from .fit_report import told_shortly
        return f"<fit of {self.title}: {', '.join(told_shortly(self, i) for i in range(len(self.names)))}>"

    def told(self, number: int) -> str:
        """A parameter's value with its error, in the unit that the file has."""
        return format_value(self.values[number], self.units[number], self.errors[number], self.written_unit(number))

    def written_unit(self, number: int) -> tuple[str, float] | None:
        """The unit of a parameter in the file, and how much it is in SI; None where it has none."""
        return self.written[number] if number < len(self.written) else None

    def __str__(self) -> str:
        from .fit_report import report
        return "\n".join(report(self))

    def plot(self, output: Path | str | None = None, *, size: str | tuple[float, float] | None = None, title: str | None = None,
             dpi: float = 200) -> object:
        """Counts, the fitted curve and the residuals; written to `output` where that is given. `size` in mm, "86x60" or a pair. Raises OSError,
        TypeError, and errors.InputError for an ending that is no picture's or a size that has no room."""
        from .fit_plots import draw_fit
        from .picture_options import drawn
        with as_keywords():
            return drawn(lambda: draw_fit(self, title), output, size, dpi)


@np.errstate(all="ignore")  # of values that lead nowhere
def fit_counts(experiment: Experiment, data: Counts | str | Path | pandas.DataFrame, free: Sequence[str], *, detector: str | None = None,
               threads: int | None = None, start: dict[str, float | str] | None = None, intervals: bool = True, explore: int = 0,
               told: Callable[[int, int, bool, float], None] | None = None) -> CountsFit:
    """Fits parameters of the experiment, in SI, from where the file has them or from `start`. `free` may have `scale` and
    `background` too. The exposure is known where the data have `emitted`, or `seconds` and the file the source's `rate`; else
    a scale is free. `explore` particles, by default a quarter of all and 5000 at most or more where this needs them, show how
    the curve changes with the parameters; `told` hears of each flight its number, particles, whether these fly in one, and seconds. Raises NoFit where nothing can be fitted, FileError
    for a table that cannot be used, InputError as `load` does, TypeError, and ValueError for fewer than 0 to explore."""
    free, detector, explore = asked.names("free", free), asked.name("detector", detector), asked.whole_number("explore", explore)
    counts = data if isinstance(data, Counts) else read_counts(data, detector)
    check_columns(experiment, counts)
    names = [name for name in free if name not in (SCALE, BACKGROUND)]
    model = CurveModel(experiment, counts.parameter, counts.places, names, detector or counts.detector, asked.threads(threads),
                       counts.across and (counts.across.parameter, counts.across.places), explore, told)
    values = model.start()
    if not isinstance(start, (Mapping, type(None))):
        raise TypeError(f"`start` is a mapping of names and values, not {type(start).__name__}")
    for name, value in (start or {}).items():
        first, i = name.split("+")[0], asked.place_of(name, tuple(names), (SCALE, BACKGROUND))
        values[i] = experiment.scan().set({first: value}).value(first) if isinstance(value, str) else asked.number(f"start[{name!r}]", value)
    exposure = exposure_of(model, counts, values)
    extra = tuple(name for name in (SCALE, BACKGROUND) if name in free or (name == SCALE and not exposure.is_known))
    require_free((*names, *extra))
    if counts.counts.size < len(names) + len(extra):
        raise NoFit(f"{len(names) + len(extra)} parameters are free ({', '.join((*names, *extra))}), and there are only {counts.counts.size} points to know them by")
    model.scaled, model.counted = SCALE in extra, counts.counts
    scale = 1.0 if exposure.is_known else first_scale(model, counts, exposure, values)
    values = np.concatenate([values, [scale if name == SCALE else exposure.start(name, scale) or 0.1 * counts.counts.min() for name in extra]])
    first = values
    values, problem = _settle(model, *_search(model, counts, exposure, extra, values))
    sparse = counts.are_sparse(problem.surface.y, problem.surface.covariance)
    rejected = stats.chi2.sf(_flown(model, problem, values), counts.counts.size - values.size) < LEAST_P
    others = _searched_beside(model, counts, problem, values) if sparse or rejected else []
    if others and others[0][0] < _flown(model, problem, values):
        values, problem = _settle(model, *others[0][1:])
    found = profiles(model, problem, values, intervals)
    ended = [(values, problem, found)]
    for _ in range(MOST_MINIMA):
        if found.lower is None:
            break
        if (np.abs(found.lower - values)[:len(names)] > FAR * problem.surface.steps).any():
            values, problem = _search(model, counts, exposure, extra, found.lower)
        else:
            values, problem = found.lower, replace(problem, surface=Surface.about(model, found.lower[:len(names)], problem.surface.steps))
        values, problem = _settle(model, values, problem)
        found = profiles(model, problem, values, intervals)
        ended.append((values, problem, found))
    if len(ended) > 1:  # what walks promise on the polynomial need not be so where it flies
        values, problem, found = min(ended, key=lambda one: _flown(model, one[1], one[0], model.particles))
    return replace(_conclude(model, counts, problem, first, values, found), searches=1 + len(others), sparse=sparse, rivals=_rivals(model, problem, values, found, others))


def _searched_beside(model: CurveModel, counts: Counts, problem: Problem, values: np.ndarray) -> list[tuple[float, np.ndarray, Problem]]:
    """Q, values and the problem where searches come to rest that begin on both sides of `values`, half of what the curve shows away: the best first.
    A curve that is off its counts by that much between two points is as good as one that is not, so that one search may end anywhere."""
    surface, found = problem.surface, []
    weights = 1 / np.maximum(surface.y, 1e-3 * surface.y.max())
    for i in range(len(model.names)):
        half = np.sqrt(np.sum(weights * surface.slopes[i]**2) / max(np.sum(weights * surface.bends[i, i]**2), 1e-300)) / 2
        for side in (1, -1):
            beside = values.copy()
            beside[i] += side * half * surface.steps[i]
            try:
                there, its = _search(model, counts, problem.exposure, problem.extra, beside)
                found.append((_flown(model, its, there), there, its))
            except NoFit:
                continue
    return sorted(found, key=lambda one: one[0])


def _rivals(model: CurveModel, problem: Problem, values: np.ndarray, profiled: Profiles, others: list[tuple[float, np.ndarray, Problem]]) -> tuple[Rival, ...]:
    """Of these, each once, that are as good but for three standard deviations, and far away."""
    errors = profiled.errors * np.sqrt(np.diag(problem.fisher(values, problem.modes(values)).covariance))
    here, rivals = _flown(model, problem, values), []
    for badness, there, _ in others:
        if badness < here + ASKS and all((np.abs(there - one) > FAR * errors)[:len(model.names)].any() for one in (values, *(one.values for one in rivals))):
            rivals.append(Rival(there, badness - here))
    return tuple(rivals)


def _search(model: CurveModel, counts: Counts, exposure: Exposure, extra: tuple[str, ...],
            values: np.ndarray) -> tuple[np.ndarray, Problem]:
    """Surfaces about better and better places, with steps of one standard deviation and more."""
    k = len(model.names)
    steps, reach, far = model.first_steps(values[:k]), np.inf, FAR
    for turn in range(MOST_ITERATIONS):
        crossed = turn > 0 and reach < 3
        problem = Problem(counts.counts, exposure, Surface.about(model, values[:k], steps, crossed), extra)
        fisher = problem.fisher(values, problem.modes(values))
        found, _ = problem.least(values)
        moves = np.abs((found - values)[:k] / steps)
        reach = float(np.sqrt((found - values) @ fisher.matrix @ (found - values) / values.size))  # in standard deviations
        at_rest = crossed and reach**2 < REST**2 + shares_of_simulation(problem, found).max(initial=0.0)
        better = None if at_rest else _better(model, problem, fisher, values, found, far=far)
        if better is None and crossed:
            if fisher.directions[2].all() or not model.explore_more():
                return found if at_rest else values, problem
        elif better is None:
            reach = 0.0  # once more, with all bends
        else:
            gone = np.abs((better - values)[:k] / steps).max(initial=0.0)
            far, values = max(FAR, 2 * far if gone > 0.9 * far else gone), better
        # Steps of about one standard deviation see the curve as the data do.
        close = moves < FAR
        steps = np.array([model.step(values[:k], i, np.clip(fisher.errors[i], steps[i] / 10 if close[i] else steps[i], 10 * steps[i]))
                          for i in range(k)])
    if k == 0:  # where the counts are far off, their weights go to and fro with a factor and a background that are found anyway
        return values, problem
    noisy = counts.counts.max() > model.particles
    raise NoFit("the fit does not come to rest: " + (
        f"the counts know the curve better than {model.particles} simulated particles at each point: fly more --particles" if noisy else
        "start nearer, or free fewer parameters"))


def _better(model: CurveModel, problem: Problem, fisher: Fisher, values: np.ndarray, found: np.ndarray, particles: int | None = None,
            far: float = FAR) -> np.ndarray | None:
    """The first place on the way from `values` to what the surface promises, no more than `far` steps of it and then half as far each time,
    at which the curve that is flown there fits better. None where nothing does but what is as good as here."""
    k = len(model.names)
    if k == 0:  # the surface is the curve
        return found
    _, here = problem.least(values, range(k))

    def on(way: np.ndarray) -> np.ndarray | None:
        way = way * min(1.0, far / max(np.abs(way[:k] / problem.surface.steps).max(initial=0.0), 1e-300))
        while way @ fisher.matrix @ way > REST**2 * way.size:
            there = values + way
            try:
                changed = model.at(there[:k], particles)
            except NoFit:  # no such value
                way = way / 2
                continue
            there, badness = replace(problem, surface=Surface.level(changed, there[:k])).least(there, range(k))
            if badness < here:
                return there
            way = way / 2
        return None

    way = found - values
    better = on(way)
    if better is None and way @ fisher.matrix @ way > FAR**2 * way.size:  # what is hardly known leads astray what is
        ways = sorted((way * one for one in np.eye(way.size)[:k]), key=lambda one: -(one @ fisher.matrix @ one))
        better = next((there for there in map(on, ways) if there is not None), None)
    return better


def _settle(model: CurveModel, values: np.ndarray, problem: Problem) -> tuple[np.ndarray, Problem]:
    """The same with all particles, about where the search came to rest, and about where that leads as long as the noise of slopes, or bends,
    matters on the way: nearer than that, what moves is the simulation's own noise. Where all are many times those explored, some lead there
    first: all then fly once."""
    k = len(model.names)
    some = [round(np.sqrt(model.explored * model.particles))] if model.particles > MANY * model.explored else []
    for particles in [*some, *(model.particles for _ in range(MOST_ITERATIONS))]:
        problem = replace(problem, surface=problem.surface.whole(model, particles))
        modes = problem.modes(values)
        fisher = problem.fisher(values, modes)
        found, _ = problem.least(values)
        moves = np.abs((found - values)[:k] / problem.surface.steps).max(initial=0.0)
        if moves < 1 and particles == model.particles and _is_there(problem, fisher, values, found, modes):
            return found, problem
        better = _better(model, problem, fisher, values, found, particles)
        if better is None and particles == model.particles:
            return values, problem
        moved, values = values, values if better is None else better
        if np.abs((values - moved)[:k] / problem.surface.steps).max(initial=0.0) < 1:
            problem = replace(problem, surface=problem.surface.moved(values[:k]))
            continue
        steps = np.array([model.step(values[:k], i, fisher.errors[i]) for i in range(k)])
        problem = replace(problem, surface=Surface.about(model, values[:k], steps))
    raise NoFit("the fit does not come to rest with all particles: start nearer, or free fewer parameters")


def _is_there(problem: Problem, fisher: Fisher, values: np.ndarray, found: np.ndarray, modes: np.ndarray) -> bool:
    """Whether the noise of the slopes, and what bends on the way, put the minimum that is `found` from `values` on elsewhere by next to
    nothing, in standard deviations; where not all directions are known, whether it is within one."""
    way = found - values
    if not problem.fisher(found, modes).directions[2].all():
        return bool(way @ fisher.matrix @ way < values.size)
    mu, slopes, each, _ = problem.together(values, modes)
    surface = problem.surface
    moves = way[:surface.steps.size] / surface.steps
    off = each * np.vstack([np.einsum("gkn,k->gn", surface.noise, moves), np.einsum("jkn,j,k->n", surface.bends, moves, moves)])
    scores = slopes @ problem.weigh(off.T, mu, each[:, None] * modes)
    return bool(np.sum(scores * (fisher.inverse @ scores)) < REST**2 * values.size)


def _conclude(model: CurveModel, counts: Counts, problem: Problem, first: np.ndarray, values: np.ndarray, profiled: Profiles) -> CountsFit:
    k = len(model.names)
    modes = problem.modes(values)
    mu, _, each = problem.mean(values)
    fisher = problem.fisher(values, modes)
    covariance, condition, degenerate, combined = analysis(fisher, values, (*model.names, *problem.extra))
    intervals = tuple((float(value + low * error), float(value + high * error))
                      for value, error, (low, high) in zip(values, np.sqrt(np.diag(covariance)), profiled.intervals))
    covariance = profiled.errors[:, None] * covariance * profiled.errors
    some = np.maximum(problem.together(values, modes)[0], 1.0)  # what little is expected tests nothing, and one count there is no miracle
    chi_squared = float((counts.counts - mu) @ problem.weigh((counts.counts - mu)[:, None], some, each[:, None] * modes)[:, 0])
    errors = np.sqrt(np.diag(covariance))
    units = (*model.units, *("" for _ in problem.extra))
    others = _held(model, counts, problem, first, values, errors) if all(direction.hidden for direction in degenerate) else ()
    return CountsFit((*model.names, *problem.extra), units, values, errors, covariance, intervals, chi_squared,
                     max(round(float(np.sum(np.minimum(mu, 1.0)))) - values.size + len(degenerate), 0), condition, degenerate, combined, counts, mu,
                     each * np.sqrt(np.sum(modes**2, axis=1)), str(model.detector), model.experiment.title, model.flights,
                     shares_of_simulation(problem, values), model.particles, model.particles * fisher.more_particles,
                     tuple((model.names[i], limit) for i, limit in model.limits.beyond(values).items()), others, start=model.start()[:k],
                     about_background="" if BACKGROUND in problem.extra else problem.exposure.about,
                     written=tuple(model.experiment.written_unit(name.split("+")[0]) for name in model.names))


def _held(model: CurveModel, counts: Counts, problem: Problem, first: np.ndarray, values: np.ndarray, errors: np.ndarray) -> tuple[Held, ...]:
    """What was not free, asked for where the fit has come to rest, and where that is far from the `first` values, a background by a search from
    there. What the surface promises beyond its reach is flown."""
    k = len(model.names)

    def confirmed(one: Held) -> Held:
        freed, here = replace(problem, extra=(*problem.extra, one.name)), _flown(model, problem, values, model.particles)
        falls = []
        for share in PARTS_OF_THE_WAY:
            try:
                falls.append(here - _flown(model, freed, np.append(values + share * one.moved * errors, one.value), model.particles))
            except NoFit:  # no such values
                continue
        return replace(one, fall=max(falls, default=one.fall))

    local = [confirmed(one) if one.is_wanted and (np.abs(one.moved[:k]) > FAR).any() else one for one in held(problem, values, errors)]
    moves = np.abs(values - first)
    if (moves <= np.maximum(FAR * errors, LARGEST_STEP * np.abs(first))).all():
        return tuple(local)
    return tuple(one if one.is_wanted or one.name == SCALE else _searched(model, counts, problem, first, values, errors, one) for one in local)


def _searched(model: CurveModel, counts: Counts, problem: Problem, first: np.ndarray, values: np.ndarray, errors: np.ndarray, one: Held) -> Held:
    """The same by a search from the `first` values, if that comes to rest far away at a curve that fits as well: both as the particles explored
    have them."""
    try:
        found, freed = _search(model, counts, problem.exposure, (*problem.extra, one.name), np.append(first, problem.start(one.name, first)))
    except NoFit:
        return one
    fall = _flown(model, problem, values) - _flown(model, freed, found)
    moved = (found[:-1] - values) / errors
    return replace(one, value=float(found[-1]), fall=fall, moved=moved, searched=True) if min(fall, found[-1]) > 0 and (np.abs(moved) > FAR).any() else one


def _flown(model: CurveModel, problem: Problem, values: np.ndarray, particles: int | None = None) -> float:
    """Q of the curve that is flown there, with what is free of the exposure as it fits best."""
    k = len(model.names)
    return replace(problem, surface=Surface.level(model.at(values[:k], particles), values[:k])).least(values, range(k))[1]

"""What an experiment expects a detector to count over a scan, as a function of its parameters.

Every evaluation flies the same random numbers, so that the curve follows a parameter smoothly where this turns spins. Where
it moves particles across edges the curve moves in steps of one particle, and where it turns what each particle does by many
phases the curve trembles: derivatives are therefore differences over about one standard deviation of the parameter, or wider.

How the curve changes with the parameters is found with few particles, in groups that know nothing of each other. What they all
say is the slope, what they differ in is its noise; steps widen, and particles become more, until that is small. The curve itself
is that of all particles, where a fit has come to rest.
"""
from __future__ import annotations

import os
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from threading import Event
from typing import Callable, Sequence

import numpy as np

from .counts import Counts, names_of
from .covariance import Spread
from .errors import InputError
from .experiment import Experiment
from .limits import Limits
from .units import base_of, format_value

NOISE = 0.01  # relative variance of a slope, at most, where it is the same noise at all points
SPREAD = 10  # times as much may be noise that differs from point to point: it only weighs the counts a little wrongly
SHAPE = 10  # likewise where a free factor takes up what is not of the shape
HELPS = 1.5  # times less noise, for a wider step to be worth while
NOISY = 0.05  # enough of it, where a wider step would go over an edge
EDGE = 0.1  # of what a step changes: so little may be beyond an edge
MOST_UNUSED = 4  # times as many places in a grid as a table has
FLAT = 0.01  # of a curve: so little is no line
FINEST = 12  # tenths of a step, until a curve keeps its shape
LARGEST_STEP = 0.1  # of the parameter's value
LARGEST_FROM_ZERO = 1e3  # SI, of one whose value says nothing about its size, such as an offset
STRENGTHS = "field", "amplitude", "gradient", "frequency", "current", "pole_field"  # with the other sign, another apparatus
EXPLORED, LEAST_EXPLORED = 5000, 500  # particles at first: a quarter of all, between these
MORE = 4  # times as many, where they do not suffice
SCALE, BACKGROUND = "scale", "background"  # of the exposure, and counts at each point (per mean time): the curve knows neither
USUAL = "field", "amplitude", "gradient", "frequency", "current", "pole_field", "at", "length"  # of a part
SEEDS = 20011, 20021, 20023, 20029  # of the groups


class NoFit(InputError):
    """Why there is nothing to fit, or no fit."""


@dataclass
class Evaluated:
    """A curve and what is known of it."""

    y: np.ndarray  # [n] detected fraction
    covariance: np.ndarray  # [n, n] of the simulation
    groups: np.ndarray  # [groups, n] curves of particles of their own, of which y is the mean


@dataclass
class CurveModel:
    """The curve of one detector at the places of a scan, by the parameters called `names`."""

    experiment: Experiment  # without a scan
    parameter: str
    places: Sequence[str]
    names: Sequence[str]
    detector: str | None = None
    threads: int = 0
    across: tuple[str, Sequence[str]] | None = None  # a second scanned parameter and its value at each place
    explored: int = 0  # particles; 0: as many as serve
    told: Callable[[int, int, bool, float], None] | None = None  # hears the flights made; of the last its particles, whether in one, and seconds
    flights: int = 0
    scaled: bool = False  # a factor on the curve is free
    counted: np.ndarray | None = None  # [n] at each place, as far as that is known
    _widened: dict[int, float] = field(default_factory=dict)  # steps of parameters whose slopes are noisy
    _known: dict[tuple[int, bool, tuple[float, ...]], Evaluated] = field(default_factory=dict)  # by particles, whether in one

    def __post_init__(self) -> None:
        scanned, self._rows = self._grid()
        self.particles = int(self.experiment.value("particles"))
        self.chosen = self.explored > 0  # by the user
        self.explored = min(self.explored or max(LEAST_EXPLORED, min(EXPLORED, self.particles // 4)), self.particles)
        first = scanned.set(particles=1).fly()
        detectors = first.core.detectors
        if self.detector is None and len(detectors) > 1:
            raise NoFit(f"{self.experiment.path}: choose one of its detectors {', '.join(detectors)} with --detector")
        self.detector = self.detector or detectors[0]
        if self.detector not in detectors:
            raise NoFit(f"`{self.detector}` is no detector of {self.experiment.path}, which has {', '.join(detectors)}\n"
                        f"  help: the column `detector` of the table, or --detector, names it")
        each = [one for name in self.names for one in name.split("+")]
        if twice := [name for name in each if each.count(name) > 1]:
            raise NoFit(f"`{twice[0]}` is free twice")
        for name in self.names:
            if {*names_of(self.parameter), *names_of(self.across[0] if self.across else "")} & set(name.split("+")):
                raise NoFit(f"`{name}` is scanned, so it is not free\n  help: `rabiline fit-line` has the centre of a line; of an experiment what moves the line is free, a field or a number under `variables:`")
            for one in name.split("+"):
                if self._follows_the_scan(one):
                    raise NoFit(f"`{one}` follows `{self.parameter}`, which is scanned, so it is not free\n  help: `rabiline fit-line` has the centre of a line; of an experiment what moves the line is free")
            of_exposure = {"source.rate": f"{SCALE}` instead, a factor of all that is expected",
                           f"{self.detector}.background": f"{BACKGROUND}` instead, in counts at each point"}
            for one in set(name.split("+")) & set(of_exposure):
                raise NoFit(f"`{one}` changes what is counted, and not the simulated curve\n  help: free `{of_exposure[one]}")
        # Counts are of whole detectors; images would only cost time.
        self.scanned = scanned.set({f"{name}.bins": [1, 1] for name in detectors})
        self.units = [self._unit(name) for name in self.names]
        start = self.start()
        self.limits = Limits(self._may_be, start)
        self._may_vanish = [not name.endswith(STRENGTHS) and self._may_be(moved(start, i, -2 * start[i])) for i, name in enumerate(self.names)]
        for name, text in self.changes(self.limits.start).items():
            for wrong in unknown(self.experiment, name, text):
                raise NoFit(f"`{name}` cannot be changed by itself in this file: {wrong}")

    def _grid(self) -> tuple[Experiment, np.ndarray]:
        """The experiment with its scan, and the scan point of each place."""
        experiment = self.experiment.scan()
        if self.across is None:
            return experiment.scan(self.parameter, ",".join(self.places)), np.arange(len(self.places))
        name, values = self.across
        outer, inner = list(dict.fromkeys(values)), list(dict.fromkeys(self.places))
        if len(outer) * len(inner) > MOST_UNUSED * len(self.places):
            raise NoFit(f"{len(outer)} values of {name} and {len(inner)} of {self.parameter} make a grid of which the table "
                        f"has only {len(self.places)} places: measure on a grid, or fit one scan at a time")
        rows = np.array([outer.index(one) * len(inner) + inner.index(other) for one, other in zip(values, self.places)])
        return experiment.scan(name, ",".join(outer)).scan(self.parameter, ",".join(inner)), rows

    def _follows_the_scan(self, name: str) -> bool:
        """Whether a parameter has another value at another place, by a variable in it."""
        try:
            return len({self.experiment.scan().set(dict.fromkeys(names_of(self.parameter), place)).value(name) for place in (self.places[0], self.places[-1])}) > 1
        except (InputError, KeyError):
            return False

    def _unit(self, name: str) -> str:
        if name in ("seed", "particles"):
            raise NoFit(f"`{name}` is a number of the simulation, not of the beam")
        if "=" in name:
            alone, _, value = name.partition("=")
            raise NoFit(f"`{name}` is free by its name alone: `{alone}`\n  help: --set {alone}='{value}' says where it starts")
        try:
            each = {one: (self.experiment.scan().value(one), self.experiment.scan().unit(one)) for one in name.split("+")}
            if len(set(each.values())) > 1:
                starts = " and ".join(f"{format_value(value, unit)} for `{one}`" for one, (value, unit) in each.items())
                raise NoFit(f"`{name}` is to be one value, and starts at {starts}\n  help: start them alike, or free each by itself")
            return next(iter(each.values()))[1]
        except KeyError:
            wrong = [text for one in name.split("+") for text in unknown(self.experiment, one, 1.0)]
            numbers = [f"{name}.{key}" for key in USUAL if self.experiment.scan()._setup.value(f"{name}.{key}") is not None]
            raise NoFit(wrong[0] if wrong and "did you mean" in wrong[0] else
                        f"`{name}` has blanks\n  help: names have commas between, or + where they share a value" if " " in name.strip() else
                        f"`{name}` is a part\n  help: name one of its numbers, such as `{numbers[0]}`" if numbers else
                        f"`{name}` is a constant of a formula\n  help: name the value under `variables:`, write `${{NAME}}` in its place, and free `variables.NAME`" if ".formula.constants." in name else
                        f"`{name}` is no number that the file states: write it there, or give its dotted name as in --set") from None

    def at(self, values: Sequence[float], particles: int | None = None) -> Evaluated:
        """Flies it, with the parameters in SI: `explored` particles in groups, or so many in one."""
        whole, particles = particles is not None, particles or self.explored
        key = particles, whole, tuple(map(float, values))
        if key not in self._known:
            try:
                self._known[key] = self._flown_at(values, particles, whole)
            except InputError as problem:
                self._known[key] = self._continued(values, particles if whole else None, problem)
        return self._known[key]

    def beside(self, values: np.ndarray, number: int, step: float) -> list[np.ndarray]:
        """[2] Groups of curves with one parameter a step above and below; what cannot be on one side goes on straight from the other."""
        here, sides = self.at(values).groups, []
        for by in (step, -step):
            try:
                sides.append(self.at(moved(values, number, by)).groups)
            except NoFit:
                sides.append(2 * here - self.at(moved(values, number, -by)).groups)
        return sides

    def _flown_at(self, values: Sequence[float], particles: int, whole: bool) -> Evaluated:
        self.flights += 1
        begun = time.monotonic()
        changed = self.changes(values)
        sizes = [{"particles": particles}] if whole else [{"particles": max(particles // len(SEEDS), 1), "seed": seed} for seed in SEEDS]
        flown = self._side_by_side([{**changed, **size} for size in sizes])
        groups = np.array([y for y, _ in flown])
        y, covariance = groups.mean(axis=0), sum(own for _, own in flown) / len(sizes)**2
        if self.told is not None:
            self.told(self.flights, particles, whole, time.monotonic() - begun)
        return Evaluated(y, covariance, groups)

    def _continued(self, values: Sequence[float], particles: int | None, problem: InputError) -> Evaluated:
        """Beyond what a parameter may have, such as 1 of an efficiency, the curve goes on straight."""
        number, limit = next(iter(self.limits.beyond(values).items()), (0, np.nan))
        away, start = values[number] - limit, self.limits.start[number]
        if not abs(away) <= (max(abs(limit), abs(limit - start)) or np.inf):  # too far, or nothing that is wrong by itself
            raise NoFit(self._out_of_range(values, problem)) from None
        within = np.copysign(min(abs(away), LARGEST_STEP * max(abs(limit), abs(start)) or abs(away)), away)
        last, before = (self.at(moved(values, number, to - values[number]), particles) for to in (limit, limit - within))
        further = away / within
        return Evaluated(last.y + further * (last.y - before.y), last.covariance, last.groups + further * (last.groups - before.groups))

    def _may_be(self, values: np.ndarray) -> bool:
        try:
            self.scanned.set(self.changes(values))
        except InputError:
            return False
        return True

    def _out_of_range(self, values: Sequence[float], problem: InputError) -> str:
        """Which of the parameters [k] has no such value, and what it may have."""
        tried = self.changes(values)
        alone = ((name, words[0]) for name, text in tried.items() if (words := unknown(self.experiment, name, text)))
        name, wrong = next(alone, (self.names[0], first_of(problem)[0]))
        number, _, unit = tried[name.split("+")[0]].partition(" ")
        why = wrong.partition("\n")[0].partition(", but is `")[0]
        return f"the fit tries {f'{float(number):.4g} {unit}'.strip()} for `{name}`: {why}\n  help: start farther from there, or hold `{name}`"

    def _side_by_side(self, changes: Sequence[dict[str, object]]) -> list[tuple[np.ndarray, np.ndarray]]:
        """The curve and its covariance of each, at once as far as there are threads: much of a small flight is its plan, which one thread makes."""
        threads = self.threads or os.cpu_count() or 1
        workers = min(len(changes), threads)
        if workers == 1:
            return [self._flown(one, self.threads) for one in changes]
        stopped = Event()
        with ThreadPoolExecutor(workers) as pool:
            try:
                return list(pool.map(lambda one: self._flown(one, threads // workers, stopped), changes))
            except BaseException:
                stopped.set()  # the others, too
                raise

    def _flown(self, changes: dict[str, object], threads: int, stopped: Event | None = None) -> tuple[np.ndarray, np.ndarray]:
        """The curve [n] and its covariance [n, n]; ends early when it is `stopped`."""
        def go_on(done: float, left: float) -> None:
            if stopped.is_set():
                raise InterruptedError

        result = self.scanned.set(changes).fly(threads or None, go_on if stopped else False).core
        i = result.detectors.index(self.detector)
        y, covariance = result.detected[i], result.covariance[i]
        covariance = covariance.reshape(y.size, y.size)[np.ix_(self._rows, self._rows)] if covariance.size else None
        y, errors = y[self._rows], result.errors[i][self._rows]
        spread = Spread.of(y, errors, covariance, np.array(result.particles))
        covariance = spread.covariance
        unseen = np.flatnonzero(y <= 0)  # what would be seen there is not known, at each place by itself
        covariance[np.ix_(unseen, unseen)] = np.diag(spread.particle[unseen]**2)
        return y, covariance

    def changes(self, values: Sequence[float]) -> dict[str, str]:
        """As `Experiment.set` takes them; names with `+` between have one value."""
        return {name: f"{value!r} {unit}".strip() for names, value, unit in zip(self.names, map(float, values), self.units)
                for name in names.split("+")}

    def start(self) -> np.ndarray:
        """[k] The values in the file, SI."""
        experiment = self.experiment.scan()
        return np.array([experiment.value(name.split("+")[0]) for name in self.names])

    def step(self, values: np.ndarray, number: int, wanted: float) -> float:
        """A step of one parameter, `wanted` or more, over which its slope is known to `NOISE`: wider as long as that helps, up
        to `LARGEST_STEP` of the value, else with more particles. A parameter without any effect is refused."""
        largest = LARGEST_FROM_ZERO if values[number] == 0 or self._may_vanish[number] else LARGEST_STEP * abs(values[number])
        step, before, patient = min(max(wanted, self._widened.get(number, 0.0)), largest), np.inf, True
        while True:
            change = self.beside(values, number, step)[0] - self.at(values).groups
            variance, ways = noise_of(change, self.at(values).y)
            of_shape = noise_of(change, self.at(values).y, True)[0] if self.scaled else 0.0
            noise = max(variance / SPREAD, variance / ways, of_shape / SHAPE, self._noise_beside_errors(change, self.at(values)) / SPREAD)
            if noise <= NOISE:
                break
            if step > wanted and variance < NOISY and self._meets_an_edge(values, number, step):
                if not self.explore_more():
                    break
                step, before = wanted, np.inf
            elif step < largest and (noise > 1 or noise < before / HELPS or patient):
                patient = noise < before / HELPS or noise > 1
                step, before = min(step * (10 if noise > 1 else 2), largest), noise
            elif not change.any():
                y = self.at(values).y
                raise NoFit(f"`{self.names[number]}` has no effect on what `{self.detector}` counts"
                            + ("" if np.ptp(y) > FLAT * y.max() else f"\n  help: at these places `{self.parameter}` has none either: is its unit right, and does a part in front of `{self.detector}` sort spins?"))
            elif not self.explore_more():
                break
        if step > wanted:
            self._widened[number] = step
        return step

    def _noise_beside_errors(self, change: np.ndarray, here: Evaluated) -> float:
        """The relative variance of the mean of groups of a change, where what is off at several points together by chance, as levels that are drawn
        are, counts less than what is off at one."""
        if self.counted is None:
            return 0.0
        own = here.covariance * (self.explored / self.particles)
        own = own + np.diag(np.maximum(here.y, 1e-3 * here.y.max(initial=1e-300))**2 / np.maximum(self.counted, 1.0))
        return noise_of(np.linalg.solve(np.linalg.cholesky(own), change.T).T, np.ones(here.y.size))[0]

    def _meets_an_edge(self, values: np.ndarray, number: int, step: float) -> bool:
        up, down = (groups.mean(axis=0) for groups in self.beside(values, number, step))
        here = self.at(values).y
        return meets_an_edge(here, (up - down) / 2, (up + down) / 2 - here)

    def first_steps(self, values: np.ndarray) -> np.ndarray:
        """[k] One for each parameter, SI."""
        return np.array([self.step(values, i, self._gentle(values, i, 1e-3 * abs(value) if value != 0 else 1e-6)) for i, value in enumerate(values)])

    def _gentle(self, values: np.ndarray, number: int, step: float) -> float:
        """The step, or a smaller one that leaves something of the curve: what moves a line may move it out of the scan by a thousandth."""
        here = self.at(values).y
        for _ in range(FINEST):
            bend = np.mean([groups.mean(axis=0) for groups in self.beside(values, number, step)], axis=0) - here
            if np.sum(bend**2) < 0.25 * np.sum((here - here.mean())**2):
                break
            step /= 10
        return step

    def explore_more(self) -> bool:
        """More particles from here on, if there are any and the user has not chosen how many."""
        if self.chosen or self.explored == self.particles:
            return False
        self.explored = min(MORE * self.explored, self.particles)
        self._widened.clear()
        return True


def meets_an_edge(y: np.ndarray, slope: np.ndarray, bend: np.ndarray) -> bool:
    """Whether much of what a step changes of a curve y [n] is where next to nothing is counted: what begins or ends within the step."""
    known = slope**2 / np.maximum(np.maximum(y, bend), 1e-300)
    return bool(known[bend > y].sum() > EDGE * known.sum())


def unknown(experiment: Experiment, name: str, value: str | float) -> list[str]:
    """What is wrong with the name of a parameter or the value, in the words of the program; nothing where it can be set."""
    try:
        experiment.scan().set({name: value})
    except InputError as problem:
        return first_of(problem)
    return []


def first_of(problem: InputError) -> list[str]:
    """The first of what is wrong, with its help where there is any."""
    return ["\n  help: ".join(filter(None, (one["message"], one["help"]))) for one in problem.diagnostics[:1]]


def require_free(names: Sequence[str]) -> None:
    """Raises NoFit where nothing is free, of the curve or of the exposure."""
    if not names:
        raise NoFit("nothing is free: name a parameter of the experiment or more, or `scale` or `background`")


def check_columns(experiment: Experiment, counts: Counts) -> None:
    """That the experiment knows what the table calls scanned, in its units."""
    for one in filter(None, (counts, counts.across)):
        header = f"{one.parameter} [{one.unit}]" if one.unit else one.parameter
        for name in names_of(one.parameter):
            if base_of(one.unit)[0] == _unit(experiment, name) == "Hz" and (one.x < 0).any():
                raise NoFit(f"{counts.path}: the column `{header}`: a frequency is below zero\n  help: write whole frequencies, not how far they are from a line")
            for wrong in unknown(experiment, name, one.places[0]):
                unitless = not one.unit and not unknown(experiment, name, f"{one.places[0]} {_unit(experiment, name)}")
                raise NoFit(f"{counts.path}: the column `{header}`: " + (
                    f"it has no unit\n  help: write `{one.parameter} [{_unit(experiment, name)}]`" if unitless else wrong))


def _unit(experiment: Experiment, name: str) -> str:
    try:
        return experiment.scan().unit(name)
    except KeyError:
        return ""


def noise_of(groups: np.ndarray, y: np.ndarray, scaled: bool = False) -> tuple[float, float]:
    """The relative variance of the mean of groups [groups, n] of a change of the curve y [n], as counts weigh it: what they differ
    in over what they have in common. And in how many ways they differ, over the points: 1 where all points tremble together.
    `scaled`: what only a factor on the curve changes does not count."""
    root = np.sqrt(np.maximum(y, 1e-3 * y.max(initial=1e-300)))
    weighted = groups / root
    if scaled:
        weighted = weighted - np.outer(weighted @ root, root) / (root @ root)
    q, mean = len(groups), weighted.mean(axis=0)
    products = (weighted - mean) @ (weighted - mean).T
    noise = np.trace(products) / q / (q - 1)
    common = np.sum(mean**2) - noise
    alike = np.sum(products**2) / np.trace(products)**2 - 1 / (q - 1) if noise > 0 else 1.0
    return float(noise / common) if common > 0 else np.inf, 1 / max(alike, 1 / y.size)


def moved(values: np.ndarray, number: int, by: float) -> np.ndarray:
    """The same values [k], one of them by so much more."""
    out = np.array(values, dtype=float)
    out[number] += by
    return out

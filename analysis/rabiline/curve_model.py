"""What an experiment expects a detector to count over a scan, as a function of its parameters.

Every evaluation flies the same random numbers, so that the curve follows a parameter smoothly where this turns spins. Where
it moves particles across edges the curve moves in steps of one particle: derivatives are therefore differences over about
one standard deviation of the parameter, and wide enough that `MOVED` particles are counted differently.

How the curve changes with the parameters is found with some of the particles, `EXPLORED` at most, as what these do
differently is known well; the curve itself with all of them, where a fit has come to rest.
"""
from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Callable, Sequence

import numpy as np

from .covariance import Spread
from .errors import BadInput
from .experiment import Experiment

MOVED = 1000  # particles
MOST_UNUSED = 4  # times as many places in a grid as a table has
LARGEST_STEP = 0.2  # of the parameter's value
EXPLORED = 5000  # particles at most, and a quarter of all of them
LEAST_EXPLORED = 500
PART, LEAST_PART, SMOOTH = 0.1, 0.001, 0.2  # of a step, over which slopes are compared, and by how much they may differ


class NoFit(BadInput):
    """Why there is nothing to fit, or no fit."""


@dataclass
class Evaluated:
    """A curve and what is known of it."""

    y: np.ndarray  # [n] detected fraction
    covariance: np.ndarray  # [n, n] of the simulation


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
    told: Callable[[int, int, float], None] | None = None  # hears the flights made, their particles and the seconds of the last
    flights: int = 0
    _known: dict[tuple[bool, tuple[float, ...]], Evaluated] = field(default_factory=dict)

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
            raise NoFit(f"{self.experiment.path}: no detector `{self.detector}` (there is {', '.join(detectors)})")
        for name in self.names:
            if {self.parameter, self.across and self.across[0]} & set(name.split("+")):
                raise NoFit(f"`{name}` is scanned, so it is not free")
        # Counts are of whole detectors; images would only cost time.
        self.scanned = scanned.set({f"{name}.bins": [1, 1] for name in detectors})
        self.units = [self._unit(name) for name in self.names]

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

    def _unit(self, name: str) -> str:
        try:
            return [self.experiment.scan().unit(one) for one in name.split("+")][0]
        except KeyError:
            raise NoFit(f"`{name}` is no number that the file states: write it there, or give its dotted name as in --set") \
                from None

    def at(self, values: Sequence[float], whole: bool = False) -> Evaluated:
        """Flies it, with the parameters in SI: `explored` particles, or the `whole` of them."""
        changed = self.changes(values)
        key = whole or self.explored == self.particles, tuple(map(float, values))
        if key not in self._known:
            self.flights += 1
            begun = time.monotonic()
            particles = self.particles if key[0] else self.explored
            result = self.scanned.set({**changed, "particles": particles}).fly(self.threads).core
            if self.told is not None:
                self.told(self.flights, particles, time.monotonic() - begun)
            i = result.detectors.index(self.detector)
            y, covariance = result.detected[i], result.covariance[i]
            covariance = covariance.reshape(y.size, y.size)[np.ix_(self._rows, self._rows)] if covariance.size else None
            y, errors = y[self._rows], result.errors[i][self._rows]
            spread = Spread.of(y, errors, covariance, np.array(result.particles))
            covariance = spread.covariance
            unseen = np.flatnonzero(y <= 0)  # what would be seen there is not known, at each place by itself
            covariance[np.ix_(unseen, unseen)] = np.diag(spread.errors[unseen]**2)
            self._known[key] = Evaluated(y, covariance)
        return self._known[key]

    def changes(self, values: Sequence[float]) -> dict[str, str]:
        """As `Experiment.set` takes them; names with `+` between have one value."""
        return {name: f"{value!r} {unit}".strip() for names, value, unit in zip(self.names, map(float, values), self.units)
                for name in names.split("+")}

    def start(self) -> np.ndarray:
        """The values in the file, SI."""
        experiment = self.experiment.scan()
        return np.array([experiment.value(name.split("+")[0]) for name in self.names])

    def step(self, values: np.ndarray, number: int, wanted: float) -> float:
        """A step of one parameter that counts `MOVED` particles differently, `wanted` or more, and no more than
        `LARGEST_STEP` of the value. A parameter without any effect is refused."""
        largest = LARGEST_STEP * abs(values[number]) if values[number] != 0 else np.inf
        step = min(wanted, largest)
        here = self.at(values).y
        while True:
            moved = np.abs(self.at(_moved(values, number, step)).y - here).sum() * self.explored
            if moved >= MOVED or step >= largest:
                break
            step = min(step * (10 if moved < MOVED / 30 else 2), largest)
        if moved == 0:
            raise NoFit(f"`{self.names[number]}` has no effect on what `{self.detector}` counts")
        return step

    def first_steps(self, values: np.ndarray) -> np.ndarray:
        """One for each parameter, and the choice of how many particles explore."""
        steps = [self.step(values, i, 1e-3 * abs(value) if value != 0 else 1e-6) for i, value in enumerate(values)]
        if not self.explore(values, steps):
            return self.first_steps(values)
        return np.array(steps)

    def explore(self, values: np.ndarray, steps: Sequence[float]) -> bool:
        """Whether few particles show how the curve changes: it does so smoothly, as where spins turn, and no particle crosses an
        edge. Else all particles are flown from here on."""
        def slope(i: int, part: float) -> np.ndarray:
            return (self.at(_moved(values, i, part * steps[i])).y - self.at(values).y) / part

        def is_smooth(i: int) -> bool:
            return bool(np.abs(slope(i, LEAST_PART) - slope(i, PART)).sum() < SMOOTH * np.abs(slope(i, PART)).sum())

        if self.chosen or self.explored == self.particles or all(map(is_smooth, range(len(steps)))):
            return True
        self.explored = self.particles
        return False


def _moved(values: np.ndarray, number: int, by: float) -> np.ndarray:
    out = np.array(values, dtype=float)
    out[number] += by
    return out


@dataclass(frozen=True)
class Surface:
    """The curve about a place as a polynomial of second order in the parameters, through flights one step away."""

    centre: np.ndarray  # [k]
    steps: np.ndarray  # [k]
    y: np.ndarray  # [n]
    slopes: np.ndarray  # [k, n] for one step
    bends: np.ndarray  # [k, k, n] half of the second differences
    covariance: np.ndarray  # [n, n]
    moved: np.ndarray  # [k] particles that a step counts differently: the slopes are known to a part 1/sqrt(moved)

    @classmethod
    def about(cls, model: CurveModel, centre: np.ndarray, steps: np.ndarray, crossed: bool = True) -> Surface:
        """`crossed`: with the mixed second differences."""
        here = model.at(centre)
        k = centre.size
        slopes, bends = np.zeros((k, here.y.size)), np.zeros((k, k, here.y.size))
        above = []
        for i in range(k):
            up, down = model.at(_moved(centre, i, steps[i])).y, model.at(_moved(centre, i, -steps[i])).y
            above.append(up)
            slopes[i], bends[i, i] = (up - down) / 2, (up + down) / 2 - here.y
        for i in range(k if crossed else 0):
            for j in range(i):
                both = model.at(_moved(_moved(centre, i, steps[i]), j, steps[j])).y
                bends[i, j] = bends[j, i] = (both - above[i] - above[j] + here.y) / 2
        return cls(centre, steps, here.y, slopes, bends, here.covariance, np.abs(slopes).sum(axis=1) * model.explored)

    def whole(self, model: CurveModel) -> Surface:
        """About the same place with all particles; how it bends is that of those explored."""
        here = model.at(self.centre, whole=True)
        return replace(self, y=here.y, covariance=here.covariance)

    def at(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The curve [n] and its derivatives [k, n] by the parameters."""
        d = (values - self.centre) / self.steps
        bent = np.einsum("ijn,j->in", self.bends, d)
        return self.y + d @ (self.slopes + bent), (self.slopes + 2 * bent) / self.steps[:, None]

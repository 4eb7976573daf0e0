"""The curve of an experiment about a place among its parameters."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .curve_model import SEEDS, CurveModel, Evaluated, NoFit, moved, noise_of


def _mean_and_noise(groups: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The mean [n] of groups [groups, n], and what they differ in, such that the sum of squares is the variance of the mean."""
    mean = groups.mean(axis=0)
    return mean, (groups - mean) / np.sqrt(len(groups) * (len(groups) - 1))


def _agreed(groups: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same, less where it is mostly noise."""
    mean, noise = _mean_and_noise(groups)
    less = 1 + noise_of(groups, y)[0]
    return mean / less, noise / less


@dataclass(frozen=True)
class Surface:
    """The curve about a place as a polynomial of second order in the parameters, through flights one step away."""

    centre: np.ndarray  # [k]
    steps: np.ndarray  # [k]
    y: np.ndarray  # [n]
    slopes: np.ndarray  # [k, n] for one step
    bends: np.ndarray  # [k, k, n] half of the second differences
    covariance: np.ndarray  # [n, n]
    noise: np.ndarray  # [groups, k, n] what the groups differ in, such that the sum of squares is the variance of the slopes
    bend_noise: np.ndarray  # [groups, k, k, n] likewise of the bends

    @classmethod
    def level(cls, here: Evaluated, centre: np.ndarray) -> Surface:
        """Of a curve of which nothing else is known."""
        k, n = centre.size, here.y.size
        return cls(centre, np.ones(k), here.y, np.zeros((k, n)), np.zeros((k, k, n)), here.covariance, np.zeros((0, k, n)), np.zeros((0, k, k, n)))

    @classmethod
    def about(cls, model: CurveModel, centre: np.ndarray, steps: np.ndarray, crossed: bool = True) -> Surface:
        """`crossed`: with the mixed second differences."""
        here = model.at(centre)
        k, n = centre.size, here.y.size
        slopes, bends = np.zeros((k, n)), np.zeros((k, k, n))
        noise, bend_noise, above = np.zeros((len(SEEDS), k, n)), np.zeros((len(SEEDS), k, k, n)), []
        for i in range(k):
            up, down = model.beside(centre, i, steps[i])
            above.append(up)
            slopes[i], noise[:, i] = _mean_and_noise((up - down) / 2)
            bends[i, i], bend_noise[:, i, i] = _agreed((up + down) / 2 - here.groups, here.y)
        for i in range(k if crossed else 0):
            for j in range(i):
                try:
                    both = model.at(moved(moved(centre, i, steps[i]), j, steps[j])).groups
                except NoFit:
                    continue  # of values that cannot be together
                bends[i, j], bend_noise[:, i, j] = _agreed((both - above[i] - above[j] + here.groups) / 2, here.y)
                bends[j, i], bend_noise[:, j, i] = bends[i, j], bend_noise[:, i, j]
        return cls(centre, steps, here.y, slopes, bends, here.covariance, noise, bend_noise)

    def whole(self, model: CurveModel, particles: int) -> Surface:
        """About the same place with so many particles in one flight; how it bends is that of those explored."""
        here = model.at(self.centre, particles)
        return replace(self, y=here.y, covariance=here.covariance)

    def moved(self, centre: np.ndarray) -> Surface:
        """The same polynomial about another place, less than a step away."""
        d = (centre - self.centre) / self.steps
        return replace(self, centre=centre, y=self.at(centre)[0], slopes=self.slopes + 2 * np.einsum("ijn,j->in", self.bends, d))

    def at(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The curve [n] and its derivatives [k, n] by the parameters."""
        d = (values - self.centre) / self.steps
        bent = np.einsum("ijn,j->in", self.bends, d)
        return self.y + d @ (self.slopes + bent), (self.slopes + 2 * bent) / self.steps[:, None]

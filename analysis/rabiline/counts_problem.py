"""How likely counts are under a simulated curve that has errors of its own.

n_i counts are Poisson about mu_i = E_i s (y_i + d_i) + b t_i: y the simulated fraction, d what it may be off, normal with the
covariance of the simulation; E the exposure, s its factor, which is free unless it is known, and b a background. The slope of s is y + d: that
of the simulation alone would be larger where too many particles came by chance.
Where that factor alone says how long was counted, a background that is known goes with it: mu_i = E_i s (y_i + d_i + f).
Q = 2 sum[mu - n + n ln(n/mu)] + z.z, with d = L z and L the root of the covariance, as Conway (PHYSTAT 2011) does for one factor
per bin.
"""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Sequence

import numpy as np

from .curve_model import BACKGROUND, SCALE
from .exposures import Exposure
from .surface import Surface

IMPOSSIBLE = 1e300  # Q of a factor that is not above 0
LEAST_MODE = 1e-4  # of the Poisson variance: smaller modes of the simulation's covariance do not matter
DEGENERATE = 1e-4  # ratio of the eigenvalues of the parameters' correlation, below which a direction is not known
MUCH_THE_SAME = 4.0  # a factor between such eigenvalues
TIMES_NOISE = 4.0  # likewise, times what the slopes' own noise makes of it
SEEN = 2.0  # times that noise: nothing that is degenerate comes so far
LED = 4.0  # of Q, two standard deviations: what falls by less along a direction may be the noise of the slopes
MOST_ITERATIONS = 25
AVERAGES = 12  # each halves, at least, what an average is off
SETTLED = 1e-9  # of the errors, within which such an average has come to rest
REACH = 2.0  # steps
UNSEEN = 2.0  # particles: as many may come on the average where none did, in one simulation of seven
TOGETHER = 3  # iterations, after which counts and simulation have a curve together


@dataclass(frozen=True)
class Fisher:
    """Half of the expected second derivatives of Q, and which parts of it are the noise of the slopes, what bends know, and their noise."""

    matrix: np.ndarray  # [k, k]
    noise: np.ndarray  # [k, k]
    bent: np.ndarray  # [k, k]
    trembling: np.ndarray  # [k, k]

    def of(self, moving: Sequence[int]) -> Fisher:
        """Of some of the parameters."""
        return Fisher(*(part[np.ix_(moving, moving)] for part in (self.matrix, self.noise, self.bent, self.trembling)))

    @cached_property
    def errors(self) -> np.ndarray:
        """[k] Of each parameter where the others are known."""
        return 1 / np.sqrt(np.maximum(np.diag(self.matrix), 1e-300))

    @cached_property
    def directions(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Directions as columns, along which the parameters' correlation has these values, and which of them are known: its eigenvectors, or where
        it has much the same value along several, those of the noise."""
        values, vectors = np.linalg.eigh(self._scaled(self.matrix))
        noise, begin = self._scaled(self.noise + self.trembling), 0
        for end in range(1, values.size + 1):
            if end == values.size or values[end] > MUCH_THE_SAME * values[begin]:
                alike = vectors[:, begin:end]
                vectors[:, begin:end] = alike @ np.linalg.eigh(alike.T @ noise @ alike)[1]
                begin = end
        values = np.einsum("ij,ik,kj->j", vectors, self._scaled(self.matrix), vectors)
        return values, vectors, (values > DEGENERATE * values.max()) & (values > TIMES_NOISE * self._noise_along(vectors))

    @property
    def condition(self) -> float:
        """Number of the parameters' correlation."""
        values = np.linalg.eigvalsh(self._scaled(self.matrix))
        return float(values.max() / max(values.min(), 1e-16 * values.max()))

    def _noise_along(self, vectors: np.ndarray) -> np.ndarray:
        """[k] The part of each eigenvalue that is noise."""
        return np.einsum("ij,ik,kj->j", vectors, self._scaled(self.noise + self.trembling), vectors)

    def _scaled(self, matrix: np.ndarray) -> np.ndarray:
        """[k, k] In units of the errors."""
        return self.errors[:, None] * matrix * self.errors

    @property
    def hidden(self) -> np.ndarray:
        """[k] Which of these directions stand out of the noise of the slopes, too little to be known."""
        values, vectors, known = self.directions
        return ~known & (values > DEGENERATE * values.max()) & (values > SEEN * self._noise_along(vectors))

    @property
    def more_particles(self) -> float:
        """How many times as many it may take to know directions that are lost in the noise of the slopes; 1 where none is."""
        values, vectors, known = self.directions
        lost = ~known & (values > DEGENERATE * values.max())
        return float(TIMES_NOISE**2 * np.max(self._noise_along(vectors)[lost] / values[lost])) if lost.any() else 1.0

    @property
    def inverse(self) -> np.ndarray:
        """[k, k] Without the directions that the data do not know."""
        _, vectors, known = self.directions
        return self._scaled(vectors[:, known] @ self._inverse_in(vectors[:, known]) @ vectors[:, known].T)

    def _inverse_in(self, vectors: np.ndarray) -> np.ndarray:
        """[j, j] Of the correlation, along directions [k, j]."""
        return np.linalg.inv(vectors.T @ self._scaled(self.matrix) @ vectors)

    def way(self, score: np.ndarray) -> np.ndarray:
        """[k] To the minimum from where Q has a gradient of -2 `score` [k]: along what is known, and along what the noise hides, where Q promises
        to fall by more than `LED`. What is degenerate stays, and what only the noise of slopes would follow."""
        values, vectors, known = self.directions
        along = vectors.T @ (self.errors * score)
        led = known | (values > DEGENERATE * values.max()) & (along**2 > LED * values)
        return self.errors * (vectors[:, led] @ (self._inverse_in(vectors[:, led]) @ along[led]))

    @property
    def covariance(self) -> np.ndarray:
        """[k, k] The same, but for slopes that weigh the counts a little wrongly by their noise, and promise more than they know, as bends do."""
        _, vectors, known = self.directions
        in_them = vectors[:, known]
        scaled = [in_them.T @ self._scaled(matrix) @ in_them for matrix in (self.matrix - self.trembling, self.noise)]
        weighed = np.linalg.inv(scaled[0] - scaled[1])
        return self._scaled(in_them @ weighed @ scaled[0] @ weighed @ in_them.T)


@dataclass(frozen=True)
class Problem:
    """What is fitted: counts and the curve about some place. Parameters are those of the surface, then the free ones of the
    exposure."""

    counts: np.ndarray
    exposure: Exposure
    surface: Surface
    extra: tuple[str, ...]  # SCALE, BACKGROUND

    def start(self, name: str, values: np.ndarray) -> float:
        """Of SCALE or BACKGROUND, one that is not free: what it is with the values of those that are."""
        return self.exposure.start(name, values[self.surface.centre.size + self.extra.index(SCALE)] if SCALE in self.extra else 1.0)

    def mean(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """mu [n], its derivatives [parameters, n], and mu by y [n]."""
        k = self.surface.centre.size
        free = dict(zip(self.extra, values[k:]))
        y, slopes = self.surface.at(values[:k])
        each = self.exposure.each * free.get(SCALE, 1.0)
        background, floor = (free[BACKGROUND] * self.exposure.time, 0.0) if BACKGROUND in free else (self.exposure.background, self.exposure.floor)
        mu = each * (y + floor) + background
        by = {SCALE: self.exposure.each * (y + floor), BACKGROUND: self.exposure.time}
        return np.maximum(mu, 1e-9), np.concatenate([each * slopes, *(by[name][None] for name in self.extra)]), each

    def modes(self, values: np.ndarray) -> np.ndarray:
        """[n, r] What the simulation may be off, detected fractions, as columns that are each one standard deviation: of the curve that the counts
        and the simulation have together (R. Barlow and C. Beeston, Comp. Phys. Comm. 77, 219, 1993). By its own errors the simulation would weigh
        most where few particles came by chance."""
        mu, _, each = self.mean(values)
        errors = np.sqrt(np.diag(self.surface.covariance))
        y = np.maximum(self.surface.y, errors)  # of one particle the error is all of it
        least = UNSEEN * errors**2 / y
        root = np.sqrt(np.maximum(mu, 1.0)) / each
        variances, vectors = np.linalg.eigh(self.surface.covariance / root[:, None] / root)
        kept = variances > LEAST_MODE
        modes = own = root[:, None] * vectors[:, kept] * np.sqrt(variances[kept])
        for _ in range(TOGETHER):
            off = modes @ (modes.T @ (each * self.weigh((self.counts - mu)[:, None], mu, each[:, None] * modes)[:, 0]))
            modes = np.sqrt(np.maximum(self.surface.y + off, least) / y)[:, None] * own
        return modes

    def together(self, values: np.ndarray, modes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
        """The mean of the curve that the counts and the simulation have together, and how far that is from the simulation's: z.z."""
        mu, slopes, each = self.mean(values)
        modes = each[:, None] * modes
        z = np.zeros(modes.shape[1])
        shifted = mu
        for _ in range(20 if z.size else 0):  # Newton's method with the expected curvature
            step = np.linalg.solve(modes.T @ (modes / shifted[:, None]) + np.eye(z.size), modes.T @ (self.counts / shifted - 1) - z)
            z = z + step
            shifted = np.maximum(mu + modes @ z, 1e-3 * mu)
            if np.abs(step).max() < 1e-6:
                break
        if SCALE in self.extra:
            number = self.surface.centre.size + self.extra.index(SCALE)
            slopes[number] += (shifted - mu) / values[number]
        return shifted, slopes, each, float(z @ z)

    def fisher(self, values: np.ndarray, modes: np.ndarray) -> Fisher:
        """What is known of the parameters: on the average over where their own errors may put them, since at the top of a curve a parameter
        has no slope and is known by the bend alone, as far as the exposure does not explain it."""
        mu, slopes, each, _ = self.together(values, modes)
        surface, groups, k = self.surface, len(self.surface.noise), self.surface.centre.size
        by = np.append(surface.steps, np.ones(len(self.extra)))
        slopes = slopes * by[:, None]
        mu, modes = self.beside_edges(mu, each, modes)
        bends = [each * own.reshape(k * k, mu.size) for own in (surface.bends, *surface.bend_noise)]
        rows = [slopes, *(each * surface.noise), *bends]
        weighed = np.split(self.weigh(np.concatenate(rows).T, mu, modes), np.cumsum([len(own) for own in rows])[:-1], axis=1)
        straight, *noise = (own @ columns for own, columns in zip(rows[:1 + groups], weighed))
        linear = slopes[k:].T @ _inverse(straight[k:, k:]) @ slopes[k:]  # what the exposure explains
        bent, *trembling = (4 * (own @ columns - columns.T @ linear @ columns).reshape(k, k, k, k)
                            for own, columns in zip(bends, weighed[1 + groups:]))
        matrix, scatter = _averaged(straight, bent)
        of_slopes, of_bends = np.zeros_like(matrix), np.zeros_like(matrix)
        of_slopes[:k, :k] += sum(noise)
        of_bends[:k, :k] += sum(np.einsum("ijml,jl->im", own, scatter) for own in trembling)
        return Fisher(*(part / by / by[:, None] for part in (matrix, of_slopes, matrix - straight, of_bends)))

    def beside_edges(self, mu: np.ndarray, each: np.ndarray, modes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """[n] Counts and [n, m] modes of their errors: where an edge is about to come in, or to go, the curve is known no better than as it is on
        both sides, where more particles make it."""
        modes = each[:, None] * modes
        beside = np.maximum(mu, each * np.maximum(np.einsum("iin->in", self.surface.bends), 0).sum(axis=0))
        few = np.maximum(mu, np.sqrt(np.sum(modes**2, axis=1)))  # of one particle the error is all of it
        return beside, modes * np.sqrt(np.maximum(beside / few, 1))[:, None]

    def badness(self, values: np.ndarray, modes: np.ndarray) -> tuple[float, np.ndarray]:
        """Q and its gradient."""
        if SCALE in self.extra and values[self.surface.centre.size + self.extra.index(SCALE)] <= 0:
            return IMPOSSIBLE, np.zeros(values.size)
        mu, slopes, _, off = self.together(values, modes)
        n = self.counts
        q = 2 * np.sum(mu - n + n * np.log(np.maximum(n, 1e-300) / mu)) + off
        return float(q), -2 * slopes @ (n / mu - 1)

    @staticmethod
    def weigh(columns: np.ndarray, mu: np.ndarray, modes: np.ndarray) -> np.ndarray:
        """[n, m] V^-1 columns, V = diag(mu) + modes modesᵀ."""
        inner = np.eye(modes.shape[1]) + modes.T @ (modes / mu[:, None])
        return columns / mu[:, None] - modes / mu[:, None] @ np.linalg.solve(inner, modes.T @ (columns / mu[:, None]))

    def least(self, values: np.ndarray, fixed: Sequence[int] = ()) -> tuple[np.ndarray, float]:
        """The minimum from `values` on, with some parameters held, and Q there. What is degenerate stays."""
        modes = self.modes(values)
        moving = [i for i in range(values.size) if i not in fixed]
        q, gradient = self.badness(values, modes)
        for _ in range(MOST_ITERATIONS if moving else 0):
            step = np.zeros(values.size)
            step[moving] = self.fisher(values, modes).of(moving).way(-gradient[moving] / 2)
            factor, better = 1.0, None
            while better is None and factor > 1e-3:
                tried = values + factor * step
                found = self.badness(tried, modes)
                better = (tried, found) if found[0] <= q + 1e-12 else None
                factor /= 2
            if better is None:
                break
            gained = q - better[1][0]
            values, (q, gradient) = better
            if gained < 1e-6:
                break
        return values, q


def _averaged(straight: np.ndarray, bent: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fisher's matrix F [k + exposure, k + exposure] of slopes and bends [k, k, k, k] of parameters in steps, and the covariance [k, k] over which it
    is averaged: F = straight + bent : covariance, which is that of F itself."""
    k = len(bent)
    matrix, scatter = straight.copy(), np.zeros((k, k))
    matrix[:k, :k] += np.diag(np.sqrt(np.maximum(np.einsum("iiii->i", bent), 0)))
    for _ in range(AVERAGES):  # as Heron takes roots: of the bend, where there is no slope
        scatter = _within_reach(_inverse(matrix, DEGENERATE)[:k, :k])
        before, matrix = matrix, (matrix + straight) / 2
        matrix[:k, :k] += np.einsum("ijml,jl->im", bent, scatter) / 2
        if (np.abs(matrix - before) <= SETTLED * np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))).all():
            break
    return matrix, scatter


def _within_reach(scatter: np.ndarray) -> np.ndarray:
    """A covariance [k, k] of parameters in steps, of no more than `REACH`: farther the surface is not believed."""
    less = np.minimum(1.0, REACH / np.sqrt(np.maximum(np.diag(scatter), 1e-300)))
    return less[:, None] * scatter * less


def _inverse(matrix: np.ndarray, least: float = 1e-10) -> np.ndarray:
    """[k, k] Of second derivatives, whatever the units of the parameters; without directions that these do not know, whose eigenvalues are below
    `least` of the largest."""
    size = 1 / np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    values, vectors = np.linalg.eigh(size[:, None] * matrix * size)
    known = vectors[:, values > least * values[-1:]]
    return size[:, None] * (known / values[values > least * values[-1:]] @ known.T) * size


def shares_of_simulation(problem: Problem, values: np.ndarray) -> np.ndarray:
    """[k] Which part of the variance of each parameter of the curve is the simulation's, or where none is free, of each of the exposure: its next
    flight may differ by that."""
    modes = problem.modes(values)
    mu, slopes, each, _ = problem.together(values, modes)
    mu, modes = problem.beside_edges(mu, each, modes)
    levers = _inverse(problem.fisher(values, problem.modes(values)).matrix) @ problem.weigh(slopes.T, mu, modes).T  # [k, n] by a count more
    simulated, counted = np.sum((levers @ modes)**2, axis=1), np.sum(levers**2 * mu, axis=1)
    return (simulated / np.maximum(simulated + counted, 1e-300))[:problem.surface.steps.size or values.size]

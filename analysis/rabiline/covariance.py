"""What the errors of scan points are worth: the weights of a fit, and chi² with its p-value.

The covariance between points that fly the same particles is estimated from `GROUPS` groups of them. Such a matrix
cannot simply be inverted: its small eigenvalues are noise, and with as many points as groups it has none. So

- its diagonal is replaced by the errors of the file, which are better known and never zero (`Spread.of`);
- weights are the inverse of the covariance plus a multiple of the identity, so large that no more than `WEIGHED`
  directions count by their own variance (`Weights`);
- chi² is taken in at most `DIRECTIONS` directions chosen without looking at it, and its p-value counts in that the
  covariance is an estimate (`chi_squared`).

Points that fly particles of their own have a diagonal covariance that is known, and all of it is used.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg, special

from .hdf5 import INTERPOLATED

GROUPS = 256  # of particles, from which `rabiline run` estimates the covariance
WEIGHED = GROUPS // 16
DIRECTIONS = GROUPS // 4
COUNTED = 10  # particles that must tell points apart before their number is as good as normally distributed
LEAST_P = 1e-3  # of chi²: a model with less is rejected
LEAST_RIDGE = 0.01  # a hundred times the mean point's weight is the most that a point can have


@dataclass(frozen=True)
class Spread:
    """How fractions at scan points scatter: errors, their correlation, and what it was estimated from."""

    errors: np.ndarray  # [n] one standard error, nowhere below half a particle
    correlation: np.ndarray | None  # [n, n]; None where points are independent, of which there may be a million
    freedom: float  # of the estimate: GROUPS - 1, or infinite where the correlation is known
    particle: np.ndarray  # [n] the fraction that one particle is

    @classmethod
    def of(cls, y: np.ndarray, errors: np.ndarray, covariance: np.ndarray | None, particles: np.ndarray,
           known: bool = False) -> Spread:
        """From `errors` [n] and the correlations in `covariance` [n, n], estimated from groups or `known`; None for
        points that are independent.

        Where all particles did the same, or so nearly that the file's own rounding hides it, nothing varies between groups. Nothing is known there to less than half a
        particle, and points at which the same number was caught would err together, as they saw the same particles.
        """
        particle = 1 / (np.broadcast_to(particles, y.shape) + 1.0)
        errors = np.maximum(errors, particle / 2)
        if covariance is None:
            return cls(errors, None, np.inf, particle)
        roots = np.sqrt(np.diag(covariance))
        still = roots <= np.maximum(1e-6 * particle, np.abs(y) * np.sqrt(INTERPOLATED * particle))
        roots[still] = 1
        correlation = covariance / roots / roots[:, None]
        correlation[still], correlation[:, still] = 0, 0
        caught = np.rint(y[still] / particle[still])
        correlation[np.ix_(still, still)] = caught[:, None] == caught
        np.fill_diagonal(correlation, 1)
        return cls(errors, correlation, np.inf if known else GROUPS - 1, particle)

    @property
    def covariance(self) -> np.ndarray:
        """[n, n]"""
        return np.diag(self.errors**2) if self.correlation is None else self.errors[:, None] * self.correlation * self.errors

    def of_sum(self, along: np.ndarray) -> float:
        """One standard error of along @ y."""
        return float(np.sqrt(max(0.0, along @ self.with_sum(along))))

    def with_sum(self, along: np.ndarray) -> np.ndarray:
        """[n] The covariance of each point with along @ y."""
        return along * self.errors**2 if self.correlation is None else self.covariance @ along

    def at(self, expected: np.ndarray, y: np.ndarray) -> Spread:
        """The errors as they are where `expected` [n] is true instead of the measured `y`: binomial variances p (1 - p)
        in proportion. Weights from the measured fractions would favour what happened to come out near 0 or 1."""
        expected, y = np.clip(expected, 0, 1), np.clip(y, 0, 1)
        least = self.particle / (1 - self.particle) / 4
        ratio = (expected * (1 - expected) + least) / (y * (1 - y) + least)
        errors = np.maximum(self.errors * np.sqrt(ratio), self.particle / 2)
        return Spread(errors, self.correlation, self.freedom, self.particle)

    def minus(self, other: Spread) -> Spread:
        """That of the difference to a result with other particles. Its degrees of freedom are those of Nel and van der
        Merwe (1986), who extend Welch's to matrices."""
        parts = self.covariance, other.covariance
        errors = np.hypot(self.errors, other.errors)

        def size(matrix: np.ndarray) -> float:
            return float(np.sum(matrix**2) + np.trace(matrix)**2)

        freedom = size(sum(parts)) / (size(parts[0]) / self.freedom + size(parts[1]) / other.freedom) \
            if np.isfinite([self.freedom, other.freedom]).any() else np.inf
        return Spread(errors, sum(parts) / errors / errors[:, None], freedom, np.maximum(self.particle, other.particle))


@dataclass(frozen=True)
class Weights:
    """A fit's weights W, as a root L with LᵀL = W. They are (C + ε m)⁻¹ with m the mean variance: between those
    of generalised least squares (small ε) and equal ones (large ε).

    ε is at least that of the oracle approximating shrinkage (Chen, Wiesel, Eldar and Hero 2010), which gets closest to
    the true covariance in the mean square, and large enough that tr C (C + ε m)⁻¹, the number of directions that
    count by their own variance, stays below `WEIGHED`: more of them gain little and follow the noise of C."""

    root: np.ndarray  # [n, n]
    directions: float  # how many directions count by their own variance; 0 where C is known

    @classmethod
    def equal(cls, points: int) -> Weights:
        """The same for every point."""
        return cls(np.eye(points), 0.0)

    @classmethod
    def of(cls, spread: Spread) -> Weights:
        """For points with this spread."""
        covariance = spread.covariance
        values, vectors = np.linalg.eigh(covariance)
        values = values.clip(0) / values.mean()
        ridge = LEAST_RIDGE
        if np.isfinite(spread.freedom):
            ridge = max(ridge, _shrinkage(values, spread.freedom))
            while np.sum(values / (values + ridge)) > WEIGHED:
                ridge *= 1.1
        root = (vectors / np.sqrt(values + ridge)).T
        directions = np.sum(values / (values + ridge)) if np.isfinite(spread.freedom) else 0.0
        return cls(root, float(directions))


def _shrinkage(values: np.ndarray, freedom: float) -> float:
    """ε from the eigenvalues of C, of mean 1: ρ/(1 - ρ), with ρ of Chen et al. (2010), eq. 23."""
    n, square = values.size, float(np.sum(values**2))
    above = (1 - 2 / n) * square + n**2
    below = (freedom + 1 - 2 / n) * (square - n)
    return above / (below - above) if below > above else 1e6


@dataclass(frozen=True)
class ChiSquared:
    """How well numbers agree within their errors, and where `freedom` is 0, the reason why there is no chi²."""

    value: float
    freedom: int
    p: float
    reason: str = ""

    def __str__(self) -> str:
        if not self.freedom:
            return f"no chi²: {self.reason}"
        return f"chi² {self.value:.1f} for {freedom_in_words(self.freedom)}, {p_in_words(self.p)}"


def freedom_in_words(freedom: int) -> str:
    """"3 degrees of freedom"."""
    return f"{freedom} degree{'' if freedom == 1 else 's'} of freedom"


def p_in_words(p: float) -> str:
    """"p = 0.12", or that it is next to none."""
    return f"p = {p:.2g}" if p >= 1e-6 else "p < 1e-6"


def chi_squared(residual: np.ndarray, spread: Spread, derivatives: np.ndarray | None = None,
                counted: np.ndarray | None = None) -> ChiSquared:
    """chi² of `residual` [n], least over the parameters with these `derivatives` [n, parameters].

    Only points that are `counted` [n] take part, at which particles enough could be missing. Of them, at most
    `DIRECTIONS` combinations take part: those orthogonal to the derivatives that vary most slowly from point to point,
    and of these the ones in which at least `COUNTED` particles make a difference. The covariance of these is small
    enough to invert, and Hotelling's T² of them follows the F distribution, whatever the covariance (Rao 1959). The
    value is T² with its mean made that of chi² (Hartlap, Simon and Schneider 2007)."""
    kept = np.ones(residual.size, bool) if counted is None else counted
    errors, n = spread.errors[kept], int(kept.sum())
    slopes = np.zeros((n, 0)) if derivatives is None else derivatives[kept] / errors[:, None]
    spanned = linalg.orth(slopes) if n and slopes.any() else np.zeros((n, 0))
    if n <= spanned.shape[1]:
        few = {0: "no point tells", 1: "only one point tells"}.get(n, f"only {n} points tell")
        return ChiSquared(0.0, 0, np.nan, f"{few} {COUNTED} or more particles apart")
    basis = _smoothest(spanned, n - spanned.shape[1] if np.isinf(spread.freedom) else DIRECTIONS)
    varying = basis.T @ (basis if spread.correlation is None else spread.correlation[np.ix_(kept, kept)] @ basis)
    one_particle = basis.T * (spread.particle[kept] / errors) ** 2 @ basis
    values, vectors = linalg.eigh(varying, one_particle)  # variances in particles
    used = values >= COUNTED
    freedom = int(used.sum())
    if not freedom:
        return ChiSquared(0.0, 0, np.nan, f"the points differ by fewer than {COUNTED} particles")
    along = vectors[:, used].T @ (basis.T @ (residual[kept] / errors))
    squares = float(np.sum(along**2 / values[used]))
    if np.isinf(spread.freedom):
        return ChiSquared(squares, freedom, float(special.chdtrc(freedom, squares)))
    rest = spread.freedom - freedom + 1
    p = float(special.fdtrc(freedom, rest, squares * rest / (spread.freedom * freedom)))
    return ChiSquared(squares * (rest - 2) / spread.freedom, freedom, p)


def enough(fraction: np.ndarray, particle: np.ndarray) -> np.ndarray:
    """[n] Where at least `COUNTED` particles do what most do not."""
    return np.minimum(fraction, 1 - fraction) >= COUNTED * particle


def _smoothest(spanned: np.ndarray, most: int) -> np.ndarray:
    """[n, at most `most`] Orthonormal directions orthogonal to the columns of `spanned`: of cosines over the points,
    those that turn least."""
    n, taken = spanned.shape
    waves = np.cos(np.pi * np.outer(np.arange(n) + 0.5, np.arange(min(n, taken + most))) / n)
    orthonormal, _ = np.linalg.qr(np.column_stack([spanned, waves]))
    return orthonormal[:, taken:taken + min(most, n - taken)]

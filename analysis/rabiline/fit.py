"""The fit of dips or peaks with a model, and what its errors mean."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .agreement import with_model
from .covariance import LEAST_P, ChiSquared, Weights
from .curves import Curve, NoResonance, Resonance, Value, are_fringes, half_maxima

MOST_POINTS = 8192  # of a curve: weights and covariances are squares of them
SHARED, OWN = 1, 4  # parameters of all dips, and of each: in the order of `Fit.parameters`


def bell(x: np.ndarray, height: float, centre: float, width: float, steepness: float) -> np.ndarray:
    """[n] height 2^(-|2 (x - centre)/width|^steepness). `width` is the full width at half maximum whatever the steepness:
    2 is a Gaussian, close to a Rabi line's main lobe; large values a dip with a flat bottom."""
    distance = np.maximum(np.abs(2 * (x - centre) / width), 1e-300)
    return height * np.exp2(-np.exp(np.minimum(steepness * np.log(distance), 10.0)))


def bells(x: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """[n] A baseline and one bell for every four numbers after it."""
    return parameters[0] + sum(bell(x, *own) for own in parameters[SHARED:].reshape(-1, OWN))


@dataclass(frozen=True)
class Fit:
    """The fitted dips or peaks of a curve, by rising x."""

    resonances: tuple[Resonance, ...]
    steepnesses: tuple[Value, ...]
    misfit: float  # rms residual over rms error: about 1 or below where the model describes the curve
    chi_squared: ChiSquared  # of the curve and the model
    weighted: bool  # by the covariance, where chi² says that the model may be right; else equally


@np.errstate(all="ignore")  # of values that lead nowhere
def fit(curve: Curve) -> Fit:
    """Fits all dips or peaks of a curve at once, as `bells` on a common baseline: first with equal weights, and where
    chi² then says that the model may be right, by generalised least squares with `covariance.Weights`, for errors as
    they are where the first fit goes. Where the model is wrong, such weights would follow its faults: points that share
    particles hardly differ by chance, so that each difference the model cannot have would count for much.

    The covariance C of the points, not of the weights W, gives the errors, through the estimate p = A y with
    A = (JᵀWJ)⁻¹JᵀW, as A C Aᵀ. That holds for any W. What W has learnt from the noise of an estimated C makes
    them too small by the share of its groups that this took, and they are divided by what is left. Where the model
    misses the points by more than their errors (misfit > 1), all errors are multiplied by the misfit, as the Particle
    Data Group does with the root of chi² per degree of freedom. That would multiply too much here: chi² sees what
    sets the curve and the model apart, however little it has to do with the centre.

    A model says nothing about what happens between points, so the resolution of the half-maximum edges
    (`curves.Edge.resolution`) is added in quadrature: the whole of it to the width, half of it to the centre. It
    counts where an edge falls between two points or three, and is negligible where many points follow the edges.
    Raises NoResonance.
    """
    starts = half_maxima(curve)
    if are_fringes(curve):
        raise NoResonance("fringes are no dips or peaks: see fit-line --form ramsey")
    if curve.x.size < SHARED + OWN * len(starts):
        raise NoResonance(f"{curve.x.size} points are too few to fit {len(starts)} dip{'s' if len(starts) > 1 else ''} or peak{'s' if len(starts) > 1 else ''}")
    if curve.x.size > MOST_POINTS:
        raise NoResonance(f"{curve.x.size} points are too many for one fit, which takes up to {MOST_POINTS}")
    unit, origin = float(np.ptp(curve.x)), float(curve.x[0])  # the fit sees numbers of order one
    x = (curve.x - origin) / unit
    start, bounds = _start(starts, unit, origin)
    first = _least_squares(x, curve.y, np.eye(x.size), start, bounds)
    expected = bells(x, first)
    agreement = with_model(curve, expected, _jacobian(x, first))
    weighted = agreement.p > LEAST_P  # not where there is no chi²
    spread = curve.spread.at(expected, curve.y) if weighted else curve.spread
    weights = Weights.of(spread) if weighted else Weights.equal(x.size)
    best = _least_squares(x, curve.y, weights.root, first, bounds) if weighted else first
    jacobian = _jacobian(x, best)
    residual = curve.y - bells(x, best)
    misfit = float(np.sqrt(np.mean(residual**2) / np.mean(spread.errors**2)))
    linear = np.linalg.pinv(weights.root @ jacobian, rcond=1e-8) @ weights.root
    learnt = weights.directions / spread.freedom
    errors = np.sqrt(np.diag(linear @ spread.covariance @ linear.T).clip(0)) / (1 - learnt) * max(1.0, misfit)
    baseline, *own = map(Value, best.tolist(), errors.tolist())
    resonances = tuple(
        _resonance(start, baseline, *own[i:i + OWN - 1], unit=unit, origin=origin)
        for start, i in zip(starts, range(0, len(own), OWN)))
    return Fit(resonances, tuple(own[OWN - 1::OWN]), misfit, agreement, weighted)


def _least_squares(x: np.ndarray, y: np.ndarray, root: np.ndarray, start: np.ndarray, bounds: np.ndarray) -> np.ndarray:
    """[parameters] Those within `bounds` [2, parameters] at which |root (model - y)|² is least."""
    from scipy import optimize  # when a line is fitted: it takes long to load
    try:
        found = optimize.least_squares(lambda values: root @ (bells(x, values) - y), start.clip(*bounds), lambda values: root @ _jacobian(x, values),
                                       bounds, x_scale="jac", ftol=1e-10, xtol=1e-10)
    except ValueError:  # of values that are infinite or no numbers
        raise NoResonance("the fit does not converge") from None
    if not (found.success and np.isfinite(found.x).all()):
        raise NoResonance("the fit does not converge")
    return found.x


def _start(starts: list[Resonance], unit: float, origin: float) -> tuple[np.ndarray, np.ndarray]:
    """Where a fit starts, and what its parameters [2, parameters] are between: centres stay in their dips or peaks."""
    rows = [(starts[0].baseline.value, -np.inf, np.inf)]
    for start in starts:
        low, high = ((start.centre.value - origin + side * start.width.value / 2) / unit for side in (-1, 1))
        rows += [((1 if start.kind == "peak" else -1) * start.depth.value, -np.inf, np.inf), ((low + high) / 2, low, high),
                 (high - low, (high - low) / 4, 2.0), (4.0, 0.5, 60.0)]  # height, centre, width, steepness
    first, *bounds = np.array(rows).T
    return first, np.array(bounds)


def _resonance(start: Resonance, baseline: Value, height: Value, centre: Value, width: Value, *, unit: float,
               origin: float) -> Resonance:
    return Resonance(
        kind=start.kind,
        centre=Value(origin + unit * centre.value, float(np.hypot(unit * centre.error, start.resolution / 2))),
        width=Value(unit * width.value, float(np.hypot(unit * width.error, start.resolution))),
        depth=Value(abs(height.value), height.error),
        baseline=baseline,
        resolution=start.resolution,
    )


def _jacobian(x: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """[n, parameters] Derivatives of `bells` by its parameters, by central differences."""
    step = 1e-5 * np.maximum(np.abs(parameters), 1e-3)
    columns = [(bells(x, parameters + move) - bells(x, parameters - move)) for move in np.diag(step)]
    return np.stack(columns, axis=1) / (2 * step)

"""The fit of dips or peaks with a model, and what its errors mean."""
from __future__ import annotations

import sys
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from .agreement import with_model
from .covariance import LEAST_P, ChiSquared, Weights
from .curves import Curve, NoResonance, Resonance, Value, are_fringes, half_maxima

if TYPE_CHECKING:
    import lmfit

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
    first = _least_squares(x, curve.y, np.eye(x.size), _start(starts, unit, origin))
    expected = bells(x, _numbers(first))
    agreement = with_model(curve, expected, _jacobian(x, _numbers(first)))
    weighted = agreement.p > LEAST_P  # not where there is no chi²
    spread = curve.spread.at(expected, curve.y) if weighted else curve.spread
    weights = Weights.of(spread) if weighted else Weights.equal(x.size)
    best = _numbers(_least_squares(x, curve.y, weights.root, first)) if weighted else _numbers(first)

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


def _least_squares(x: np.ndarray, y: np.ndarray, root: np.ndarray, start: lmfit.Parameters) -> lmfit.Parameters:
    """The parameters at which |root (model - y)|² is least."""
    outcome = _lmfit().minimize(lambda p: root @ (bells(x, _numbers(p)) - y), start)
    if not (outcome.success and np.isfinite(_numbers(outcome.params)).all()):
        raise NoResonance("the fit does not converge")
    return outcome.params


def _lmfit() -> ModuleType:
    """The module, which takes long to load; without pandas, which takes as long and would serve to write models as JSON."""
    hidden = "pandas" not in sys.modules
    if hidden:
        sys.modules["pandas"] = None  # type: ignore[assignment]
    try:
        import lmfit
        return lmfit
    finally:
        if hidden:
            del sys.modules["pandas"]


def _start(starts: list[Resonance], unit: float, origin: float) -> lmfit.Parameters:
    parameters = _lmfit().Parameters()
    parameters.add("baseline", starts[0].baseline.value)
    for i, start in enumerate(starts):
        low, high = ((start.centre.value - origin + side * start.width.value / 2) / unit for side in (-1, 1))
        parameters.add(f"height_{i}", (1 if start.kind == "peak" else -1) * start.depth.value)
        parameters.add(f"centre_{i}", (low + high) / 2, min=low, max=high)
        parameters.add(f"width_{i}", high - low, min=(high - low) / 4, max=2.0)
        parameters.add(f"steepness_{i}", 4.0, min=0.5, max=60.0)
    return parameters


def _numbers(parameters: lmfit.Parameters) -> np.ndarray:
    return np.array([parameter.value for parameter in parameters.values()])


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

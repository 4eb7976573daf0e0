"""The fit of a dip or peak with a model, and what its errors mean."""
from __future__ import annotations

from dataclasses import dataclass

import lmfit
import numpy as np

from .curves import Curve, NoResonance, Resonance, Value, half_maximum

NAMES = ("baseline", "height", "centre", "width", "steepness")


def bell(x: np.ndarray, baseline: float, height: float, centre: float, width: float, steepness: float) -> np.ndarray:
    """baseline + height 2^(-|2 (x - centre)/width|^steepness). `width` is the full width at half maximum whatever the
    steepness: 2 is a Gaussian, close to a Rabi line's main lobe; large values a dip with a flat bottom."""
    distance = np.maximum(np.abs(2 * (x - centre) / width), 1e-300)
    return baseline + height * np.exp2(-np.exp(np.minimum(steepness * np.log(distance), 10.0)))


@dataclass(frozen=True)
class Fit:
    """A fitted dip or peak."""

    resonance: Resonance
    steepness: Value
    misfit: float  # rms residual over rms error: about 1 or below where the model describes the curve
    parameters: dict[str, float]  # of `bell`

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """The fitted curve at x."""
        return bell(x, **self.parameters)


def fit(curve: Curve) -> Fit:
    """Fits `bell` by least squares and takes the errors from the curve's covariance.

    Every point weighs the same, and the covariance C enters through the estimate p = A y, A = (JᵀJ)⁻¹Jᵀ, as A C Aᵀ.
    That holds for any C, also for one that is singular or estimated from few groups of particles, where C⁻¹ as a
    weight would be wrong or would not exist. Where the model misses the points by more than their errors
    (misfit > 1), all errors are multiplied by the misfit, as the Particle Data Group does. Raises NoResonance.
    """
    start = half_maximum(curve)
    sign = 1 if start.kind == "peak" else -1
    unit, origin = float(np.ptp(curve.x)), start.centre.value  # the fit sees numbers of order one
    x = (curve.x - origin) / unit
    parameters = lmfit.Parameters()
    parameters.add("baseline", start.baseline.value)
    parameters.add("height", sign * start.depth.value)
    parameters.add("centre", 0.0, min=x[0], max=x[-1])
    parameters.add("width", start.width.value / unit, min=1e-6, max=2.0)
    parameters.add("steepness", 4.0, min=0.5, max=60.0)
    outcome = lmfit.minimize(lambda p: bell(x, **p.valuesdict()) - curve.y, parameters)
    best = np.array([outcome.params[name].value for name in NAMES])
    if not (outcome.success and np.isfinite(best).all()):
        raise NoResonance("the fit does not converge")

    misfit = float(np.sqrt(np.mean(outcome.residual**2) / np.mean(np.diag(curve.covariance))))
    linear = np.linalg.pinv(_jacobian(x, best), rcond=1e-8)
    errors = np.sqrt(np.diag(linear @ curve.covariance @ linear.T).clip(0)) * max(1.0, misfit)
    baseline, height, centre, width, steepness = map(Value, best.tolist(), errors.tolist())
    resonance = Resonance(
        kind=start.kind,
        centre=Value(origin + unit * centre.value, unit * centre.error),
        width=Value(unit * width.value, unit * width.error),
        depth=Value(abs(height.value), height.error),
        baseline=baseline,
    )
    values = (baseline.value, height.value, resonance.centre.value, resonance.width.value, steepness.value)
    return Fit(resonance, steepness, misfit, dict(zip(NAMES, values)))


def _jacobian(x: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """[n, 5] Derivatives of `bell` by its parameters, by central differences."""
    step = 1e-5 * np.maximum(np.abs(parameters), 1e-3)
    columns = [(bell(x, *(parameters + move)) - bell(x, *(parameters - move))) for move in np.diag(step)]
    return np.stack(columns, axis=1) / (2 * step)

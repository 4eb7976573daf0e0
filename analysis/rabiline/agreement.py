"""Whether curves agree: with a constant, with a model, with another result. All by chi² with the covariance."""
from __future__ import annotations

from dataclasses import replace

import numpy as np

from .covariance import ChiSquared, chi_squared, enough
from .curves import Curve, spread_of
from .errors import InputError
from .results import Axis, Results

MISSING = "the points share particles, and their covariance is not in the file"


class NotComparable(InputError):
    """Two results that have nothing to compare, and why."""


def with_constant(curve: Curve) -> ChiSquared:
    """Whether the curve may be flat, at whatever height."""
    return with_model(curve, np.full(curve.y.size, curve.y.mean()), np.ones((curve.y.size, 1)))


def with_model(curve: Curve, expected: np.ndarray, derivatives: np.ndarray | None = None) -> ChiSquared:
    """Whether the curve may come from the fractions `expected` [n]; where these were fitted, over parameters with the
    `derivatives` [n, parameters]. Errors are those at `expected`, but where next to no particles are expected to differ
    and many do, the measured ones, which the other would make seem to be none."""
    if curve.covariance_missing:
        return ChiSquared(0.0, 0, np.nan, MISSING)
    likely = enough(expected, curve.spread.particle)
    errors = np.where(likely, curve.spread.at(expected, curve.y).errors, curve.spread.errors)
    counted = likely | enough(curve.y, curve.spread.particle)
    return chi_squared(curve.y - expected, replace(curve.spread, errors=errors), derivatives, counted)


def compare(one: Results, other: Results) -> dict[str, ChiSquared]:
    """For each detector, whether two results of one scan, with particles of their own, agree. Errors are those at the
    mean of both. There is no chi² over several detectors: they see the same particles, and files do not say how they
    correlate. Raises NotComparable."""
    _check(one, other)
    return {name: _compare(one, other, name) for name in one.scan.detectors}


def same_particles(one: Results, other: Results) -> bool:
    """Whether two results have one seed, and with it particles in common."""
    seeds = {file.simulation.get("seed") for file in (one, other)}
    return len(seeds) == 1 and None not in seeds


def _compare(one: Results, other: Results, detector: str) -> ChiSquared:
    if one.covariance_missing or other.covariance_missing:
        return ChiSquared(0.0, 0, np.nan, MISSING)
    points = [_in_order(file) for file in (one, other)]
    rows = [file.scan.detectors.index(detector) for file in (one, other)]
    y = [file.scan.detected[row][order] for file, row, order in zip((one, other), rows, points)]
    pooled = np.average(y, axis=0, weights=[file.particles[order] for file, order in zip((one, other), points)])
    spreads = [spread_of(file, row, order).at(pooled, own) for file, row, order, own in zip((one, other), rows, points, y)]
    counted = enough(pooled, 1 / (1 / spreads[0].particle + 1 / spreads[1].particle))
    return chi_squared(y[0] - y[1], spreads[0].minus(spreads[1]), counted=counted)


def _check(one: Results, other: Results) -> None:
    if [axis.parameter for axis in one.scan.axes] != [axis.parameter for axis in other.scan.axes]:
        raise NotComparable(f"{other.path}: its scan runs over {_names(other.scan.axes)}, that of {one.path} over "
                            f"{_names(one.scan.axes)}")
    for mine, its in zip(one.scan.axes, other.scan.axes):
        alike = mine.values.shape == its.values.shape and mine.labels == its.labels and np.allclose(
            np.sort(mine.values), np.sort(its.values), rtol=0, atol=1e-9 * max(np.ptp(mine.values), np.abs(mine.values).max()))
        if not alike:
            raise NotComparable(f"{other.path}: the points of its scan over {mine.parameter} are not those of "
                                f"{one.path}")
    if set(one.scan.detectors) != set(other.scan.detectors):
        raise NotComparable(f"{other.path}: it has the detectors {', '.join(other.scan.detectors)}, {one.path} has "
                            f"{', '.join(one.scan.detectors)}")


def _in_order(results: Results) -> np.ndarray:
    """[points] The scan points by rising values of each axis, whichever way its scan ran."""
    orders = [np.argsort(axis.values, kind="stable") for axis in results.scan.axes]
    return np.arange(len(results.laws)).reshape(results.scan.shape)[np.ix_(*orders)].ravel() if orders else np.arange(1)


def _names(axes: tuple[Axis, ...]) -> str:
    return " and ".join(axis.parameter for axis in axes) or "nothing"

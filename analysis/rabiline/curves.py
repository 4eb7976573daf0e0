"""Curves of a scan, one per law, species or value of the second axis, and the dip or peak in them."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .results import Axis, Results
from .units import format_value, law_name


class NoResonance(Exception):
    """A curve in which no dip or peak can be measured, and why."""


@dataclass(frozen=True)
class Curve:
    """The detected fraction along one axis of a scan."""

    label: str  # what tells this curve from the others of its file
    law: str
    species: str
    axis: Axis
    points: np.ndarray  # [n] flat numbers of its scan points
    y: np.ndarray  # [n] detected fraction of emitted
    errors: np.ndarray  # [n] one standard error
    covariance: np.ndarray  # [n, n] of y; diagonal where the file has none

    @property
    def x(self) -> np.ndarray:
        """[n] The scanned values, SI."""
        return self.axis.values


@dataclass(frozen=True)
class Value:
    """A number and its standard error."""

    value: float
    error: float


@dataclass(frozen=True)
class Resonance:
    """A dip or peak; centre and width in the units of the curve's axis."""

    kind: str  # "dip" or "peak"
    centre: Value
    width: Value  # full width at half maximum
    depth: Value  # height over the baseline for a peak; never negative
    baseline: Value

    @property
    def level(self) -> float:
        """The detected fraction at half depth."""
        sign = -1 if self.kind == "dip" else 1
        return self.baseline.value + sign * self.depth.value / 2


def curves(results: Results, detector: str | None = None) -> list[Curve]:
    """The rows of the scan for one detector, the first by default. A row runs along the numeric axis with the most
    points; the other axis, if any, tells the rows apart. Raises NoResonance where nothing is scanned."""
    scan = results.scan
    if not scan.axes:
        raise NoResonance("nothing is scanned in this file")
    number = scan.detectors.index(detector) if detector is not None else 0
    along = max(range(len(scan.axes)), key=lambda i: (not scan.axes[i].labels, scan.axes[i].values.size))
    flat = np.moveaxis(np.arange(np.prod(scan.shape)).reshape(scan.shape), along, -1)
    rows = flat.reshape(-1, flat.shape[-1])
    others = [axis for i, axis in enumerate(scan.axes) if i != along]
    covariance = np.diag(scan.errors[number] ** 2) if scan.covariance is None else scan.covariance[number]
    return [
        Curve(
            label=_label(results, rows, row, others),
            law=_common(results.laws, points),
            species=_common(results.species, points),
            axis=scan.axes[along],
            points=points,
            y=scan.detected[number, points],
            errors=scan.errors[number, points],
            covariance=_at_least(covariance[np.ix_(points, points)], scan.errors[number, points]),
        )
        for row, points in enumerate(rows)
    ]


def half_maximum(curve: Curve) -> Resonance:
    """The dip or peak without a model. The baseline is the mean of the outer tenths of the scan, the depth the distance
    to the farthest point, the edges where straight lines between points first cross half of it on either side. Errors
    come from the covariance, to first order, and for the edges from the curvature that straight lines leave out. Raises
    NoResonance."""
    y, sign = curve.y, _direction(curve)
    n, tenth = y.size, max(1, y.size // 10)
    along_baseline = np.zeros(n)  # d(baseline)/dy, and so on
    along_baseline[:tenth] = along_baseline[n - tenth:] = 1 / (2 * tenth)
    farthest = int(np.argmax(sign * y))
    along_extreme = np.eye(n)[farthest]
    along_level = (along_baseline + along_extreme) / 2

    def value(of: float, along: np.ndarray, bend: float = 0.0) -> Value:
        return Value(float(of), float(np.sqrt(max(0.0, along @ curve.covariance @ along) + bend**2)))

    baseline = value(along_baseline @ y, along_baseline)
    depth = value(abs(y[farthest] - baseline.value), along_extreme - along_baseline)
    if depth.value <= 5 * max(depth.error, float(curve.errors.min()), 1e-12):  # 1e-12: rounding
        raise NoResonance("nothing stands out from the baseline by more than five standard errors")
    low, along_low, bend_low = _crossing(curve, farthest, -1, along_level)
    high, along_high, bend_high = _crossing(curve, farthest, +1, along_level)
    bend = float(np.hypot(bend_low, bend_high))
    return Resonance(
        kind="peak" if sign > 0 else "dip",
        centre=value((low + high) / 2, (along_low + along_high) / 2, bend / 2),
        width=value(high - low, along_high - along_low, bend),
        depth=depth,
        baseline=baseline,
    )


def _direction(curve: Curve) -> int:
    """+1 for a peak, -1 for a dip: where the curve goes farther from its outer tenths."""
    if curve.axis.labels or curve.y.size < 5:
        raise NoResonance("a resonance needs a numeric axis with at least five points")
    if not (np.isfinite(curve.y).all() and (np.diff(curve.x) > 0).all()):
        raise NoResonance("a resonance needs finite fractions at rising values")
    tenth = max(1, curve.y.size // 10)
    baseline = (curve.y[:tenth].mean() + curve.y[-tenth:].mean()) / 2
    return 1 if curve.y.max() - baseline > baseline - curve.y.min() else -1


def _crossing(curve: Curve, start: int, step: int, along_level: np.ndarray) -> tuple[float, np.ndarray, float]:
    """Where the curve, followed from `start`, first crosses its half level, the gradient of that place by y, and how
    far a parabola through the neighbours would put it from there."""
    x, y = curve.x, curve.y
    level = along_level @ y
    inside = np.sign(y[start] - level)
    i = start
    while np.sign(y[i] - level) == inside:
        i += step
        if not 0 <= i < y.size:
            raise NoResonance("the scan ends before the curve is back at half its depth")
    before = i - step
    slope = (y[i] - y[before]) / (x[i] - x[before])
    part = (level - y[before]) / (y[i] - y[before])
    along = along_level.copy()
    along[before] -= 1 - part
    along[i] -= part
    curvature = np.abs(np.diff(y[max(0, min(i, before) - 1):max(i, before) + 2], 2)).max()
    bend = part * (1 - part) / 2 * curvature / abs(slope)
    return float(x[before] + part * (x[i] - x[before])), along / slope, float(bend)


def _at_least(covariance: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """The covariance with no variance below errors². A covariance from groups of particles is zero where all
    particles agree; the binomial error there is not."""
    return covariance + np.diag(np.maximum(0, errors**2 - np.diag(covariance)))


def _common(values: tuple[str, ...], points: np.ndarray) -> str:
    distinct = dict.fromkeys(values[point] for point in points)
    return next(iter(distinct)) if len(distinct) == 1 else ""


def _label(results: Results, rows: np.ndarray, row: int, others: list[Axis]) -> str:
    """The law, the species where it differs between rows, and the value of any other second axis."""
    parts = [law_name(_common(results.laws, rows[row]))]
    if len(set(results.species)) > 1:
        parts.append(_common(results.species, rows[row]))
    for axis in others:
        if axis.parameter not in ("law", "species"):
            value = axis.labels[row] if axis.labels else format_value(axis.values[row], axis.units)
            parts.append(f"{axis.parameter} = {value}")
    return ", ".join(filter(None, parts))

"""Curves of a scan, one per law, species or value of the second axis, and the dip or peak in them."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .covariance import Spread
from .errors import InputError
from .results import Axis, Results
from .swings import central, maxima
from .units import law_name


RESONANT = {"Hz", "T", "A"}  # units of what brings a frequency and a field together
MOST_RESONANCES = 6  # in one curve; Ramsey fringes, for one, are many more
WIDEST = 0.5  # of the scan, a dip or peak that has a baseline on both sides
LOBES = 3  # from which on side lobes are known by how they fall off,
FALLING = (0.2, 0.8)  # each by such a factor: a first side lobe is less than a fifth of its resonance
EVEN = 1.5  # and by the distances between them, which differ by less than this factor


class NoResonance(InputError):
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
    spread: Spread  # errors and correlation, fit for use
    detector: str = ""
    rate: tuple[float, float] | None = None  # counts per second of a fraction of 1, and without a beam; None: not known
    aimed: bool = False  # its fraction is of what starts towards the target of the source
    covariance_missing: bool = False  # its points share particles, and the file does not say how they correlate

    @property
    def x(self) -> np.ndarray:
        """[n] The scanned values, SI."""
        return self.axis.values

    @property
    def covariance(self) -> np.ndarray:
        """[n, n] of y."""
        return self.spread.covariance

    def piece(self, part: slice) -> Curve:
        """A part of it."""
        spread = Spread(self.spread.errors[part], None if self.spread.correlation is None else self.spread.correlation[part, part], self.spread.freedom,
                        self.spread.particle[part])
        return replace(self, axis=replace(self.axis, values=self.axis.values[part]), points=self.points[part], y=self.y[part],
                       errors=self.errors[part], spread=spread)


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
    resolution: float  # what the spacing of the points alone leaves open of the width, one standard deviation; it is
    # part of the width's error, and half of it of a fitted centre's

    @property
    def level(self) -> float:
        """The detected fraction at half depth."""
        sign = -1 if self.kind == "dip" else 1
        return self.baseline.value + sign * self.depth.value / 2


def curves(results: Results, detector: str | None = None) -> list[Curve]:
    """The rows of the scan for one detector, or for each in turn. A row runs along the numeric axis with the most
    points; the others, if any, tell the rows apart. Raises NoResonance where nothing is scanned."""
    scan = results.scan
    if not scan.axes:
        raise NoResonance("nothing is scanned in this file")
    if detector is None and len(scan.detectors) > 1:
        names = labels_of(results)
        every = [curve for name in scan.detectors for curve in curves(results, name)]
        return [replace(curve, label=": ".join(filter(None, (names[curve.detector], curve.label)))) for curve in every]
    number = scan.detectors.index(detector) if detector is not None else 0
    along = max(range(len(scan.axes)), key=lambda i: (not scan.axes[i].labels, scan.axes[i].values.size))
    flat = np.moveaxis(np.arange(np.prod(scan.shape)).reshape(scan.shape), along, -1)
    order = np.argsort(scan.axes[along].values, kind="stable")  # a scan may run downwards, or to and fro
    axis = replace(scan.axes[along], values=scan.axes[along].values[order])
    rows = flat.reshape(-1, flat.shape[-1])[:, order]
    others = [axis for i, axis in enumerate(scan.axes) if i != along]
    return [
        Curve(
            label=_label(results, rows, row, others),
            law=_common(results.laws, points),
            species=_common(results.species, points),
            axis=axis,
            points=points,
            y=scan.detected[number, points],
            errors=scan.errors[number, points],
            spread=spread_of(results, number, points),
            detector=scan.detectors[number],
            rate=_rate(results, number),
            aimed=results.aimed_fraction is not None,
            covariance_missing=results.covariance_missing,
        )
        for row, points in enumerate(rows)
    ]


def labels_of(results: Results) -> dict[str, str]:
    """What pictures call each detector: its label, or its name where two have one label."""
    labels = [results.detectors[name].label for name in results.scan.detectors]
    return {name: label if labels.count(label) == 1 else name for name, label in zip(results.scan.detectors, labels)}


def _rate(results: Results, detector: int) -> tuple[float, float] | None:
    """Counts per second by the detected fraction of a detector, by its number, where that is the same at all points."""
    if results.scan.count_rate is None:
        return None
    background = results.detectors[results.scan.detectors[detector]].background
    seen = results.scan.detected[detector] > 0
    each = (results.scan.count_rate[detector] - background)[seen] / results.scan.detected[detector][seen]
    return (float(np.median(each)), background) if each.size and np.ptp(each) < 1e-6 * np.median(each) else None


def spread_of(results: Results, detector: int, points: np.ndarray) -> Spread:
    """How the fractions that a detector, by its number, caught at these scan points scatter."""
    covariance = results.scan.covariance
    return Spread.of(results.scan.detected[detector, points], results.scan.errors[detector, points],
                     None if covariance is None else covariance[detector][np.ix_(points, points)],
                     results.particles[points])


def half_maxima(curve: Curve) -> list[Resonance]:
    """Every dip or peak without a model, by rising x. The depth of each is the distance from the baseline to its farthest point; its edges are where
    straight lines between points first cross half of it on either side. Two dips are two where the curve comes back between them to less than a quarter
    of the shallower one's depth; what stays below a quarter of the deepest one is a side lobe and not measured; of fringes, which swing to both sides of
    the baseline, only the farthest is, or the central one of few, whose depth is that to the mean of the extremes beside it.

    Errors come from the covariance, to first order, and for the edges from `Edge.resolution` on top. Raises NoResonance where nothing stands out, where
    any one of several cannot be measured, and where what stands out belongs to a resonance outside the scan: no number is better than a wrong one.
    """
    if found := _central(curve):
        sign, farthest, *beside = found
        return [_measured(curve, farthest, sum(_at(place, curve.y.size) for place in beside) / 2, sign)]
    along_baseline, sign = _baseline(curve)
    height = sign * (curve.y - along_baseline @ curve.y)
    farthest = int(np.argmax(height))
    noise = _noise(curve, along_baseline)
    if height[farthest] <= 5 * noise[farthest]:
        raise NoResonance("nothing stands out from the baseline by more than five standard errors")
    least = np.clip(5 * curve.errors, height[farthest] / 4, height[farthest])
    extremes = _extremes(height, _of_fringes(height))
    if _are_fringes(curve, height, extremes):
        if not _is_inside(curve.x, extremes, farthest):
            raise NoResonance("the highest fringe is the last one on its side: the central one may lie outside the scan")
        return [_measured(curve, farthest, _between(curve.x, height, extremes, farthest), sign)]
    extremes = _extremes(height, least)
    if _are_side_lobes(curve.x, height, 5 * float(np.median(noise))):
        raise NoResonance("the dips or peaks fall off from one end of the scan as side lobes do: the resonance may lie outside")
    found = [_measured(curve, extreme, along_baseline, sign) for extreme in extremes]
    if len(found) > MOST_RESONANCES:
        raise NoResonance(f"{len(found)} dips or peaks: too many to measure each")
    if max(resonance.width.value for resonance in found) > WIDEST * np.ptp(curve.x):
        raise NoResonance("the scan shows no baseline: what stands out takes more than half of it")
    return found


def are_fringes(curve: Curve) -> bool:
    """Whether a curve with dips or peaks swings beyond its baseline between them, as Ramsey's fringes do."""
    if _central(curve):
        return True
    along_baseline, sign = _baseline(curve)
    height = sign * (curve.y - along_baseline @ curve.y)
    return _are_fringes(curve, height, _extremes(height, _of_fringes(height)))


def _of_fringes(height: np.ndarray) -> np.ndarray:
    """[n] What an extreme of a fringe reaches: points of a scan err together, so that their own errors say little of how they differ."""
    return np.full(height.size, height.max() / 4)


def _are_fringes(curve: Curve, height: np.ndarray, extremes: list[int]) -> bool:
    """Whether between two extremes the curve swings beyond its baseline, by more than five standard errors of the way there."""
    for i, j in zip(extremes, extremes[1:]):
        lowest, lower = i + int(np.argmin(height[i:j])), i if height[i] < height[j] else j
        along = _at(lower, height.size) - _at(lowest, height.size)
        if height[lowest] < -height.max() / 4 and height[lower] - height[lowest] > 5 * curve.spread.of_sum(along):
            return True
    return False


def _noise(curve: Curve, along_baseline: np.ndarray) -> np.ndarray:
    """[n] Standard errors of the distances from the baseline."""
    with_baseline = curve.spread.with_sum(along_baseline)
    variances = curve.spread.errors**2 - 2 * with_baseline + along_baseline @ with_baseline
    return np.maximum(np.sqrt(variances.clip(0)), max(float(curve.errors.min()), 1e-12))  # 1e-12: rounding


def _between(x: np.ndarray, height: np.ndarray, extremes: list[int], farthest: int) -> np.ndarray:
    """d(baseline)/dy [n] of the farthest fringe: the mean of the lowest points beside it, on either side no farther than the next fringe."""
    spacing = float(np.diff(x[extremes]).min())
    near = np.abs(x - x[farthest]) < spacing
    left, right = near & (x < x[farthest]), near & (x > x[farthest])
    lowest = [int(np.argmin(np.where(side, height, np.inf))) for side in (left, right)]
    return sum(_at(place, x.size) for place in lowest) / 2


def _is_inside(x: np.ndarray, extremes: list[int], farthest: int) -> bool:
    """Whether a comb of fringes falls off on both sides of its farthest one, as far as the scan would have shown another."""
    spacing = float(np.diff(x[extremes]).min())
    return (extremes[0] < farthest or x[farthest] - x[0] > spacing) and (farthest < extremes[-1] or x[-1] - x[farthest] > spacing)


def _are_side_lobes(x: np.ndarray, height: np.ndarray, least: float) -> bool:
    """Whether dips or peaks, as far as they rise by `least` from their neighbourhood, fall off from one end of the scan on, at even
    distances, the first no farther from the end than the next from it."""
    tops = maxima(height, least)
    above = height - height.min()  # what touches has no baseline between
    for lobes, end in ((tops[:LOBES], x[0]), (tops[:-LOBES - 1:-1], x[-1])):
        if lobes.size < LOBES:
            return False
        falls, distances = above[lobes[1:]] / above[lobes[:-1]], np.abs(np.diff(x[lobes]))
        if (falls > FALLING[0]).all() and (falls < FALLING[1]).all() and distances.max() < EVEN * distances.min() \
                and abs(x[lobes[0]] - end) < distances.max():
            return True
    return False


def deepest(resonances: list[Resonance]) -> Resonance:
    """The one with the largest depth."""
    return max(resonances, key=lambda resonance: resonance.depth.value)


@dataclass(frozen=True)
class Edge:
    """Where a curve passes half its depth, between two neighbouring points."""

    place: float
    gradient: np.ndarray  # [n] d(place)/dy
    spacing: float  # of the two points
    climb: float  # part of the depth by which the curve changes between them
    bend: float  # how far a parabola through the neighbours would put the place from there

    @property
    def resolution(self) -> float:
        """How well the spacing of the points allows to know the place, as a standard deviation, whatever the number
        of particles. Where the curve climbs by half its depth or more from one point to the next, the place may be
        anywhere between the two: spacing/√12. Where several points follow the edge, what straight lines or a model
        miss between points falls as the square of the climb; the bend is a lower limit of it."""
        return self._open(2)

    @property
    def of_centre(self) -> float:
        """The part of it that does not cancel in a centre between two edges: points as near to one another miss a smooth line by much the
        same on both of them, and what is left falls as the square again."""
        return self._open(4)

    def _open(self, power: int) -> float:
        return max(self.bend, self.spacing / np.sqrt(12) * min(1.0, 2 * self.climb) ** power)


def _measured(curve: Curve, extreme: int, along_baseline: np.ndarray, sign: int) -> Resonance:
    low, high = _edges(curve, extreme, along_baseline)
    along_depth = sign * (_at(extreme, curve.y.size) - along_baseline)

    def value(along: np.ndarray, of: float | None = None, resolution: float = 0.0) -> Value:
        return Value(float(along @ curve.y if of is None else of),
                     float(np.hypot(curve.spread.of_sum(along), resolution)))

    resolution = float(np.hypot(low.resolution, high.resolution))
    of_centre = float(np.linalg.norm([low.of_centre, high.of_centre, high.resolution - low.resolution])) / 2  # one edge may have coarser points
    return Resonance(
        kind="peak" if sign > 0 else "dip",
        centre=value((low.gradient + high.gradient) / 2, (low.place + high.place) / 2, of_centre),
        width=value(high.gradient - low.gradient, high.place - low.place, resolution),
        depth=value(along_depth),
        baseline=value(along_baseline),
        resolution=resolution,
    )


def _edges(curve: Curve, extreme: int, along_baseline: np.ndarray) -> tuple[Edge, Edge]:
    along_level = (along_baseline + _at(extreme, curve.y.size)) / 2
    return _edge(curve, extreme, -1, along_level), _edge(curve, extreme, +1, along_level)


def _at(place: int, points: int) -> np.ndarray:
    """[points] One there, zero elsewhere."""
    out = np.zeros(points)
    out[place] = 1
    return out


def _central(curve: Curve) -> tuple[int, int, int, int] | None:
    """The central one of few fringes, where the ends of the scan are no baseline. Refused where what is scanned has no resonance."""
    if not curve.axis.labels and (curve.axis.units not in RESONANT or curve.axis.parameter.endswith(".amplitude")):
        raise NoResonance(f"{curve.axis.parameter} tunes neither a frequency nor a static field")
    if curve.axis.labels or curve.y.size < 5:
        raise NoResonance("a resonance needs a numeric axis with at least five points")
    if not (np.isfinite(curve.y).all() and (np.diff(curve.x) > 0).all()):
        raise NoResonance("a resonance needs finite fractions at values that differ")
    noise = 5 * float(curve.errors.max())
    return central(curve.y, max(float(np.ptp(curve.y)) / 4, noise), noise)


def _baseline(curve: Curve) -> tuple[np.ndarray, int]:
    """d(baseline)/dy [n], and +1 for peaks, -1 for dips: where the curve goes farther from the baseline. The baseline
    is the mean of the outer tenths of the scan where these agree with each other; else, with a dip near an end, the
    mean of the points near the median of all, which must be many. Refused where neither shows a baseline."""
    y, tenth = curve.y, max(2 if curve.y.size >= 9 else 1, curve.y.size // 10)
    near = np.zeros(y.size, dtype=bool)
    near[:tenth] = near[-tenth:] = True
    alike = np.maximum(np.ptp(y) / 10, 5 * curve.errors)
    if (np.abs(y - y[near].mean()) > alike)[near].any() or np.ptp(y[near]) > 1.5 * alike[near].max():
        near = np.abs(y - np.median(y)) <= alike
        if near.sum() < 0.4 * y.size:  # a parabola passes its median too, on its flanks
            raise NoResonance("the scan shows no baseline: its ends are not alike, and no large part of it is flat")
    baseline = y[near].mean()
    return near / near.sum(), 1 if y.max() - baseline > baseline - y.min() else -1


def _extremes(height: np.ndarray, least: np.ndarray) -> list[int]:
    """The farthest point of each dip or peak that reaches `least`. Neighbours are separate where the curve comes back
    between them to less than a quarter of the lower one's height."""
    found: list[int] = []
    for i in np.flatnonzero(height >= least):
        if not found or height[found[-1]:i + 1].min() < min(height[found[-1]], height[i]) / 4:
            found.append(int(i))
        elif height[i] > height[found[-1]]:
            found[-1] = int(i)
    return found


def _edge(curve: Curve, start: int, step: int, along_level: np.ndarray) -> Edge:
    """Where the curve, followed from `start`, first crosses its half level. Refused where it turns back on its way to a
    quarter of its depth: two dips in one."""
    x, y = curve.x, curve.y
    level, depth = along_level @ y, 2 * abs(y[start] - along_level @ y)
    outwards = slice(start, None, step)
    height = np.sign(y[start] - level) * (y[outwards] - level) / depth  # 1/2 at the start, -1/2 on the baseline
    below = np.flatnonzero(height < 0)
    if below.size == 0:
        raise NoResonance("the scan ends before the curve is back at half its depth")
    flank = height[:np.flatnonzero(np.append(height < -1 / 4, True))[0]]
    back = flank - np.minimum.accumulate(flank)
    if (back > np.maximum(0.1, 7 * curve.errors[outwards][:flank.size] / depth)).any():  # 7: five of a difference
        raise NoResonance("the curve turns back on a flank: dips or peaks that overlap")
    i = start + step * int(below[0])
    before = i - step
    slope = (y[i] - y[before]) / (x[i] - x[before])
    part = (level - y[before]) / (y[i] - y[before])
    along = along_level.copy()
    along[before] -= 1 - part
    along[i] -= part
    curvature = np.abs(np.diff(y[max(0, min(i, before) - 1):max(i, before) + 2], 2)).max()
    return Edge(
        place=float(x[before] + part * (x[i] - x[before])),
        gradient=along / slope,
        spacing=float(abs(x[i] - x[before])),
        climb=float(abs(y[i] - y[before]) / depth),
        bend=float(part * (1 - part) / 2 * curvature / abs(slope)),
    )


def _common(values: tuple[str, ...], points: np.ndarray) -> str:
    """What all points have; of a law whose strength is scanned, what is before that: "dorado (torque"."""
    distinct = list(dict.fromkeys(values[point] for point in points))
    if len(distinct) == 1:
        return distinct[0]
    families = {value.partition(", kappa")[0] for value in distinct}
    return f"{families.pop()})" if len(families) == 1 and "(" in distinct[0] else ""


def _label(results: Results, rows: np.ndarray, row: int, others: list[Axis]) -> str:
    """The law, the species where it differs between rows, and the value of each other axis."""
    parts = [law_name(_common(results.laws, rows[row]))]
    if len(set(results.species)) > 1:
        parts.append(_common(results.species, rows[row]))
    places = np.unravel_index(row, [len(axis.values) for axis in others])
    for axis, at in zip(others, places):
        if axis.parameter not in ("law", "species"):
            value = axis.labels[at] if axis.labels else axis.text(axis.values[at]).replace("-", "−")
            parts.append(f"{axis.parameter} = {value}")
    return ", ".join(filter(None, parts))

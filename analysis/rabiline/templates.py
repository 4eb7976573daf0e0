"""What each law, or each strength of one, expects a detector to count: histograms over the scan's other points, in
cells that hold enough simulated particles to mean something.

A scan point of the templates is one of the scan's other axis, or the only one; bins are those of a detector's image
(x, z), of its projections, or the whole detector.
"""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .errors import InputError
from .likelihood import Model
from .results import Axis, Results

HISTOGRAMS = {"image": "x and z", "x": "x", "z": "z", "detected": "the whole detector"}
LEAST = 50  # simulated particles in a cell, under one of the laws at least
EXACT_BITS = 48  # of a sum of particles, in the numbers by which screens are cut
MOST_BOXES, MOST_BINS = 512, 2**22  # of a screen, cut at a time
UNSEEN = 0.5  # expected particles in all cells of a point together where none was simulated: the mean of a Poisson
# expectation after no count, with Jeffreys' prior (1946); it is gamma distributed with this k


class NoTemplates(InputError):
    """A result that has no templates to compare, and why."""


@dataclass(frozen=True)
class Screen:
    """One detector's histograms."""

    name: str
    histogram: str  # one of HISTOGRAMS
    edges: tuple[np.ndarray, np.ndarray]  # [nx + 1] and [nz + 1] m; [lowest, highest] of what is summed over
    counts: np.ndarray  # [laws, points, nx, nz] per emitted particle
    variances: np.ndarray  # same shape
    totals: np.ndarray  # [laws, points] detected per emitted particle
    total_errors: np.ndarray  # [laws, points]
    cells: np.ndarray  # [points, nx, nz] number of the cell that a bin belongs to, from 0 over the whole screen
    background: float  # 1/s, that the file states


@dataclass(frozen=True)
class Templates:
    """What is compared: laws, or strengths of one."""

    path: str
    title: str
    names: tuple[str, ...]  # [laws]
    strengths: np.ndarray  # [laws] values of the axis that tells them apart
    axis: Axis | None  # over the points; None for one point
    screens: tuple[Screen, ...]
    emitted: np.ndarray  # [points] simulated particles per law
    seed: str | None
    independent: bool  # each scan point, and with it each law, flies particles of its own
    rate: float | None  # 1/s that leave the source, as the file states
    aimed: np.ndarray  # [points] share of what leaves the source that is simulated

    @property
    def points(self) -> int:
        """Scan points for each law."""
        return self.emitted.size

    def choose(self, name: str | None) -> Templates:
        """Those of one detector."""
        return self if name is None else Templates(**{**vars(self), "screens": tuple(
            screen for screen in self.screens if screen.name == name)})


def templates(results: Results, parameter: str, histogram: str = "image", most: float = np.inf) -> Templates:
    """Of the scan's axis `parameter`, with at most about `most` cells for a point and detector; raises NoTemplates."""
    scan = results.scan
    numbers = [i for i, axis in enumerate(scan.axes) if axis.parameter == parameter]
    if not numbers:
        over = " and ".join(axis.parameter for axis in scan.axes) or "nothing"
        example = "law=quantum,dorado" if parameter == "law" else "law.kappa=0:0.02:41"
        raise NoTemplates(f"{results.path}: its scan runs over {over}, not over {parameter}; "
                          f"make one with `rabiline run FILE --scan {example}`")
    along = numbers[0]
    if scan.axes[along].values.size < 2:
        raise NoTemplates(f"{results.path}: its scan has only one value of {parameter}")
    if len(scan.axes) > 2:
        raise NoTemplates(f"{results.path}: its scan runs over {len(scan.axes)} axes; templates need {parameter} and one "
                          "more at most")
    other = scan.axes[1 - along] if len(scan.axes) == 2 else None
    flat = np.moveaxis(np.arange(np.prod(scan.shape)).reshape(scan.shape), along, 0).reshape(scan.shape[along], -1)
    if other is not None:  # a scan may run downwards
        order = np.argsort(other.values, kind="stable")
        other, flat = replace(other, values=other.values[order], labels=tuple(np.array(other.labels)[order]) if other.labels else ()), flat[:, order]
    return Templates(
        path=str(results.path), title=results.title, names=tuple(results.laws[row[0]] for row in flat),
        strengths=scan.axes[along].values, axis=other,
        screens=tuple(_screen(results, name, histogram, flat, most) for name in scan.detectors),
        emitted=results.emitted[flat[0]], seed=results.simulation.get("seed"),
        independent=results.simulation.get("particles") == "independent", rate=results.rate,
        aimed=np.ones(flat.shape[1]) if results.aimed_fraction is None else results.aimed_fraction[flat[0]],
    )


def histogram_of(results: Results, name: str, histogram: str,
                 points: np.ndarray) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """Counts and variances [*points.shape, nx, nz] in particles, and the edges."""
    detector, row = results.detectors[name], results.scan.detectors.index(name)
    ends = detector.x_edges[[0, -1]], detector.z_edges[[0, -1]]
    if histogram == "image":
        return detector.counts[points], detector.errors[points] ** 2, (detector.x_edges, detector.z_edges)
    if histogram == "x":
        return detector.counts_x[points][..., None], detector.errors_x[points][..., None] ** 2, \
            (detector.x_edges, ends[1])
    if histogram == "z":
        return detector.counts_z[points][..., None, :], detector.errors_z[points][..., None, :] ** 2, \
            (ends[0], detector.z_edges)
    emitted = results.emitted[points]
    counts, errors = results.scan.detected[row, points] * emitted, results.scan.errors[row, points] * emitted
    return counts[..., None, None], errors[..., None, None] ** 2, ends


def models(made: Templates, exposure: np.ndarray | float, backgrounds: list[float] | None = None,
           free: bool = False) -> list[Model]:
    """For each law, expected counts in the cells of all screens, in turn, when `exposure` [points] particles are
    emitted at each point; `backgrounds` are counts at each point, one number for each screen, spread evenly over it."""
    exposure = np.broadcast_to(exposure, made.points)
    found = []
    for law in range(len(made.names)):
        parts = [_cells_of(screen, made.emitted, law, exposure, 0.0 if backgrounds is None else backgrounds[i])
                 for i, screen in enumerate(made.screens)]
        signal, background, k = (np.concatenate(part) for part in zip(*parts))
        found.append(Model(signal, background, k, free))
    return found


def gather(screen: Screen, values: np.ndarray) -> np.ndarray:
    """[cells] Sums of `values` [points, nx, nz] over the bins of each cell."""
    return np.bincount(screen.cells.ravel(), np.broadcast_to(values, screen.cells.shape).ravel())


def point_of_cell(screen: Screen) -> np.ndarray:
    """[cells]"""
    point = np.broadcast_to(np.arange(screen.cells.shape[0])[:, None, None], screen.cells.shape)
    found = np.zeros(screen.cells.max() + 1, dtype=int)
    found[screen.cells.ravel()] = point.ravel()
    return found


def spread_over_bins(screen: Screen, values: np.ndarray) -> np.ndarray:
    """[points, nx, nz] What a cell has, over its bins in proportion to what all laws together expect there."""
    weights = screen.counts.sum(axis=0)
    sums = gather(screen, weights)
    area = gather(screen, np.ones(1))
    return values[screen.cells] * np.where(sums[screen.cells] > 0, weights / np.where(sums > 0, sums, 1)[screen.cells],
                                           1 / area[screen.cells])


def _cells_of(screen: Screen, emitted: np.ndarray, law: int, exposure: np.ndarray,
              background: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    point = point_of_cell(screen)
    counts, variances = gather(screen, screen.counts[law]), gather(screen, screen.variances[law])
    seen = counts > 0
    # all empty cells of a point share half a particle
    unseen = (UNSEEN / np.maximum(np.bincount(point, ~seen), 1))[point]
    with np.errstate(divide="ignore", invalid="ignore"):
        k = np.where(seen, counts**2 / np.where(seen, variances, 1), unseen)
    floors = np.where(seen, counts, unseen / emitted[point])
    kept = np.maximum(np.bincount(point, counts), UNSEEN / emitted) / np.bincount(point, floors)
    counts = floors * kept[point]  # the screen as a whole keeps what it has, or half a particle
    area = gather(screen, np.ones(1)) / screen.cells[0].size
    return counts * exposure[point], background * area, np.where(np.isnan(k), np.inf, k)


def _screen(results: Results, name: str, histogram: str, flat: np.ndarray, most: float) -> Screen:
    counts, variances, edges = histogram_of(results, name, histogram, flat)
    # a bin without a count has an error of half a particle; a cell of many such bins has none of its own
    variances = np.where(counts > 0, variances, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        weight = np.nan_to_num(variances.sum(axis=(2, 3)) / counts.sum(axis=(2, 3)))  # [laws, points] of one particle
    weight = np.where((weight > 0) & (weight <= 1) & (histogram != "detected"), weight, 1.0)
    emitted = results.emitted[flat][..., None, None]
    cells, first = [], 0
    for some in np.array_split(np.arange(flat.shape[1]), min(counts.size // MOST_BINS + 1, flat.shape[1])):
        particles = counts[:, some] / weight[:, some, None, None]
        own = _cut(particles, np.maximum(LEAST, particles.sum(axis=(2, 3)).max(axis=0) / most))
        cells.append(own + first)
        first += own.max() + 1
    row = results.scan.detectors.index(name)
    return Screen(name, histogram, edges, counts / emitted, variances / emitted**2, results.scan.detected[row, flat],
                  results.scan.errors[row, flat], np.concatenate(cells), results.detectors[name].background)


def _cut(counts: np.ndarray, least: np.ndarray) -> np.ndarray:
    """[points, nx, nz] Numbers of cells, from 0 over all points, for counts [laws, points, nx, nz]: the screen is cut in two as evenly as
    possible, and each half again, along its longer side or else the other, while both halves hold `least` [points] particles under some law."""
    laws, points, nx, nz = counts.shape
    steps = 2.0 ** (EXACT_BITS - np.ceil(np.log2(max(counts.sum(axis=(2, 3)).max(), 1.0))))  # of one particle: sums are exact, whatever their order
    sums = np.zeros((laws, points, nx + 1, nz + 1))
    sums[:, :, 1:, 1:] = np.rint(counts * steps).cumsum(axis=2).cumsum(axis=3)
    boxes, waiting = np.array([[0, nx, 0, nz, point] for point in range(points)]), np.arange(points)
    while waiting.size:
        cuts = np.full((len(boxes), 2), -1)
        cuts[waiting] = _cuts(sums, boxes[waiting], least * steps)
        boxes, waiting = _halved(boxes, cuts)
    cells = np.zeros((points, nx, nz), dtype=int)
    for number, (x, to_x, z, to_z, point) in enumerate(boxes.tolist()):
        cells[point, x:to_x, z:to_z] = number
    return cells


def _cuts(sums: np.ndarray, boxes: np.ndarray, least: np.ndarray) -> np.ndarray:
    """[boxes, 2] Along which axis, and where, each box [x, to_x, z, to_z, point] is cut; -1 where it is not. `sums` [laws, points, nx + 1, nz + 1]
    are those from the corner."""
    extents = boxes[:, [1, 3]] - boxes[:, [0, 2]]
    found = np.full((len(boxes), 2), -1)
    first = np.where(extents[:, 0] >= extents[:, 1], 0, 1)
    for axes in (first, 1 - first):
        for axis in (0, 1):
            left = np.flatnonzero((found[:, 1] < 0) & (axes == axis) & (extents[:, axis] > 1))
            alike = left[np.argsort(extents[left, axis])]
            for part in np.array_split(alike, alike.size // MOST_BOXES + 1) if alike.size else ():
                found[part] = np.stack(np.broadcast_arrays(axis, _cuts_along(axis, sums, boxes[part], least)), axis=1)
    return found


def _cuts_along(axis: int, sums: np.ndarray, boxes: np.ndarray, least: np.ndarray) -> np.ndarray:
    """[boxes] Where each box is cut most evenly along an axis, the first of equal places; -1 where a half would have too few particles."""
    begin, end, side, other_side = boxes[:, [2 * axis, 2 * axis + 1, 2 - 2 * axis, 3 - 2 * axis], None].transpose(1, 0, 2)
    point = boxes[:, 4:]
    places = begin + np.arange(1, (end - begin).max())

    def up_to(at: np.ndarray) -> np.ndarray:
        one, other = (sums[:, point, at, to] if axis == 0 else sums[:, point, to, at] for to in (side, other_side))
        return other - one

    start = up_to(begin)
    below = up_to(np.minimum(places, end)) - start  # [laws, boxes, places]
    above = up_to(end) - start - below
    allowed = (places < end) & (below.max(axis=0) >= least[point]) & (above.max(axis=0) >= least[point])
    best = np.argmin(np.where(allowed, np.abs(below - above).sum(axis=0), np.inf), axis=1)
    return np.where(allowed.any(axis=1), begin[:, 0] + 1 + best, -1)


def _halved(boxes: np.ndarray, cuts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Boxes with the halves of those that are cut in their place, the farther half first, and the numbers of these halves."""
    is_cut = cuts[:, 1] >= 0
    halves = np.repeat(boxes, 1 + is_cut, axis=0)
    far = np.flatnonzero(is_cut) + np.arange(is_cut.sum())
    axes, places = cuts[is_cut].T
    halves[far, 2 * axes] = halves[far + 1, 2 * axes + 1] = places
    return halves, np.flatnonzero(np.repeat(is_cut, 1 + is_cut))

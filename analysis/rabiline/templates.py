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
    for point in range(flat.shape[1]):
        particles = counts[:, point] / weight[:, point, None, None]
        own = _cut(particles, max(LEAST, particles.sum(axis=(1, 2)).max() / most))
        cells.append(own + first)
        first += own.max() + 1
    row = results.scan.detectors.index(name)
    return Screen(name, histogram, edges, counts / emitted, variances / emitted**2, results.scan.detected[row, flat],
                  results.scan.errors[row, flat], np.array(cells), results.detectors[name].background)


def _cut(counts: np.ndarray, least: float) -> np.ndarray:
    """[nx, nz] Numbers of cells for counts [laws, nx, nz]: the screen is cut in two as evenly as possible, and each
    half again, along its longer side or else the other, while both halves hold `least` particles under some law."""
    cells = np.zeros(counts.shape[1:], dtype=int)
    number, waiting = 0, [(slice(0, counts.shape[1]), slice(0, counts.shape[2]))]
    while waiting:
        box = waiting.pop()
        inside = counts[(slice(None), *box)]
        for axis in sorted((0, 1), key=lambda axis: -inside.shape[axis + 1]):
            below = np.cumsum(inside.sum(axis=2 - axis), axis=1)  # [laws, n]
            above = below[:, -1:] - below
            allowed = np.flatnonzero((below.max(axis=0) >= least) & (above.max(axis=0) >= least))
            if allowed.size:
                uneven = np.abs(below - above).sum(axis=0)[allowed]
                cut = box[axis].start + int(allowed[np.argmin(uneven)]) + 1
                halves = slice(box[axis].start, cut), slice(cut, box[axis].stop)
                waiting += [(half, box[1]) if axis == 0 else (box[0], half) for half in halves]
                break
        else:
            cells[box] = number
            number += 1
    return cells

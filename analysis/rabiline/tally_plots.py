"""Tallies as pictures: one axis with error bars, two as an image."""
from __future__ import annotations

from dataclasses import replace
from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from . import stated, style
from .image_plots import about, scanned_at, shot_of
from .results import Results, Tally, TallyAxis
from .style import COUNTS, GREY, LAWS, OTHERS
from .units import Scale, edges_of, is_logarithmic, law_name

BESIDE = 2.6  # inches beside panels: the numbers and names of an axis, and of the colours
FEW = 4  # levels whose names stand side by side, or values that are the ticks of their axis
LEVELS = {"level": "level in which it is found", "prepared_level": "level in which it was prepared"}  # whose names have their m
COLOURS = [LAWS["quantum"][0], LAWS["dorado"][0], LAWS["classical"][0], *(colour for colour, _ in OTHERS)]


def draw_tally(results: Results, tally: Tally, axes: Sequence[int], points: Sequence[int], title: str | None = None) -> Figure:
    """Counts over one or two of a tally's axes at some scan points, summed over its other axes."""
    others = tuple(1 + i for i in range(len(tally.axes)) if i not in axes)
    counts = tally.counts.sum(axis=others)
    errors = np.sqrt((tally.errors**2).sum(axis=others))
    if list(axes) != sorted(axes):
        counts, errors = counts.swapaxes(1, 2), errors.swapaxes(1, 2)
    shown = [tally.axes[i] for i in axes]
    if len(shown) == 1:
        return _draw_curves(results, tally, shown[0], counts, errors, points, title)
    figure = _draw_images(results, shown, counts, points)
    _write_title(figure, results, tally, shown, title)
    return figure


def draw_over_scan(results: Results, tally: Tally, number: int, along: int, title: str | None = None) -> Figure:
    """One axis of a tally up, an axis of the scan across, at the first value of every other axis of the scan."""
    axis, scanned = tally.axes[number], results.scan.axes[along]
    counts = tally.counts.sum(axis=tuple(1 + i for i in range(len(tally.axes)) if i != number))
    flat = np.moveaxis(np.arange(len(counts)).reshape(results.scan.shape), along, -1).reshape(-1, scanned.values.size)[0]
    order = np.argsort(scanned.values, kind="stable")  # a scan may run downwards
    scanned, flat = replace(scanned, values=scanned.values[order]), flat[order]
    figure, panel = plt.subplots(figsize=style.size(7.2, 4.8), layout="constrained")
    across, up = scanned.scale, axis.scale
    mesh = panel.pcolormesh(across.apply(edges_of(scanned.values)), up.apply(axis.edges), counts[flat].T, cmap=COUNTS,
                            vmin=0, vmax=counts[flat].max() or 1, rasterized=True)
    if is_logarithmic(scanned.values):
        style.logarithmic(panel.xaxis)
    if scanned.labels:
        panel.set_xticks(scanned.values, [law_name(label).replace(", ", "\n") for label in scanned.labels])
    elif scanned.values.size <= FEW:  # whose cells reach far beyond them
        panel.set_xticks(across.apply(scanned.values))
    style.name_below(panel, across.label(scanned.parameter))
    if axis.labels:
        panel.set_yticks((axis.edges[:-1] + axis.edges[1:]) / 2, [style.level(label) for label in axis.labels])
    panel.set_ylabel(_label(axis, up))
    figure.colorbar(mesh, ax=panel, label="particles per bin")
    first = scanned_at(results, int(flat[0]))
    others = [f"{name} = {value}" for name, value in first.items() if name != scanned.parameter]
    if len(set(results.laws)) > 1 and scanned.parameter != "law":
        others.append(law_name(results.laws[int(flat[0])]))
    _write_title(figure, results, tally, [axis], title, ", ".join(others))
    return figure


def _write_title(figure: Figure, results: Results, tally: Tally, shown: Sequence[TallyAxis], title: str | None, held: str = "") -> None:
    """With what is not shown, and at which values of what is scanned. Outcomes are those of a measurement, which only one law knows."""
    split = tally.is_expectation and all(law.startswith("quantum") for law in results.laws)
    summed = " and ".join(_name(axis) for axis in tally.axes if not any(axis is one for one in shown))
    style.write_title(figure, "\n".join([title or tally.title, *([f"at {held}"] if held else []), *([f"summed over {summed}"] if summed else []),
                                        *(["spin: expectation, weights split over the outcomes"] if split else [])]))


def _heading(results: Results, point: int) -> str:
    whose = ", ".join(filter(None, (law_name(results.laws[point]), results.species[point])))
    return ": ".join(filter(None, (shot_of(results, point).heading, whose)))


def _name(axis: TallyAxis) -> str:
    return LEVELS.get(axis.name, axis.title.rsplit(" (", 1)[0] if axis.units else axis.title)


def _label(axis: TallyAxis, scale: Scale) -> str:
    return scale.label(_name(axis))


def _draw_curves(results: Results, tally: Tally, axis: TallyAxis, counts: np.ndarray, errors: np.ndarray,
                 points: Sequence[int], title: str | None) -> Figure:
    """Steps with error bars, one colour for each scan point."""
    figure, panel = plt.subplots(figsize=style.size(7.2, 4.4), layout="constrained")
    _write_title(figure, results, tally, [axis], title)
    heading, labels = stated.what_differs([about(results, point) for point in points]) if len(points) > 1 else \
        ("", [_heading(results, points[0])])
    scale = axis.scale
    edges = np.asarray(scale.apply(axis.edges))
    for number, (colour, label, point) in enumerate(zip(COLOURS, labels, points)):
        same = [k for k in range(number) if np.array_equal(counts[point], counts[points[k]])]
        label += f"\nthe same as {labels[same[0]]}" if same else ""
        panel.stairs(counts[point], edges, color=colour, linewidth=1.1, linestyle="--" if number % 2 else "-",
                     label=label,
                     fill=len(points) == 1 and bool(axis.labels), alpha=0.6 if axis.labels else None)
        hit = counts[point] > 0
        panel.errorbar(((edges[:-1] + edges[1:]) / 2)[hit], counts[point][hit], errors[point][hit], fmt="none", ecolor=colour,
                       elinewidth=0.9, capsize=2 if edges.size < 60 else 0)
    hanging = 0.0  # inches of names that stand upright
    if axis.labels:
        room = (figure.get_figwidth() - 1.0) * 72 / style.points("xtick.labelsize") / style.LETTER  # in letters
        turn = 0 if len(axis.labels) * (style.widest(axis.labels) + 1) < room else 90
        hanging = style.widest(axis.labels) * style.LETTER * style.points("xtick.labelsize") / 72 if turn else 0.0
        panel.set_xticks((edges[:-1] + edges[1:]) / 2, [style.level(label) for label in axis.labels], rotation=turn)
    panel.set_xlim(edges[0], edges[-1])
    if not counts[list(points)].any():
        panel.text(0.5, 0.5, "nothing counted", transform=panel.transAxes, ha="center", color=GREY)
    panel.set_ylim(0, 1 if not counts[list(points)].any() else None)
    style.name_below(panel, _label(axis, scale))
    panel.grid(axis="y")
    foot = style.legend_below(figure, panel, 3, heading)
    panel.set_ylabel(style.upright(figure, "particles per bin\n(bars: 1 σ)", foot + hanging))
    return figure


@style.in_proportion
def _draw_images(results: Results, axes: Sequence[TallyAxis], counts: np.ndarray, points: Sequence[int]) -> Figure:
    """The first axis across, the second one up; one colour scale for all scan points."""
    figure, panels = plt.subplots(1, len(points), figsize=(1.4 + 4.4 * len(points), 4.8), squeeze=False,
                                  sharey=True, layout="constrained")
    scales = [axis.scale for axis in axes]
    most = float(counts[list(points)].max()) or 1.0
    room = (figure.get_figwidth() - BESIDE) / len(points) if len(points) > 1 else figure.get_figwidth() - 0.5
    for panel, point in zip(panels[0], points):
        edges = [np.asarray(scale.apply(axis.edges)) for axis, scale in zip(axes, scales)]
        mesh = panel.pcolormesh(*edges, counts[point].T, cmap=COUNTS, vmin=0, vmax=most, rasterized=True)
        if all(axis.labels for axis in axes):
            _write_numbers(panel, edges, counts[point], most)
        panel.spines[["top", "right"]].set_visible(True)
        panel.set_title(style.in_lines(_heading(results, point), room, style.points("axes.titlesize")))
        panel.set_xlabel(_label(axes[0], scales[0]))
        for axis, own, ticks, turn in ((axes[0], edges[0], panel.set_xticks, 90 if len(axes[0].labels) > FEW else 0),
                                       (axes[1], edges[1], panel.set_yticks, 0)):
            if axis.labels:
                ticks((own[:-1] + own[1:]) / 2, [style.level(label) for label in axis.labels], rotation=turn)
    panels[0][0].set_ylabel(_label(axes[1], scales[1]))
    figure.colorbar(mesh, ax=list(panels[0]), label="particles per bin")
    return figure


def _write_numbers(panel: Axes, edges: list[np.ndarray], counts: np.ndarray, most: float) -> None:
    """A matrix of levels is small enough to be read."""
    size = 8 if counts.shape[0] <= FEW else 6
    for i in range(counts.shape[0]):
        for k in range(counts.shape[1]):
            panel.text((edges[0][i] + edges[0][i + 1]) / 2, (edges[1][k] + edges[1][k + 1]) / 2, _short(counts[i, k], most),
                       ha="center", va="center", fontsize=style.scaled(size), color="white" if counts[i, k] > 0.5 * most else "black")


def _short(count: float, most: float) -> str:
    """A count without a power of ten, unless all are large."""
    if most >= 1e6:
        return f"{count / 1e3:.0f} k"
    return "<0.1" if 0 < count < 0.05 else f"{count:.0f}" if count >= 100 or count == round(count) else f"{count:.1f}"

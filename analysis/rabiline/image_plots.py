"""The images of detectors as pictures, with their projections."""
from __future__ import annotations

from dataclasses import dataclass, replace
from math import floor, log10
from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from . import style
from .curves import Curve, NoResonance, Resonance, deepest, half_maxima
from .pieces import pieces_of
from .results import Detector, Results
from .style import COUNTS, GREY, LAWS, TITLE, in_lines
from .units import SUPERSCRIPT, Scale, format_value, law_name

MILLI = 1e3
LARGEST, PROJECTION, GAP, MARGIN = 3.0, 0.8, 0.15, 0.75  # inches: an image's longer side, and what surrounds it
SMALL_PROJECTION, SMALLEST = 0.45, 0.5  # likewise, where room is scarce; and the least of an image's longer side
BELOW, SMALL_BELOW = 1.2, 1.05  # inches: numbers and names of the axes, and the bar of colours
BAR, SMALL_BAR = 0.55, 0.48  # inches: from the foot of the figure to that bar
BEAM = LAWS["quantum"][0]
TWO = 0.25  # inches: so high an axis has room for two numbers
MANY = 1e4  # counts that are written with a power of ten
PROJECTED = "<projection>"  # the label of axes whose ranges follow from the image


@dataclass(frozen=True)
class Shot:
    """One scan point to show."""

    point: int  # flat
    heading: str


def shot_of(results: Results, point: int) -> Shot:
    """A scan point, headed by the values that are scanned."""
    return Shot(point, ", ".join(f"{name} = {value}" for name, value in scanned_at(results, point).items()))


def scanned_at(results: Results, point: int) -> dict[str, str]:
    """What is scanned, laws and species apart, with its values at a scan point."""
    indices = np.unravel_index(point, results.scan.shape)
    return {axis.parameter: axis.labels[i] if axis.labels else axis.text(axis.values[i]).replace("-", "−")
            for axis, i in zip(results.scan.axes, indices) if axis.parameter not in ("law", "species")}


def about(results: Results, point: int) -> dict[str, str]:
    """What tells a scan point from others: its law, its species, and what is scanned."""
    said = {"law": law_name(results.laws[point]), "species": results.species[point], **scanned_at(results, point)}
    return {name: value for name, value in said.items() if value}


def off_and_on(results: Results, curves: list[Curve]) -> list[Shot]:
    """The edge of the scan, or of a stretch between its gaps, and the middle of its deepest dip or peak; the middle of the scan where there is none."""
    found: list[tuple[Resonance, Curve]] = []
    for curve in (curve.piece(part) for curve in curves for part in pieces_of([curve])):
        try:
            found.append((deepest(half_maxima(curve)), curve))
        except NoResonance:
            continue
    if found:
        resonance, curve = max(found, key=lambda pair: pair[0].depth.value)
        on = int(np.argmin(np.abs(curve.x - resonance.centre.value)))
        words = ("off resonance: ", "on resonance: ") if curve.axis.units == "Hz" else ("", "")
    else:
        curve, words = curves[0], ("", "")
        on = curve.x.size // 2
    shots = [shot_of(results, int(curve.points[i])) for i in (0, on)]
    return [Shot(shot.point, word + shot.heading if shot.heading else "") for word, shot in zip(words, shots)]


@style.in_proportion
def draw_images(results: Results, detector: Detector, shots: list[Shot], title: str | None = None) -> Figure:
    """Images side by side on one colour scale and in true proportion, each with its projections on x (above) and z
    (right)."""
    layout, title, headings = _laid_out(results, detector, shots, title or (f"{results.title}: {detector.label}" if results.title else detector.label))
    figure, rows = layout.figure()
    size = layout.image
    norm = Normalize(0, max(detector.counts[[shot.point for shot in shots]].max(), 1))
    for shot, heading, (image, above, beside) in zip(shots, headings, rows):
        point = shot.point
        x, z = detector.x_edges + detector.offset_x[point], detector.z_edges + detector.offset_z[point]
        mesh = image.pcolormesh(x * MILLI, z * MILLI, detector.counts[point].T,
                                cmap=COUNTS, norm=norm, rasterized=True)
        if not detector.counts[point].any():
            said = "nothing detected" if size[0] > 3 * size[1] else "nothing\ndetected"
            image.text(0.5, 0.5, said, transform=image.transAxes, ha="center", va="center", color=GREY)
        for axis, length in ((image.xaxis, size[0]), (image.yaxis, size[1])):
            along_x = axis is image.xaxis
            axis.set_major_locator(MaxNLocator(max(1, min(5, int(2 * length))), steps=[1, 2, 5, 10], prune="upper" if along_x else None,
                                               min_n_ticks=1 if along_x or length < TWO else 2))
        image.set_xlabel("x (mm)")
        image.spines[["top", "right"]].set_visible(True)
        above.set_title(heading, loc="left")
        _draw_projection(above, x, detector.counts_x[point], detector.errors_x[point])
        _draw_projection(beside, z, detector.counts_z[point], detector.errors_z[point], along_z=True)
    for i, limits in ((1, Axes.set_ylim), (2, Axes.set_xlim)):
        most = max(row[i].dataLim.get_points()[1, i % 2] for row in rows)
        limits(rows[0][i], 0, most * 1.05 or 1)
        for row in rows:
            _write_counts((row[1].yaxis, row[2].xaxis)[i - 1], most)
    rows[0][0].set_ylabel("z (mm)")
    colour_bar = figure.add_axes(_inches(figure, MARGIN, layout.bar, layout.width - MARGIN - 0.3, 0.12))
    figure.colorbar(mesh, cax=colour_bar, orientation="horizontal")
    _write_counts(colour_bar.xaxis, norm.vmax, " per bin")
    figure.suptitle(title.strip(), fontsize=style.scaled(TITLE), y=1 - 0.12 / figure.get_figheight(), va="top", parse_math=False)
    return figure


@dataclass(frozen=True)
class Layout:
    """Where images, side by side, have their places, in inches."""

    image: tuple[float, float]  # width and height of each
    projection: float  # what is left for each
    below: float
    bar: float  # from the foot of the figure
    shots: int
    head: float = 0.0  # for the title and what stands above each image

    @property
    def width(self) -> float:
        """Of the figure."""
        return self.shots * (self.image[0] + self.projection + 2 * GAP + MARGIN) + 0.15

    @property
    def height(self) -> float:
        """Of the figure."""
        return self.below + self.image[1] + GAP + self.projection + self.head

    def figure(self) -> tuple[Figure, list[tuple[Axes, Axes, Axes]]]:
        """The figure, and for each shot the axes of its image and of the projections above and beside it."""
        figure = plt.figure(figsize=(self.width, self.height))
        rows: list[tuple[Axes, Axes, Axes]] = []
        (wide, high), projection = self.image, self.projection
        for i in range(self.shots):
            left = MARGIN + i * (wide + projection + 2 * GAP + MARGIN)
            shared = rows[0] if rows else (None, None, None)
            image = figure.add_axes(_inches(figure, left, self.below, wide, high), sharex=shared[0], sharey=shared[0])
            above = figure.add_axes(_inches(figure, left, self.below + high + GAP, wide, projection), sharex=image, sharey=shared[1], label=PROJECTED)
            beside = figure.add_axes(_inches(figure, left + wide + GAP, self.below, projection, high), sharex=shared[2], sharey=image, label=PROJECTED)
            rows.append((image, above, beside))
        return figure, rows


def _laid_out(results: Results, detector: Detector, shots: list[Shot], title: str) -> tuple[Layout, str, list[str]]:
    """Places, and title and headings in lines that fit: of images in true proportion, as far as a page allows that, and no larger than there is
    room for."""
    ratio = np.ptp(detector.z_edges) / np.ptp(detector.x_edges)
    ratio = min(max(ratio, 1 / 3), 3)
    room, largest = style.room(), LARGEST
    words = [_heading(results, detector, shot, shots if room else ()) for shot in shots]
    while True:
        places = (SMALL_PROJECTION, SMALL_BELOW, SMALL_BAR) if room else (PROJECTION, BELOW, BAR)
        layout = Layout((largest / max(ratio, 1), largest * min(ratio, 1)), *places, len(shots))
        lines = in_lines(style.shortened(title), layout.width, TITLE)
        headings = [in_lines(text, layout.image[0] + layout.projection + GAP + 0.5 * MARGIN, 10.5) for text in words]
        head = 0.21 * (1 + lines.count("\n")) + 0.19 * (1 + max(heading.count("\n") for heading in headings)) + (0.15 if room else 0.25)
        layout = replace(layout, head=head)
        if room is None or layout.width <= room[0] and layout.height <= room[1] or largest <= SMALLEST:
            return layout, lines, headings
        largest = max(0.95 * largest, SMALLEST)


def _inches(figure: Figure, left: float, bottom: float, width: float, height: float) -> tuple[float, ...]:
    """A rectangle in fractions of the figure."""
    across, up = figure.get_size_inches()
    return left / across, bottom / up, width / across, height / up


def _heading(results: Results, detector: Detector, shot: Shot, among: Sequence[Shot]) -> str:
    """What is seen, and the fraction of the emitted particles that it is; less of it where it is to be short `among` others, with the law where
    that differs."""
    scan, point = results.scan, shot.point
    row = scan.detectors.index(detector.name)
    fraction, error = scan.detected[row, point], scan.errors[row, point]
    about = ", ".join(filter(None, (law_name(results.laws[point]), results.species[point])))
    of = "aimed at the target" if results.aimed_fraction is not None else "emitted"
    share = f"detected: {format_value(fraction, '', error)} of what was {of}" if 0 < fraction < 1 else \
        f"detected: {'none' if fraction == 0 else 'all'} of {results.emitted[point]:.6g} {of}"
    if among:
        law = law_name(results.laws[point]) if len({results.laws[other.point].partition(" ")[0] for other in among}) > 1 else ""
        return "\n".join(filter(None, (shot.heading, law, share.partition(" of ")[0])))
    return "\n".join(filter(None, (shot.heading, about, share)))


def _draw_projection(axes: Axes, edges: np.ndarray, counts: np.ndarray, errors: np.ndarray,
                     along_z: bool = False) -> None:
    """Counts summed along the other axis, as steps with error bars; upright for x, sideways for z."""
    orientation = "horizontal" if along_z else "vertical"
    axes.stairs(counts, edges * MILLI, orientation=orientation, color=BEAM, fill=True, alpha=0.25)
    axes.stairs(counts, edges * MILLI, orientation=orientation, color=BEAM, linewidth=0.9)
    filled = counts > 0
    centres, counts, errors = ((edges[:-1] + edges[1:]) / 2 * MILLI)[filled], counts[filled], errors[filled]
    bars = {"fmt": "none", "ecolor": BEAM, "elinewidth": 0.8}
    if along_z:
        axes.errorbar(counts, centres, xerr=errors, **bars)
    else:
        axes.errorbar(centres, counts, errors, **bars)
    axes.tick_params(labelbottom=along_z, labelleft=not along_z)
    axes.grid(axis="x" if along_z else "y")


def _write_counts(axis: Axis, most: float, each: str = "") -> None:
    """Its name and short numbers: of many counts in thousands or millions."""
    power = 3 * floor(log10(most) / 3) if most > 0 and not 0.01 <= most < MANY else 0
    scale = Scale(f"10{str(power).translate(SUPERSCRIPT)}" if power else "", 10.0**power)
    axis.set_major_formatter(lambda value, _: f"{scale.apply(value):.6g}")
    axis.set_label_text(scale.label(f"counts{each}"))

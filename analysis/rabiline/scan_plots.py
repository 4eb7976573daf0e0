"""The curves of scans as pictures."""
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from . import style
from .curves import Curve, NoResonance, Resonance
from .measured import Measured
from .pieces import pieces_of, runs_of
from .reading import Reading, reading_of
from .regions import row_for
from .results import Axis
from .style import COUNTS, GREY, INK, Look, looks
from .units import Scale, edges_of, fitting_scale, format_value, is_logarithmic, law_name, with_error

SYMBOL = 3.4  # points
RIM = 1.4  # points, by which symbols or lines are larger than those that hide them
THICK = 2.8  # points, by which the widest line of those that lie on each other is wider than the narrowest
WHOLE = 0.4  # of the largest value: what begins below is shown from 0 on
BEYOND = 1.0  # points, by which a bar stands out of its symbol where it is seen
TURNS = 5  # symbols of each curve, at least, where those that lie on each other have them in turns
MOST_COLUMNS = 3  # of maps
BESIDE = 5.4  # inches of a file's panel beside others
ROOM = 2.0  # inches of a piece, for a line's numbers above it
LEGEND = 0.25  # of a small picture's height at most, with the numbers of all lines
LETTER, ROW = 0.09, 12.0  # inches of a panel for each letter of a mark's name, points from row to row
PANEL = 3.2  # inches, about, from the bottom to the top of a curve's axes
WIDE = 0.85  # of a picture's width, about, that of its axes
AWAY = 10.0  # points from a line's width to its numbers
LETTER_WIDE, LINE_HIGH = 0.55, 1.3  # of the size of letters


def draw_scan(curves: Sequence[Curve], labels: Sequence[str], title: str, marks: dict[str, float],
              measured: Measured | None = None) -> Figure:
    """Curves with their error bars over one axis. `marks` names values of the axis (SI) to point out; the dips or
    peaks of a curve have the numbers of their `reading`. Where there are several, of one curve or of different ones, these
    stand in the legend."""
    pieces = pieces_of(curves) if measured is None else []
    if len(pieces) > 1:
        return _draw_pieces(curves, labels, title, marks, pieces)
    figure, axes = plt.subplots(figsize=style.size(7.2, 4.5), layout="constrained")
    _draw_panel(axes, curves, labels, marks, measured=measured)
    limits = _fraction_limits(curves)
    about = f"{_measure(curves)}\n({about_errors(curves, limits)})"
    if measured is not None:
        scale = _scale(curves)
        axes.errorbar(scale.apply(measured.x), measured.y, measured.errors, fmt="o", color=INK, markersize=SYMBOL, elinewidth=0.9,
                      zorder=5, label=measured.label)
        limits = min(limits[0], np.min(measured.y - measured.errors)), max(limits[1], np.max(measured.y + measured.errors))
    axes.set_ylim(*limits)
    _draw_rates(axes, curves)
    style.write_title(figure, title)
    foot = 0.0
    if len(curves) > 1 or labels[0] and not curves[0].axis.labels:
        foot = _draw_legend(figure, axes, [*labels, measured.label] if measured else labels)
    axes.set_ylabel(style.upright(figure, about, foot))
    return figure


def _draw_pieces(curves: Sequence[Curve], labels: Sequence[str], title: str, marks: dict[str, float],
                 pieces: Sequence[slice]) -> Figure:
    """A scan with gaps, each of its pieces in a panel of its own."""
    figure, row = plt.subplots(1, len(pieces), figsize=style.size(7.2, 4.5), sharey=True, squeeze=False, layout="constrained")
    limits = _fraction_limits(curves)
    for number, (axes, piece) in enumerate(zip(row[0], pieces)):
        parts = [curve.piece(piece) for curve in curves]
        scale = parts[0].axis.scale
        _draw_panel(axes, parts, labels, {name: value for name, value in marks.items()
                                          if parts[0].x.min() <= value <= parts[0].x.max()}, beside=False)
        readings = [told for part in parts if (told := _reading(part))]
        seen = sum(len(told.resonances) for told in readings) == 1 and figure.get_figwidth() / len(pieces) > ROOM
        axes.set_title("\n".join(_in_words(readings[0], scale, parts[0].axis)).replace(", FWHM", "\nFWHM") if seen else "", fontsize="small")
        axes.xaxis.set_major_locator(MaxNLocator(max(1, int(figure.get_figwidth() / len(pieces) / 0.8))))
        axes.set_ylim(*limits)
        axes.spines["left"].set_visible(number == 0)
        axes.tick_params(left=number == 0)
    row[0, 0].set_ylabel(f"{_measure(curves)}\n({about_errors(curves, limits)})")
    style.write_title(figure, title)
    if len(curves) > 1:
        row[0, 0].legend(*zip(*[(item, _without_numbers(label)) for item, label in zip(*row[0, 0].get_legend_handles_labels())]))
    return figure


def _measure(curves: Sequence[Curve]) -> str:
    """Of curves that have one measure."""
    return "detected / aimed at the target" if curves[0].aimed else "detected / emitted"


def _draw_rates(axes: Axes, curves: Sequence[Curve]) -> None:
    """Counts per second on the right, where the source's rate is known and all curves have one scale of them."""
    rates = {curve.rate for curve in curves}
    rate = rates.pop() if len(rates) == 1 else None
    if rate is None:
        return
    each, background = rate
    scale = fitting_scale(np.array([each * max(curve.y.max() for curve in curves) + background]), "")
    other = axes.secondary_yaxis("right", functions=(lambda y: scale.apply(each * y + background), lambda n: (scale.factor * n - background) / each))
    other.spines["right"].set_visible(True)
    other.set_ylabel(scale.label("counts per second") + ("\n(with background)" if background else ""))


@dataclass(frozen=True)
class Panel:
    """The curves of one file."""

    title: str
    curves: Sequence[Curve]
    labels: Sequence[str]


@style.in_proportion
def draw_beside(panels: Sequence[Panel], title: str, marks: dict[str, float]) -> Figure:
    """Scans of several files side by side, over the same axis: each panel like draw_scan's, with its legend below."""
    figure, row = plt.subplots(1, len(panels), figsize=(BESIDE * len(panels), 4.5), sharey=True, squeeze=False,
                               layout="constrained")
    limits = _fraction_limits([curve for panel in panels for curve in panel.curves])
    for axes, panel in zip(row[0], panels):
        rows = _draw_panel(axes, panel.curves, panel.labels, marks, beside=False)
        axes.set_title(style.in_lines(style.plain(panel.title), BESIDE - 0.9, style.RULES["axes.titlesize"]), pad=title_pad(rows))
        axes.set_ylim(*limits)
        axes.set_ylabel(f"{_measure(panel.curves)}\n({about_errors(panel.curves, limits)})")
    style.write_title(figure, title)
    for axes, panel in zip(row[0], panels):
        _draw_legend(figure, axes, panel.labels, width=60)
    return figure


def _scale(curves: Sequence[Curve]) -> Scale:
    """Of all together, in the unit of the first."""
    return fitting_scale(np.concatenate([curve.x for curve in curves]), curves[0].axis.units, curves[0].axis.written)


def _draw_panel(axes: Axes, curves: Sequence[Curve], labels: Sequence[str], marks: dict[str, float],
                beside: bool = True, measured: Measured | None = None) -> int:
    """Curves over their axis; numbers of a single resonance stand beside it, if wanted and where they cover nothing, else in the legend.
    Returns how many rows of names stand above."""
    axis = curves[0].axis
    scale = _scale(curves)
    readings = [_reading(curve) for curve in curves]
    several = sum(len(told.resonances) for told in readings if told) != 1 or any(told and told.is_fringe for told in readings)
    beside = beside and not several and not any(curve.rate for curve in curves)  # they would write over each other
    drawn = list(zip(curves, labels, looks([curve.law for curve in curves]), readings))
    drawn.sort(key=lambda row: bool(row[3]))  # flat ones below
    near = SYMBOL / (PANEL * 72) * np.ptp(_fraction_limits(curves))
    for i, (curve, label, look, told) in enumerate(drawn):
        alike = [k for k, (other, *_) in enumerate(drawn) if _coincide(curve, other, near)]
        covered = [np.abs(curve.y - drawn[k][0].y) <= near for k in alike if k != i]
        place = _Place(alike.index(i), len(alike), np.any(covered, axis=0) | np.zeros(curve.y.size, bool))
        first = next((name for other, name in zip(curves, labels) if _is_same(curve, other)), label)
        if first != label:
            _draw_curve(axes, curve, f"{style.plain(label)}\nthe same as {style.plain(first)}", look, scale, place)
            continue
        words = _in_words(told, scale, axis) if told else []
        text = "\n".join(words).replace(", FWHM", "\nFWHM")
        side = _free_side(axes, text, told.resonances[0], [*curves, *([measured] if measured else [])]) if beside and words else None
        side = side or ("right" if beside and not label else None)  # without a legend
        _draw_curve(axes, curve, "\n".join([style.plain(label), *([] if side else words)]), look, scale, place)
        for resonance in told.resonances if told else []:
            _draw_width(axes, resonance, look, scale)
            if side:
                _write_beside(axes, text, resonance, side, look, scale)
    if axis.labels:
        axes.set_xticks(axis.values, [style.beside_ticks(axes.figure, law_name(label)) for label in axis.labels])
    if is_logarithmic(axis.values):
        style.logarithmic(axes.xaxis)
    style.name_below(axes, scale.label(axis.parameter))
    axes.margins(x=0.1 if axis.labels else 0.02)
    axes.grid(axis="y")
    return draw_marks(axes, marks, scale)


def draw_maps(grids: Sequence[Sequence[Curve]], across: Axis, title: str, marks: dict[str, float], measure: str = "") -> Figure:
    """The detected fraction, or another `measure`, over both axes of each grid; `across` tells the curves of one apart."""
    along, order = grids[0][0].axis, np.argsort(across.values, kind="stable")  # a scan may run downwards
    across, grids = replace(across, values=across.values[order]), [[grid[i] for i in order] for grid in grids]
    scale, scale_across = along.scale, across.scale
    rows = -(-len(grids) // MOST_COLUMNS)
    columns = -(-len(grids) // rows)
    figure, panels = plt.subplots(rows, columns, figsize=style.size(7.2, 4.8 if rows == 1 else 2.9 * rows), squeeze=False, sharex=True,
                                  sharey=True, layout="constrained")
    known = np.nan_to_num(np.concatenate([curve.y for grid in grids for curve in grid]))
    most, least = known.max(), known.min()
    least = least if least > WHOLE * most else 0.0
    if is_logarithmic(along.values):
        style.logarithmic(panels[0, 0].xaxis)
    if is_logarithmic(across.values):
        style.logarithmic(panels[0, 0].yaxis)
    for axes, grid in zip(panels.flat, grids):
        mesh = axes.pcolormesh(scale.apply(edges_of(along.values)), scale_across.apply(edges_of(across.values)),
                               np.stack([curve.y for curve in grid]), shading="flat", cmap=COUNTS, rasterized=True, vmin=least, vmax=most)
        above = draw_marks(axes, marks, scale)
        if len(grids) > 1:
            name = ", ".join(part for part in grid[0].label.split(", ") if not part.startswith(f"{across.parameter} = "))
            axes.set_title(style.in_lines(style.plain(name), figure.get_figwidth() / columns, style.points("axes.titlesize")), fontsize="small",
                           pad=title_pad(above))
    for axes in panels.flat[len(grids):]:
        axes.remove()
    curves = [curve for grid in grids for curve in grid]
    figure.colorbar(mesh, ax=list(panels.flat[:len(grids)]), label=measure or _measure(curves))
    for axes in panels.flat[max(0, len(grids) - columns):len(grids)]:
        axes.tick_params(labelbottom=True)
        axes.set_xlabel(style.in_lines(scale.label(along.parameter), 0.75 * figure.get_figwidth() / columns, style.points("axes.labelsize")))
    for axes in panels[:, 0]:
        axes.set_ylabel(scale_across.label(across.parameter))
    style.write_title(figure, title if len(grids) > 1 else f"{title}\n{law_name(curves[0].law)}")
    return figure


def draw_marks(axes: Axes, marks: dict[str, float], scale: Scale, named: bool = True) -> int:
    """Lines at values of the axis (SI), with their names above in as many rows as keep these apart: that many are returned."""
    width = axes.figure.get_figwidth() / axes.get_subplotspec().get_gridspec().ncols
    rows: list[float] = []  # in shares of the axis
    for name, value in sorted(marks.items(), key=lambda mark: mark[1]):
        x = scale.apply(value)
        axes.axvline(x, color=GREY, linestyle=(0, (4, 3)), linewidth=1, zorder=1)
        if not named:
            continue
        middle, half = axes.transAxes.inverted().transform(axes.transData.transform((x, 0)))[0], 0.5 * (len(name) + 1) * LETTER / width
        row = row_for(rows, middle - half, middle + half)
        axes.annotate(style.plain(name), (x, 1), xycoords=("data", "axes fraction"), xytext=(0, 3 + ROW * row), textcoords="offset points",
                      ha="center", va="bottom", color=GREY, fontsize=style.scaled(9))
    return len(rows)


def title_pad(rows: int) -> float:
    """[points] above names of marks in so many rows."""
    return 6 + ROW * rows


def _reading(curve: Curve) -> Reading | None:
    """None of a flat line, which is a result too, and of what shows no dip or peak."""
    try:
        return reading_of(curve)
    except NoResonance:
        return None


def _coincide(one: Curve, other: Curve, near: float) -> bool:
    """Whether most points of two curves lie on each other, nearer than their symbols are large."""
    return bool(np.array_equal(one.x, other.x) and np.median(np.abs(one.y - other.y)) <= near)


def _is_same(one: Curve, other: Curve) -> bool:
    return np.array_equal(one.x, other.x) and np.array_equal(one.y, other.y) and np.array_equal(one.errors, other.errors)


@dataclass(frozen=True)
class _Place:
    """Of a curve among those that lie on each other."""

    turn: int
    of: int
    covered: np.ndarray  # [n] the points at which another one is


def _draw_curve(axes: Axes, curve: Curve, label: str, look: Look, scale: Scale, place: _Place) -> None:
    """Where several lie on each other, they have their symbols in turns, or smaller and smaller ones, and narrower and narrower lines."""
    x, size = scale.apply(curve.x), 6.0 if curve.axis.labels else SYMBOL
    above = place.of - 1 - place.turn
    in_turns = not curve.axis.labels and x.size >= TURNS * place.of
    every = ~place.covered | (np.arange(x.size) % place.of == place.turn) | (not in_turns)
    rim = min(RIM, THICK / max(place.of - 1, 1))
    size += RIM if in_turns and place.of > 1 else RIM * above
    width = 1.1 + rim * above
    runs = [] if curve.axis.labels else runs_of(curve.x)
    style_of = "--" if look.open else "-"
    axes.errorbar(x, curve.y, curve.errors, color=look.colour, marker=look.marker, linestyle=style_of if len(runs) == 1 else "none",
                  markersize=size, markevery=every.tolist(), errorevery=every, linewidth=width, elinewidth=0.9, capsize=2, capthick=0.9,
                  markeredgewidth=0.8 if look.open else 0, markerfacecolor="white" if look.open else look.colour, label=label)
    if in_turns and place.of > 1:  # above the lines of all
        axes.plot(x[every], curve.y[every], look.marker, color=look.colour, markersize=size, markeredgewidth=0.8 if look.open else 0,
                  markerfacecolor="white" if look.open else look.colour, zorder=3)
    for run in runs if len(runs) > 1 else []:
        axes.plot(x[run], curve.y[run], color=look.colour, linewidth=width, linestyle=style_of)


def about_errors(curves: Sequence[Curve], limits: tuple[float, float]) -> str:
    """What the error bars are, or why none are to be seen."""
    if not any(curve.y.any() for curve in curves):
        return "nothing detected"
    smallest_seen = (SYMBOL / 2 + BEYOND) / (PANEL * 72) * (limits[1] - limits[0])
    if not any((curve.errors > smallest_seen).any() for curve in curves):
        return "errors smaller than symbols"
    return "bars: 1 σ" + (", correlated" if any(np.isfinite(curve.spread.freedom) for curve in curves) else "")


def _in_words(told: Reading, scale: Scale, axis: Axis) -> list[str]:
    """A line of centre and width with their errors for each dip or peak, and where they come from."""
    centre = "middle between the edges" if told.fit is None and is_logarithmic(axis.values) else "centre"  # far from the top of what is even there
    return [*(f"{centre} {_numbers(resonance, scale, axis)}" for resonance in told.resonances), told.how]


def _numbers(resonance: Resonance, scale: Scale, axis: Axis) -> str:
    """The centre in the unit of the axis, the width in that which the user wrote, or with a prefix of its own."""
    centre, width = resonance.centre, resonance.width
    shown = with_error(centre.value, centre.error, scale.unit, scale.factor) if scale.origin == 0 and scale.unit and axis.units and centre.error > 0 else \
        format_value(centre.value, axis.units, centre.error, axis.written)
    return f"{shown.replace('-', '−')}, FWHM {format_value(width.value, axis.units, width.error, axis.written)}"


def _edges(resonance: Resonance, scale: Scale) -> tuple[float, float]:
    """Where the curve passes half its depth, as shown."""
    centre, half = resonance.centre.value, resonance.width.value / 2
    return scale.apply(centre - half), scale.apply(centre + half)


def _draw_width(axes: Axes, resonance: Resonance, look: Look, scale: Scale) -> None:
    low, high = _edges(resonance, scale)
    axes.annotate("", (low, resonance.level), (high, resonance.level),
                  arrowprops={"arrowstyle": "<->", "color": look.colour, "shrinkA": 0, "shrinkB": 0})


def _free_side(axes: Axes, text: str, resonance: Resonance, drawn: Sequence[Curve | Measured]) -> str | None:
    """On which side of a resonance, "left" or "right", its numbers cover nothing of what is drawn; that with more room first."""
    curve, lines = drawn[0], text.splitlines()
    low, high = np.min(curve.x), np.max(curve.x)
    wide = (high - low) / (WIDE * axes.figure.get_figwidth() * 72)  # of a point
    letters = style.points("font.size") * np.array([LETTER_WIDE * max(map(len, lines)), LINE_HIGH * len(lines)])
    width, half = (letters[0] + AWAY) * wide, letters[1] / 2 / (PANEL * 72) * np.ptp(_fraction_limits([curve]))

    def is_free(side: str) -> bool:
        edge = resonance.centre.value + (-0.5 if side == "left" else 0.5) * resonance.width.value
        begin, end = (edge - width, edge) if side == "left" else (edge, edge + width)
        for each in drawn:
            order = np.argsort(each.x)
            x = each.x if isinstance(each, Measured) else np.linspace(max(begin, low), min(end, high), 50)
            y, errors = (np.interp(x, each.x[order], values[order]) for values in (each.y, each.errors))
            if ((x > begin) & (x < end) & (np.abs(y - resonance.level) < half + errors)).any():
                return False
        return begin >= low and end <= high

    sides = ("left", "right") if resonance.centre.value > np.mean(curve.x) + 0.1 * (high - low) else ("right", "left")
    return next(filter(is_free, sides), None)


def _write_beside(axes: Axes, text: str, resonance: Resonance, side: str, look: Look, scale: Scale) -> None:
    low, high = _edges(resonance, scale)
    away = -AWAY if side == "left" else AWAY
    axes.annotate(text, (low if side == "left" else high, resonance.level), xytext=(away, 0), textcoords="offset points",
                  ha="right" if side == "left" else "left", va="center", color=look.colour,
                  bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.5}, zorder=6)


def _draw_legend(figure: Figure, axes: Axes, order: Sequence[str], width: int | None = None) -> float:
    """The legend below, by the order of the labels without their numbers, in as many columns as fit the width in
    letters; the figure grows with its lines, or where its size was asked for gives them room at its foot. Gives back how much
    [inches]."""
    def place(item: tuple[object, str]) -> int:
        return next(i for i, label in enumerate(map(style.plain, order)) if item[1] == label or item[1].startswith(f"{label}\n"))

    longest, width = width or style.letters(figure) - 12, width or style.letters(figure)
    items, whole = zip(*sorted(zip(*axes.get_legend_handles_labels()), key=place))
    labels = [style.wrapped(label, longest) for label in whole]
    widths = [10 + max(map(len, label.splitlines())) for label in labels]  # in letters
    columns = len(labels) if sum(widths) < width else max(1, width // max(widths))
    lines = -(-len(labels) // columns) * (1 + max(label.count("\n") for label in labels))
    if style.size(0, 0) != (0, 0):  # the figure cannot grow: the legend has its place at the foot
        labels = [label.replace(", FWHM", "\nFWHM") if max(widths) > width else label for label in labels]
        if 0.019 * style.points("legend.fontsize") * sum(1 + label.count("\n") for label in labels) > LEGEND * figure.get_figheight():
            labels = [_without_numbers(label) for label in whole]  # `summary` has the numbers
            for arrow in [text for text in axes.texts if not text.get_text()]:
                arrow.remove()  # of a width that is not told
        return style.legend_at_foot(figure, items, labels)
    figure.set_figheight(max(figure.get_figheight(), 4.3 + 0.19 * lines))
    below = -0.62 / (figure.get_figheight() - 1)  # inches to axes, near enough
    axes.legend(items, labels, loc="upper center", bbox_to_anchor=(0.5, below), ncol=columns, columnspacing=2.5, handlelength=2.5)
    return 0.0


def _without_numbers(label: str) -> str:
    """Of a curve, or that it is another one's."""
    return "\n".join(line for i, line in enumerate(label.split("\n")) if i == 0 or line.startswith("the same as "))


def _fraction_limits(curves: Sequence[Curve]) -> tuple[float, float]:
    low = min(np.min(curve.y - curve.errors) for curve in curves)
    high = max(np.max(curve.y + curve.errors) for curve in curves)
    if all(np.ptp(curve.y) == 0 for curve in curves):  # nothing changes: bars alone are no range, but of small fractions they are seen
        top = 1.05 * max(high, 1.0) if high > 0.5 or not any(curve.y.any() for curve in curves) else 1.5 * high
        return -0.05 * top, top
    if high - low > 0.2 and low < WHOLE * high:
        low = min(low, 0.0)
    margin = 0.06 * (high - low) or 0.05
    return low - margin, high + margin

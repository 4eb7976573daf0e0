"""The populations of spin levels at a detector as pictures: Rabi's curves."""
from __future__ import annotations

import re
from dataclasses import replace
from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from . import style
from .curves import Curve
from .errors import InputError
from .pieces import pieces_of, runs_of
from .results import Detector, Levels
from .scan_plots import SYMBOL, draw_marks, title_pad
from .style import LAWS, OTHERS, Look
from .units import Scale, is_logarithmic, law_name

LOOKS = [Look(*pair) for pair in [*LAWS.values(), *OTHERS]]
PANEL = 2.6  # inches high, where there are several
MOST_PANELS = 6
BESIDE = 0.3  # of the step between two names, over which levels are spread
LEGEND_LINE = 0.145  # inches
LOWEST_PANEL, FOOT = 0.6, 0.9  # inches: below that ticks and titles meet; and what a title, the lowest numbers and a legend take


class TooSmall(InputError):
    """A size was asked for into which the panels do not fit."""


def draw_levels(rows: Sequence[Curve], detector: Detector, title: str, marks: dict[str, float],
                wanted: Sequence[int] | None = None) -> Figure:
    """The fraction of what a detector caught that is in each level, or in those `wanted` by number, over the scan, with error
    bars. One panel for each row of the scan, such as a law; levels that are too many for one panel have one for each F, or
    species. Points at which nothing was detected have no level and are left out. Raises TooSmall where panels do not fit into the size
    that was asked for."""
    axis, labels = rows[0].axis, detector.levels.labels
    scale = axis.scale
    shown = list(range(len(labels)) if wanted is None else wanted)
    families = _families(labels, shown) if len(shown) > len(LOOKS) else {"": shown}
    if len(families) * len(rows) > MOST_PANELS:
        families = {"": shown}
    panels_of = [(row, name, levels) for row in rows for name, levels in families.items()]
    pieces = pieces_of(rows)
    figure, grid = plt.subplots(len(panels_of), len(pieces), squeeze=False, sharex="col", sharey="row", layout="constrained",
                                figsize=style.size(7.2, 1.9 + max(PANEL, 3.2 / len(panels_of)) * len(panels_of)))
    panels = list(grid[:, -1])
    one_look = dict(zip(shown, LOOKS)) if len(shown) <= len(LOOKS) else None
    by_m = one_look or _by_m(labels, shown)
    beside = sum(max(LOWEST_PANEL, 0.35 + LEGEND_LINE * len(levels)) for *_, levels in panels_of)  # inches, with a legend for each
    one_legend = one_look is not None or figure.get_figheight() < beside
    least = LOWEST_PANEL * len(panels_of) + FOOT
    if len(panels_of) > 1 and figure.get_figheight() < least:
        plt.close(figure)
        raise TooSmall(f"{len(panels_of)} panels need a height of {25.4 * least:.0f} mm at least (--size)")
    top = 0.0
    for number, (panel, (row, name, levels)) in enumerate(zip(panels, panels_of)):
        for part, piece in zip(grid[number], pieces):
            top = max(top, _draw_row(part, row.piece(piece), detector.levels, scale, {level: by_m[level] for level in levels}))
            if len(pieces) > 1:
                part.xaxis.set_major_locator(MaxNLocator(max(1, int(figure.get_figwidth() / len(pieces) / 0.8))))
        above = draw_marks(panel, marks, scale, named=panel is panels[0])
        heading = style.in_lines(style.plain(", ".join(filter(None, (row.label, name)))), figure.get_figwidth() - 1.0, style.points("font.size"))
        grid[number, 0].set_title(heading, loc="left", fontsize="medium", pad=title_pad(above))
        if not one_legend and panel.get_legend_handles_labels()[0]:
            panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), markerscale=1.5, handlelength=3, ncol=1 + (len(levels) - 1) // 14)
    top = 1.0 if top > 0.8 or top == 0 else top
    for panel in panels:
        panel.set_ylim(-0.04 * top, 1.04 * top)
    if axis.labels:
        panels[-1].set_xticks(axis.values, [style.beside_ticks(figure, law_name(label)) for label in axis.labels])
    if is_logarithmic(axis.values):
        style.logarithmic(panels[-1].xaxis)
    style.name_below(grid[-1, len(pieces) // 2], scale.label(axis.parameter))
    style.write_title(figure, title)
    foot = _legend_of_all(figure, panels, [name for _, name, _ in panels_of]) if one_legend else 0.0
    figure.supylabel(style.upright(figure, f"fraction of what {style.plain(detector.label)} detected\n(bars: 1 σ)", foot), fontsize="medium")
    return figure


def share_of(level: int, row: Curve, levels: Levels) -> Curve:
    """The fraction in one level, by its number, along a row of the scan."""
    label = ", ".join(filter(None, (style.level(levels.labels[level]), row.label)))
    return replace(row, label=label, y=levels.fractions[row.points, level], errors=levels.errors[row.points, level])


def _legend_of_all(figure: Figure, panels: Sequence[Axes], families: Sequence[str]) -> float:
    """Below the last panel, without the names of families, which stand above their panels; gives back the height [inches] of the figure's foot,
    where it has one."""
    named = {label.removeprefix(style.level(family)).strip(): handle for panel, family in zip(panels, families)
             for handle, label in zip(*panel.get_legend_handles_labels())}
    if style.size(0, 0) != (0, 0) and named:
        return style.legend_at_foot(figure, list(named.values()), list(named), markerscale=1.5)
    below = -0.55 / panels[-1].get_position().height / figure.get_figheight()  # inches to axes, near enough
    panels[-1].legend(named.values(), named.keys(), loc="upper center", bbox_to_anchor=(0.5, below), markerscale=1.5,
                      ncol=max(1, min(5, style.letters(figure) * 84 // 95 // (6 + max(map(len, named), default=1)))))
    return 0.0


def _families(labels: Sequence[str], shown: Sequence[int]) -> dict[str, list[int]]:
    """Levels by what stands before their m: F, or the species; components of a vector together."""
    families: dict[str, list[int]] = {}
    for i in shown:
        families.setdefault("" if labels[i].startswith("(") else re.split(r" m\b| \(", labels[i])[0], []).append(i)
    return families


def _by_m(labels: Sequence[str], levels: Sequence[int]) -> dict[int, Look]:
    """A colour and a symbol for each |m|, which levels of different F share; those of negative m have open symbols and dashed lines.
    Names without one m go by their order."""
    found = {level: re.search(r"m *= *([-+]?)(\S+)$", labels[level]) for level in levels}
    sizes = sorted({name[2] for name in found.values() if name})
    of_size = {size: LOOKS[i % len(LOOKS)] for i, size in enumerate(sizes)}
    return {level: replace(of_size[name[2]], open=name[1] == "-") if name else LOOKS[i % len(LOOKS)]
            for i, (level, name) in enumerate(found.items())}


def _draw_row(axes: Axes, row: Curve, levels: Levels, scale: Scale, looks: dict[int, Look]) -> float:
    """The levels that this row has: a law may not know those of another. Lines break where nothing was detected, and over
    gaps of the scan; over names levels stand side by side. What another would hide is drawn larger. Gives back how far up
    they reach."""
    x, top, fractions = scale.apply(row.x), 0.0, levels.fractions[row.points]
    for number, (i, look) in enumerate(looks.items()):
        y, errors = fractions[:, i], levels.errors[row.points, i]
        known = np.isfinite(y)
        if not known.any():
            continue
        hidden = 0 if row.axis.labels else sum(np.allclose(y, fractions[:, other], 0, 5e-3, equal_nan=True) for other in [*looks][number + 1:])
        top = max(top, float((y + errors)[known].max()))
        small = style.SMALLER**2 if axes.figure.get_figwidth() < style.NARROW else 1.0
        symbols = {"color": look.colour, "marker": look.marker, "markersize": 2 * SYMBOL if row.axis.labels else small * SYMBOL * (1 + 0.6 * min(hidden, 2)),
                   "markerfacecolor": "white" if look.open else look.colour, "markeredgewidth": 0.8 if look.open else 0}
        label = style.level(levels.labels[i]).replace("S_z", "$S_z$")
        at = x + BESIDE * ((number + 0.5) / len(looks) - 0.5) if row.axis.labels else x
        axes.errorbar(at[known], y[known], errors[known], color=look.colour, linestyle="none", elinewidth=0.9)
        for run in runs_of(row.x):
            axes.plot(at[run], y[run], linewidth=1.1 + min(hidden, 2), linestyle="none" if row.axis.labels else "--" if look.open else "-", label=label, **symbols)
            label = None
    if top == 0:
        missing = "none in these levels" if np.nansum(fractions) > 0 else "nothing detected"
        axes.text(0.5, 0.5, missing, transform=axes.transAxes, ha="center")
        axes.update_datalim(np.column_stack([x, np.zeros(x.size)]))
    axes.margins(x=0.1 if row.axis.labels else 0.02)
    axes.grid(axis="y")
    return top

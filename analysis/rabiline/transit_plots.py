"""Times of flight to a detector, by the levels that particles are found in before and behind the fields."""
from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from . import style
from .results import Transit
from .style import GREY
from .units import fitting_scale

MOST_STEPS = 60  # cells of the slowness follow the spins' turns and may be many more
MOST_PATHS = 8
LOW = 3.0  # inches of a picture without room for more words
KEPT = 0.98  # of what is caught is shown, where cells are many
FEW = 20  # cells that are no more than steps of what is not known any finer


def draw_transit(transit: Transit, emitted: float, title: str) -> Figure:
    """Steps with error bars: the share of the emitted particles per time, if found on that path."""
    edges, caught, errors = coarser(transit)
    scale = fitting_scale(edges, "s")
    at = np.asarray(scale.apply(edges))
    each = emitted * np.diff(at)
    order = np.argsort(-caught.sum(axis=1), kind="stable")
    shown, left = np.sort(order[:MOST_PATHS]), len(order) - MOST_PATHS
    figure, axes = plt.subplots(figsize=style.size(7.2, 4.8), layout="constrained")
    colours = colormaps["viridis"](np.linspace(0, 0.85, len(shown)))
    for number, (path, colour) in enumerate(zip(shown, colours)):
        y, bars = caught[path] / each, errors[path] / each
        label = style.level(transit.paths[path]).replace("m = ", "").replace(" to ", " → ")
        axes.stairs(y, at, color=colour, linewidth=1.2, label=label, linestyle="-" if number % 2 == 0 else (0, (4, 2)))
        hit = y > 0
        axes.errorbar(((at[:-1] + at[1:]) / 2)[hit], y[hit], bars[hit], fmt="none", ecolor=colour, elinewidth=0.8)
    axes.set_xlim(at[0], at[-1])
    axes.set_ylim(bottom=0)
    style.name_below(axes, scale.label("time of flight from the source"))
    axes.grid(axis="y")
    speeds = axes.secondary_xaxis("top", functions=(lambda t: speed_at(t, transit, scale.factor),
                                                    lambda v: speed_at(v, transit, scale.factor)))
    wide = figure.get_figwidth()
    speeds.set_xticks(round_speeds(transit.distance / edges[-1], transit.distance / edges[0], 7 if wide > style.NARROW else max(2, min(5, int(2.2 * wide)))))
    speeds.xaxis.set_major_formatter("{x:g}")
    above = style.in_lines("speed along the beam (m/s)", wide - 0.8, style.points("axes.labelsize"))
    speeds.set_xlabel(above)
    style.write_title(figure, title)
    further = f"\n{left} further paths are not shown" if left > 0 else ""
    if caught.shape[1] < FEW and figure.get_figheight() > LOW:
        size, cells = style.points("legend.fontsize"), f"{caught.shape[1]} cell{'' if caught.shape[1] == 1 else 's'}"
        axes.set_title(style.in_lines(f"{cells}: for the scan that is fine enough, and nothing finer is kept. A tally of the time_of_flight may have "
                                      "any bins", figure.get_figwidth() - 1, size), fontsize=size, color=GREY)
    heading, foot = style.in_lines(f"level before and behind the fields{further}", wide - 0.3, style.points("legend.fontsize")), 0.0
    if style.size(0, 0) != (0, 0):
        foot = style.legend_at_foot(figure, *axes.get_legend_handles_labels(), heading)
    else:
        axes.legend(title=heading, title_fontsize=style.points("legend.fontsize"), ncol=1 + len(shown) // 5, loc="best")
    high = style.BELOW * (1 + above.count("\n")) * style.points("axes.labelsize") if foot else 0.0  # of the axis of speeds
    axes.set_ylabel(style.upright(figure, f"caught / emitted per {scale.unit}, if found on that path\n(bars: 1 σ)", foot + high))
    return figure


def coarser(transit: Transit) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges [s], and what is caught on each path with its errors: nearly all of it, neighbouring cells added up."""
    share = np.cumsum(transit.caught.sum(axis=0)) / transit.caught.sum()
    first, last = np.searchsorted(share, (1 - KEPT) / 2), np.searchsorted(share, (1 + KEPT) / 2) + 1
    if last - first < FEW:
        filled = np.flatnonzero(transit.caught.sum(axis=0))
        first, last = filled[0], filled[-1] + 1
    begins = np.arange(0, last - first, -(-(last - first) // MOST_STEPS))
    edges = np.append(transit.edges[first + begins], transit.edges[last]) * transit.distance
    return (edges, np.add.reduceat(transit.caught[:, first:last], begins, axis=1),
            np.sqrt(np.add.reduceat(transit.errors[:, first:last]**2, begins, axis=1)))


def round_speeds(low: float, high: float, most: int = 7) -> np.ndarray:
    """[any] m/s: speeds for an axis that is even in their inverse, `most` of them: round, and about evenly spread over it."""
    wanted = 1 / np.linspace(1 / high, 1 / low, most)
    size = 10 ** (np.floor(np.log10(wanted)) - 1)
    return np.unique(np.round(wanted / size / 5) * size * 5)


def speed_at(time: np.ndarray, transit: Transit, unit: float) -> np.ndarray:
    """[n] Speed of a time, and time of a speed."""
    return transit.distance / unit / np.where(np.asarray(time) > 0, time, np.nan)

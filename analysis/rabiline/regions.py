"""Stretches of the beam that are shaded in pictures, with their names."""
from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Sequence

from matplotlib.axes import Axes
from matplotlib.transforms import ScaledTranslation

from . import style
from .errors import InputError
from .style import GREY

ABOVE, ROW = 4.5, 1.5  # points above a panel where names begin, and the height of a row over the size of letters
LETTER = 0.14  # inches of figure per letter of a name, with what is beside the panel
SHADES = ["#f3e7c9", "#dfe8d8", "#d7e3ee", "#ead9e6"]


@dataclass(frozen=True)
class Region:
    """A stretch of the beam to shade."""

    name: str
    begin: float  # m along y
    end: float  # m


def read_region(text: str) -> Region:
    """From NAME=BEGIN:END. Raises InputError."""
    name, _, stretch = text.rpartition("=")
    begin, _, end = stretch.partition(":")
    try:
        region = Region(name, float(begin), float(end))
        if not (name and -inf < region.begin < region.end < inf):
            raise ValueError("empty")
        return region
    except ValueError:
        raise InputError(f'--region "{text}" is not NAME=BEGIN:END in metres, such as "B=0.30:0.55"') from None


def shade(axes: Axes, regions: Sequence[Region], named: bool) -> int:
    """Field regions; those that overlap show through. Their names stand above, over a line from edge to edge, in so many rows as are
    returned."""
    size, up = style.points("legend.fontsize"), axes.get_xaxis_transform()
    rows: list[float] = []
    ordered = sorted(regions, key=lambda region: (region.begin, -region.end))
    for region, colour in zip(ordered, SHADES * (len(regions) // len(SHADES) + 1)):
        axes.axvspan(region.begin, region.end, color=colour if region.end > region.begin else GREY, alpha=0.75,
                     linewidth=0 if region.end > region.begin else 0.8, zorder=0)  # a coil has a place, and no edges
        if not named:
            continue
        left, right = sorted(axes.get_xlim())  # an axis may run downwards
        begin, end = max(region.begin, left), min(region.end, right)
        half = 0.5 * (len(region.name) + 1) * LETTER / axes.figure.get_figwidth() * (right - left)
        middle = min(max((begin + end) / 2, left + half), right - half)
        row = row_for(rows, min(begin, middle - half), max(end, middle + half))
        height = style.scaled(ABOVE) + ROW * size * row
        axes.plot([begin, end], [1, 1], transform=up + ScaledTranslation(0, height / 72, axes.figure.dpi_scale_trans), clip_on=False,
                  color=GREY, linewidth=1.2, solid_capstyle="butt")
        axes.annotate(style.plain(region.name), (middle, 1), xycoords=up, xytext=(0, height + 1), textcoords="offset points", ha="center",
                      va="bottom", color=GREY, fontsize=size)
    return len(rows)


def row_for(rows: list[float], begin: float, end: float) -> int:
    """The first of the rows above a panel that has room from `begin` to `end`, where `rows` has the place at which each one's last name
    ends; names come by rising places."""
    row = next((i for i, taken in enumerate(rows) if taken <= begin), len(rows))
    rows[row:row + 1] = [end]
    return row

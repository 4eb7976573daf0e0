"""The paths of particles in three dimensions: what different laws make of one initial state."""
from __future__ import annotations

from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from . import style
from .style import GREY, looks
from .regions import SHADES, Region
from .track_plots import ENDS, legend_items
from .tracks import Tracks
from .units import Scale, fitting_scale

LETTERS = 105  # of a legend
LETTER, ROW = 0.022, 0.1  # of a name above its region: the width of a letter, and the height of a row, in parts of the axes


@style.in_proportion
def draw_paths(files: Sequence[Tracks], labels: Sequence[str], title: str, regions: Sequence[Region]) -> Figure:
    """x, y and z of every track, in the laboratory: y along the beam to the right, z upwards.
    Along the beam the scale is another one than across, so that small deflections are seen. Faint lines on the floor
    and on the back wall show the paths from above and from the side, frames where regions begin and end."""
    regions = regions or [Region(part.label, part.begin, part.end) for part in files[0].parts if part.has_field]
    reached = max(track.position[:, 1].max() for file in files for track in file.tracks)
    regions = [region for region in regions if region.begin < reached]
    styled = list(zip(files, labels, looks([file.law or label for file, label in zip(files, labels)])))
    points = np.concatenate([track.position for file in files for track in file.tracks])
    across, along = fitting_scale(points[:, [0, 2]], "m"), fitting_scale(points[:, 1], "m")
    scales = [across, along, across]
    low, high = (np.array([scale.apply(edge) for scale, edge in zip(scales, edges)]) for edges in _limits(points))
    figure = plt.figure(figsize=(8.4, 6.0), layout="constrained")
    axes = figure.add_subplot(projection="3d", computed_zorder=False)
    for file, _, look in styled:
        for track in file.tracks:
            x, y, z = (scales[k].apply(track.position[:, k]) for k in range(3))
            floor, wall = np.full_like(x, low[2]), np.full_like(x, low[0])
            axes.plot(x, y, floor, color=look.colour, linewidth=0.8, alpha=0.35)
            axes.plot(wall, y, z, color=look.colour, linewidth=0.8, alpha=0.35)
            axes.plot(x, y, z, color=look.colour, linewidth=1.6)
            axes.plot(x[-1:], y[-1:], z[-1:], ENDS.get(track.fate, "*"), color=look.colour, markersize=6,
                      markeredgewidth=0)
    _draw_frames(axes, regions, along, low, high)
    for k, (name, about) in enumerate(zip("xyz", ("", ", along the beam", ""))):
        getattr(axes, f"set_{name}lim")(low[k], high[k])
        getattr(axes, f"set_{name}label")(scales[k].label(name + about))
        getattr(axes, f"{name}axis").pane.set_facecolor("white")
        getattr(axes, f"{name}axis").set_major_locator(MaxNLocator(6 if name == "y" else 4))
    style.pad_in_space(axes, {"x": 4, "y": 12, "z": 4})
    axes.set_box_aspect((1, 2, 1), zoom=1.12)
    axes.view_init(elev=20, azim=-35)
    style.write_title(figure, title)
    lines = legend_items(styled)
    axes.legend(handles=lines, loc="upper center", bbox_to_anchor=(0.5, 0.02), ncol=style.columns_of([line.get_label() for line in lines], LETTERS))
    return figure


def _limits(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Around all points [n, 3]; where they lie in a plane, as much room across as the other way across has."""
    low, high = points.min(axis=0), points.max(axis=0)
    across = max(np.ptp(points[:, 0]), np.ptp(points[:, 2])) or 1e-3
    room = np.maximum(0.06 * (high - low), [0.15 * across, 0, 0.15 * across])
    return low - room, high + room


def _draw_frames(axes: Axes, regions: Sequence[Region], along: Scale, low: np.ndarray, high: np.ndarray) -> None:
    rows: list[float] = []  # where the last name of each row ends
    for region, shade in zip(sorted(regions, key=lambda region: region.begin + region.end), SHADES * (len(regions) // len(SHADES) + 1)):
        for y in (along.apply(region.begin), along.apply(region.end)):
            corners = [(low[0], y, low[2]), (high[0], y, low[2]), (high[0], y, high[2]), (low[0], y, high[2])]
            axes.add_collection3d(Poly3DCollection([corners], facecolor=shade, edgecolor=GREY, linewidth=0.5,
                                                   alpha=0.25))
        middle = along.apply((region.begin + region.end) / 2)
        half = 0.5 * LETTER * (len(region.name) + 2) * (high[1] - low[1])
        row = next((i for i, end in enumerate(rows) if end <= middle - half), len(rows))
        rows[row:row + 1] = [middle + half]
        axes.text(low[0], middle, high[2] + ROW * row * (high[2] - low[2]), style.plain(region.name), color=GREY,
                  fontsize=style.scaled(9), ha="center", va="bottom")

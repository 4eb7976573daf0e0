"""The paths of particles as pictures: where they go, and how their spins turn."""
from __future__ import annotations

from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import ScaledTranslation

from . import style
from .regions import Region, shade
from .style import INK, Look, looks
from .tracks import Track, Tracks
from .units import Scale, fitting_scale

MILLI = 1e3
STILL = 1e-6  # rad: a spin that tilts less needs no panel
TILTED = np.radians(20)  # a spin that tilts by more is shown on the whole sphere
USUAL_ROWS, HIGHER = 4, 0.19  # rows of names, and inches for each more
BELOW = 38.0  # points from the axis to the legend
LETTERS = 86  # of a legend below the panels
ENDS = {"detected": "o", "stopped": "X", "passed": ">"}  # any other fate: a star


@style.in_proportion
def draw_tracks(files: Sequence[Tracks], labels: Sequence[str], title: str, regions: Sequence[Region]) -> Figure:
    """x, z and the tilt of the spin from the z axis, over y, with the parts of the file where no `regions` are named; and the
    spins' paths in three dimensions where there is room for them. Spins are shown from their first alignment on: what they were before is chance."""
    styled = list(zip(files, labels, looks([file.law or label for file, label in zip(files, labels)])))
    spinning = [(track, look) for file, _, look in styled for track in file.tracks if track.has_spin]
    if not any(_tilt(track).max() > STILL for track, _ in spinning):
        spinning = []
    regions = regions or [Region(part.label, part.begin, part.end) for part in files[0].parts]
    room = style.room()
    turning = [(track, look) for track, look in spinning if _while_turning(track)] if room is None else []
    scales = [fitting_scale(np.concatenate([track.position[:, i] for file in files for track in file.tracks]), "m") for i in (0, 2)]
    figure = plt.figure(figsize=room or (11.0 if turning else 7.2, 6.2 if spinning else 5.0), layout="constrained")
    grid = figure.add_gridspec(3 if spinning else 2, 2 if turning else 1, width_ratios=[1.55, 1] if turning else None)
    panels = [figure.add_subplot(grid[0, 0])]
    panels += [figure.add_subplot(grid[row, 0], sharex=panels[0]) for row in range(1, grid.nrows)]
    for file, _, look in styled:
        for track in file.tracks:
            for panel, component, scale in zip(panels, (0, 2), scales):
                _draw_path(panel, track, component, look, scale)
    for panel, name, scale in zip(panels, "xz", scales):
        panel.set_ylabel(scale.label(name))
    if spinning:
        for track, look in spinning:
            for part in track.stretches:
                panels[2].plot(track.position[part, 1], np.degrees(track.tilt[part]), color=look.colour, linewidth=1.2)
        top = np.degrees(max(_tilt(track).max() for track, _ in spinning)) or 1.0
        panels[2].set_ylim(-0.05 * top, 1.08 * top)
        panels[2].set_ylabel("spin's tilt\nfrom z (°)" if room else "spin's tilt from z (°)")
    if turning:
        by_angle = sorted(turning, key=lambda pair: _tilt(pair[0]).max())
        farthest = {look: track for track, look in by_angle}  # one per file, the last
        sphere = figure.add_subplot(grid[:, 1], projection="3d")
        _draw_spins(sphere, [(track, look) for look, track in farthest.items()])
    panels[0].set_xlim(*_extent(files))
    regions = [region for region in regions if region.begin <= _extent(files)[1]]
    rows = [shade(panel, regions, named=panel is panels[0]) for panel in panels][0]
    if room is None:
        figure.set_figheight(figure.get_figheight() + HIGHER * max(0, rows - USUAL_ROWS))
    for panel in panels:
        panel.label_outer()
    panels[-1].set_xlabel("y, along the beam (m)")
    style.write_title(figure, title)
    lines = legend_items(styled)
    below = panels[-1].transAxes + ScaledTranslation(0, -style.scaled(BELOW) / 72, figure.dpi_scale_trans)
    panels[-1].legend(handles=lines, loc="upper center", bbox_to_anchor=(0.5, 0), bbox_transform=below, ncol=style.columns_of([line.get_label() for line in lines], LETTERS))
    return figure


def _tilt(track: Track) -> np.ndarray:
    return np.concatenate([track.tilt[part] for part in track.stretches])


def _draw_path(axes: Axes, track: Track, component: int, look: Look, scale: Scale) -> None:
    y, across = track.position[:, 1], scale.apply(track.position[:, component])
    axes.plot(y, across, color=look.colour, linewidth=1.2, alpha=0.85)
    axes.plot(y[-1], across[-1], ENDS.get(track.fate, "*"), color=look.colour, markersize=5, markeredgewidth=0,
              clip_on=False, zorder=5)


def _extent(files: Sequence[Tracks]) -> tuple[float, float]:
    y = np.concatenate([track.position[:, 1] for file in files for track in file.tracks])
    margin = 0.01 * np.ptp(y)
    return float(y.min() - margin), float(y.max() + margin)


def _draw_spins(axes: Axes, files: Sequence[tuple[Track, Look]]) -> None:
    """For each file the spin that tilts farthest: its tip on the unit sphere, or where it tilts little the two small
    components along the beam."""
    far = max(_tilt(track).max() for track, _ in files) > TILTED
    for track, look in files:
        part = _while_turning(track)
        across = track.spin[part, :2] * MILLI
        path = track.spin[part] if far else np.column_stack([track.position[part, 1], across])
        line = "-" if _is_smooth(across) else ""
        axes.plot(*path.T, line, marker="" if line else ".", markersize=2, color=look.colour, linewidth=0.8)
        axes.plot(*path[-1:].T, "o", color=look.colour, markersize=5, markeredgewidth=0)
    if far:
        _draw_sphere(axes)
        names, about = ["$S_x$", "$S_y$", "$S_z$"], "path of its tip on the unit sphere"
    else:
        names = ["y (m)", "$S_x$ (10$^{-3}$)", "$S_y$ (10$^{-3}$)"]
        about = "while it turns, along the beam"
        axes.set_box_aspect((1.5, 1, 1), zoom=0.75)
    axes.set(xlabel=names[0], ylabel=names[1], zlabel=names[2])
    which = f"the spin that tilts farthest, of particle {files[0][0].particle}" if len(files) == 1 else "of each file the spin that tilts farthest"
    axes.set_title(f"{which}:\n{about}", y=1.0)
    axes.view_init(elev=22, azim=-58)
    for plane in (axes.xaxis, axes.yaxis, axes.zaxis):
        plane.pane.set_facecolor("white")
        plane.set_major_locator(MaxNLocator(4))
    style.pad_in_space(axes, {"x": 4, "y": 4, "z": 4})


def _while_turning(track: Track) -> slice | None:
    """The part of a track during which its spin moves farthest, between alignments; None where it does not."""
    found = None, 0.0
    for part in track.stretches:
        steps = np.linalg.norm(np.diff(track.spin[part], axis=0), axis=1)
        moving = part.start + np.flatnonzero(steps > 1e-12)
        if moving.size and steps.sum() > found[1]:
            found = slice(moving[0], moving[-1] + 2), steps.sum()
    return found[0]


def _is_smooth(path: np.ndarray) -> bool:
    """Whether a path [n, 2] has enough points per turn to join them by lines."""
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    return steps.size > 0 and bool(np.median(steps) < 0.25 * np.ptp(path, axis=0).max())


def _draw_sphere(axes: Axes) -> None:
    polar, azimuth = np.mgrid[0:np.pi:13j, 0:2 * np.pi:25j]
    axes.plot_wireframe(np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar),
                        color="#cccccc", linewidth=0.4)
    axes.set_box_aspect((1, 1, 1), zoom=0.84)


def legend_items(styled: Sequence[tuple[Tracks, str, Look]]) -> list[Line2D]:
    """One line per file, with the law named, and one marker per fate that occurs."""
    lines = [Line2D([], [], color=look.colour, label=label) for _, label, look in styled]
    fates = dict.fromkeys(track.fate for file, _, _ in styled for track in file.tracks)
    return lines + [Line2D([], [], color=INK, marker=ENDS.get(fate, "*"), linestyle="", markersize=5,
                           label=fate.replace("_", " "))
                    for fate in fates if fate]

"""The motions of a model as pictures: paths from one start, how they part, how the axis nods; findings over a scan."""
from __future__ import annotations

from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from .motions import Course, Finding, Motion, Motions
from .style import GREY, LAWS, OTHERS, Look
from .units import Scale, fitting_scale

MOST_PANELS = 6
MOST_TURNS = 12  # of a path that is drawn whole
ROUNDING = 1e-9  # a drift below is a proof, not a curve
LINES = ["-", "--", "-.", ":"]  # so that paths which lie upon each other are both seen


def draw_motions(motions: Sequence[Motion], title: str) -> Figure:
    """The paths of all motions in three dimensions; beside them their distance from the first one, and the first course
    in which they differ."""
    figure = plt.figure(figsize=(11.5, 5.8), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=[1.25, 1])
    styled = list(zip(motions, _looks(motions), LINES * len(motions)))
    space = figure.add_subplot(grid[:, 0], projection="3d")
    _draw_paths(space, styled)
    clock = fitting_scale(np.concatenate([motion.time for motion in motions]), "s")
    apart = figure.add_subplot(grid[0, 1])
    _draw_distances(apart, styled, clock)
    course = figure.add_subplot(grid[1, 1], sharex=apart)
    _draw_course(course, styled, clock)
    apart.tick_params(labelbottom=False)
    course.set_xlabel(clock.label("time"))
    apart.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=len(motions))
    figure.suptitle(title, fontsize=11.5)
    return figure


def draw_findings(file: Motions, title: str) -> Figure:
    """What was found over the scanned parameter, with what is expected; findings that are rounding alone are named."""
    assert file.axis is not None
    shown = [finding for finding in file.findings if _varies(finding)][:MOST_PANELS]
    kept = [finding.name for finding in file.findings
            if not _is_expected(finding) and np.nanmax(np.abs(finding.values)) <= ROUNDING]
    columns = min(3, max(1, len(shown)))
    rows = max(1, -(-len(shown) // columns))
    figure, panels = plt.subplots(rows, columns, figsize=(3.9 * columns, 3.1 * rows + 0.6), layout="constrained",
                                  squeeze=False, sharex=True)
    scale = fitting_scale(file.axis.values, file.axis.units)
    x = scale.apply(file.axis.values)
    for panel, finding in zip(panels.flat, shown):
        _draw_finding(panel, x, finding)
    for panel in panels.flat[len(shown):]:
        panel.set_visible(False)
    for panel in panels[-1]:
        panel.set_xlabel(scale.label(file.axis.parameter))
    if _spans_decades(x):
        panels.flat[0].set_xscale("log")
    if file.axis.labels:
        panels.flat[0].set_xticks(x, file.axis.labels)
    figure.suptitle(title, fontsize=11.5)
    if kept:
        figure.supxlabel(_wrapped(f"nothing beyond {ROUNDING:.0e} at any point: {', '.join(kept)}", 120), fontsize=8,
                         color=GREY)
    return figure


def _looks(motions: Sequence[Motion]) -> list[Look]:
    """The hypothesis in its own colour, established mechanics in that of the standard laws."""
    own = {"paper": LAWS["dorado"], "torque": LAWS["dorado"], "eq74": LAWS["dorado"], "standard": LAWS["quantum"],
           "larmor_theorem": LAWS["classical"], "euler": OTHERS[0], "larmor": OTHERS[0]}
    spare = iter(OTHERS[1:] * len(motions))
    return [Look(*(own.get(motion.name) or next(spare))) for motion in motions]


def _draw_paths(axes: Axes, styled: Sequence[tuple[Motion, Look, str]]) -> None:
    scale = fitting_scale(np.concatenate([motion.position.ravel() for motion, _, _ in styled]), "m")
    shown = [scale.apply(motion.position[:_readable(motion.position)]) for motion, _, _ in styled]
    for path, (motion, look, line) in zip(shown, styled):
        axes.plot(*path.T, line, color=look.colour, linewidth=1.6)
        if len(path) == len(motion.position):
            axes.plot(*path[-1:].T, look.marker, color=look.colour, markersize=5, markeredgewidth=0)
    axes.plot(*shown[0][:1].T, "o", color=GREY, markersize=6, fillstyle="none")
    places = np.concatenate(shown)
    # One scale along all axes, so that a plane path looks plane; none thinner than a quarter of the longest.
    extent = np.ptp(places, axis=0)
    extent = np.maximum(1.05 * extent, 0.25 * (extent.max() or 1.0))
    middle = (places.max(axis=0) + places.min(axis=0)) / 2
    axes.set(**{f"{name}lim": (m - e / 2, m + e / 2) for name, m, e in zip("xyz", middle, extent)})
    axes.set_box_aspect(extent, zoom=0.9)
    axes.set(**{f"{name}label": scale.label(name) for name in "xyz"})
    part = "first turns" if len(shown[0]) < len(styled[0][0].position) else "paths"
    axes.set_title(f"{part} of the centre of mass; the ring is the start", y=1.02)
    axes.yaxis.labelpad = 9
    axes.view_init(elev=20, azim=-35)
    for plane, size in zip((axes.xaxis, axes.yaxis, axes.zaxis), extent / extent.max()):
        plane.pane.set_facecolor("white")
        plane.set_major_locator(MaxNLocator(4 if size > 0.5 else 2))
    axes.tick_params(labelsize=8, pad=1)


def _readable(path: np.ndarray) -> int:
    """How many points [n, 3] of a path are drawn: more than MOST_TURNS around its extent make a ball of wool."""
    travelled = np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))
    return 1 + int(np.searchsorted(travelled, MOST_TURNS * np.pi * np.linalg.norm(np.ptp(path, axis=0)), side="right"))


def _draw_distances(axes: Axes, styled: Sequence[tuple[Motion, Look, str]], clock: Scale) -> None:
    first = styled[0][0]
    axes.plot([], [], styled[0][2], color=styled[0][1].colour, label=first.name)
    for motion, look, line in styled[1:]:
        distance = np.linalg.norm(motion.position - first.position, axis=1)
        axes.plot(clock.apply(motion.time), np.where(distance > 0, distance, np.nan), line, color=look.colour,
                  linewidth=1.2, label=motion.name)
    axes.set_yscale("log")
    axes.set_ylabel(f"distance from `{first.name}` (m)")
    axes.grid(axis="y")


def _draw_course(axes: Axes, styled: Sequence[tuple[Motion, Look, str]], clock: Scale) -> None:
    """Of motions that share the course to the bit, the first one is drawn."""
    course = _first_difference([motion for motion, _, _ in styled])
    drawn: set[bytes] = set()
    for motion, look, line in styled:
        for own in motion.courses:
            if course and own.name == course.name and own.values.tobytes() not in drawn:
                drawn.add(own.values.tobytes())
                axes.plot(clock.apply(motion.time), own.values, line, color=look.colour, linewidth=0.8)
    axes.set_ylabel(_wrapped(course.title, 34) if course else "")
    axes.grid(axis="y")


def _first_difference(motions: Sequence[Motion]) -> Course | None:
    """The course that tells the motions apart best, relative to its size: the first one that does so at all."""
    for course in motions[0].courses:
        others = [own.values for motion in motions[1:] for own in motion.courses if own.name == course.name]
        size = max([np.abs(course.values).max(), *(np.abs(values).max() for values in others)])
        if any(np.abs(values - course.values).max() > ROUNDING * size for values in others):
            return course
    return None


def _varies(finding: Finding) -> bool:
    size = np.nanmax(np.abs(finding.values))
    return bool(size > ROUNDING and np.nanmax(finding.values) - np.nanmin(finding.values) > ROUNDING * size)


def _is_expected(finding: Finding) -> bool:
    """Whether a value other than zero is expected anywhere."""
    return bool(np.nan_to_num(finding.expected).any())


def _spans_decades(values: np.ndarray) -> bool:
    finite = values[np.isfinite(values)]
    return finite.size > 1 and bool(finite.min() > 0) and bool(finite.max() >= 20 * finite.min())


def _draw_finding(axes: Axes, x: np.ndarray, finding: Finding) -> None:
    colour, marker = LAWS["dorado"]
    axes.plot(x, finding.values, marker=marker, markersize=4, color=colour, linewidth=1.2, label="found")
    if _is_expected(finding):
        axes.plot(x, finding.expected, "--", color=GREY, linewidth=1.2, label="expected")
        axes.legend()
    if _spans_decades(finding.values):
        axes.set_yscale("log")
    axes.set_ylabel(f"{finding.name} ({finding.units})" if finding.units else finding.name)
    axes.set_title(_wrapped(finding.meaning), fontsize=7.5, color=GREY)
    axes.grid()


def _wrapped(text: str, width: int = 46) -> str:
    lines = [""]
    for word in text.split():
        if len(lines[-1]) + len(word) > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return "\n".join(lines)

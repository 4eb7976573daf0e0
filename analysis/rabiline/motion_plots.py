"""The motions of a model as pictures: paths from one start, how they part, how the axis nods; findings over a scan."""
from __future__ import annotations

import re
from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, MaxNLocator

from . import style
from .motions import Course, Finding, Motion, Motions
from .style import GREY, INK, LAWS, OTHERS, Look
from .units import Scale, fitting_scale

MOST_PANELS = 6
MOST_TURNS = 12  # of a path that is drawn whole
SHOWN_TURNS = 2.0  # of a longer one, at its start and at its end
SMOOTH = 8  # samples in a turn from which a cubic spline between them is the path
FINE = 6  # its places for each sample
MOST_WAVES = 12  # of a dashed curve: over more of them dashes beat with the waves
ROUNDING = 1e-9  # a drift below is a proof, not a curve
DECADES = 20.0  # a ratio of values from which an axis is logarithmic
SHORT = 16  # letters of a line beside one of two panels where room is scarce
LINES = ["-", "--", "-.", ":"]  # so that paths which lie upon each other are both seen
BROADER = 1.4  # points, of the first motion, which is seen below others that lie upon it
INPUTS = {"fast_top"}  # findings that follow from the input alone, shown where there is room

Styled = Sequence[tuple[Motion, Look, str]]


@style.in_proportion
def draw_motions(motions: Sequence[Motion], title: str) -> Figure:
    """The paths of all motions in three dimensions; beside them their distance from the first one, where the paths are
    drawn whole, and the first course in which they differ, or that varies at all."""
    styled = list(zip(motions, _looks(motions), LINES * len(motions)))
    course = _telling_course(motions)
    part = any((motion.position != motions[0].position).any() for motion in motions[1:])
    whole = part and not any(_is_long(motion.position) for motion in motions)
    beside = whole + (course is not None)
    room = style.room()
    in_space = not (room and beside)
    figure = plt.figure(figsize=room or (11.5 if beside else 6.5, 5.8), layout="constrained")
    grid = figure.add_gridspec(max(beside, 1), in_space + bool(beside), width_ratios=[1.25, 1] if in_space and beside else None)
    if in_space:
        space = figure.add_subplot(grid[:, 0], projection="3d")
        _draw_paths(space, styled)
    clock = fitting_scale(np.concatenate([motion.time for motion in motions]), "s")
    panels = [figure.add_subplot(grid[row, -1]) for row in range(beside)]
    for panel in panels[:-1]:
        panel.sharex(panels[-1])
        panel.tick_params(labelbottom=False)
    if whole:
        _draw_distances(panels[0], styled, clock)
    if course is not None:
        _draw_course(panels[-1], course, styled, clock)
    for panel in panels:
        panel.set_ylabel(_wrapped(panel.get_ylabel(), SHORT if room and beside > 1 else 34))
    if panels:
        panels[-1].set_xlabel(clock.label("time"))
    keys = [Line2D([], [], color=look.colour, linestyle=line, label=motion.label) for motion, look, line in styled]
    if panels:
        panels[0].legend(handles=keys, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=min(3, len(keys)),
                         columnspacing=1.2, handlelength=2.6)
    else:
        space.legend(handles=keys, loc="upper left")
    style.write_title(figure, title)
    return figure


@style.in_proportion
def draw_findings(file: Motions, title: str) -> Figure:
    """What was found over the scanned parameter, with what is expected; findings that are rounding alone, and those for
    which there is no room, are named."""
    assert file.axis is not None
    varying = sorted(filter(_varies, file.findings), key=lambda finding: finding.name in INPUTS)
    shown, left = varying[:MOST_PANELS], varying[MOST_PANELS:]
    kept = [finding.name for finding in file.findings
            if not _is_expected(finding) and np.nanmax(np.abs(finding.values)) <= ROUNDING]
    columns = min(3, max(1, len(shown)))
    rows = max(1, -(-len(shown) // columns))
    figure, panels = plt.subplots(rows, columns, figsize=(3.9 * columns, 3.1 * rows + 0.6), layout="constrained",
                                  squeeze=False, sharex=True)
    scale = fitting_scale(file.axis.values, file.axis.units)
    x = scale.apply(file.axis.values)
    for panel, finding in zip(panels.flat, shown):
        _draw_finding(panel, x, finding, joined=not file.axis.labels)
    for panel in panels.flat[len(shown):]:
        panel.set_visible(False)
    for panel in panels[-1]:
        panel.set_xlabel(scale.label(file.axis.parameter))
    if file.axis.labels:
        panels.flat[0].set_xticks(x, file.axis.labels)
        panels.flat[0].margins(x=0.15)
    elif _spans_decades(x):
        style.logarithmic(panels.flat[0].xaxis)
    style.write_title(figure, title)
    footer = [f"{what}: {', '.join(names)}" for what, names in
              (("not shown", [finding.name for finding in left]),
               ("nothing beyond 10⁻⁹ at any point", kept)) if names]
    if footer:
        figure.supxlabel("\n".join(_wrapped(line, 38 * columns) for line in footer), fontsize=style.scaled(8), color=GREY)
    return figure


def _looks(motions: Sequence[Motion]) -> list[Look]:
    """The hypothesis in its own colour, established mechanics in that of the standard laws."""
    own = {"paper": LAWS["dorado"], "torque": LAWS["dorado"], "eq74": LAWS["dorado"], "standard": LAWS["quantum"],
           "larmor_theorem": LAWS["classical"], "euler": OTHERS[0], "larmor": OTHERS[0]}
    spare = iter(OTHERS[1:] * len(motions))
    return [Look(*(own.get(motion.name) or next(spare))) for motion in motions]


def _draw_paths(axes: Axes, styled: Styled) -> None:
    scale = fitting_scale(np.concatenate([motion.position.ravel() for motion, _, _ in styled]), "m")
    axes.computed_zorder = False  # of lines by their depth, which hides the start
    some_long = False
    for number, (motion, look, line) in enumerate(styled):
        long = _is_long(motion.position)
        some_long |= long
        for part in _ends(motion) if long else [motion.position]:
            axes.plot(*scale.apply(part).T, line, color=look.colour,
                      linewidth=(0.9 if long else 1.6) + (BROADER if number == 0 else 0))
        axes.plot(*scale.apply(motion.position[-1:]).T, look.marker, color=look.colour, markersize=5, markeredgewidth=0,
                  zorder=3)
    axes.plot(*scale.apply(styled[0][0].position[:1]).T, "o", color=INK, markersize=7, fillstyle="none",
              markeredgewidth=1.4, zorder=4)
    places = scale.apply(np.concatenate([motion.position for motion, _, _ in styled]))
    # One scale along all axes, so that a plane path looks plane; none thinner than a quarter of the longest.
    extent = np.ptp(places, axis=0)
    extent = np.maximum(1.05 * extent, 0.25 * (extent.max() or 1.0))
    middle = (places.max(axis=0) + places.min(axis=0)) / 2
    axes.set(**{f"{name}lim": (m - e / 2, m + e / 2) for name, m, e in zip("xyz", middle, extent)})
    tall = extent[2] >= extent[:2].max()
    axes.set_box_aspect(extent, zoom=0.8 if tall else 0.9)
    axes.set(**{f"{name}label": scale.label(name) for name in "xyz"})
    part = f"first {SHOWN_TURNS:g} and last {SHOWN_TURNS:g} turns" if some_long else "paths"
    axes.set_title(f"{part}; the ring is the start", y=1.02)
    axes.view_init(elev=20, azim=-35)
    for plane, size in zip((axes.xaxis, axes.yaxis, axes.zaxis), extent / extent.max()):
        plane.pane.set_facecolor("white")
        plane.set_major_locator(MaxNLocator(4 if size > 0.5 else 2))
    style.pad_in_space(axes, {"x": 4, "y": 9 if extent[1] < 2 * extent[::2].max() else 14, "z": 24 if tall else 4}, {"z": 7} if tall else {})


def _is_long(path: np.ndarray) -> bool:
    """Whether a path [n, 3] goes more than MOST_TURNS around its extent, and drawn whole is a ball of wool."""
    travelled = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    return bool(travelled > MOST_TURNS * np.pi * np.linalg.norm(np.ptp(path, axis=0)))


def _ends(motion: Motion) -> list[np.ndarray]:
    """The first and the last turns of a path; between few samples a spline, as chords are no orbit."""
    steps = np.diff(motion.position, axis=0)
    steps /= np.maximum(np.linalg.norm(steps, axis=1), np.finfo(float).tiny)[:, None]
    angles = np.arccos(np.clip(np.sum(steps[1:] * steps[:-1], axis=1), -1, 1))
    turns = np.concatenate([[0.0, 0.0], np.cumsum(angles) / (2 * np.pi)])  # at each sample
    begin, end = np.searchsorted(turns, SHOWN_TURNS), np.searchsorted(turns, turns[-1] - SHOWN_TURNS)
    times = [motion.time[:begin + 1], motion.time[max(end - 1, 0):]]
    if motion.time.size < SMOOTH * turns[-1]:
        return [motion.position[:begin + 1], motion.position[max(end - 1, 0):]]
    from scipy.interpolate import CubicSpline  # takes long to load
    path = CubicSpline(motion.time, motion.position)
    return [path(np.linspace(part[0], part[-1], FINE * part.size)) for part in times]


def _draw_distances(axes: Axes, styled: Styled, clock: Scale) -> None:
    first = styled[0][0]
    distances = [np.linalg.norm(motion.position - first.position, axis=1) for motion, _, _ in styled[1:]]
    scale = fitting_scale(np.concatenate([[0.0], *distances]), "m")
    for distance, (motion, look, line) in zip(distances, styled[1:]):
        axes.plot(clock.apply(motion.time), scale.apply(np.where(distance > 0, distance, np.nan)),
                  _line_of(distance, line), color=look.colour, linewidth=1.2, label=motion.label)
    style.logarithmic(axes.yaxis)
    axes.set_ylabel(scale.label(f"distance from {first.name}"))
    axes.grid(axis="y")


def _draw_course(axes: Axes, course: Course, styled: Styled, clock: Scale) -> None:
    """Of motions that share the course to the bit, the first one is drawn."""
    drawn: set[bytes] = set()
    for number, (motion, look, line) in enumerate(styled):
        for own in motion.courses:
            if own.name == course.name and own.values.tobytes() not in drawn:
                drawn.add(own.values.tobytes())
                axes.plot(clock.apply(motion.time), own.values, _line_of(own.values, line), color=look.colour,
                          linewidth=1.0 + (BROADER if number == 0 else 0), label=motion.label)
    axes.set_ylabel(course.title)
    axes.grid(axis="y")


def _line_of(values: np.ndarray, line: str) -> str:
    """The line of a curve, without dashes where it goes up and down many times."""
    slopes = np.sign(np.diff(values)[np.abs(np.diff(values)) > ROUNDING * np.abs(values).max()])
    return "-" if np.count_nonzero(np.diff(slopes)) > 2 * MOST_WAVES else line


def _telling_course(motions: Sequence[Motion]) -> Course | None:
    """The first course that tells the motions apart, relative to its size; of a single motion, the first that varies at
    all."""
    for course in motions[0].courses:
        others = [own.values for motion in motions[1:] for own in motion.courses if own.name == course.name]
        size = max([np.abs(course.values).max(), *(np.abs(values).max() for values in others)])
        apart = [np.abs(values - course.values).max() for values in others] if len(motions) > 1 else \
            [np.ptp(course.values)]
        if max(apart, default=0.0) > ROUNDING * size:
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
    return finite.size > 1 and bool(finite.min() > 0) and bool(finite.max() >= DECADES * finite.min())


def _draw_finding(axes: Axes, x: np.ndarray, finding: Finding, joined: bool) -> None:
    """Values over numbers are joined by a line, those of a list of names are not."""
    colour, marker = LAWS["dorado"]
    scale = fitting_scale(finding.values, finding.units)
    axes.plot(x, scale.apply(finding.values), marker=marker, markersize=4, color=colour, linewidth=1.2,
              linestyle="-" if joined else "none", label="found")
    about = _heading(finding)
    if _is_expected(finding):
        looks = {"linestyle": "--", "linewidth": 1.2} if joined else \
            {"linestyle": "none", "marker": "o", "markersize": 9, "fillstyle": "none"}
        axes.plot(x, scale.apply(finding.expected), color=GREY, label=finding.basis, **looks)
        axes.legend()
    elif finding.expectation in ("supposed", "approximate"):
        about = f"{about} ({finding.basis} 0)"
    _fit_values(axes, finding.values / scale.factor)  # not what they are beyond an origin
    axes.set_ylabel(_wrapped(scale.label(finding.name), 30))
    axes.set_title(_wrapped(about), fontsize=style.scaled(7.5), color=GREY)
    axes.grid()


def _fit_values(axes: Axes, values: np.ndarray) -> None:
    """A logarithmic axis over decades, on both sides of zero where signs differ; plain numbers along a linear one."""
    sizes = np.abs(values[np.isfinite(values) & (values != 0)])
    if _spans_decades(values):
        style.logarithmic(axes.yaxis)
    elif sizes.size > 1 and sizes.max() >= DECADES * sizes.min():
        axes.set_yscale("symlog", linthresh=10.0**np.floor(np.log10(sizes.min())))
        axes.axhline(0, color=GREY, linewidth=0.8, zorder=1)
    else:
        axes.yaxis.set_major_locator(MaxNLocator(5))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.10g}"))


def _heading(finding: Finding) -> str:
    """Its meaning up to the first stop: pictures have no room for more."""
    return re.split("[;:] ", finding.meaning, maxsplit=1)[0].replace("`", "")


def _wrapped(text: str, width: int = 46) -> str:
    lines = [""]
    for word in text.split():
        if len(lines[-1]) + len(word) > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return "\n".join(lines)

"""The command draw: an apparatus before a run, from above and from the side, with a few paths."""
from __future__ import annotations

import argparse
import time
from argparse import ArgumentParser
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from . import style
from .argument_types import count, heading
from .asked import MOST_TRACKS
from .errors import InputError
from .style import GREY, INK, LAWS, OTHERS
from .units import Scale, fitting_scale, format_value

if TYPE_CHECKING:
    from .experiment import Experiment
    from .tracks import Tracks

PATHS = 50
PLACES = 600  # along the beam, where fields are probed
FAR = 100.0  # between fields that are drawn on a logarithmic axis
MOST_RECORDS = 2000  # of a path
AT_ONCE, PATIENCE = 2, 0.5  # paths, and seconds of processor time after which no more are flown than were flown by then
COILS = {"current_loop", "solenoid", "coil_pair", "straight_wire", "current_sheet", "field_map", "formula_field"}  # drawn where their field is
FIELDS = COILS | {"polarizer", "uniform_field", "guide_field", "electric_field", "multipole_field", "gradient_magnet", "two_wire_magnet", "iron_magnet",
                  "multipole_magnet"}
SMALL = 0.1  # of a coil's largest field on the axis: less is not shaded
DRIVES = {"rotating_field", "oscillating_field", "coil"}
PLATES = {"slit", "collimator", "chopper", "velocity_selector", "gas_cell"}
COUNTERS = {"detector", "monitor"}
FIELD, DRIVE, GAS = "#d9e6f2", "#f5dcc8", "#e8e8e8"
WIDTH = 9.0  # inches
NAME, NAMES, MOST_ROWS = 0.37, 0.3, 3  # of a row of names: its share of the height, inches that it takes, and how many a usual picture has
PANELS, LETTER = 0.6, 1.8  # of a picture where room is scarce: the share of its height that panels have, and lines of letters that a row takes
SHARE, PALEST = 0.01, 0.12  # of a path's weight: a change that is seen, and the least that is drawn with its own strength
THIN = 0.006  # of the length of the beam, drawn of what has none


@dataclass(frozen=True)
class Piece:
    """A part as it is drawn, SI."""

    part: str  # as the file calls it
    name: str  # as pictures do
    kind: str
    begin: float
    length: float
    half: dict[str, float | None]  # of its opening, or face, along "x" and "z"
    offset: dict[str, float]
    words: str  # its field


def arguments(verb: str, parser: ArgumentParser) -> None:
    """Its options."""
    parser.set_defaults(command=draw)
    parser.description = "The apparatus before a run: along the beam to scale, across it stretched; with 50 paths."
    parser.add_argument("file", metavar="FILE", type=Path)
    parser.add_argument("-o", "--output", type=Path, metavar="PNG", help="PNG, PDF or SVG; FILE-apparatus.png where it is missing")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("-n", "--paths", type=partial(count, least=0, most=MOST_TRACKS), metavar="N",
                        help=f"{PATHS} by default, or fewer where they take long to fly; 0 draws the apparatus alone")
    parser.add_argument("--title", type=heading)


def draw(options: argparse.Namespace) -> Figure:
    """The apparatus of a file."""
    from .experiment import load
    experiment = load(options.file).scan()
    experiment = experiment.set({name: value for name, _, value in (text.partition("=") for text in options.set)})
    return draw_apparatus(experiment, options.paths, options.title)


def draw_apparatus(experiment: Experiment, paths: int | None = None, title: str | None = None) -> Figure:
    """Side (z) and top (x) view over y, and the fields along the beam, without a scan. `paths` are PATHS by default, or as many as PATIENCE allows."""
    if experiment.is_model:
        raise InputError(f"{experiment.path} is a model, and no beamline to draw")
    experiment = experiment.scan()
    pieces = pieces_of(experiment)
    if not pieces:
        raise InputError(f"{experiment.path}: no parts to draw")
    return _draw(experiment, pieces, _traced(experiment, paths), title or experiment.title)


@style.in_proportion
def _draw(experiment: Experiment, pieces: list[Piece], tracks: Tracks | None, title: str) -> Figure:
    end = max(piece.begin + piece.length for piece in pieces) * 1.02
    fields = fields_along(experiment, pieces, end, tracks)
    drawn = [draw for draw, there in ((_draw_fields, fields and fields.is_magnetic), (_draw_electric, fields and fields.electric.any()))
             if there]
    room = style.room()
    figure, panels = plt.subplots(3 + len(drawn), 1, figsize=room or (WIDTH, 6.4 + 1.4 * len(drawn)), sharex=True, layout="constrained")
    names, side, top = panels[0], panels[-2], panels[-1]
    if fields:
        pieces = [_where_it_acts(piece, fields) for piece in pieces]
    rows = _write_names(names, [replace(piece, words="") for piece in pieces] if room else pieces, end)
    others = [*(1.3 for _ in drawn), 2.0, 2.0]
    names.get_gridspec().set_height_ratios((_share_of_names(rows, figure.get_figheight()) * sum(others) if room else NAME * rows, *others))
    if room is None and rows < MOST_ROWS:
        figure.set_figheight(figure.get_figheight() - NAMES * (MOST_ROWS - rows))
    for draw_field, panel in zip(drawn, panels[1:]):
        draw_field(panel, fields)
    for axes, across in ((side, "z"), (top, "x")):
        half = _extent(pieces, across, tracks)
        _draw_view(axes, pieces, across, half, end)
        if tracks is not None:
            _draw_paths(axes, tracks, across, half)
        axes.set_ylim(-1e3 * half, 1e3 * half)
        axes.set_ylabel(f"{across} (mm)")
    top.set_xlabel("y, along the beam (m)")
    top.set_xlim(-0.01 * end, end)
    figure.align_ylabels(panels[1:])
    if room:
        for axes in panels[1:]:
            axes.yaxis.label.set_size(style.scaled(8))
        _name_at_foot(figure, panels[1:-1])
    elif tracks is not None:
        handles, labels = side.get_legend_handles_labels()
        legend = top.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, -0.3), ncol=min(len(labels), 3))
        for line in legend.get_lines():
            line.set(linewidth=2, alpha=1)
    style.write_title(figure, title)
    return figure


def _name_at_foot(figure: Figure, panels: Sequence[Axes]) -> None:
    """One legend for all panels where room is scarce."""
    named = {}
    for axes in panels:
        named |= {label.replace("\n", " "): handle for handle, label in zip(*axes.get_legend_handles_labels())}
        if axes.get_legend():
            axes.get_legend().remove()
    if named:
        style.legend_at_foot(figure, list(named.values()), list(named))
        for line in figure.legends[0].get_lines():
            line.set(linewidth=2, alpha=1)


def _traced(experiment: Experiment, paths: int | None) -> Tracks | None:
    there = int(experiment.value("particles"))
    if paths is not None:
        return experiment.trace(min(paths, there)) if paths > 0 else None
    most = min(PATHS, there)
    begun, tracks = time.process_time(), experiment.trace(min(AT_ONCE, most))
    while len(tracks.tracks) < most and time.process_time() - begun < PATIENCE:
        flown = len(tracks.tracks)
        tracks = replace(tracks, tracks=(*tracks.tracks, *experiment.trace(min(flown, most - flown), flown).tracks))
    return tracks


@dataclass(frozen=True)
class FieldsAlong:
    """B and E on the axis of the beam, SI."""

    y: np.ndarray  # [n]
    static: np.ndarray  # [n] its size, of what has no clock
    drives: np.ndarray  # [n] the largest size of what has a clock, whatever its phase
    electric: np.ndarray  # [n] its size
    parts: dict[str, np.ndarray]  # [n] the size of B of each
    changes: bool = False  # what should be static has formulas in time, as the first path meets them

    @property
    def is_magnetic(self) -> bool:
        """Whether there is B anywhere."""
        return bool(self.static.any() or self.drives.any())


def fields_along(experiment: Experiment, pieces: list[Piece], end: float, tracks: Tracks | None = None) -> FieldsAlong | None:
    """Where it changes most it is probed most; None where there is none. Formulas, which may have t, as the first path meets them."""
    edges = [place for piece in pieces for at in (piece.begin, piece.begin + piece.length) for place in (at - 1e-6, at + 1e-6)]
    y = np.unique(np.clip([*np.linspace(0, end, PLACES), *edges], 0, end))
    places = [(0.0, float(place), 0.0) for place in y]
    swinging = {clock.partition(".")[0] for clock in _clocks(experiment)}
    drives = {name for name, *_, drives in experiment._setup.parts if drives} | swinging
    fields, later = (_at_phase(experiment, phase).field(places) for phase in (0, 90))
    electric = experiment.electric_field(places)
    nothing = np.zeros((y.size, 3))
    changes = False
    in_time = [piece.part for piece in pieces if piece.kind == "formula_field" and piece.part not in swinging]
    if in_time and tracks and tracks.tracks:
        first = tracks.tracks[0]
        met = experiment.field(places, np.interp(y, first.position[:, 1], first.time))
        changes = any(not np.allclose(met[name], fields.get(name, nothing), rtol=1e-9, atol=0) for name in in_time if name in met)
        fields |= {name: met[name] for name in in_time if name in met}
    static = sum((B for name, B in fields.items() if name not in drives), nothing)
    driven = [sum((B for name, B in phase.items() if name in drives), nothing) for phase in (fields, later)]
    amplitude = np.linalg.norm(driven, ord=2, axis=(0, 2))  # half the long axis of the ellipse on which it turns
    found = FieldsAlong(y, np.linalg.norm(static, axis=1), amplitude,
                        np.linalg.norm(sum(electric.values(), nothing), axis=1),
                        {name: np.linalg.norm(B, axis=1) for name, B in fields.items()}, changes)
    return found if found.is_magnetic or found.electric.any() else None


def _clocks(experiment: Experiment) -> list[str]:
    """What has a frequency of its own: `first`, `coil.oscillates`."""
    names = [name + inside for name, *_ in experiment._setup.parts for inside in ("", ".oscillates", ".formula")]
    return [name for name in names if experiment._setup.value(f"{name}.frequency") is not None]


def _at_phase(experiment: Experiment, degrees: float) -> Experiment:
    """With all clocks at one phase at time 0, and what is pulsed switched on."""
    pulsed = [name for name, *_ in experiment._setup.parts if experiment._setup.value(f"{name}.pulses.end") is not None]
    return experiment.set({**{f"{name}.phase": f"{degrees} deg" for name in _clocks(experiment)},
                           **{f"{name}.pulses.begin": "0 s" for name in pulsed}})


def _where_it_acts(piece: Piece, fields: FieldsAlong) -> Piece:
    """A coil or a map, which has a place but no edges, with those of its field on the axis."""
    size = fields.parts.get(piece.part, np.zeros(1))
    if piece.kind not in COILS or not size.any():
        return piece
    reached = fields.y[size > SMALL * size.max()]
    return replace(piece, begin=float(reached[0]), length=float(np.ptp(reached)))


def _draw_fields(axes: Axes, fields: FieldsAlong) -> None:
    """Logarithmic where the fields of the apparatus differ by far."""
    sizes = np.concatenate([fields.static, fields.drives])
    plateaus = [values[values > 0.01 * values.max()] for values in (fields.static, fields.drives) if values.any()]
    far = sizes.max() > FAR * min(np.median(values) for values in plateaus) or \
        fields.static.any() and fields.static.max() > FAR * np.median(fields.static[fields.static > 0])
    scale = Scale("T") if far else fitting_scale(sizes, "T")
    for values, colour, line, label in ((fields.static, INK, "-", "|B|, as a path meets it" if fields.changes else "|B|, static"),
                                        (fields.drives, LAWS["dorado"][0], _line(), "|B|, oscillating:\namplitude")):
        if values.any():
            shown = np.where(values > 0 if far else _near_any(values), scale.apply(values), np.nan)
            axes.plot(fields.y, shown, color=colour, linewidth=1.2, linestyle=line, label=label)
    if far:
        style.logarithmic(axes.yaxis)
        axes.yaxis.set_major_formatter(lambda value, _: format_value(float(f"{value:.3g}"), "T"))
        low, high = np.log10(axes.get_ylim())
        powers = np.arange(np.ceil(low), np.floor(high) + 1)
        if powers.size > 1:  # as low as it is, it may be given one
            axes.set_yticks(10**np.unique(np.round(np.linspace(powers[0], powers[-1], 2 if style.room() else 3))))
    else:
        axes.set_ylim(bottom=0)
    name = "B" if style.room() else "B on axis"
    axes.set_ylabel(name if far else scale.label(name))
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes.grid(axis="y")


def _line() -> object:
    """Of a field in the colour of some paths, from which one legend for both tells it by its dashes."""
    return (0, (2.5, 1)) if style.room() else "-"


def _near_any(values: np.ndarray) -> np.ndarray:
    """[n] Where there is a field, or beside it: a line along zero would cover another one."""
    there = np.concatenate([[False], values > 0, [False]])
    return there[:-2] | there[1:-1] | there[2:]


def _draw_electric(axes: Axes, fields: FieldsAlong) -> None:
    scale = fitting_scale(fields.electric, "V/m")
    axes.plot(fields.y, scale.apply(fields.electric), color=LAWS["classical"][0], linewidth=1.2, linestyle=_line(), label="|E|")
    axes.set_ylim(bottom=0)
    axes.set_ylabel(scale.label("E" if style.room() else "E on axis"))
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes.grid(axis="y")


def pieces_of(experiment: Experiment) -> list[Piece]:
    """What is drawn, in the order of the beam."""
    value = experiment._setup.value  # None where the file says nothing

    def number(name: str) -> float | None:
        found = value(name)
        return None if found is None else found[0]

    pieces = []
    for name, kind, label, *_ in experiment._setup.parts:
        opening = f"{name}.gap" if number(f"{name}.gap.width") or number(f"{name}.gap.height") else name
        radius = next(filter(None, (number(f"{name}.{key}") for key in ("radius", "bore.radius", "pole_radius"))), None)
        half = {across: number(f"{opening}.{key}") for across, key in (("x", "width"), ("z", "height"))}
        half = {across: None if kind in COILS else radius if size is None else size / 2 for across, size in half.items()}
        offset = {across: number(f"{name}.offset.{across}") or 0.0 for across in "xz"}
        field = next((format_value(number(f"{name}.{key}") or 0.0, unit, None, experiment.written_unit(f"{name}.{key}")) for key, unit in
                      (("field", "V/m" if kind == "electric_field" else "T"), ("amplitude", "T"), ("pole_field", "T"))
                      if number(f"{name}.{key}")), "")
        pieces.append(Piece(name, label, kind, number(f"{name}.at") or 0.0, number(f"{name}.length") or 0.0, half, offset, field))
    return pieces


def _extent(pieces: list[Piece], across: str, tracks: Tracks | None) -> float:
    """Half of what is shown: the paths, openings that are not much larger, and detectors beside the beam."""
    index = "xyz".index(across)
    reached = max((np.abs(track.position[:, index]).max() for track in tracks.tracks), default=0.0) if tracks else 0.0
    sizes = [abs(piece.offset[across]) + piece.half[across] for piece in pieces if piece.half[across] and piece.kind != "monitor"]
    near = [size for size in sizes if reached == 0 or size <= max(4 * reached, 1.5 * min(sizes))]
    beside = [abs(piece.offset[across]) for piece in pieces if piece.kind == "detector" and abs(piece.offset[across]) > (piece.half[across] or 0.0)]
    return 1.15 * max([reached, *near, *beside, min(sizes, default=1e-3) if not near else 0.0, 1e-6])


def _draw_view(axes: Axes, pieces: list[Piece], across: str, half: float, end: float) -> None:
    for piece in pieces:
        low, length = piece.begin, max(piece.length, THIN * end)
        centre, size = piece.offset[across], piece.half[across]
        reach = half if size is None else min(size, half)
        if piece.kind == "gas_cell":
            axes.add_patch(Rectangle((low, 1e3 * (centre - reach)), length, 2e3 * reach, facecolor=GAS, edgecolor="none", zorder=0.8))
        if piece.kind in FIELDS | DRIVES:
            colour = DRIVE if piece.kind in DRIVES else FIELD
            axes.add_patch(Rectangle((low, 1e3 * (centre - reach)), length, 2e3 * reach, facecolor=colour, edgecolor="none",
                                     zorder=1.2 if piece.kind in DRIVES else 1))
            if size is not None and size < half:
                _walls(axes, low, length, centre, size, half, GREY)
        elif piece.kind in PLATES and size is not None:
            _walls(axes, low, length, centre, size, half, INK)
        elif piece.kind == "beam_stop" and size is not None:
            axes.add_patch(Rectangle((low, 1e3 * (centre - size)), length, 2e3 * size, facecolor=INK, zorder=3))
        elif piece.kind in COUNTERS:
            axes.plot([low, low], [1e3 * (centre - reach), 1e3 * (centre + reach)], color=LAWS["quantum"][0],
                      linewidth=3 if piece.kind == "detector" else 1.2,
                      linestyle="-" if piece.kind == "detector" else (0, (2, 2)), zorder=3)
        elif piece.kind != "gas_cell":  # filters and the like: a plane
            axes.axvline(low, color=GREY, linewidth=1.2, linestyle=(0, (4, 2)), zorder=2)
    axes.axhline(0, color=GREY, linewidth=0.5, zorder=0.5)


def _walls(axes: Axes, low: float, length: float, centre: float, size: float, half: float, colour: str) -> None:
    for bottom, height in ((-half, centre - size + half), (centre + size, half - centre - size)):
        if height > 0:
            axes.add_patch(Rectangle((low, 1e3 * bottom), length, 1e3 * height, facecolor=colour, edgecolor="none", zorder=2.5))


def _draw_paths(axes: Axes, tracks: Tracks, across: str, half: float) -> None:
    """One colour for each fate, as strong as the share of the particle that is left."""
    index = "xyz".index(across)
    fates = list(dict.fromkeys(track.ending for track in tracks.tracks))
    colours = [LAWS["classical"][0], LAWS["dorado"][0], *(colour for colour, _ in OTHERS), GREY]
    fates.sort(key=lambda fate: not fate.startswith("detected"))
    if not fates[0].startswith("detected"):
        colours = colours[1:]
    shown = set()
    for track in tracks.tracks:
        fate = track.ending
        number = min(fates.index(fate), len(colours) - 1)
        label = None if number in shown else fate if number < len(colours) - 1 else "elsewhere"
        shown.add(number)
        few = np.unique(np.linspace(0, track.time.size - 1, min(track.time.size, MOST_RECORDS)).astype(int))
        y, across, weight = track.position[few, 1], 1e3 * track.position[few, index].clip(-2 * half, 2 * half), track.weight[few]
        edges = [0, *(np.flatnonzero(np.abs(np.diff(weight)) > SHARE) + 1), few.size]
        for first, behind in zip(edges, edges[1:]):  # what is left of it, from the last place of what was there before
            axes.plot(y[max(first - 1, 0):behind], across[max(first - 1, 0):behind], color=colours[number], linewidth=0.7,
                      alpha=0.8 * max(weight[first], PALEST), zorder=4, label=None if first else label, in_layout=False)


def _share_of_names(rows: int, height: float) -> float:
    """What rows of names take of the height of a picture [inches], against what is below."""
    taken = LETTER * style.scaled(8) / 72 * (rows + 0.6)
    return taken / max(PANELS * style.scaled(height) - taken, taken)


def _write_names(axes: Axes, pieces: list[Piece], end: float) -> int:
    """Names above their parts in rows, so that none lies over another; as many as that are."""
    axes.set_axis_off()
    letter = 0.0085 * WIDTH / axes.figure.get_figwidth() * end  # the width of one, near enough
    rows: list[float] = []
    placed = []
    for piece in pieces:
        words = ", ".join(filter(None, (piece.name, piece.words.replace("-", "−"))))
        middle = piece.begin + piece.length / 2
        begin = min(max(middle - len(words) * letter / 2, 0.0), end - len(words) * letter)
        row = next((i for i, taken in enumerate(rows) if taken < begin), len(rows))
        if row == len(rows):
            rows.append(0.0)
        rows[row] = begin + (len(words) + 1) * letter
        placed.append((middle, begin + len(words) * letter / 2, row, words))
    axes.set_ylim(-0.6, len(rows))
    for middle, at, row, words in placed:
        axes.text(at, row + 0.1, style.plain(words), ha="center", va="bottom", fontsize=style.scaled(8), zorder=3,
                  bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5})
        axes.plot([middle, at], [-0.6, row + 0.05], color=GREY, linewidth=0.5)
    return len(rows)

"""The pictures of the command line, each from its options; the figure is given back, not written."""
from __future__ import annotations

import argparse
import re
from argparse import ArgumentParser
from pathlib import Path
from typing import Sequence

import numpy as np
from matplotlib.figure import Figure

from . import (angle_plots, asked, field_plots, image_plots, level_plots, motion_plots, motions, profile_plots, results, scan_plots,
               space_plots, stated, style, tally_plots, track_plots, tracks, transit_plots)
from .curves import Curve, NoResonance, curves, labels_of
from .errors import InputError, as_keywords
from .files import open as read_any
from .hdf5 import IN_MEMORY, FileError
from .measured import read_measured
from .picture_options import OWN_OPTIONS, KeywordParser, add_options, asked_dots, asked_size, mark_of, points_of, words_of
from .regions import read_region
from .reports import require_detector
from .units import law_name, parse_quantity

MOST_CURVES = 8  # in one picture; a larger grid is drawn as a map
MOST_PANELS = 6
MOST_MAPS = 9


def arguments(verb: str, parser: ArgumentParser) -> None:
    """The options of one of these commands."""
    function = globals()[verb.replace("-", "_")]
    parser.set_defaults(command=function)
    parser.description = function.__doc__
    add_options(verb, parser)


def limited(figure: Figure, options: argparse.Namespace) -> Figure:
    """The figure with the ranges that are asked for, on all its panels. Raises InputError for one in which nothing is drawn."""
    bars = {image.colorbar.ax for axes in figure.axes for image in (*axes.images, *axes.collections) if image.colorbar}
    panels = [axes for axes in figure.axes if axes not in bars and axes.get_label() != image_plots.PROJECTED]
    for name in "xy":
        chosen = getattr(options, f"{name}_range", None)
        drawn = [sorted(getattr(axes.dataLim, f"interval{name}")) for axes in panels]
        if chosen is None or not drawn:
            continue
        if all(high < chosen[0] or low > chosen[1] for low, high in drawn):
            raise InputError(f"--{name}-range {chosen[0]:.10g}:{chosen[1]:.10g}: what is drawn lies from {min(low for low, _ in drawn):.6g} to "
                             f"{max(high for _, high in drawn):.6g}, as the axis writes it")
        for axes in panels:
            axes.set(**{f"{name}lim": chosen})
    return figure


def picture(opened: object, kind: str | None, output: Path | str | None, options: dict[str, object]) -> Figure:
    """As `plot_of`, with `dpi` among the options; written to `output` where that is given."""
    with as_keywords():
        dpi = asked_dots(options.pop("dpi", 200))
        figure = plot_of(opened, kind, options)
    if output is not None:
        style.save(figure, output, dpi)
    return figure


def plot_of(opened: object, kind: str | None = None, options: dict[str, object] | None = None) -> Figure:
    """The picture of what is open, with the options of `plot-KIND` as keywords: texts and numbers as on the command line, a range or a size
    also as a pair of numbers, the size in mm."""
    parser, options = KeywordParser(), dict(options or {})
    size = options.pop("size", None)
    verb = f"plot-{kind or _fitting_kind(opened)}"
    if verb not in OWN_OPTIONS:
        raise InputError(f"there is no picture `{kind}`: kind is {', '.join(one.removeprefix('plot-') for one in OWN_OPTIONS)}, or left out")
    drawn = motions.Motions if verb == "plot-motion" else tracks.Tracks if verb == "plot-tracks" else results.Results
    if verb == "plot-field" or not isinstance(opened, drawn):
        raise InputError(f"there is no picture `{kind}` of this" + (": `rabiline.load(...).trace().plot()` draws paths" if kind == "tracks" else
                         ": the command `rabiline probe` draws fields" if kind == "field" else ""))
    arguments(verb, parser)
    if verb == "plot-tally" and "name" not in options:
        there = ", ".join(getattr(opened, "tallies", {}))
        raise InputError(f"which tally? `name` is one of {there}" if there else "it has no tally")
    name = [str(options.pop("name"))] if verb == "plot-tally" else []
    frame = options.pop("data") if verb == "plot-scan" and not isinstance(options.get("data"), (str, Path, type(None))) else None
    fixed = ["FILE", *name, "-o", "none.png"]
    known = vars(parser.parse_args(fixed))
    if unknown := [key for key in options if key not in known]:
        raise InputError(f"{verb} has no option `{unknown[0]}`")
    chosen = parser.parse_args([*fixed, *(word for key, value in options.items() for word in words_of(key, value))])
    chosen.file, chosen.files = opened, [opened]
    chosen.data = getattr(chosen, "data", None) if frame is None else frame
    with style.here(asked_size(size)):
        return limited(chosen.command(chosen), chosen)


def _fitting_kind(opened: object) -> str:
    if isinstance(opened, results.Results):
        scan = opened.scan
        if not scan.axes:
            return "image" if scan.detected.any() else _kind_without_counts(opened)
        if all(axis.labels for axis in scan.axes) and scan.detected.shape[1] <= MOST_CURVES:  # such as a scan over the laws
            return "profiles"
        same = (np.ptp(scan.detected, axis=1) == 0).all()  # all that a scan does is to turn spins
        changing = any(np.nan_to_num(np.ptp(one.levels.fractions, axis=0)).max(initial=0.0) > 0.01 for one in opened.detectors.values())
        return "levels" if same and changing else "scan"
    return "tracks" if isinstance(opened, tracks.Tracks) else "motion"


def _kind_without_counts(file: results.Results) -> str:
    """Where nothing is scanned and nothing detected, so that an image would be empty. Raises InputError where no other picture is left."""
    try:
        angle_plots.angles_of(file, None, 0)
        return "angles"
    except angle_plots.NoAngles:
        tallies = f", and plot-tally what its tallies count ({', '.join(file.tallies)})" if file.tallies else ""
        raise InputError(f"{file.path}: nothing was detected in it, and nothing is scanned: plot-image would be empty\n"
                         f"  help: plot-tracks draws the paths that `rabiline trace` writes{tallies}") from None


def _results(source: object) -> results.Results:
    return source if isinstance(source, results.Results) else results.read(source)


def _read(source: object) -> object:
    """A file's content, whatever it holds; or what is open already."""
    return source if not isinstance(source, (str, Path)) else read_any(source)


def plot(options: argparse.Namespace) -> Figure:
    """The picture that fits a file: its scan, else its image, or the angles of spins where that is empty; its tracks; the motions of a model."""
    opened = _read(options.file)
    kind = _fitting_kind(opened)
    chosen: dict[str, object] = {"title": options.title} if options.title else {}
    if kind == "scan" and len(opened.scan.detectors) > 1 and len(curves(opened)) > MOST_CURVES:
        chosen["detector"] = opened.scan.detectors[0]
    if isinstance(opened, results.Results) and len(opened.scan.detectors) > 1 and (kind in ("image", "profiles") or "detector" in chosen):
        first, *others = opened.scan.detectors
        print(f"shown: {first}; `rabiline plot-{kind} {opened.path} --detector NAME` shows {' or '.join(others)}")
    return plot_of(opened, kind, chosen)


def plot_scan(options: argparse.Namespace) -> Figure:
    """Curves of one or several files in one picture."""
    files = [_results(path) for path in options.files]
    found = [(file, curve) for file in files for curve in _curves(file, options.detector)]
    first = found[0][1].axis
    for file, curve in found:
        if (curve.axis.parameter, curve.axis.labels) != (first.parameter, first.labels):
            raise InputError(f"{file.path}: its scan runs over {curve.axis.parameter}, the first one over "
                             f"{first.parameter}")
    if not options.beside:
        _require_one_measure(files, "draw them with --beside")
    own = _differences(files)
    labels = _distinct([stated.said(curve.label, own[file.path]) for file, curve in found], [file.path.stem for file, _ in found])
    chosen = f": {labels_of(files[0])[options.detector]}" if any(len(file.scan.detectors) > 1 for file in files) and options.detector else ""
    title = options.title or _title(files, chosen)
    marks = dict(mark_of(text, first.units) for text in options.mark)
    lines = [curve for _, curve in found]
    across = _across(files[0], first)
    if options.data is not None and (options.beside or len(lines) > MOST_CURVES):
        raise InputError("--data is drawn beside curves in one panel: leave out --beside, and of a map scan one parameter")
    if options.data is not None and options.detector is None and len({curve.detector for curve in lines}) > 1:
        raise InputError(f"--data: choose which of {', '.join(dict.fromkeys(curve.detector for curve in lines))} counted, with --detector")
    if options.panel_title and not options.beside:
        raise InputError("--panel-title names the panels of --beside")
    if options.beside:
        names = options.panel_title or _distinct([stated.said(file.title, own[file.path]) for file in files], [file.path.stem for file in files])
        if len(names) != len(files):
            raise InputError(f"{len(names)} --panel-title for {len(files)} files; give one for each file")
        panels = [_panel(file, name, [curve for of, curve in found if of is file]) for file, name in zip(files, names)]
        figure = scan_plots.draw_beside(panels, options.title or "", marks)
    elif len(lines) <= MOST_CURVES:
        figure = scan_plots.draw_scan(lines, labels, title, marks, read_measured(options.data, lines[0], options.detector) if options.data is not None else None)
    elif across and len(files) == len({curve.detector for curve in lines}) == 1 and len(lines) <= MOST_PANELS * across.values.size:
        figure = scan_plots.draw_maps(_grids(files[0], lines, across), across, title, marks)
    else:
        several = any(len(file.scan.detectors) > 1 for file in files) and options.detector is None
        choose = "; choose one detector with --detector" if several else ""
        raise InputError(f"{len(lines)} curves are too many for one picture{choose}")
    return figure


def _require_one_measure(files: Sequence[results.Results], instead: str) -> None:
    """Fractions of all that leave the source, or of what is aimed at its target, have one axis; not both."""
    wholes = [f"what {'leaves the source' if file.aimed_fraction is None else 'is aimed at the target'}" for file in files]
    for file, whole in zip(files, wholes):
        if whole != wholes[0]:
            raise InputError(f"{file.path}: has fractions of {whole}, {files[0].path} of {wholes[0]}: {instead}")


def _across(file: results.Results, along: results.Axis) -> results.Axis | None:
    """The other axis of numbers that has most of them: of a map."""
    others = [axis for axis in file.scan.axes if axis.parameter != along.parameter and not axis.labels]
    return max(others, key=lambda axis: axis.values.size, default=None)


def _grids(file: results.Results, lines: Sequence[Curve], across: results.Axis) -> list[list[Curve]]:
    """The curves of a scan over two axes or more, those that differ along `across` together."""
    others = [axis for axis in file.scan.axes if axis.parameter != lines[0].axis.parameter]
    number = next(i for i, axis in enumerate(others) if axis is across)
    order = np.moveaxis(np.arange(len(lines)).reshape([axis.values.size for axis in others]), number, -1)
    return [[lines[i] for i in row] for row in order.reshape(-1, across.values.size)]


def _panel(file: results.Results, title: str, lines: list[Curve]) -> scan_plots.Panel:
    return scan_plots.Panel(title, lines, _distinct([line.label for line in lines], [file.path.stem] * len(lines)))


def plot_levels(options: argparse.Namespace) -> Figure:
    """Populations of the spin levels at a detector, over the scan."""
    file = _results(options.file)
    rows = _curves(file, _detector(file, options.detector))
    detector = file.detectors[_detector(file, options.detector)]
    marks = dict(mark_of(text, rows[0].axis.units) for text in options.mark)
    title, levels = options.title or _title([file]), _levels(detector, options.levels)
    if len(rows) <= MOST_PANELS:
        return level_plots.draw_levels(rows, detector, title, marks, levels)
    across = _across(file, rows[0].axis)
    if across is None:
        raise InputError(f"{len(rows)} curves are too many for one picture")
    shown = range(len(detector.levels.labels)) if levels is None else levels
    maps = [grid for level in shown for grid in _grids(file, [level_plots.share_of(level, row, detector.levels) for row in rows], across)]
    if len(maps) > MOST_MAPS:
        raise InputError(f"{len(maps)} maps are too many for one picture: choose some of {', '.join(detector.levels.labels)} by --levels")
    return scan_plots.draw_maps(maps, across, title, marks, f"fraction of what {detector.label} detected")


def _levels(detector: results.Detector, names: str | None) -> list[int] | None:
    """By their names, however these are spaced."""
    if names is None:
        return None
    def bare(name: str) -> str:
        return re.sub(r"[ +]", "", name).replace("−", "-")

    known = {bare(label): i for i, label in enumerate(detector.levels.labels)}
    asked = [name.strip() for name in names.split(",")]
    missing = [name for name in asked if bare(name) not in known]
    if missing:
        there = ", ".join(style.level(label).replace("−", "-") for label in detector.levels.labels)
        raise InputError(f"--levels: no level `{missing[0]}`: there is {there}")
    return [known[bare(name)] for name in asked]


def plot_image(options: argparse.Namespace) -> Figure:
    """A detector's images off and on resonance."""
    file = _results(options.file)
    name = _detector(file, options.detector)
    if options.points:
        shots = [image_plots.shot_of(file, point) for point in points_of(options.points, len(file.laws))]
    elif file.scan.axes:
        shots = image_plots.off_and_on(file, curves(file, name))
    else:
        shots = [image_plots.shot_of(file, 0)]
    return image_plots.draw_images(file, file.detectors[name], shots, options.title)


def plot_profiles(options: argparse.Namespace) -> Figure:
    """Profiles on a detector, of all scan points of one or several files, in one picture."""
    files = [_results(path) for path in options.files]
    _require_one_measure(files, "draw each by itself")
    shots = [(file, point) for file in files
             for point in (points_of(options.points, len(file.laws)) if options.points else range(len(file.laws)))]
    if len(shots) > MOST_CURVES:
        raise InputError(f"{len(shots)} profiles are too many for one picture: choose some by --points, such as 0,{len(shots) // 2}")
    own = _differences(files)
    heading, labels = stated.what_differs([{**image_plots.about(file, point), **own[file.path]} for file, point in shots])
    if not any(labels):
        labels = [law_name(file.laws[point]) for file, point in shots]
    labels = _distinct(labels, [file.path.stem for file, _ in shots])
    profiles = [profile_plots.profile_of(file, _detector(file, options.detector), point, options.along, label)
                for (file, point), label in zip(shots, labels)]
    chosen = f": {labels_of(files[0])[_detector(files[0], options.detector)]}" if len(files[0].scan.detectors) > 1 else ""
    return profile_plots.draw_profiles(profiles, options.along, options.title or f"{files[0].title}{chosen}", heading)


def plot_tally(options: argparse.Namespace) -> Figure:
    """A tally of a monitor or a detector, over one or two of its axes."""
    file = _results(options.file)
    if options.name not in file.tallies:
        meant = asked.near(options.name, file.tallies)
        there = f"there is {', '.join(file.tallies)}{f'; did you mean `{meant}`?' if meant else ''}" if file.tallies else "it has none"
        raise InputError(f"{file.path}: no tally `{options.name}` ({there})")
    tally = file.tallies[options.name]
    names = [axis.name for axis in tally.axes]
    chosen = options.axes.split(",") if options.axes else names[:2]
    if not set(chosen) <= set(names) or len(chosen) not in (1, 2) or len(set(chosen)) != len(chosen):
        raise InputError(f"--axes {options.axes}: name one or two of {', '.join(names)}")
    if options.points == "all":
        if not file.scan.axes:
            raise InputError(f"{file.path}: nothing is scanned in this file")
        along = max(range(len(file.scan.axes)), key=lambda i: file.scan.axes[i].values.size)
        return tally_plots.draw_over_scan(file, tally, names.index(chosen[0] if options.axes else names[-1]), along, options.title)
    points = points_of(options.points, len(file.laws)) if options.points else [0]
    if len(points) > MOST_PANELS:
        raise InputError(f"{len(points)} scan points are too many for one picture")
    return tally_plots.draw_tally(file, tally, [names.index(name) for name in chosen], points, options.title)


def plot_angles(options: argparse.Namespace) -> Figure:
    """Polar angle and azimuth of the spin along the planes of a monitor, with straight lines fitted to them."""
    file = _results(options.file)
    if not 0 <= options.point < len(file.laws):
        raise InputError(f"--point {options.point}: the scan points are 0 to {len(file.laws) - 1}")
    try:
        angles = angle_plots.angles_of(file, options.monitor, options.point)
    except angle_plots.NoAngles as problem:
        raise InputError(f"{file.path}: {problem}") from problem
    try:
        expected = [parse_quantity(text, "Hz") if text else None for text in (options.polar_rate, options.azimuth_rate)]
    except ValueError as problem:
        raise InputError(f"a rate is written like `2.9 kHz`: {problem}") from problem
    for line in angles:
        print(line)
    return angle_plots.draw_angles(file, angles, expected, options.point, options.title)


def plot_transit(options: argparse.Namespace) -> Figure:
    """Times of flight to a detector, by the levels before and behind the fields that turn spins."""
    file = _results(options.file)
    name = _detector(file, options.detector)
    transits = file.detectors[name].transits
    if not transits:
        raise InputError(f"{file.path}: has no times of flight to `{name}`: they are kept where a scan follows from "
                         "moments of the slowness; a tally of the time_of_flight has them always")
    if not 1 <= options.species <= len(transits):
        raise InputError(f"--species {options.species}: there are 1 to {len(transits)}")
    transit = transits[options.species - 1]
    return transit_plots.draw_transit(transit, file.emitted[0], options.title or transit.title)


def plot_tracks(options: argparse.Namespace) -> Figure:
    """Paths of single particles."""
    files = [path if isinstance(path, tracks.Tracks) else tracks.read(path) for path in options.files]
    own = _differences(files)
    labels = _distinct([stated.said(law_name(file.law), own[file.path]) for file in files], [file.path.stem for file in files])
    regions = [read_region(text) for text in options.region]
    title = options.title or files[0].title
    draw = space_plots.draw_paths if options.in_space else track_plots.draw_tracks
    return draw(files, labels, title, regions)


def plot_motion(options: argparse.Namespace) -> Figure:
    """Motions of a model, or its findings over a scan."""
    file = options.file if isinstance(options.file, motions.Motions) else motions.read(options.file)
    title = options.title or file.title
    if file.axis is not None and options.point is None:
        return motion_plots.draw_findings(file, title)
    point = options.point or 0
    if not 0 <= point < len(file.points):
        raise InputError(f"--point {point}: the scan points are 0 to {len(file.points) - 1}")
    return motion_plots.draw_motions(file.points[point], title)


def _detector(file: results.Results, name: str | None) -> str:
    return file.scan.detectors[0] if name is None else require_detector(file, name)


def _curves(file: results.Results, detector: str | None) -> list[Curve]:
    try:
        return curves(file, None if detector is None else _detector(file, detector))
    except NoResonance as problem:
        raise FileError(file.path, str(problem)) from None


def _title(files: list[results.Results], chosen: str = "") -> str:
    """The first file's title, with what was chosen; and what the beam consists of, where that is a mixture."""
    species = dict.fromkeys(name for file in files for name in file.species)
    mixture = list(species) if len(species) == 1 and " + " in next(iter(species)) else []
    return "\n".join([files[0].title + chosen, *mixture])


def _differences(files: Sequence[results.Results | tracks.Tracks]) -> dict[Path, dict[str, str]]:
    """What tells each of several files from the others."""
    paths = list(dict.fromkeys(file.path for file in files))
    return dict(zip(paths, stated.differing(paths) if len(paths) > 1 else [{}]))


def _distinct(labels: list[str], stems: list[str]) -> list[str]:
    """Labels, with the file's name where there is none of several, or it would come twice."""
    stems = ["" if len(labels) == 1 and not labels[0] or len(set(stems)) == 1 and stem == IN_MEMORY.stem else stem for stem in stems]
    return [label if label and labels.count(label) == 1 else f"{label} [{stem}]" if label and stem else label or stem
            for label, stem in zip(labels, stems)]


def plot_field(options: argparse.Namespace) -> Figure:
    """B along a line, from the table of `rabiline probe --along`."""
    regions = [read_region(text) for text in options.region]
    return field_plots.draw_field(field_plots.read_field(options.file), options.title or options.file.stem, regions)

"""The command line: `python3 -m rabiline plot-scan | plot-levels | plot-image | plot-profiles | plot-tally |
plot-angles | plot-transit | plot-tracks | plot-motion | plot-field | summary | compare-scans | compare-laws | bound-kappa`.

Exit codes: 0 done; 2 bad input or arguments, with one line on stderr; 3 the picture could not be written.
"""
from __future__ import annotations

import argparse
import sys
from math import inf
from pathlib import Path
from typing import NoReturn, Sequence

from matplotlib.figure import Figure

from . import (angle_plots, field_plots, image_plots, laws_commands, level_plots, motion_plots, motions, profile_plots, results,
               scan_plots, space_plots, style, tally_plots, track_plots, tracks, transit_plots)
from .agreement import NotComparable, compare, same_particles
from .curves import Curve, NoResonance, curves
from .hdf5 import FileError
from .motion_report import motion_summary
from .report import summary
from .units import law_name, parse_quantity


MOST_CURVES = 8  # in one picture; a larger grid is drawn as a map
MOST_PANELS = 6


class InputError(Exception):
    """Something wrong with what was asked for."""


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"rabiline: {message} (see --help)\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command; returns the exit code."""
    options = _parser().parse_args(arguments)
    try:
        options.command(options)
    except (FileError, InputError, NoResonance, NotComparable, *laws_commands.BAD_INPUT) as problem:
        print(f"rabiline: {problem}", file=sys.stderr)
        return 2
    except OSError as problem:
        print(f"rabiline: {problem}", file=sys.stderr)
        return 3
    return 0


def plot_scan(options: argparse.Namespace) -> None:
    """Curves of one or several files in one picture."""
    files = [results.read(path) for path in options.files]
    found = [(file, curve) for file in files for curve in _curves(file, options.detector)]
    first = found[0][1].axis
    for file, curve in found:
        if (curve.axis.parameter, curve.axis.labels) != (first.parameter, first.labels):
            raise InputError(f"{file.path}: its scan runs over {curve.axis.parameter}, the first one over "
                             f"{first.parameter}")
    labels = _distinct([curve.label for _, curve in found], [file.path.stem for file, _ in found])
    chosen = f": {options.detector}" if any(len(file.scan.detectors) > 1 for file in files) and options.detector else ""
    title = options.title or _title(files, chosen)
    marks = dict(_mark(text) for text in options.mark)
    lines = [curve for _, curve in found]
    across = [axis for axis in files[0].scan.axes if axis.parameter != first.parameter and not axis.labels]
    if options.panel_title and not options.beside:
        raise InputError("--panel-title names the panels of --beside")
    if options.beside:
        names = options.panel_title or [file.title for file in files]
        if len(names) != len(files):
            raise InputError(f"{len(names)} --panel-title for {len(files)} files; give one for each file")
        panels = [_panel(file, name, [curve for of, curve in found if of is file]) for file, name in zip(files, names)]
        figure = scan_plots.draw_beside(panels, options.title or "", marks)
    elif len(lines) <= MOST_CURVES:
        figure = scan_plots.draw_scan(lines, labels, title, marks)
    elif across and len(files) == len({curve.detector for curve in lines}) == 1:
        figure = scan_plots.draw_map(lines, across[0], title, marks)
    else:
        several = any(len(file.scan.detectors) > 1 for file in files) and options.detector is None
        choose = "; choose one detector with --detector" if several else ""
        raise InputError(f"{len(lines)} curves are too many for one picture{choose}")
    _save(figure, options.output)


def _panel(file: results.Results, title: str, lines: list[Curve]) -> scan_plots.Panel:
    return scan_plots.Panel(title, lines, _distinct([line.label for line in lines], [file.path.stem] * len(lines)))


def plot_levels(options: argparse.Namespace) -> None:
    """Populations of the spin levels at a detector, over the scan."""
    file = results.read(options.file)
    rows = _curves(file, _detector(file, options.detector))
    if len(rows) > MOST_PANELS:
        raise InputError(f"{len(rows)} curves are too many for one picture")
    detector = file.detectors[_detector(file, options.detector)]
    marks = dict(_mark(text) for text in options.mark)
    _save(level_plots.draw_levels(rows, detector, options.title or _title([file]), marks), options.output)


def plot_image(options: argparse.Namespace) -> None:
    """A detector's images off and on resonance."""
    file = results.read(options.file)
    name = _detector(file, options.detector)
    if options.points:
        shots = [image_plots.shot_of(file, point) for point in _points(options.points, len(file.laws))]
    elif file.scan.axes:
        shots = image_plots.off_and_on(file, curves(file, name))
    else:
        shots = [image_plots.shot_of(file, 0)]
    _save(image_plots.draw_images(file, file.detectors[name], shots), options.output)


def plot_profiles(options: argparse.Namespace) -> None:
    """Profiles on a detector, of all scan points of one or several files, in one picture."""
    files = [results.read(path) for path in options.files]
    shots = [(file, point) for file in files for point in range(len(file.laws))]
    if len(shots) > MOST_CURVES:
        raise InputError(f"{len(shots)} profiles are too many for one picture")
    about = [", ".join(filter(None, (law_name(file.laws[point]), file.species[point],
                                     image_plots.shot_of(file, point).heading if _scans_values(file) else "")))
             for file, point in shots]
    labels = _distinct(about, [file.path.stem for file, _ in shots])
    profiles = [profile_plots.profile_of(file, _detector(file, options.detector), point, options.along, label)
                for (file, point), label in zip(shots, labels)]
    _save(profile_plots.draw_profiles(profiles, options.along, options.title or files[0].title), options.output)


def plot_tally(options: argparse.Namespace) -> None:
    """A tally of a monitor or a detector, over one or two of its axes."""
    file = results.read(options.file)
    if options.name not in file.tallies:
        there = f"there is {', '.join(file.tallies)}" if file.tallies else "it has none"
        raise InputError(f"{file.path}: no tally `{options.name}` ({there})")
    tally = file.tallies[options.name]
    names = [axis.name for axis in tally.axes]
    chosen = options.axes.split(",") if options.axes else names[:2]
    if not set(chosen) <= set(names) or len(chosen) not in (1, 2) or len(set(chosen)) != len(chosen):
        raise InputError(f"--axes {options.axes}: name one or two of {', '.join(names)}")
    points = _points(options.points, len(file.laws)) if options.points else [0]
    if len(points) > MOST_PANELS:
        raise InputError(f"{len(points)} scan points are too many for one picture")
    _save(tally_plots.draw_tally(file, tally, [names.index(name) for name in chosen], points), options.output)


def plot_angles(options: argparse.Namespace) -> None:
    """Polar angle and azimuth of the spin along the planes of a monitor, with straight lines fitted to them."""
    file = results.read(options.file)
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
    _save(angle_plots.draw_angles(file, angles, expected, options.point), options.output)


def plot_transit(options: argparse.Namespace) -> None:
    """Times of flight to a detector, by the levels before and behind the fields that turn spins."""
    file = results.read(options.file)
    name = _detector(file, options.detector)
    transits = file.detectors[name].transits
    if not transits:
        raise InputError(f"{file.path}: has no times of flight to `{name}`: they are kept where a scan follows from "
                         "moments of the slowness, or with `rabiline run --transit totals`")
    if not 1 <= options.species <= len(transits):
        raise InputError(f"--species {options.species}: there are 1 to {len(transits)}")
    transit = transits[options.species - 1]
    _save(transit_plots.draw_transit(transit, file.emitted[0], options.title or transit.title), options.output)


def plot_tracks(options: argparse.Namespace) -> None:
    """Paths of single particles."""
    files = [tracks.read(path) for path in options.files]
    labels = _distinct([law_name(file.law) for file in files], [file.path.stem for file in files])
    regions = [_region(text) for text in options.region]
    title = options.title or files[0].title
    draw = space_plots.draw_paths if options.in_space else track_plots.draw_tracks
    _save(draw(files, labels, title, regions), options.output)


def plot_motion(options: argparse.Namespace) -> None:
    """Motions of a model, or its findings over a scan."""
    file = motions.read(options.file)
    title = options.title or file.title
    if file.axis is not None and options.point is None:
        _save(motion_plots.draw_findings(file, title), options.output)
        return
    point = options.point or 0
    if not 0 <= point < len(file.points):
        raise InputError(f"--point {point}: the scan points are 0 to {len(file.points) - 1}")
    _save(motion_plots.draw_motions(file.points[point], title), options.output)


def plot_field(options: argparse.Namespace) -> None:
    """B along a line, from the table of `rabiline probe --along`."""
    line = field_plots.read_field(options.file)
    _save(field_plots.draw_field(line, options.title or options.file.stem), options.output)


def print_summary(options: argparse.Namespace) -> None:
    """What a file holds, in words."""
    if motions.has_motions(options.file):
        if options.detector:
            raise InputError(f"{options.file}: holds the motions of a model, and no detector")
        print(motion_summary(motions.read(options.file)))
        return
    file = results.read(options.file)
    print(summary(file, [_detector(file, options.detector)] if options.detector else file.scan.detectors))


def compare_scans(options: argparse.Namespace) -> None:
    """chi² of the difference between two results of one scan that differ in their seed, with the covariance."""
    one, other = (results.read(path) for path in (options.file, options.other))
    name = options.detector
    wanted = [_detector(file, name) for file in (one, other)] if name else one.scan.detectors
    agreements = compare(one, other)
    if same_particles(one, other):
        print(f"rabiline: warning: both files have the seed {one.simulation['seed']} and may share their particles; "
              "their difference then varies less than the errors say, and chi² and p mean nothing", file=sys.stderr)
    for detector in dict.fromkeys(wanted):
        print(f"{detector}: {agreements[detector]}")


def _parser() -> Parser:
    parser = Parser(prog="rabiline", description="Pictures and figures from rabiline's HDF5 files.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def command(name: str, function: object, many: bool, draws: bool = True) -> Parser:
        made = commands.add_parser(name, help=function.__doc__, description=function.__doc__)
        made.set_defaults(command=function)
        made.add_argument("files" if many else "file", metavar="FILE", type=Path, nargs="+" if many else None)
        if draws:
            made.add_argument("-o", "--output", required=True, type=Path, metavar="PNG", help="PNG, PDF or SVG")
        return made

    scan = command("plot-scan", plot_scan, many=True)
    scan.add_argument("--beside", action="store_true", help="a panel for each file, side by side")
    scan.add_argument("--panel-title", action="append", default=[], metavar="TEXT",
                      help="above a panel of --beside instead of the file's title; repeated, one for each file")
    levels = command("plot-levels", plot_levels, many=False)
    for plot in (scan, levels):
        plot.add_argument("--mark", action="append", default=[], metavar="LABEL=VALUE",
                          help='points out a value: "Larmor frequency=291.647 kHz"')
    image = command("plot-image", plot_image, many=False)
    image.add_argument("--points", metavar="I,J", help="flat numbers of the scan points to show; else the scan's edge "
                                                        "and the middle of its deepest dip or peak")
    profiles = command("plot-profiles", plot_profiles, many=True)
    profiles.add_argument("--along", choices=("x", "z"), default="z", help="axis of the detector; z by default")
    tally = command("plot-tally", plot_tally, many=False)
    tally.add_argument("name", metavar="NAME", help="PART_TALLY, as `summary` lists them")
    tally.add_argument("--axes", metavar="A,B",
                       help="one or two of its axes; the first ones by default, the others are summed over")
    tally.add_argument("--points", metavar="I,J", help="flat numbers of the scan points to show; the first by default")
    spins = command("plot-angles", plot_angles, many=False)
    spins.add_argument("--monitor", metavar="NAME", help="the first one that has such tallies by default")
    spins.add_argument("--point", metavar="I", type=int, default=0, help="flat number of the scan point; 0 by default")
    spins.add_argument("--polar-rate", metavar="RATE",
                       help='expected, drawn beside the fit: "-140 Hz" (turns per second)')
    spins.add_argument("--azimuth-rate", metavar="RATE", help='expected: "2.91646935 kHz"')
    transit = command("plot-transit", plot_transit, many=False)
    transit.add_argument("--species", metavar="I", type=int, default=1, help="which of the beam; 1 by default")
    flights = command("plot-tracks", plot_tracks, many=True)
    flights.add_argument("--region", action="append", default=[], metavar="NAME=BEGIN:END",
                         help='shades a field: "B=0.30:0.55" (m)')
    flights.add_argument("--in-space", action="store_true", help="in three dimensions")
    motion = command("plot-motion", plot_motion, many=False)
    field = command("plot-field", plot_field, many=False)
    motion.add_argument("--point", metavar="I", type=int, help="of a scan: the motions at this point, not the findings")
    report = command("summary", print_summary, many=False, draws=False)
    pair = command("compare-scans", compare_scans, many=False, draws=False)
    pair.add_argument("other", metavar="OTHER", type=Path)
    laws_commands.add(commands)
    for one in (levels, image, profiles, transit):
        one.add_argument("--detector", metavar="NAME", help="the first one by default")
    for each in (scan, report, pair):
        each.add_argument("--detector", metavar="NAME", help="all by default")
    for plot in (scan, levels, profiles, transit, flights, motion, field):
        plot.add_argument("--title", help="instead of the file's own")
    return parser


def _detector(file: results.Results, name: str | None) -> str:
    if name is not None and name not in file.detectors:
        raise InputError(f"{file.path}: no detector `{name}` (there is {', '.join(file.detectors)})")
    return name or file.scan.detectors[0]


def _scans_values(file: results.Results) -> bool:
    return any(axis.parameter != "law" for axis in file.scan.axes)


def _curves(file: results.Results, detector: str | None) -> list[Curve]:
    try:
        return curves(file, detector and _detector(file, detector))
    except NoResonance as problem:
        raise FileError(file.path, str(problem)) from None


def _title(files: list[results.Results], chosen: str = "") -> str:
    """The first file's title, with what was chosen; and what the beam consists of, where that is a mixture."""
    species = dict.fromkeys(name for file in files for name in file.species)
    mixture = list(species) if len(species) == 1 and " + " in next(iter(species)) else []
    return "\n".join([files[0].title + chosen, *mixture])


def _distinct(labels: list[str], stems: list[str]) -> list[str]:
    """Labels, with the file's name where there is none or it would come twice."""
    return [label if label and labels.count(label) == 1 else f"{label} [{stem}]" if label else stem
            for label, stem in zip(labels, stems)]


def _mark(text: str) -> tuple[str, float]:
    label, equals, value = text.rpartition("=")
    try:
        if not (equals and label):
            raise ValueError("no label")
        return label, parse_quantity(value)
    except ValueError:
        raise InputError(f'--mark "{text}" is not LABEL=VALUE, such as "Larmor frequency=291.647 kHz"') from None


def _points(text: str, points: int) -> list[int]:
    try:
        numbers = [int(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"--points {text} is not a list of numbers, such as 0,50") from None
    if not all(0 <= number < points for number in numbers):
        raise InputError(f"--points {text}: the scan points are 0 to {points - 1}")
    return numbers


def _region(text: str) -> track_plots.Region:
    name, _, stretch = text.rpartition("=")
    begin, _, end = stretch.partition(":")
    try:
        region = track_plots.Region(name, float(begin), float(end))
        if not (name and -inf < region.begin < region.end < inf):
            raise ValueError("empty")
        return region
    except ValueError:
        raise InputError(f'--region "{text}" is not NAME=BEGIN:END in metres, such as "B=0.30:0.55"') from None


def _save(figure: Figure, path: Path) -> None:
    if not path.suffix:  # else matplotlib would choose another name
        raise InputError(f"-o {path}: a picture's name ends in .png, .pdf or .svg")
    try:
        style.save(figure, path)
    except ValueError as problem:  # an ending that matplotlib does not know
        raise InputError(f"{path}: {problem}") from None


if __name__ == "__main__":
    sys.exit(main())

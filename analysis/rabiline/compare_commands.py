"""The commands compare and compare-scans: two results of one scan."""
from __future__ import annotations

import argparse
import sys
from argparse import ArgumentParser
from pathlib import Path

from matplotlib.figure import Figure

from . import results
from .agreement import compare, same_particles
from .argument_types import heading
from .errors import InputError
from .reports import require_detector


def arguments(verb: str, parser: ArgumentParser) -> None:
    """The options of both."""
    parser.set_defaults(command=compare_scans)
    parser.description = compare_scans.__doc__
    parser.add_argument("file", metavar="FILE", type=Path)
    parser.add_argument("other", metavar="OTHER", type=Path)
    parser.add_argument("--detector", metavar="NAME", help="all by default; of the picture, the first one")
    parser.add_argument("-o", "--output", type=Path, metavar="PNG", help="a picture of both, and of their difference over its error")
    parser.add_argument("--title", type=heading, help="of the picture, instead of the file's own")


def compare_scans(options: argparse.Namespace) -> Figure | None:
    """chi² of the difference between two results of one scan that differ in their seed, with the covariance."""
    one, other = (results.read(path) for path in (options.file, options.other))
    if options.detector:
        for file in (one, other):
            require_detector(file, options.detector)
    wanted = [options.detector] if options.detector else one.scan.detectors
    agreements = {detector: str(agreement) for detector, agreement in compare(one, other).items()}
    if same_particles(one, other):
        print(f"rabiline: warning: both files have the seed {one.simulation['seed']} and may share their particles; "
              "their difference then varies less than the errors say, and chi² and p mean nothing", file=sys.stderr)
        agreements = {detector: f"{agreement}; of shared particles, which makes it no verdict" for detector, agreement in agreements.items()}
    for detector in wanted:
        print(f"{detector}: {agreements[detector]}")
    if not options.output:
        return None
    if not one.scan.axes:
        raise InputError(f"{one.path}: nothing is scanned in it that a picture could show")
    from .compare_plots import draw_difference
    return draw_difference(one, other, wanted[0], options.title, agreements[wanted[0]])

"""The commands summary and export."""
from __future__ import annotations

import argparse
import json
import sys
from argparse import ArgumentParser
from pathlib import Path

from . import results, tables
from .errors import InputError
from .files import open as read_any
from .motion_report import motion_numbers, motion_summary
from .motions import Motions
from .report import summary, summary_numbers
from .track_report import track_numbers, track_summary
from .tracks import Tracks


def arguments(verb: str, parser: ArgumentParser) -> None:
    """The options of one of these commands."""
    function = {"summary": print_summary, "export": export}[verb]
    parser.set_defaults(command=function)
    parser.description = function.__doc__
    parser.add_argument("file", metavar="FILE", type=Path)
    if function is export:
        parser.add_argument("-o", "--output", type=Path, metavar="CSV", help="printed where it is missing")
        return
    parser.add_argument("--detector", metavar="NAME", help="all by default")
    parser.add_argument("--json", action="store_true", help="the numbers as JSON")


def print_summary(options: argparse.Namespace) -> None:
    """What a file holds, in words."""
    file = read_any(options.file)
    for kind, what, in_words, numbers in ((Motions, "the motions of a model", motion_summary, motion_numbers),
                                          (Tracks, "the paths of single particles", track_summary, track_numbers)):
        if isinstance(file, kind):
            if options.detector:
                raise InputError(f"{options.file}: holds {what}, and no detector")
            print(json.dumps(numbers(file), indent=1) if options.json else in_words(file))
            return
    detectors = [require_detector(file, options.detector)] if options.detector else file.scan.detectors
    print(json.dumps(summary_numbers(file, detectors), indent=1) if options.json else summary(file, detectors))


def export(options: argparse.Namespace) -> None:
    """The numbers of a scan as CSV: a line for each scan point of each detector, with the populations of its levels, or of a model; of paths
    a line for each of their records. In SI, with the units in the header in []."""
    file = read_any(options.file)
    try:
        tables.to_csv(file, options.output or sys.stdout)
    except InputError as problem:
        raise InputError(f"--output: {problem}") from None


def require_detector(file: results.Results, name: str) -> str:
    """The name; raises InputError where there is no such detector."""
    if name not in file.detectors:
        raise InputError(f"{file.path}: no detector `{name}` (there is {', '.join(file.detectors)})")
    return name

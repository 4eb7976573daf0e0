"""The commands summary, export and compare."""
from __future__ import annotations

import argparse
import json
import sys
from argparse import ArgumentParser
from pathlib import Path

from . import motions, results, tables
from .agreement import compare, same_particles
from .errors import InputError
from .motion_report import motion_summary
from .report import summary, summary_numbers


def arguments(verb: str, parser: ArgumentParser) -> None:
    """The options of one of these commands."""
    function = {"summary": print_summary, "export": export}.get(verb, compare_scans)
    parser.set_defaults(command=function)
    parser.description = function.__doc__
    parser.add_argument("file", metavar="FILE", type=Path)
    if function is compare_scans:
        parser.add_argument("other", metavar="OTHER", type=Path)
    if function is export:
        parser.add_argument("-o", "--output", type=Path, metavar="CSV", help="printed where it is missing")
        return
    parser.add_argument("--detector", metavar="NAME", help="all by default")
    if function is print_summary:
        parser.add_argument("--json", action="store_true", help="the numbers as JSON")


def print_summary(options: argparse.Namespace) -> None:
    """What a file holds, in words."""
    if motions.has_motions(options.file):
        if options.detector or options.json:
            raise InputError(f"{options.file}: holds the motions of a model, and no detector")
        print(motion_summary(motions.read(options.file)))
        return
    file = results.read(options.file)
    detectors = [_detector(file, options.detector)] if options.detector else file.scan.detectors
    print(json.dumps(summary_numbers(file, detectors), indent=1) if options.json else summary(file, detectors))


def export(options: argparse.Namespace) -> None:
    """The numbers of a scan as CSV: a line for each scan point of each detector, in SI, with the units in the header. Raises InputError where the
    output is not for a table."""
    file = results.read(options.file)
    try:
        tables.to_csv(file, options.output or sys.stdout)
    except InputError as problem:
        raise InputError(f"--output: {problem}") from None


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


def _detector(file: results.Results, name: str) -> str:
    if name not in file.detectors:
        raise InputError(f"{file.path}: no detector `{name}` (there is {', '.join(file.detectors)})")
    return name

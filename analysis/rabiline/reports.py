"""The commands summary and export."""
from __future__ import annotations

import argparse
import json
import sys
from argparse import ArgumentParser
from pathlib import Path

from . import motions, results, tables
from .errors import InputError
from .motion_report import motion_numbers, motion_summary
from .report import summary, summary_numbers


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
    if motions.has_motions(options.file):
        if options.detector:
            raise InputError(f"{options.file}: holds the motions of a model, and no detector")
        solved = motions.read(options.file)
        print(json.dumps(motion_numbers(solved), indent=1) if options.json else motion_summary(solved))
        return
    file = results.read(options.file)
    detectors = [require_detector(file, options.detector)] if options.detector else file.scan.detectors
    print(json.dumps(summary_numbers(file, detectors), indent=1) if options.json else summary(file, detectors))


def export(options: argparse.Namespace) -> None:
    """The numbers of a scan as CSV: a line for each scan point of each detector, with the populations of its levels, or of a model, in SI, with the
    units in the header in []."""
    file = motions.read(options.file) if motions.has_motions(options.file) else results.read(options.file)
    try:
        tables.to_csv(file, options.output or sys.stdout)
    except InputError as problem:
        raise InputError(f"--output: {problem}") from None


def require_detector(file: results.Results, name: str) -> str:
    """The name; raises InputError where there is no such detector."""
    if name not in file.detectors:
        raise InputError(f"{file.path}: no detector `{name}` (there is {', '.join(file.detectors)})")
    return name

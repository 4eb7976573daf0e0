"""The command fit-line."""
from __future__ import annotations

import argparse
from argparse import ArgumentParser
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from . import results
from .argument_types import count
from .counts import read_counts
from .covariance import LEAST_P, p_in_words
from .curves import Curve, curves
from .errors import InputError
from .hdf5 import is_hdf5
from .lines import FORMS, LineFit, fit_line, ramsey_over
from .units import base_of, format_value, parse_quantity

PLANCK = 6.62607015e-34  # J s
MAGNETONS = {"nuclear magnetons": 5.0507837393e-27, "Bohr magnetons": 9.2740100657e-24}  # J/T, CODATA 2022
UNKNOWN = 10  # times itself: an error that leaves nothing
UNITS = {"centre": 1, "width": 1, "strength": 1, "time": -1, "pulse": -1}  # powers of the axis' unit


def arguments(parser: ArgumentParser) -> None:
    """Its options."""
    parser.set_defaults(command=fit_a_line)
    parser.description = fit_a_line.__doc__
    parser.add_argument("file", metavar="FILE", type=Path, help="a result (HDF5), or measured counts (CSV)")
    parser.add_argument("--form", choices=[*FORMS], default="rabi",
                        help="rabi by default; ramsey is averaged over the times of flight that a result keeps")
    parser.add_argument("--lines", type=count, default=1, metavar="N", help="how many, alike but for centre and contrast")
    parser.add_argument("--start", action="append", default=[], metavar="NAME=VALUE", help="where a parameter starts, in SI")
    known = parser.add_mutually_exclusive_group()
    known.add_argument("--per-field", metavar="RATE", help='turns the centres into fields: "29.1646935 MHz/T"')
    known.add_argument("--field", metavar="B", help='turns the centres into moments and g factors: "10 mT"')
    parser.add_argument("--detector", metavar="NAME")
    parser.add_argument("--title")
    parser.add_argument("-o", "--output", type=Path, metavar="PNG")


def fit_a_line(options: argparse.Namespace) -> Figure | None:
    """A closed form of a line fitted to a result or to measured counts: centre, width, contrast."""
    try:
        start = {name: float(value) for name, _, value in (text.partition("=") for text in options.start)}
    except ValueError:
        raise InputError("--start is NAME=VALUE, a number in SI") from None
    form: object = options.form
    if is_hdf5(options.file):
        file = results.read(options.file)
        found = curves(file, options.detector)
        if len(found) != 1:
            raise InputError(f"{options.file}: {len(found)} curves: choose one with --detector, or scan one parameter")
        curve: Curve = found[0]
        x, y, covariance, unit, name, title = curve.x, curve.y, curve.covariance, curve.axis.units, curve.axis.parameter, file.title
        transits = file.detectors[curve.detector].transits
        if options.form == "ramsey" and transits:
            edges, caught = transits[0].edges, transits[0].caught.sum(axis=0)
            form = ramsey_over((edges[:-1] + edges[1:])[caught > 0] / 2, caught[caught > 0])
    else:
        counts = read_counts(options.file, options.detector)
        unit, factor = base_of(counts.unit)
        x, y, name, title = factor * counts.x, counts.counts, counts.parameter, options.file.name
        covariance = np.diag(np.maximum(y, 1.0))
    fitted = fit_line(x, y, covariance, form, lines=options.lines, start=start)
    words = [*described(fitted, unit), *derived(fitted, unit, options.per_field, options.field)]
    print("\n".join(words))
    if not options.output:
        return None
    from .line_plots import draw_line
    return draw_line(x, y, np.sqrt(np.diag(covariance)), fitted, name, unit, options.title or title, words)


def derived(fitted: LineFit, unit: str, per_field: str | None, field: str | None) -> list[str]:
    """What the centres mean, with the covariance of the fit: distances between them, fields, moments and g factors."""
    centres = [i for i, name in enumerate(fitted.names) if name.startswith("centre")]
    lines = []
    for i, j in zip(centres, centres[1:]):
        variance = fitted.covariance[i, i] + fitted.covariance[j, j] - 2 * fitted.covariance[i, j]
        between = f"{fitted.names[j]} - {fitted.names[i]}"
        lines.append(f"{between:<10} {format_value(fitted.values[j] - fitted.values[i], unit, float(np.sqrt(max(variance, 0))))}")
    if (per_field or field) and unit != "Hz":
        raise InputError("--field and --per-field are for scans over a frequency")
    for i in centres:
        value, error = float(fitted.values[i]), float(fitted.errors[i])
        which = fitted.names[i].replace("centre", "")
        if per_field:
            rate = _rate(per_field)
            lines.append(f"{'field' + which:<10} {format_value(value / rate, 'T', abs(error / rate))}")
        if field:
            known = _quantity("--field", field, "T")
            lines.append(f"{'moment' + which:<10} {format_value(value / known, 'Hz/T', abs(error / known))} times h")
            for name, magneton in MAGNETONS.items():
                g, g_error = (PLANCK * one / known / magneton for one in (value, error))
                lines.append(f"{'g' + which:<10} {format_value(g, '', abs(g_error))} in {name}")
    return lines


def _rate(text: str) -> float:
    """"29.1646935 MHz/T" in Hz/T."""
    if not text.endswith("/T"):
        raise InputError(f'--per-field {text}: a frequency per field is meant, such as "29.1646935 MHz/T"')
    return _quantity("--per-field", text[:-2], "Hz")


def _quantity(option: str, text: str, unit: str) -> float:
    try:
        value = parse_quantity(text, unit)
    except ValueError as problem:
        raise InputError(f"{option} {text}: {problem}") from None
    if value == 0:
        raise InputError(f"{option} must not be zero")
    return value


def described(fitted: LineFit, unit: str) -> list[str]:
    """Values with their errors."""
    lines = []
    for name, value, error in zip(fitted.names, fitted.values, fitted.errors):
        power = UNITS.get(name.split("_")[0], 0)
        inverse = "s" if unit == "Hz" else f"1/{unit}" if unit else ""
        shown = unit if power == 1 else inverse if power == -1 else "m" if name in ("zone", "distance") else ""
        lines.append(f"{name:<10} {format_value(value, shown, error) if error < UNKNOWN * abs(value) or name.startswith(('centre', 'baseline')) else 'not known'}")
    lines.append(f"chi²       {fitted.chi_squared:.1f} for {fitted.freedom} degrees of freedom, {p_in_words(fitted.p)}, without correlations")
    lines += [f"           or another fringe: centre {format_value(centre, unit if unit else '')} with chi² {chi_squared:.1f}"
              for centre, chi_squared in fitted.others]
    if fitted.p < LEAST_P:
        lines.append("           the form does not describe the curve: believe the centre of a symmetric line, and no errors")
    return lines

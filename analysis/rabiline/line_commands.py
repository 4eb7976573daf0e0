"""The command fit-line."""
from __future__ import annotations

import argparse
import re
from argparse import ArgumentParser
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import results
from .argument_types import count, heading
from .counts import Counts, read_counts
from .covariance import LEAST_P
from .curves import Curve, curves
from .errors import InputError
from .forms import FORMS, SHORTEST, Form, rabi_over, ramsey_over
from .hdf5 import EXPERIMENTS, is_hdf5
from .line_report import described, unit_of
from .lines import LineFit, NoLine, Poisson, fit_line
from .reports import require_detector
from .units import as_written, base_of, format_value, parse_quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PLANCK = 6.62607015e-34  # J s
MAGNETONS = {"nuclear magnetons": 5.0507837393e-27, "Bohr magnetons": 9.2740100657e-24}  # J/T, CODATA 2022
PROFILES = {"m", "rad", "deg", "m/s", "K"}  # what no resonance lies over
FEWEST_CELLS, LEAST_SHARE = 12, 0.01  # of the slowness, with such a part of the beam, by which flight times are told apart
BETTER = 2.0  # times smaller: a chi² that makes another form worth naming
NEEDED = {"frequency": "Hz", "field": "T", "amplitude": "T", "gradient": "T/m", "current": "A", "phase": "deg"}  # units that columns must have, by their ends


def arguments(parser: ArgumentParser) -> None:
    """Its options."""
    parser.set_defaults(command=fit_a_line)
    parser.description = fit_a_line.__doc__
    parser.add_argument("file", metavar="FILE", type=Path, help="a result (HDF5), or measured counts (CSV)")
    parser.add_argument("--form", choices=[*FORMS],
                        help="rabi by default, over places and angles gauss; rabi and ramsey are averaged over the times of flight that a result keeps, or over normal ones "
                             "where it tells few apart")
    parser.add_argument("--lines", type=count, default=1, metavar="N", help="how many, alike but for centre and contrast")
    parser.add_argument("--start", action="append", default=[], metavar="NAME=VALUE", help='where a parameter starts: "centre=29 kHz"; a plain number is in SI')
    known = parser.add_mutually_exclusive_group()
    known.add_argument("--per-field", metavar="RATE", help='turns the centres into fields: "29.1646935 MHz/T"')
    known.add_argument("--field", metavar="B", help='turns the centres into gyromagnetic ratios and g factors: "10 mT"')
    parser.add_argument("--detector", metavar="NAME")
    parser.add_argument("--title", type=heading)
    parser.add_argument("-o", "--output", type=Path, metavar="PNG")


def fit_a_line(options: argparse.Namespace) -> Figure | None:
    """A closed form of a line fitted to a result or to measured counts: centre, width, contrast."""
    forms: dict[str, Form] = dict(FORMS)
    per_field = _rate(options.per_field) if options.per_field else None
    field = _quantity("--field", options.field, "T") if options.field else None
    if is_hdf5(options.file):
        file = results.read(options.file)
        found = curves(file, require_detector(file, options.detector) if options.detector else None)
        if len(found) != 1:
            choose = "" if options.detector or len(file.scan.detectors) == 1 else "choose one with --detector, or "
            raise InputError(f"{options.file}: {len(found)} curves: {choose}scan one parameter")
        curve: Curve = found[0]
        x, y, errors, unit, name, title = curve.x, curve.y, curve.covariance, curve.axis.units, curve.axis.parameter, file.title
        deviations, each = np.sqrt(np.diag(errors)), "detected / emitted"
        written = curve.axis.written
        transits = file.detectors[curve.detector].transits
        if transits:
            edges, caught = transits[0].edges, transits[0].caught.sum(axis=0)
            slowness, weights = (edges[:-1] + edges[1:])[caught > 0] / 2, caught[caught > 0]
            told_apart = max(np.count_nonzero(caught > LEAST_SHARE * caught.sum()), caught.sum()**2 / np.sum(caught**2))  # of many, each has little
            if told_apart >= FEWEST_CELLS:
                forms |= {"rabi": rabi_over(slowness, weights), "ramsey": ramsey_over(slowness, weights)}
            elif told_apart > 2:
                forms["rabi"] = rabi_over(*_normal(slowness, weights, edges[1] - edges[0]))
    elif options.file.suffix in EXPERIMENTS:
        raise InputError(f"{options.file} is an experiment, and a form is fitted to a result of it, or to counts\n"
                         f"  help: `rabiline run {options.file}` makes one; `rabiline fit {options.file} --data COUNTS.csv` fits the experiment itself")
    else:
        counts = read_counts(options.file, options.detector)
        if options.detector and counts.detector is None:
            raise InputError(f"{counts.path}: it has no column `detector`, so --detector chooses nothing")
        if counts.across:
            raise InputError(f"{counts.path}: its counts are over {counts.parameter} and {counts.across.parameter}, and a form is fitted to one curve\n"
                             f"  help: keep the rows of one value of `{counts.across.parameter}`, without that column; `rabiline fit` fits the experiment to all")
        _require_unit(counts)
        unit, factor = base_of(counts.unit)
        written = as_written(counts.unit)
        x, name, title = factor * counts.x, counts.parameter, options.file.name
        exposure, each = _exposure(counts)
        y, errors = counts.counts / exposure, Poisson(exposure)
        deviations = np.sqrt(np.diag(errors.covariance(y, 1.0)))
    usual = "gauss" if unit in PROFILES else "rabi"
    start = dict(_start(text, unit) for text in options.start)
    fitted = fit_line(x, y, errors, forms[options.form or usual], lines=options.lines, start=start)
    words = [*described(fitted, unit, written, each if each.startswith("counts /") else ""), *derived(fitted, unit, per_field, field, written)]
    print("\n".join(words))
    if options.form is None:
        others = {name: form for name, form in forms.items() if name != usual and not (unit in PROFILES and name in ("rabi", "ramsey"))}
        print(f"           {usual} is the form by default: --form has {', '.join(others)} too")
        if fitted.p < LEAST_P and (better := _better(fitted, others, x, y, errors, options.lines)):
            print(f"  help: the form {better.form} describes the curve far better, with chi² {better.chi_squared:.1f}: --form {better.form}")
    if not options.output:
        return None
    from .line_plots import draw_line
    return draw_line(x, y, deviations, fitted, name, unit, options.title or title, words, each, written)


def _normal(slowness: np.ndarray, weights: np.ndarray, cell: float) -> tuple[np.ndarray, np.ndarray]:
    """Normal flight times of the same mean and deviation, which cells make larger (W. Sheppard, Proc. London Math. Soc. 29, 353, 1898)."""
    mean = np.average(slowness, weights=weights)
    deviation = np.sqrt(max(np.average((slowness - mean)**2, weights=weights) - cell**2 / 12, 0.0))
    away = np.linspace(-3, 3, 25)
    return np.maximum(mean + deviation * away, SHORTEST * mean), np.exp(-away**2 / 2)


def _exposure(counts: Counts) -> tuple[np.ndarray, str]:
    """[n] What counts are divided by, and what that makes of them."""
    if counts.emitted is not None:
        return counts.emitted, "counts / emitted"
    if counts.seconds is not None and np.ptp(counts.seconds) > 0:
        return counts.seconds, "counts / s"
    return np.ones(counts.counts.size), "counts"


def _require_unit(counts: Counts) -> None:
    """As a fit of the experiment asks for it; what a form does not know by its name is a plain number."""
    unit = NEEDED.get(counts.parameter.rpartition(".")[2])
    if unit and not counts.unit:
        raise InputError(f"{counts.path}: the column `{counts.parameter}`: it has no unit\n  help: write `{counts.parameter} [{unit}]`")
    if unit == "Hz" and base_of(counts.unit)[0] != unit:
        raise InputError(f"{counts.path}: the column `{counts.parameter}`: `{counts.unit}` is no unit of a frequency\n"
                         f"  help: write `{counts.parameter} [kHz]` or another multiple of Hz")


def _start(text: str, unit: str) -> tuple[str, float]:
    """"centre=29 kHz" in SI; a parameter that the form does not have is refused where it is fitted."""
    name, _, value = text.partition("=")
    try:
        return name, parse_quantity(value, unit_of(name, unit))
    except ValueError as problem:
        raise InputError(f"--start {text}: it is NAME=VALUE, such as centre=29 kHz ({problem})") from None


def _better(fitted: LineFit, others: dict[str, Form], x: np.ndarray, y: np.ndarray, errors: np.ndarray | Poisson, lines: int) -> LineFit | None:
    """The best fit with one of other forms, where it is better by far."""
    found = []
    for form in others.values():
        try:
            found.append(fit_line(x, y, errors, form, lines=lines))
        except NoLine:
            pass
    best = min(found, key=lambda one: one.chi_squared, default=fitted)
    return best if BETTER * best.chi_squared < fitted.chi_squared else None


def derived(fitted: LineFit, unit: str, per_field: float | None, field: float | None, written: tuple[str, float] | None = None) -> list[str]:
    """What the centres mean, with the covariance of the fit: distances between them, fields by a frequency `per_field` [Hz/T], gyromagnetic
    ratios and g factors by the `field` [T]."""
    centres = [i for i, name in enumerate(fitted.names) if name.startswith("centre")]
    lines = []
    for i, j in zip(centres, centres[1:]):
        variance = fitted.covariance[i, i] + fitted.covariance[j, j] - 2 * fitted.covariance[i, j]
        between = f"{fitted.names[j]} - {fitted.names[i]}"
        lines.append(f"{between:<10} {format_value(fitted.values[j] - fitted.values[i], unit, float(np.sqrt(max(variance, 0))), written)}")
    if (per_field or field) and unit != "Hz":
        raise InputError("--field and --per-field are for scans over a frequency")
    for i in centres:
        value, error = float(fitted.values[i]), float(fitted.errors[i])
        which = fitted.names[i].replace("centre", "")
        if per_field:
            lines.append(f"{'field' + which:<10} {format_value(value / per_field, 'T', abs(error / per_field))}")
        if field:
            lines.append(f"{'γ/2π' + which:<10} {format_value(value / field, 'Hz/T', abs(error / field))}")
            for name, magneton in MAGNETONS.items():
                g, g_error = (PLANCK * one / field / magneton for one in (value, error))
                lines.append(f"{'g' + which:<10} {format_value(g, '', abs(g_error))} in {name}")
    return lines


def _rate(text: str) -> float:
    """"29.1646935 MHz/T" in Hz/T."""
    if not text.endswith("/T"):
        raise InputError(f'--per-field {text}: a frequency per field is meant, such as "29.1646935 MHz/T"')
    return _quantity("--per-field", text[:-2], "Hz")


def _quantity(option: str, text: str, unit: str) -> float:
    if re.fullmatch(r"[-+.\deE\s]+", text):
        raise InputError(f"{option} {text}: its unit is missing, such as `{text.strip()} {unit}`")
    try:
        value = parse_quantity(text, unit)
    except ValueError as problem:
        raise InputError(f"{option} {text}: {problem}") from None
    if value == 0:
        raise InputError(f"{option} must not be zero")
    return value

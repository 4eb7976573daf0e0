"""A closed form that was fitted, in words."""
from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from .covariance import LEAST_P, freedom_in_words, p_in_words
from .lines import UNKNOWN
from .units import base_of, format_value

if TYPE_CHECKING:
    from .lines import LineFit

RESEMBLES = 0.2  # of the chi² of a constant: a form that leaves no more than that has its line where the curve has it
WIDE = 0.05  # relative: a spread of times of flight by which it matters how they are distributed
TOGETHER = 0.999  # a p of points whose errors have much in common
MOST_OTHERS = 5  # told by their centres
UNDETERMINED = "not known"
UNITS = {"centre": 1, "width": 1, "strength": 1, "time": -1, "pulse": -1}  # powers of the axis' unit


def unit_of(name: str, unit: str) -> str:
    """That of a parameter of a form over an axis with this unit."""
    power = UNITS.get(name.split("_")[0], 0)
    inverse = "s" if unit == "Hz" else f"1/{unit}" if unit else ""
    across = "m" if unit == "Hz" else f"m Hz/{unit}" if unit else ""  # as far as the axis is a frequency, or stands for one
    return unit if power == 1 else inverse if power == -1 else across if name in ("length", "zone", "distance") else ""


def _written_of(name: str, written: tuple[str, float] | None) -> tuple[str, float] | None:
    """The unit of a parameter of a form over an axis that the user wrote in this one; None where that says nothing about it."""
    power = UNITS.get(name.split("_")[0], 0)
    if written is None or power == 0 or power == -1 and base_of(written[0])[0] == "Hz":
        return None
    return written if power == 1 else (f"1/{written[0]}", 1 / written[1])


def told(fitted: LineFit) -> list[str]:
    """Each parameter with its error, in the unit that the fit was told; and how well all of them describe the curve."""
    values = (_value(fitted, i, fitted.unit, None) for i in range(len(fitted.names)))
    return [*(f"{name} {value}" if value == UNDETERMINED else f"{name} = {value}" for name, value in zip(fitted.names, values)),
            f"chi² {fitted.chi_squared:.1f} for {freedom_in_words(fitted.freedom)}", p_in_words(fitted.p)]


def _value(fitted: LineFit, number: int, unit: str, written: tuple[str, float] | None) -> str:
    name, value, error = fitted.names[number], fitted.values[number], fitted.errors[number]
    return format_value(value, unit_of(name, unit), error, _written_of(name, written)) if _is_known(fitted, number) else UNDETERMINED


def _is_known(fitted: LineFit, number: int) -> bool:
    return bool(fitted.errors[number] < UNKNOWN * abs(fitted.values[number]) or fitted.names[number].startswith(("centre", "baseline")))


def _goes_below_zero(fitted: LineFit) -> bool:
    """Whether a dip is deeper than what is there without it, by three errors."""
    base, parts = fitted.names.index("baseline"), [i for i, name in enumerate(fitted.names) if name.startswith("contrast")]
    bottoms = ((fitted.values[base] + fitted.values[i], fitted.covariance[base, base] + fitted.covariance[i, i] + 2 * fitted.covariance[base, i]) for i in parts)
    return any(bottom < -3 * sqrt(max(variance, 0.0)) for bottom, variance in bottoms)


def described(fitted: LineFit, unit: str, written: tuple[str, float] | None = None, each: str = "") -> list[str]:
    """The form, and its values with their errors; in the unit of the axis as the user wrote it, with how much that is in SI. `each`: what points,
    contrasts and the baseline are."""
    lines = [f"form       {fitted.form}", *(f"{name:<10} {_value(fitted, i, unit, written)}" for i, name in enumerate(fitted.names))]
    lines += [f"           contrast and baseline are in {each}"] if each else []
    if fitted.form == "rabi" and fitted["strength"][1] > UNKNOWN * fitted["strength"][0]:
        lines.append("           the field is weak: its strength and the contrast cannot be told apart; --form sinc2 needs neither")
    if fitted.form == "rabi" and "time" in fitted.names and _goes_below_zero(fitted):
        lines.append("           no line can be that deep: flight times differ, and the form has one, so that strength, time and contrast are effective")
    if "spread" in fitted.names and (fitted["spread"][0] > WIDE or not _is_known(fitted, fitted.names.index("spread"))):
        lines.append("           normal times of flight stand in for those of the beam: strength, pulse, time and spread are effective")
    together = fitted.deviance is None and fitted.p > TOGETHER
    lines.append(f"chi²       {fitted.chi_squared:.1f} for {freedom_in_words(fitted.freedom)}, " + (
        "as little as where points err together" if together else p_in_words(fitted.p) + ("" if fitted.deviance is not None else ", without correlations")))
    for centres, chi_squared in fitted.others[:MOST_OTHERS]:
        places = " and ".join(format_value(centre, unit, None, written) for centre in centres)
        other = "another fringe: centre" if fitted.form == "ramsey" else "another line: centre" if len(centres) == 1 else "other lines: centres"
        lines.append(f"           or {other} {places} with chi² {chi_squared:.1f}")
    if len(fitted.others) > MOST_OTHERS:
        lines.append(f"           and {len(fitted.others) - MOST_OTHERS} more that are as good: a longer scan tells them apart")
    if len({value > 0 for name, value in zip(fitted.names, fitted.values) if name.startswith("contrast")}) > 1:
        lines.append("           contrasts have opposite signs: peaks and dips together are rarely lines of one kind")
    if fitted.p < LEAST_P:
        believed = "the centre of a symmetric line, and no errors" if fitted.chi_squared < RESEMBLES * fitted.constant else "none of these numbers"
        lines.append(f"           the form does not describe the curve: believe {believed}")
    return lines

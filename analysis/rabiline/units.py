"""Numbers as people read them: SI prefixes, values with errors, names of laws."""
from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass
from math import floor, isfinite, log10

import numpy as np

from .asked import written_number

PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
ELECTRONVOLT, MACROSCOPIC = 1.602176634e-19, 1e-12  # J; energies below the latter are in eV
QUANTITY = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*((?:[^\W\d_]|[%°])[^\s:,;'\"\[\]{}#]*)"  # number, unit, as files have them
# What else may be written, and how much it is in SI: units that take prefixes, and those that do not.
OTHERS = {"G": ("T", 1e-4), "rad": ("rad", 1.0)}
WITHOUT = {"cm": ("m", 0.01), "deg": ("rad", np.pi / 180), "°": ("rad", np.pi / 180)}
TAKE_PREFIXES = {"Hz", "m", "s", "T", "A", "V", "W", "J", "eV", "V/m"}  # nobody reads mK, km/s or krad here


@dataclass(frozen=True)
class Scale:
    """How an axis shows its values: (value - origin) / factor, in `unit`."""

    unit: str
    factor: float = 1.0
    origin: float = 0.0

    def apply(self, values: np.ndarray | float) -> np.ndarray | float:
        """SI values as shown."""
        return (values - self.origin) / self.factor

    def label(self, name: str) -> str:
        """An axis label, such as "H0.frequency (kHz)"."""
        sign = "+" if self.origin < 0 else "−"
        shown = name if self.origin == 0 else f"{name} {sign} {format_value(abs(self.origin), self.base_unit)}"
        return f"{shown} ({self.unit})" if self.unit else shown

    @property
    def base_unit(self) -> str:
        """That of SI, without prefix."""
        base = base_of(self.unit)[0]
        return "J" if base == "eV" else base


def fitting_scale(values: np.ndarray, unit: str, written: tuple[str, float] | None = None) -> Scale:
    """The unit that the user wrote, with how much it is in SI; else the SI prefix that shows the largest of `values` as 1 to 1000.
    Values that differ by less than a thousandth are shown as differences from the middle one, rounded to a tenth of their spread."""
    finite = np.asarray(values, dtype=float)[np.isfinite(values)]
    if written and finite.size and (np.ptp(finite) >= 1e-3 * np.abs(finite).max() or is_logarithmic(finite)):
        return Scale(*written)
    if unit == "" and finite.size and not 1e-3 <= np.abs(finite).max() < 1e5 and np.abs(finite).max() > 0:
        power = floor(log10(np.abs(finite).max()))
        return Scale("10" + str(power).translate(SUPERSCRIPT), 10.0**power)
    if unit == "rad" and finite.size:
        return Scale("deg", np.pi / 180) if _round_in_degrees(finite) else Scale(*prefixed(min(np.abs(finite).max(), 1.0), unit))
    if unit not in TAKE_PREFIXES or finite.size == 0:
        return Scale(unit.replace("u", "µ"))
    largest, spread = np.abs(finite).max(), np.ptp(finite)
    origin = 0.0
    if 0 < spread < 1e-3 * largest and not is_logarithmic(finite):
        decimals = 1 - floor(log10(spread))
        origin = round(float(finite.min() + spread / 2), decimals)
        largest = np.abs(finite - origin).max()
    return Scale(*prefixed(largest, unit), origin)


def is_logarithmic(values: np.ndarray) -> bool:
    """Whether values go in equal ratios over more than a factor of two, or over a decade in ratios that are more even than
    their steps, such as 1, 2, 5, 10, 20."""
    if values.size < 4 or not (values > 0).all() or values.max() < 2 * values.min():
        return False
    ratios, steps = np.diff(np.log(values)), np.diff(values)
    if np.ptp(ratios) < 1e-3 * np.abs(ratios).max():
        return True
    return bool(values[-1] >= 10 * values[0] and (steps > 0).all() and ratios.max() < 4 * ratios.min()
                and steps.max() > 4 * steps.min())


def _round_in_degrees(values: np.ndarray) -> bool:
    """Whether angles were meant in degrees: all are whole tenths of one."""
    tenths = np.degrees(values) * 10
    return bool(np.abs(values).max() > 0 and (np.abs(tenths - np.rint(tenths)) < 1e-6).all())


def edges_of(values: np.ndarray) -> np.ndarray:
    """[n + 1] Between the values, and beyond the first and the last one."""
    if values.size < 2:
        return values[0] + np.array([-0.5, 0.5]) * (abs(values[0]) or 1.0)
    shown = np.log(values) if is_logarithmic(values) else values
    middle = (shown[:-1] + shown[1:]) / 2
    edges = np.concatenate([[2 * shown[0] - middle[0]], middle, [2 * shown[-1] - middle[-1]]])
    return np.exp(edges) if is_logarithmic(values) else edges


def format_value(value: float, unit: str, error: float | None = None, written: tuple[str, float] | None = None) -> str:
    """A value with its unit, "291.65 kHz", or with its error to two digits, "291.652 ± 0.014 kHz"; see `unit_shown` for `written`."""
    shown = unit_shown(value, unit, error, written)
    return with_error(value, error, *shown) if _is_known(error) else in_unit(value, *shown).strip()


def unit_shown(value: float, unit: str, error: float | None = None, written: tuple[str, float] | None = None) -> tuple[str, float]:
    """The unit in which a value in SI is told, and how much it is in SI: the one that the user wrote where that needs no row of zeros."""
    is_known = _is_known(error)
    if written and (value == 0 or abs(value) >= 0.1 * written[1]) and not (is_known and error < 1e-8 * written[1]):
        return written
    if unit == "rad" and not is_known and _round_in_degrees(np.array([value])):
        return "deg", np.pi / 180
    if unit not in TAKE_PREFIXES:
        return unit, 1.0
    shown = prefixed(abs(value), unit)
    if is_known and error < 1e-6 * shown[1]:  # 9192631770.1 ± 1.1 Hz, not ten decimals of a GHz
        return prefixed(1.0 if error < 1 <= abs(value) else error, unit)  # nor 9192631771543 ± 480 mHz
    return shown


def _is_known(error: float | None) -> bool:
    return error is not None and isfinite(error) and error > 0


def with_error(value: float, error: float, unit: str, factor: float) -> str:
    """A value in SI with its error, above 0, to two digits, in a unit that is so much in SI."""
    digits = max(0, 1 - floor(log10(error / factor)))
    return f"{value / factor:.{digits}f} ± {error / factor:.{digits}f} {unit}".strip()


def in_unit(value: float, unit: str, factor: float, digits: int = 10) -> str:
    """A value in SI in a unit that is so much in SI."""
    return f"{_with_power(f'{value / factor:.{digits}g}')} {unit}"


def wrapped(text: str, most: int) -> str:
    """In lines of so many letters at most. A number stays with its error and its unit where a line has room for them, and is never broken itself; long
    names are, behind a sign between their parts."""
    def fitting(word: str) -> str:
        if len(word) > most and "\u00a0" in word:
            return " ".join(map(fitting, word.split("\u00a0")))
        if len(word) <= most or word[0].isdigit():
            return word
        parts = textwrap.wrap(re.sub(r"(?<=[+._])(?=.)", " ", word), most)
        return " ".join(line.replace(" ", "") for line in parts)

    lines = (" ".join(map(fitting, filter(None, part.split(" ")))) for part in _unbroken(text).splitlines())
    return "\n".join(line for part in lines for line in textwrap.wrap(part, most, break_long_words=False) or [""]).replace("\u00a0", " ")


def _unbroken(text: str) -> str:
    """The same with blanks that no line ends at between numbers, errors and units."""
    units = "|".join(sorted(map(re.escape, TAKE_PREFIXES), key=len, reverse=True))
    return re.sub(rf" ?± ?|(?<=\d) (?=[{''.join(filter(None, PREFIXES.values()))}]?(?:{units})(?![a-z]))", lambda found: found[0].replace(" ", "\u00a0"), text)


def _with_power(number: str) -> str:
    """2.5e-06 as 2.5×10⁻⁶."""
    digits, e, power = number.partition("e")
    return f"{digits}×10{str(int(power)).translate(SUPERSCRIPT)}" if e else number


def parse_quantity(text: str, wanted: str | None = None) -> float:
    """"291.65 kHz", "3 meV" or "2.5" as a finite SI number; raises ValueError. The unit is one that takes prefixes, and of the
    kind of the wanted one where there is such."""
    glued = re.fullmatch(QUANTITY, text.strip())
    words = [glued[1], glued[2]] if glued and not re.fullmatch(r"[eE][-+]?\d*", glued[2]) else text.split()
    if not 1 <= len(words) <= 2:
        raise ValueError("it has no number and unit")
    value, unit = written_number(words[0]), words[1] if len(words) == 2 else ""
    known = _in_base(unit)
    if unit and not known:
        raise ValueError(f"unknown unit {unit}")
    if known and wanted and known[0] != _in_base(wanted, (wanted, 1.0))[0] and (known[0], wanted) != ("eV", "J"):
        raise ValueError(f"{unit} is not a unit of the kind of {wanted}")
    value *= known[1] if known else 1.0
    value *= ELECTRONVOLT if known and known[0] == "eV" else 1.0
    if not isfinite(value):
        raise ValueError("it is not a finite number")
    return value


def base_of(unit: str) -> tuple[str, float]:
    """A unit of SI, without prefix, and how much of it another one is: "kHz" is 1000 "Hz", "deg" 0.017 "rad". Others stay as they are."""
    return _in_base(unit, (unit, 1.0))


def as_written(unit: str) -> tuple[str, float] | None:
    """A unit of a table as pictures have it, and how much it is in SI; None of none."""
    return (re.sub("^u", "µ", unit), base_of(unit)[1]) if unit else None


def _in_base(unit: str, otherwise: tuple[str, float] | None = None) -> tuple[str, float] | None:
    """The unit of SI, or eV, and how much of it this one is."""
    if unit in WITHOUT:
        return WITHOUT[unit]
    for power, prefix in PREFIXES.items():
        for written in {prefix, prefix.replace("µ", "u")}:
            rest = unit.removeprefix(written)
            if unit.startswith(written) and (rest in TAKE_PREFIXES or rest in OTHERS):
                base, factor = OTHERS.get(rest, (rest, 1.0))
                return base, factor * 10.0**power
    return otherwise


def law_name(law: str) -> str:
    """A law as texts and pictures name it: a hypothesis is called one. "dorado (torque, kappa = 1)" becomes
    "dorado (hypothesis), torque, κ = 1"."""
    name, _, details = law.partition(" (")
    if name != "dorado":
        return law
    shown = re.sub(r"[\d.]+e[-+]?\d+", lambda found: _with_power(found[0]), details.rstrip(")").replace("kappa", "κ"))
    return ", ".join(["dorado (hypothesis)", *([shown] if details else [])])


def prefixed(size: float, unit: str) -> tuple[str, float]:
    """The unit with the prefix that shows `size` as 1 to 1000, and how much it is in SI; eV for the energy of a particle."""
    if unit == "J" and 0 < size < MACROSCOPIC:
        shown, factor = prefixed(size / ELECTRONVOLT, "eV")
        return shown, factor * ELECTRONVOLT
    power = 3 * floor(log10(size * (1 + 1e-12)) / 3) if size > 0 else 0
    power = min(max(power, min(PREFIXES)), max(PREFIXES))
    return PREFIXES[power] + unit, 10.0**power

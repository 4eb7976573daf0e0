"""Measured counts beside a simulated curve."""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .counts import Counts, names_of, read_counts
from .curves import Curve
from .errors import InputError
from .units import parse_quantity

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Measured:
    """Counts in the measure of a curve."""

    x: np.ndarray  # SI
    y: np.ndarray
    errors: np.ndarray
    label: str


def read_measured(source: Path | pandas.DataFrame, curve: Curve, detector: str | None) -> Measured:
    """Counts of a table or frame, of one detector in it, over the curve's parameter: as fractions where the table tells how many particles were `emitted`, or the `seconds` and
    the experiment its rate; else by the factor that makes the squares of their differences least. Raises InputError."""
    counts = read_counts(source, detector)
    if counts.across:
        raise InputError(f"{counts.path}: its counts are over {counts.parameter} and {counts.across.parameter}: of such a table the rows of one value of "
                         f"`{counts.across.parameter}`, without that column, are drawn beside curves")
    if names_of(counts.parameter) != names_of(curve.axis.parameter):
        raise InputError(f"{counts.path}: its counts are over {counts.parameter}, the scan is over {curve.axis.parameter}")
    if curve.axis.units and not counts.unit:
        unit = curve.axis.written[0] if curve.axis.written else curve.axis.units
        raise InputError(f"{counts.path}: the column `{counts.parameter}` has no unit: write `{counts.parameter} [{unit}]`")
    try:
        x = counts.x * (parse_quantity(f"1 {counts.unit}", curve.axis.units) if counts.unit else 1.0)
    except ValueError as problem:
        raise InputError(f"{counts.path}: {problem}") from None
    if x.min() > curve.x.max() or x.max() < curve.x.min():
        raise InputError(f"{counts.path}: all counts lie outside the scan, {curve.axis.text(curve.x.min())} to "
                         f"{curve.axis.text(curve.x.max())}: is the unit right?")
    each, background = _each(counts, curve) or (None, 0.0)
    floor = 0.0
    if each is not None:
        label = "counted"
    else:
        order = np.argsort(curve.x)
        floor = curve.rate[1] / curve.rate[0] if curve.rate else 0.0  # the background, as a fraction
        expected = np.interp(x, curve.x[order], curve.y[order]) + floor
        time = np.ones(x.size) if counts.seconds is None else counts.seconds / counts.seconds.mean()
        counted = counts.counts / time
        factor = float(expected @ counted / max(counted @ counted, 1e-300))
        each, label = time / max(factor, 1e-300), f"counted, times {factor:.3g}" + (", less the background" if floor else "")
    return Measured(x, (counts.counts - background) / each - floor, np.sqrt(np.maximum(counts.counts, 1.0)) / each, label)


def _each(counts: Counts, curve: Curve) -> tuple[np.ndarray, np.ndarray | float] | None:
    """[n] Counts where the fraction is 1, and the background's, if they are known."""
    each, background = curve.rate or (None, 0.0)
    seconds = counts.seconds
    if seconds is None and counts.emitted is not None and each is not None:
        seconds = counts.emitted / each
    if counts.emitted is not None:
        return counts.emitted, 0.0 if seconds is None else background * seconds
    return None if seconds is None or each is None else (each * seconds, background * seconds)

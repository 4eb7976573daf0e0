"""Tallies as plain values: histograms over what is asked for of particles."""
from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Sequence

import numpy as np

from .hdf5 import Group
from .scan_axes import written_unit_of_bins
from .units import Scale, fitting_scale, format_value, in_unit, with_error

SMALL = 1e-3  # of a unit: what is smaller is shown in another one


@dataclass(frozen=True)
class TallyAxis:
    """One axis of a tally: bins of equal width, or levels with labels."""

    name: str
    title: str  # what plots write along it
    units: str  # SI; empty for a plain number
    edges: np.ndarray  # [n + 1]
    labels: tuple[str, ...]  # [n] of levels, else empty
    mean: np.ndarray | None  # [points], or [points, planes], of what is inside the axes; None for levels and planes
    mean_errors: np.ndarray | None
    deviation: np.ndarray | None
    deviation_errors: np.ndarray | None
    written: tuple[str, float] | None = None  # the unit in which the user wrote it, if known, and how much it is in SI

    @property
    def scale(self) -> Scale:
        """How it is shown."""
        written = self.written if self.written and np.abs(self.edges).max() > SMALL * self.written[1] else None
        return Scale(self.units) if self.units in ("m/s", "") and not written else fitting_scale(self.edges, self.units, written)

    def text(self, value: float, error: float) -> str:
        """A mean or a deviation, in the unit in which the axis is shown; one that has no error, with the digits that its sums have."""
        scale = self.scale
        if scale.origin != 0:
            return format_value(value, self.units, error)
        if isfinite(error) and error > 0:
            return with_error(value, error, scale.unit, scale.factor)
        return in_unit(0.0 if abs(value) < 1e-7 * np.abs(self.edges).max() else value, scale.unit, scale.factor, 6).strip()


@dataclass(frozen=True)
class Tally:
    """A histogram over one to three quantities of what passed a monitor or a detector counted, in particles."""

    name: str  # that of its group, "screen_spectrum"
    title: str
    axes: tuple[TallyAxis, ...]
    counts: np.ndarray  # [points, bins of each axis...]
    errors: np.ndarray  # same shape
    outside: np.ndarray  # [points], or [points, planes], what crossed the plane outside of the axes
    is_expectation: bool  # weights are split over the outcomes of a measurement of the spin


def read_tally(group: Group, name: str, points: int, texts: Sequence[str]) -> Tally:
    """The tally in a group, with where its axes may be written."""
    own = [axis for axis in group.attribute("axes") if f"{axis}_edges" in group]
    # What has several planes has them as its first axis, which then has no mean.
    of_planes = own[0] == "y" and "y_mean" not in group
    each = (points, group.numbers("y").size) if of_planes else (points,)
    axes = tuple(_read_axis(group, axis, each, name, texts) for axis in own)
    shape = (points, *(axis.edges.size - 1 for axis in axes))
    return Tally(
        name=name,
        title=group.text("title", name),
        axes=axes,
        counts=group.amounts("counts", shape),
        errors=group.amounts("counts_errors", shape),
        outside=group.amounts("outside", each),
        is_expectation=bool(group.attribute("spin_outcomes")),
    )


def _read_axis(group: Group, name: str, shape: tuple[int, ...], tally: str, texts: Sequence[str]) -> TallyAxis:
    units = "".join(group.attribute("units", of=name))
    moments = (read(f"{name}_{moment}", shape, or_none=True) if f"{name}_{moment}" in group else None
               for moment, read in (("mean", group.numbers), ("mean_errors", group.amounts), ("deviation", group.amounts), ("deviation_errors", group.amounts)))
    labels = group.texts(f"{name}_labels") if f"{name}_labels" in group else ()
    title = "".join(group.attribute("long_name", of=name)) or name
    edges = group.edges(f"{name}_edges")
    units = "" if units == "1" else units
    return TallyAxis(name, title, units, edges, labels, *moments, written=written_unit_of_bins(tally, name, edges, texts) if units else None)

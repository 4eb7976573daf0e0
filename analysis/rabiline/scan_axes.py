"""The axes of scans, in SI and in the unit in which the user wrote them: in the file, or on the command line."""
from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Sequence

import numpy as np

from .hdf5 import Group
from .units import QUANTITY, Scale, fitting_scale, in_unit, unit_shown

REST = r"(.{0,400}?)(?:\}|\n\S|$)"  # behind a parameter's name, in which its scan stands


@dataclass(frozen=True)
class Axis:
    """A scanned parameter, or several that change together."""

    parameter: str  # dotted name, "H0.frequency"; several with ", " between
    units: str  # SI, "Hz"; empty for a plain number
    values: np.ndarray  # [n] in `units`; 0, 1, ... for a categorical axis
    labels: tuple[str, ...] = ()  # [n] of a categorical axis, else empty
    written: tuple[str, float] | None = None  # the unit in which the user wrote it, if known, and how much it is in SI

    @property
    def scale(self) -> Scale:
        """How pictures show it."""
        return fitting_scale(self.values, self.units, self.written)

    def text(self, value: float) -> str:
        """One of its values, "291.65 kHz"."""
        typical = float(np.abs(self.values).max()) if self.units == "rad" else value  # 0 deg beside 90 deg
        return in_unit(value, *(self.written or unit_shown(typical, self.units)), self._digits).strip()

    @property
    def _digits(self) -> int:
        """That tell its values apart, and two more."""
        values = np.unique(self.values)
        apart = (np.maximum(np.abs(values[1:]), np.abs(values[:-1])) / np.diff(values)).max(initial=1.0)
        return int(np.clip(np.ceil(np.log10(apart)) + 3, 6, 12))


def read_axis(group: Group, name: str, texts: Sequence[str]) -> Axis:
    """The axis `name` of a group, with where it may be written."""
    values = group.numbers(name)
    labels = group.texts(f"{name}_labels") if f"{name}_labels" in group else ()
    if values.ndim != 1 or (labels and len(labels) != values.size):
        raise group.error(f"`{name}` is no axis: its shape is {values.shape}, with {len(labels)} labels")
    units = "".join(group.attribute("units", of=name))
    parameter = "".join(group.attribute("parameter", of=name)) or name
    units = "" if units == "1" else units
    return Axis(parameter, units, values, labels, written_unit(parameter, values, texts) if units and values.size > 1 else None)


def texts_of(entry: Group) -> list[str]:
    """Where a scan may be written: the arguments, the file."""
    if "simulation" not in entry:
        return []
    simulation = entry.group("simulation")
    inputs = [simulation.group(name) for name in simulation.names() if name.startswith("input_")]
    return [" ".join(simulation.texts("arguments")) if "arguments" in simulation else "", *(one.text("data", "") for one in inputs)]


def written_unit(parameter: str, values: np.ndarray, texts: Sequence[str]) -> tuple[str, float] | None:
    """The unit in which a scan of a parameter over `values` [n] in SI is written in one of some texts, and how much it is in SI. None
    where none of them has this scan with one unit."""
    name = re.escape(parameter.split(", ")[0])
    return _unit_in(texts, (rf"{name}(?:,[^=\s]+)?=(.*?)(?: -[-a-z]|$)", rf"parameters?:\s*\[?\s*['\"]?{name}\b{REST}"), values)


def written_unit_of_bins(tally: str, quantity: str, edges: np.ndarray, texts: Sequence[str]) -> tuple[str, float] | None:
    """Likewise of an axis of a tally, "PART_TALLY", with these edges [n + 1] in SI."""
    words = tally.split("_")
    names = "|".join(re.escape("_".join(words[i:])) for i in range(1, len(words)))
    return _unit_in(texts, (rf"name:\s*(?:{names})\b.{{0,400}}?quantity:\s*{re.escape(quantity)}\b{REST}",), edges)


def _unit_in(texts: Sequence[str], ways: Sequence[str], values: np.ndarray) -> tuple[str, float] | None:
    """That of the first and the last of some values, where one of these patterns finds them."""
    for text in texts:
        for found in (match for way in ways for match in re.finditer(way, text, re.DOTALL)):
            pairs = re.findall(QUANTITY, found[1])
            if len(pairs) >= 2 and len({unit for _, unit in pairs}) == 1:
                ends = np.array([float(pairs[0][0]), float(pairs[-1][0])])
                factor = float(np.abs(values[[0, -1]]).max() / max(np.abs(ends).max(), 1e-300))
                if np.allclose(factor * ends, values[[0, -1]], rtol=1e-9, atol=0) and factor > 0:
                    return pairs[0][1].replace("u", "µ", 1) if pairs[0][1][0] == "u" else pairs[0][1], factor
    return None

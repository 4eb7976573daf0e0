"""How long and with how much beam counts were taken: from their table and from what the experiment states."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .curve_model import SCALE, NoFit
from .units import format_value

if TYPE_CHECKING:
    from .counts import Counts
    from .curve_model import CurveModel
    from .results import Results


@dataclass(frozen=True)
class Exposure:
    """How many counts a detected fraction means."""

    each: np.ndarray  # [n] counts where the fraction is 1
    time: np.ndarray  # [n] in units of the mean time
    background: np.ndarray  # [n] counts, in proportion to the time: as known, unless it is free
    is_known: bool  # else a factor is free
    floor: float = 0.0  # the background as a detected fraction, where that factor alone says how long was counted
    about: str = ""  # where the background comes from, or why there is none

    def start(self, name: str, scale: float = 1.0) -> float:
        """What SCALE, or BACKGROUND with that factor, is as long as it is not free."""
        return 1.0 if name == SCALE else float(self.background.mean() + scale * self.floor * self.each.mean())


def exposure_of(model: CurveModel, counts: Counts, values: np.ndarray) -> Exposure:
    """From the table and the file. Over which time a stated background was counted follows from the source's rate, where the table does not say it."""
    flown = model.scanned.set({**model.changes(values), "particles": model.explored}).fly()
    background, per_second = flown.detectors[model.detector].background, _per_second(flown, model.detector)
    none, seconds, about = np.zeros(counts.counts.size), counts.seconds, ""
    stated = f"{format_value(background, '')} 1/s"
    if seconds is None and background > 0:
        about = f"the background is {stated}, as the file has it, over the time that `{'scale' if counts.emitted is None else 'emitted'}` means at the source's `rate`" \
            if per_second else f"the background of {stated} in the file is left out, since the time at each point is not known\n" \
            "  help: add a column `seconds`, or fit with `background` in --free"
    if seconds is None and counts.emitted is not None and per_second:
        seconds = counts.emitted / per_second
    if seconds is None:
        floor = background / per_second if per_second and counts.emitted is None else 0.0
        return Exposure(none + 1 if counts.emitted is None else counts.emitted, none + 1, none, counts.emitted is not None, floor, about)
    time = seconds / seconds.mean()
    if counts.emitted is not None:
        return Exposure(counts.emitted, time, background * seconds, True, about=about)
    return Exposure(per_second * seconds if per_second else time, time, background * seconds, per_second is not None)


def _per_second(flown: Results, detector: str) -> float | None:
    """Counts per second where the fraction is 1; None where the file has no rate, or nothing is detected."""
    i = flown.scan.detectors.index(detector)
    if flown.scan.count_rate is None or not flown.scan.detected[i].any():
        return None
    return float(np.sum(flown.scan.count_rate[i] - flown.detectors[detector].background) / np.sum(flown.scan.detected[i]))


def first_scale(model: CurveModel, counts: Counts, exposure: Exposure, values: np.ndarray) -> float:
    """The factor with which the curve at these values has as many counts as there are. Raises NoFit where it has none."""
    seen = np.sum(exposure.each * model.at(values[:len(model.names)]).y)
    if seen <= 0:
        raise NoFit(f"`{model.detector}` counts nothing at the start values: nothing to fit")
    return max(np.sum(counts.counts - exposure.background), 1.0) / (seen + exposure.floor * np.sum(exposure.each))

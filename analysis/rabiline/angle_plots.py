"""The spin's polar angle and azimuth along the planes of a monitor, with straight lines through them."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from .results import Results, TallyAxis
from .style import GREY, INK, LAWS
from .units import fitting_scale, format_value, law_name

STEP = 2.0**-24  # of an axis: what a mean is rounded to


class NoAngles(Exception):
    """The file has no tallies of angles and times in several planes."""


@dataclass(frozen=True)
class Angles:
    """One angle against the mean time of flight in each plane, and the straight line through it."""

    name: str
    times: np.ndarray  # [planes] s
    values: np.ndarray  # [planes] rad, unwrapped
    errors: np.ndarray  # [planes] rad
    spread: np.ndarray  # [planes] rad, standard deviation over the particles
    rate: float  # rad/s
    rate_error: float  # rad/s, of planes taken as independent: they see the same particles, so it is an upper bound
    offset: float  # rad at the mean time

    @property
    def turns(self) -> tuple[float, float]:
        """The rate and its error in turns per second."""
        return self.rate / (2 * np.pi), self.rate_error / (2 * np.pi)

    def __str__(self) -> str:
        rate, error = self.turns
        return f"{self.name}: {format_value(rate, 'Hz', error)} ({format_value(self.rate, 'rad/s', self.rate_error)})"


def angles_of(results: Results, monitor: str | None, point: int) -> list[Angles]:
    """Both angles of a monitor with several planes; raises NoAngles where its tallies are not there."""
    found = {}
    for tally in results.tallies.values():
        part = next((name for name in results.monitors if tally.name.startswith(f"{name}_")), None)
        if tally.outside.ndim < 2 or part is None or monitor not in (None, part):
            continue
        for axis in tally.axes:
            if axis.mean is not None:
                found.setdefault(axis.name, axis)
    missing = {"time_of_flight", "spin_polar_angle", "spin_azimuth"} - set(found)
    if missing:
        raise NoAngles(f"no tally over {', '.join(sorted(missing))} of a monitor with several planes")
    times = found["time_of_flight"].mean[point]
    return [_line(name, times, found[key], point) for name, key in
            (("polar angle θ", "spin_polar_angle"), ("azimuth φ", "spin_azimuth"))]


def _line(name: str, times: np.ndarray, axis: TallyAxis, point: int) -> Angles:
    """Least squares with the errors of the means. The first plane is left out: a spin along z has no azimuth."""
    floor = STEP * np.ptp(axis.edges)
    values, errors = axis.mean[point].copy(), np.hypot(axis.mean_errors[point], floor)
    if axis.name == "spin_azimuth":
        values[1:] = np.unwrap(values[1:])
        values[0] = np.nan
    good = np.isfinite(values) & np.isfinite(times)
    good[0] = False
    if good.sum() < 3:
        raise NoAngles(f"fewer than three planes have seen {axis.name}")
    weights = errors[good]**-2.0
    centre = np.average(times[good], weights=weights)
    lever = times[good] - centre
    bottom = np.sum(weights * lever**2)
    offset = np.average(values[good], weights=weights)
    rate = float(np.sum(weights * lever * values[good]) / bottom)
    return Angles(name, times, values, errors, axis.deviation[point], rate, float(bottom**-0.5),
                  float(offset - rate * centre))


def draw_angles(results: Results, angles: Sequence[Angles], expected: Sequence[float | None], point: int) -> Figure:
    """Each angle above what it has beyond its fit; `expected` are rates in turns per second, drawn through the middle
    of the planes."""
    figure, panels = plt.subplots(4, 1, figsize=(7.2, 8.4), sharex=True, layout="constrained",
                                  gridspec_kw={"height_ratios": [2.4, 1, 2.4, 1]})
    scale = fitting_scale(np.concatenate([one.times for one in angles]), "s")
    colour = LAWS.get(results.laws[point].split(" ")[0], (INK, "o"))[0]
    for (panel, below), one, rate in zip((panels[:2], panels[2:]), angles, expected):
        shown = np.asarray(scale.apply(one.times))
        fit = one.offset + one.rate * one.times
        panel.errorbar(shown, np.degrees(one.values), np.degrees(one.spread), fmt=".", color=colour, markersize=4,
                       ecolor=colour, elinewidth=1.2, label="mean, and standard deviation of the particles")
        turns, error = one.turns
        panel.plot(shown, np.degrees(fit), color=INK, linewidth=1, label=f"fit: {format_value(turns, 'Hz', error)}")
        below.axhline(0, color=INK, linewidth=1)
        below.errorbar(shown, np.degrees(one.values - fit), np.degrees(one.errors), fmt=".", color=colour, markersize=4,
                       elinewidth=0.9)
        if rate is not None:
            middle = np.nanmean(one.times)
            line = one.offset + one.rate * middle + 2 * np.pi * rate * (one.times - middle)
            looks = {"color": GREY, "linewidth": 2, "linestyle": (0, (2, 3))}
            panel.plot(shown, np.degrees(line), label=f"expected: {format_value(rate, 'Hz')}", **looks)
            below.plot(shown, np.degrees(line - fit), **looks)
        panel.set_ylabel(f"{one.name} (deg)")
        below.set_ylabel("beyond the fit (deg)\nbars: standard error", fontsize=8.5)
        panel.legend(loc="best")
        for each in (panel, below):
            each.grid(True)
    panels[-1].set_xlabel(scale.label("time of flight, mean in each plane"))
    figure.suptitle(f"{results.title}\n{law_name(results.laws[point])}, {results.species[point]}", fontsize=11.5)
    figure.align_ylabels(panels)
    return figure

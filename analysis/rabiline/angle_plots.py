"""The spin's polar angle and azimuth along the planes of a monitor, with straight lines through them."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from . import style
from .results import Results
from .style import GREY, INK, LAWS
from .units import Scale, fitting_scale, format_value, law_name, prefixed

ABOUT_ERROR = "error: from the scatter about the line"
LEAST = 1e-9  # rad, that a panel of residuals shows at least: less is the rounding of numbers
LEAST_BESIDE, LEAST_BELOW = (8.0, 5.0), (4.6, 6.8)  # inches, that letters of their natural size leave room for curves in
SEEN = 10.0  # times the largest residual: a line that is expected further away may leave its panel


class NoAngles(Exception):
    """The file has no tallies of angles and times in several planes."""


@dataclass(frozen=True)
class Angles:
    """One angle against the mean time of flight in each plane, and the straight line through it."""

    name: str
    times: np.ndarray  # [planes] s
    values: np.ndarray  # [planes] rad, unwrapped
    spread: np.ndarray  # [planes] rad, standard deviation over the particles
    rate: float  # rad/s
    rate_error: float  # rad/s, from the scatter of the planes about the line
    offset: float  # rad at time 0

    @property
    def turns(self) -> tuple[float, float]:
        """The rate and its error in turns per second."""
        return self.rate / (2 * np.pi), self.rate_error / (2 * np.pi)

    def __str__(self) -> str:
        rate, error = self.turns
        both = f"{format_value(rate, 'Hz', error)} ({format_value(self.rate, 'rad/s', self.rate_error)})"
        return f"{self.name}: {both}, {ABOUT_ERROR}"

    @property
    def residuals(self) -> np.ndarray:
        """[planes] rad, beyond the line."""
        return self.values - (self.offset + self.rate * self.times)


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
    azimuth = found["spin_azimuth"].mean[point].copy()
    azimuth[1:] = np.unwrap(azimuth[1:])
    azimuth[0] = np.nan  # a spin along z has none
    return [line_through(name, times, values, found[key].deviation[point]) for name, key, values in
            (("polar angle θ", "spin_polar_angle", found["spin_polar_angle"].mean[point]),
             ("azimuth φ", "spin_azimuth", azimuth))]


def line_through(name: str, times: np.ndarray, values: np.ndarray, spread: np.ndarray) -> Angles:
    """Ordinary least squares through all planes but the first, raises NoAngles where they are too few.

    All planes see the same particles, and θ0 + rate (t - t0) is a line for each of them, whatever its speed: the
    errors of the means say nothing about the rate. What does is the scatter about the line. Where it goes on from plane
    to plane, as when the line is bent, the planes count for fewer: (1 - r)/(1 + r) of them, with the correlation r of
    neighbours."""
    good = np.isfinite(values) & np.isfinite(times)
    good[0] = False
    if good.sum() < 3:
        raise NoAngles(f"fewer than three planes have seen {name}")
    centre, middle = times[good].mean(), values[good].mean()
    lever = times[good] - centre
    rate = float(np.sum(lever * (values[good] - middle)) / np.sum(lever**2))
    scatter = values[good] - middle - rate * lever
    squares = np.sum(scatter**2)
    along = np.clip(np.sum(scatter[1:] * scatter[:-1]) / squares, 0.0, 1 - 1 / good.sum()) if squares > 0 else 0.0
    variance = squares / (good.sum() - 2) / np.sum(lever**2) * (1 + along) / (1 - along)
    return Angles(name, times, values, spread, rate, float(np.sqrt(variance)), float(middle - rate * centre))


@style.in_proportion
def draw_angles(results: Results, angles: Sequence[Angles], expected: Sequence[float | None], point: int,
                title: str | None = None) -> Figure:
    """Each angle above what it has beyond its fit, both side by side where a size is asked for that is wider than high; `expected` are rates in
    turns per second, drawn through the middle of the planes."""
    asked = style.room() or (7.2, 8.4)
    beside = asked[0] > asked[1]
    size = np.maximum(asked, LEAST_BESIDE if beside else LEAST_BELOW)
    figure, grid = plt.subplots(*((2, 2) if beside else (4, 1)), figsize=size, sharex=True, layout="constrained", squeeze=False,
                                gridspec_kw={"height_ratios": [2.4, 1] if beside else [2.4, 1, 2.4, 1]})
    panels, between = grid.T.ravel(), "\n" if beside else " "
    scale = fitting_scale(np.concatenate([one.times for one in angles]), "s")
    colour = LAWS.get(results.laws[point].split(" ")[0], (INK, "o"))[0]
    for (panel, below), one, rate in zip((panels[:2], panels[2:]), angles, expected):
        shown = np.asarray(scale.apply(one.times))
        fit = one.offset + one.rate * one.times
        panel.errorbar(shown, np.degrees(one.values), np.degrees(one.spread), fmt=".", color=colour, markersize=4,
                       ecolor=colour, elinewidth=1.2, label=f"mean, and standard deviation{between}of the particles")
        turns, error = one.turns
        panel.plot(shown, np.degrees(fit), color=INK, linewidth=1,
                   label=f"fit: {format_value(turns, 'Hz', error)}\n{ABOUT_ERROR}".replace("-", "−"))
        below.axhline(0, color=INK, linewidth=1)
        rest = one.residuals
        largest = max(np.nanmax(np.abs(rest[1:])), LEAST)
        small = Scale(*prefixed(largest, "rad"))
        below.plot(shown, small.apply(rest), ".", color=colour, markersize=4)
        seen = [largest]
        if rate is not None:
            middle = np.nanmean(one.times)
            line = one.offset + one.rate * middle + 2 * np.pi * rate * (one.times - middle)
            looks = {"color": GREY, "linewidth": 2, "linestyle": (0, (2, 3))}
            panel.plot(shown, np.degrees(line), label=f"expected: {format_value(rate, 'Hz')}".replace("-", "−"), **looks)
            below.plot(shown, small.apply(line - fit), **looks)
            seen += [furthest for furthest in [np.nanmax(np.abs(line - fit))] if furthest <= SEEN * largest]
        below.set_ylim(-1.15 * small.apply(max(seen)), 1.15 * small.apply(max(seen)))
        panel.set_ylabel(f"{one.name} (deg)")
        below.set_ylabel(small.label("beyond the fit"), fontsize=style.scaled(8.5))
        panel.legend(loc="best")
        for each in (panel, below):
            each.grid(True)
    for below in grid[-1]:
        below.set_xlabel(scale.label("time of flight, mean in each plane"))
    style.write_title(figure, f"{title or results.title}\n{law_name(results.laws[point])}, {results.species[point]}")
    figure.align_ylabels(grid)
    return figure

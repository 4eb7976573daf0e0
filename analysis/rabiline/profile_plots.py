"""The profiles of beams on a detector, one over the other: the smear and the lines of a deflection."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from . import style
from .results import Results
from .style import GREY, looks
from .units import fitting_scale

RIM = 2.0  # points, by which a line is wider than each that hides it


@dataclass(frozen=True)
class Profile:
    """What one scan point leaves on a detector along one axis."""

    label: str
    law: str
    edges: np.ndarray  # [n + 1] m
    density: np.ndarray  # [n] 1/m, of all that was emitted
    errors: np.ndarray  # [n]
    aimed: bool  # the share is of what starts towards the target of the source


def profile_of(results: Results, detector: str, point: int, along: str, label: str) -> Profile:
    """The profile of a detector along "x" or "z", summed over the other axis."""
    seen = results.detectors[detector]
    edges, counts, errors = (seen.x_edges + seen.offset_x[point], seen.counts_x, seen.errors_x) if along == "x" else \
        (seen.z_edges + seen.offset_z[point], seen.counts_z, seen.errors_z)
    each = results.emitted[point] * np.diff(edges)
    return Profile(label, results.laws[point], edges, counts[point] / each, errors[point] / each,
                   results.aimed_fraction is not None)


def draw_profiles(profiles: Sequence[Profile], along: str, title: str, heading: str = "") -> Figure:
    """Steps with error bars, in shares of the emitted beam per length; `heading` stands above their labels."""
    edges = np.concatenate([profile.edges for profile in profiles])
    scale = fitting_scale(edges, "m")
    figure, axes = plt.subplots(figsize=style.size(7.2, 4.8), layout="constrained")
    for number, (profile, look) in enumerate(zip(profiles, looks([profile.law for profile in profiles]))):
        at = np.asarray(scale.apply(profile.edges))
        y, errors = profile.density * scale.factor, profile.errors * scale.factor
        above = sum(_coincide(profile, other) for other in profiles[number + 1:])
        axes.stairs(y, at, color=look.colour, linewidth=1.2 + RIM * above, linestyle="--" if look.open else "-", label=style.plain(profile.label))
        hit = y > 0
        axes.errorbar(((at[:-1] + at[1:]) / 2)[hit], y[hit], errors[hit], fmt="none", ecolor=look.colour,
                      elinewidth=0.9)
    axes.set_xlim(*_span(profiles, scale.factor))
    nothing = not any(profile.density.any() for profile in profiles)
    if nothing:
        axes.text(0.5, 0.5, "nothing detected", transform=axes.transAxes, ha="center", color=GREY)
    axes.set_ylim(0, 1 if nothing else None)
    style.name_below(axes, scale.label(along))
    of = "aimed at the target" if profiles[0].aimed else "emitted"
    axes.grid(axis="y")
    style.write_title(figure, title)
    foot = style.legend_below(figure, axes, min(3, len(profiles)), heading) if len(profiles) > 1 or profiles[0].label else 0.0
    axes.set_ylabel(style.upright(figure, f"detected / {of} per {scale.unit}\n(bars: 1 σ)", foot))
    return figure


def _coincide(one: Profile, other: Profile) -> bool:
    """Whether two profiles are the same, as where two laws say the same."""
    return np.array_equal(one.edges, other.edges) and np.array_equal(one.density, other.density)


def _span(profiles: Sequence[Profile], factor: float) -> tuple[float, float]:
    """Where anything was detected, with a margin."""
    edges = [edge for p in profiles for edge in (p.edges[:-1][p.density > 0], p.edges[1:][p.density > 0])]
    hit = np.concatenate(edges)
    low, high = (hit.min(), hit.max()) if hit.size else (profiles[0].edges[0], profiles[0].edges[-1])
    margin = 0.05 * (high - low)
    return (low - margin) / factor, (high + margin) / factor

"""The likelihood over the strength of the hypothesis, as a picture."""
from __future__ import annotations

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from . import style
from .kappa import CONFIDENCE, Bound, family
from .style import GREY, LAWS
from .templates import Templates
from .units import fitting_scale, format_value

SHOWN = 5  # times the level, at least, on the axis


@style.in_proportion
def draw_profile(made: Templates, found: Bound, title: str | None) -> Figure:
    """-2 ln L above its least value over κ, scan points, the level of acceptance and the interval connected to 0."""
    result, colour = found.profile, LAWS["dorado"][0]
    figure, axes = plt.subplots(figsize=(7.2, 4.5), layout="constrained")
    axes.plot(result.fine, result.interpolated, color=colour, linewidth=1.2, label="interpolated")
    axes.plot(result.strengths, result.values, color=colour, marker="D", markersize=4, linestyle="none",
              markeredgewidth=0, label="scan points")
    axes.axhline(result.level, color=GREY, linestyle=(0, (4, 3)), linewidth=1,
                 label=f"{result.level:.2f}: accepted below, {CONFIDENCE:.0%}")
    if result.quoted is not None:
        low, high = result.quoted.low, result.quoted.high
        axes.axvspan(low, high, color="#009E73", alpha=0.18, linewidth=0,
                     label=f"bound, connected to κ = 0: {format_value(float(f'{low:.3g}'), '')} to {format_value(float(f'{high:.3g}'), '')}")
    for other in result.others:
        axes.axvspan(other.low, other.high, color=GREY, alpha=0.15, linewidth=0)
    shown = result.interpolated <= SHOWN * result.level
    if result.quoted is not None:
        shown |= (result.fine >= result.quoted.low) & (result.fine <= result.quoted.high)
    near = np.flatnonzero(shown)
    axes.set_ylim(-0.04 * SHOWN * result.level, SHOWN * result.level)
    margin = max(0.15 * np.ptp(result.fine[near]), 0.02 * np.ptp(result.fine))
    axes.set_xlim(max(result.fine[0] - margin / 3, result.fine[near[0]] - margin),
                  min(result.fine[-1] + margin / 3, result.fine[near[-1]] + margin))
    scale = fitting_scale(np.array(axes.get_xlim()), "")
    axes.xaxis.set_major_formatter(lambda value, _: f"{scale.apply(value):.6g}".replace("-", "−"))
    axes.set_xlabel(scale.label("κ, strength of the hypothesis; 1: the paper, 0: straight flight"))
    axes.set_ylabel("−2 ln L above its least value")
    axes.grid(axis="y")
    style.write_title(figure, f"{title or made.title}\n{family(made)}\ncounts: {found.source}")
    axes.legend(loc="best")
    return figure

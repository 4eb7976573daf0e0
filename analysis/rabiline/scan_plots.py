"""The curves of scans as pictures."""
from __future__ import annotations

from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .curves import Curve, NoResonance, Resonance, half_maximum
from .fit import fit
from .style import GREY, PALE, Look, looks
from .units import Scale, fitting_scale, format_value


def draw_scan(curves: Sequence[Curve], labels: Sequence[str], title: str, marks: dict[str, float]) -> Figure:
    """Curves with their error bars over one axis. `marks` names values of the axis (SI) to point out; the dip or peak
    of a curve that has one is fitted, or measured at half maximum where the fit fails."""
    axis = curves[0].axis
    scale = fitting_scale(np.concatenate([curve.x for curve in curves]), axis.units)
    figure, axes = plt.subplots(figsize=(7.2, 4.5), layout="constrained")
    for rank, (curve, label, look) in enumerate(zip(curves, labels, looks([curve.law for curve in curves]))):
        _draw_curve(axes, curve, label, look, scale, width=1.1 + 1.7 * (len(curves) - 1 - rank))
        resonance = _measured(curve)
        if resonance is not None:
            _draw_resonance(axes, resonance, curve, look, scale)
    for name, value in marks.items():
        axes.axvline(scale.apply(value), color=GREY, linestyle=(0, (4, 3)), linewidth=1, zorder=0)
        axes.annotate(name, (scale.apply(value), 1), xycoords=("data", "axes fraction"), xytext=(0, 3),
                      textcoords="offset points", ha="center", va="bottom", color=GREY, fontsize=9)
    if axis.labels:
        axes.set_xticks(axis.values, axis.labels)
    axes.set_xlabel(scale.label(axis.parameter))
    axes.set_ylabel("detected / emitted   (bars: one standard error)")
    axes.set_ylim(*_fraction_limits(curves))
    axes.margins(x=0.02)
    axes.grid(axis="y", color=PALE, linewidth=0.8)
    figure.suptitle(title, fontsize=11.5)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.15), ncol=min(3, len(curves)), columnspacing=2.5)
    return figure


def _measured(curve: Curve) -> Resonance | None:
    """None for a flat line, which is a result too."""
    for measure in (lambda: fit(curve).resonance, lambda: half_maximum(curve)):
        try:
            return measure()
        except NoResonance:
            continue
    return None


def _draw_curve(axes: Axes, curve: Curve, label: str, look: Look, scale: Scale, width: float) -> None:
    """A curve; wider lines and markers lie below, so that curves which coincide stay visible."""
    style = "none" if curve.axis.labels else "-"
    axes.errorbar(scale.apply(curve.x), curve.y, curve.errors, color=look.colour, marker=look.marker, linestyle=style,
                  markersize=2 + width, linewidth=width, elinewidth=0.9, capsize=2, capthick=0.9,
                  markeredgewidth=0.9, label=label)


def _draw_resonance(axes: Axes, resonance: Resonance, curve: Curve, look: Look, scale: Scale) -> None:
    """An arrow across the full width, and beside it centre and width with their errors."""
    centre, width = resonance.centre, resonance.width
    low, high = (scale.apply(centre.value + side * width.value / 2) for side in (-1, 1))
    axes.annotate("", (low, resonance.level), (high, resonance.level),
                  arrowprops={"arrowstyle": "<->", "color": look.colour, "shrinkA": 0, "shrinkB": 0})
    unit = curve.axis.units
    text = (f"centre {format_value(centre.value, unit, centre.error)}\n"
            f"FWHM {format_value(width.value, unit, width.error)}")
    on_left = centre.value > curve.x.mean() + 0.1 * np.ptp(curve.x)
    axes.annotate(text, (low if on_left else high, resonance.level), xytext=(-10 if on_left else 10, 0),
                  textcoords="offset points", ha="right" if on_left else "left", va="center", color=look.colour)


def _fraction_limits(curves: Sequence[Curve]) -> tuple[float, float]:
    low = min(np.min(curve.y - curve.errors) for curve in curves)
    high = max(np.max(curve.y + curve.errors) for curve in curves)
    if high - low > 0.2:
        low = min(low, 0.0)
    margin = 0.06 * (high - low) or 0.05
    return low - margin, high + margin

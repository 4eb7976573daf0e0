"""The populations of spin levels at a detector as pictures: Rabi's curves."""
from __future__ import annotations

from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from . import style
from .curves import Curve
from .results import Detector, Levels
from .scan_plots import SYMBOL, draw_marks
from .style import LAWS, OTHERS, Look
from .units import is_logarithmic, Scale, fitting_scale, law_name

LOOKS = [Look(*pair) for pair in [*LAWS.values(), *OTHERS]]
PANEL = 2.6  # inches high, where there are several


def draw_levels(rows: Sequence[Curve], detector: Detector, title: str, marks: dict[str, float]) -> Figure:
    """The fraction of what a detector caught that is in each level, over the scan, with error bars. One panel for each
    row of the scan, such as a law. Points at which nothing was detected have no level and are left out."""
    axis = rows[0].axis
    scale = fitting_scale(axis.values, axis.units)
    figure, grid = plt.subplots(len(rows), 1, figsize=(7.2, 1.9 + max(PANEL, 3.2 / len(rows)) * len(rows)),
                                sharex=True, squeeze=False, layout="constrained")
    panels = list(grid[:, 0])
    for panel, row in zip(panels, rows):
        _draw_row(panel, row, detector.levels, scale)
        draw_marks(panel, marks, scale, named=panel is panels[0])
        panel.set_title(row.label, loc="left", fontsize=9.5, pad=18 if marks and panel is panels[0] else 6)
    if axis.labels:
        panels[-1].set_xticks(axis.values, [law_name(label).replace(", ", "\n", 1) for label in axis.labels])
    if is_logarithmic(axis.values):
        panels[-1].set_xscale("log")
    panels[-1].set_xlabel(scale.label(axis.parameter))
    figure.supylabel(f"fraction of what {detector.name} detected\n(bars: 1 σ)", fontsize=10)
    style.write_title(figure, title)
    below = -0.55 / panels[-1].get_position().height / figure.get_figheight()  # inches to axes, near enough
    named = {label: handle for panel in panels for handle, label in zip(*panel.get_legend_handles_labels())}
    panels[-1].legend(named.values(), named.keys(), loc="upper center", bbox_to_anchor=(0.5, below),
                      ncol=max(1, min(5, 84 // (6 + max(map(len, named), default=1)))))
    return figure


def _draw_row(axes: Axes, row: Curve, levels: Levels, scale: Scale) -> None:
    """The levels that this row has: a law may not know those of another. Lines break where nothing was detected."""
    x, drawn = scale.apply(row.x), False
    for i, label in enumerate(levels.labels):
        y, errors = levels.fractions[row.points, i], levels.errors[row.points, i]
        known = np.isfinite(y)
        if not known.any():
            continue
        look, drawn = LOOKS[i % len(LOOKS)], True
        if not row.axis.labels:
            axes.plot(x, y, color=look.colour, linewidth=1.1, linestyle="-" if i < len(LOOKS) else "--")
        axes.errorbar(x[known], y[known], errors[known], color=look.colour, marker=look.marker, linestyle="none",
                      markersize=SYMBOL, markeredgewidth=0, elinewidth=0.9, capsize=2, capthick=0.9,
                      label=label.replace("-", "−").replace("S_z", "$S_z$"))
    if not drawn:
        axes.text(0.5, 0.5, "nothing detected", transform=axes.transAxes, ha="center")
    axes.set_xlim(*_span(x, 0.1 if row.axis.labels else 0.02))
    axes.set_ylim(-0.04, 1.04)
    axes.grid(axis="y")


def _span(x: np.ndarray, margin: float) -> tuple[float, float]:
    return x.min() - margin * np.ptp(x), x.max() + margin * np.ptp(x)

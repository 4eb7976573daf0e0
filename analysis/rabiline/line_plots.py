"""A curve with a closed form fitted to it."""
from __future__ import annotations

import re
from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from . import style
from .fit_plots import MODEL
from .lines import LineFit
from .style import INK
from .units import fitting_scale, is_logarithmic

PLACES = 1000  # of the form, at least


def draw_line(x: np.ndarray, y: np.ndarray, errors: np.ndarray, fitted: LineFit, name: str, unit: str, title: str,
              words: Sequence[str], label: str, written: tuple[str, float] | None = None) -> Figure:
    """The points with their errors, the form, and above it its numbers; `label` says what the points are, `written` in which unit the axis is."""
    scale = fitting_scale(x, unit, written)
    order = np.argsort(x)
    at = np.asarray(scale.apply(x[order]))
    in_ratios = is_logarithmic(np.unique(x))
    fine = np.union1d((np.geomspace if in_ratios else np.linspace)(x.min(), x.max(), PLACES), x)
    figure, axes = plt.subplots(figsize=style.size(7.2, 4.5 + 0.06 * len(words)), layout="constrained")
    axes.errorbar(at, y[order], errors[order], fmt="o", color=INK, markersize=3, elinewidth=0.8, linestyle="none")
    axes.plot(scale.apply(fine), fitted.curve(fine), color=MODEL, linewidth=1.3, zorder=3)  # over the points, which may stand close
    if in_ratios:
        style.logarithmic(axes.xaxis)
    style.name_below(axes, scale.label(name))
    axes.set_ylabel(label)
    axes.grid(axis="y")
    style.write_title(figure, title)
    told = [re.sub(r" -(?=[ \d.])", " −", " ".join(line.split()).replace("chi²", "χ²")) for line in words]
    style.write_numbers(axes, told, [line for line in told if line.startswith(("χ²", "the form"))])
    return figure

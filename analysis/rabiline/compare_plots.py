"""Two results of one scan as a picture: both, and their difference over its error."""
from __future__ import annotations

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from . import stated, style
from .curves import curves, labels_of
from .errors import InputError
from .results import Results
from .scan_plots import about_errors
from .style import GREY, INK, PALE, looks
from .units import is_logarithmic

MOST_CURVES = 4


def draw_difference(one: Results, other: Results, detector: str, title: str | None, agreement: str) -> Figure:
    """Above the fractions of both with their errors, below their difference in standard deviations, point by point."""
    pairs = list(zip(curves(one, detector), curves(other, detector)))
    if len(pairs) > MOST_CURVES:
        raise InputError(f"{len(pairs)} curves are too many for one picture, which shows {MOST_CURVES} of each file")
    axis = pairs[0][0].axis
    scale = axis.scale
    figure, (above, below) = plt.subplots(2, 1, figsize=style.size(7.2, 5.2), sharex=True, layout="constrained")
    below.axhspan(-1, 1, color=PALE, linewidth=0)
    below.axhline(0, color=GREY, linewidth=0.8)
    names = [one.path.stem, other.path.stem] if one.path.stem != other.path.stem else [str(one.path), str(other.path)]
    names = [stated.said(name, own) for name, own in zip(names, stated.differing([one.path, other.path]))]
    differences = [(mine.y - its.y) / np.hypot(mine.errors, its.errors) for mine, its in pairs]
    for (mine, its), difference, look in zip(pairs, differences, looks([curve.law for curve, _ in pairs])):
        x = scale.apply(mine.x)
        for curve, name, filled, hue in ((mine, names[0], True, look.colour), (its, names[1], False, look.colour if len(pairs) > 1 else INK)):
            label = ", ".join(filter(None, (name, curve.label if len(pairs) > 1 else "")))
            above.errorbar(x, curve.y, curve.errors, color=hue, marker="o" if filled else "s", markersize=3.4 if filled else 5,
                           markerfacecolor=hue if filled else "none", linestyle="none" if axis.labels else "-" if filled else "--",
                           linewidth=1.0, elinewidth=0.9, capsize=2, label=style.plain(label))
        below.plot(x, difference, "o", color=look.colour, markersize=3)
    if axis.labels:
        below.set_xticks(axis.values, [style.beside_ticks(figure, label) for label in axis.labels])
    if is_logarithmic(axis.values):
        style.logarithmic(below.xaxis)
    style.name_below(below, scale.label(axis.parameter))
    style.write_deviations(below, "difference", max((np.abs(row[np.isfinite(row)]).max(initial=0.0) for row in differences)))
    above.grid(axis="y")
    small = style.points("legend.fontsize")
    above.set_title(style.in_lines(agreement.replace("chi²", "χ²"), figure.get_figwidth() - 0.9, small), fontsize=small)
    style.write_title(figure, title or one.title)
    foot = style.legend_at_foot(figure, *above.get_legend_handles_labels())
    drawn = [curve for pair in pairs for curve in pair]
    of = "aimed at the target" if pairs[0][0].aimed else "emitted"
    above.set_ylabel(style.upright(figure, f"{labels_of(one)[detector]}: detected / {of}\n({about_errors(drawn, above.get_ylim())})", foot + 0.3 * figure.get_figheight()))
    return figure

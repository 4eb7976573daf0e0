"""Counts, what was fitted to them, and the residuals."""
from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure
from scipy import stats

from . import style
from .covariance import freedom_in_words, p_in_words
from .fit_report import is_undetermined, verdict_of, why_unknown
from .style import INK, LAWS, OTHERS, PALE
from .units import as_written, base_of, fitting_scale, is_logarithmic

if TYPE_CHECKING:
    from .fitting import CountsFit

MODEL = LAWS["dorado"][0]


def draw_fit(fit: CountsFit, title: str | None = None) -> Figure:
    """Above the counts with the curve and its band of the simulation, below the residuals in standard deviations."""
    order = np.argsort(fit.counts.x)
    counts, expected, band = fit.counts.counts[order], fit.expected[order], fit.template_errors[order]
    unit, factor = base_of(fit.counts.unit)
    places = factor * fit.counts.x[order]
    scale = fitting_scale(places, unit, as_written(fit.counts.unit))
    x = np.asarray(scale.apply(places))
    lines, verdict = _numbers(fit), _verdict(fit)
    figure, (above, below) = plt.subplots(2, 1, figsize=style.size(7.2, 5.2 + 0.08 * len(lines + verdict)), sharex=True, layout="constrained")
    low, high = (np.maximum(limit, 0) for limit in _poisson(counts))
    curve_name, band_name = ("fitted", "its error") if figure.get_figwidth() < style.NARROW else ("simulated, fitted", "its standard error")
    for own, label, colour in _rows(fit, order):
        above.errorbar(x[own], counts[own], (counts[own] - low[own], high[own] - counts[own]), fmt="o", markersize=3,
                       color=colour if label else INK, elinewidth=0.8, linestyle="none", label=label or "counted")
        above.plot(x[own], expected[own], color=colour, linewidth=1.3, label=None if label else curve_name, zorder=3)
        if band.max() > 0.002 * np.ptp(expected):
            above.fill_between(x[own], (expected - band)[own], (expected + band)[own], color=colour, alpha=0.2, linewidth=0,
                               label=None if label else band_name)
    above.set_ylabel("counts")
    above.grid(axis="y")
    residuals = (counts - expected) / np.sqrt(np.maximum(expected, 1e-9) + band**2)
    below.axhspan(-1, 1, color=PALE)
    for own, label, colour in _rows(fit, order):
        below.plot(x[own], residuals[own], "o", color=colour if label else INK, markersize=3)
    if is_logarithmic(np.unique(fit.counts.x)):
        style.logarithmic(below.xaxis)
    style.write_deviations(below, "residual", np.abs(residuals).max())
    style.name_below(below, scale.label(fit.counts.parameter))
    style.write_title(figure, title or fit.title)
    style.write_numbers(above, lines + verdict, verdict)
    about = "points: counted, lines: simulated and fitted" if fit.counts.across else ""
    if style.size(0, 0) != (0, 0):
        style.legend_at_foot(figure, *above.get_legend_handles_labels(), about)
    else:
        below.legend(*above.get_legend_handles_labels(), loc="upper center", bbox_to_anchor=(0.5, -0.45), ncol=3, title=about or None,
                     title_fontsize=style.points("legend.fontsize"))
    return figure


def _rows(fit: CountsFit, order: np.ndarray) -> list[tuple[np.ndarray, str, str]]:
    """Which places belong to one curve, what tells it from others, and its colour."""
    across = fit.counts.across
    if across is None:
        return [(np.ones(order.size, dtype=bool), "", MODEL)]
    places = np.array(across.places)[order]
    colours = [colour for colour, _ in [*LAWS.values(), *OTHERS]]
    return [(places == place, f"{across.parameter} = {place}", colours[i % len(colours)])
            for i, place in enumerate(dict.fromkeys(across.places))]


def _numbers(fit: CountsFit) -> list[str]:
    numbers = []
    for i, name in enumerate(fit.names):
        lost = why_unknown(fit, i) or ("not determined" if is_undetermined(fit, i) else "")
        numbers.append(f"{name} {lost}" if lost else f"{name} = {fit.told(i)}".replace("= -", "= −"))
    return numbers


def _verdict(fit: CountsFit) -> list[str]:
    """On the fit as a whole."""
    return [*([f"χ² {fit.chi_squared:.1f} for {freedom_in_words(fit.freedom)}, {p_in_words(fit.p)}"] if fit.freedom > 0 else []),
            *(f"the counts ask for a free {one.name}" for one in fit.held if one.is_wanted and one.is_possible), *filter(None, [verdict_of(fit)])]


def _poisson(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Central 68 % limits (Garwood 1936)."""
    low = np.where(counts > 0, stats.chi2.ppf(0.15866, 2 * np.maximum(counts, 1)) / 2, 0)
    return low, stats.chi2.ppf(1 - 0.15866, 2 * (counts + 1)) / 2

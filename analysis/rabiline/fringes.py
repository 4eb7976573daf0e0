"""Where the fit of fringes starts: their periods from the periodogram of a curve, and centres that stand out in chi²."""
from __future__ import annotations

from typing import Callable, Sequence

import numpy as np

PERIODS = 6  # the strongest of a periodogram
FEW = 1.0, 1.5, 2.0, 3.0  # in the scan, which a periodogram does not tell from the line below them
FINE = 4  # times as fine as the extent of a scan tells periods apart
PLACES = 20  # of the form on each fringe, between which it is straight
MOST_PLACES = 4000
MANY = 201  # points from which on only those where the curve turns may be the centre


def periods_of(x: np.ndarray, y: np.ndarray, sigma: np.ndarray) -> list[float]:
    """The strongest periods of a curve y [n] with errors sigma [n] over rising x [n], the strongest first, in the unit of x; then those of a few
    fringes. What changes over the whole of the scan, as the line below the fringes does, is taken off as a parabola."""
    extent, step = float(np.ptp(x)), float(np.median(np.diff(np.unique(x))))
    at = 2 * (x - x[0]) / extent - 1
    rest = y - np.polynomial.polynomial.polyval(at, np.polynomial.polynomial.polyfit(at, y, 2, w=1 / sigma))
    rates = np.arange(FINE, max(FINE * extent / (2 * step), FINE) + 3) / (FINE * extent)  # at least three
    power = np.array([abs(np.sum(np.hanning(x.size + 2)[1:-1] * rest * np.exp(2j * np.pi * rate * (x - x[0])))) for rate in rates])
    beside = np.concatenate([[0.0], power, [0.0]])
    tops = np.flatnonzero((power >= beside[:-2]) & (power >= beside[2:]))
    return [*(1 / rates[i] for i in sorted(tops, key=lambda i: -power[i])[:PERIODS]), *(extent / few for few in FEW)]


def centres_of(f: Callable[..., np.ndarray], trials: Sequence[Sequence[float]], period: Callable[[Sequence[float]], float], x: np.ndarray, y: np.ndarray,
               sigma: np.ndarray) -> list[tuple[float, float, Sequence[float]]]:
    """chi², centre and parameters of the form f(d, *parameters), which is even in d, wherever chi² of the best of the `trials` is least along the
    centre, by rising chi². Baseline and contrast are free; `period` is that of the fringes of a trial."""
    centres = x[1:-1][(y[1:-1] - y[:-2]) * (y[2:] - y[1:-1]) <= 0] if x.size > MANY else np.sort(np.concatenate([x, (x[1:] + x[:-1]) / 2]))
    distances, weights, extent = np.abs(x - centres[:, None]), sigma**-2, float(np.ptp(x))
    mean = np.average(y, weights=weights)
    chi_squared, best = np.full(centres.size, np.inf), np.zeros(centres.size, dtype=int)
    for i, trial in enumerate(trials):
        places = np.linspace(0, extent, int(np.clip(PLACES * extent / period(trial), PLACES, MOST_PLACES)) + 1)
        shape = np.interp(distances, places, f(places, *trial))
        shape -= (shape @ weights)[:, None] / weights.sum()
        of_shape = np.maximum(shape**2 @ weights, 1e-300)
        found = np.sum(weights * (y - mean)**2) - (shape @ (weights * (y - mean)))**2 / of_shape
        better = found < chi_squared
        chi_squared[better], best[better] = found[better], i
    beside = np.concatenate([[np.inf], chi_squared, [np.inf]])
    least = np.flatnonzero((chi_squared <= beside[:-2]) & (chi_squared <= beside[2:]) & np.isfinite(chi_squared))
    return [(float(chi_squared[i]), float(centres[i]), trials[best[i]]) for i in sorted(least, key=lambda i: chi_squared[i])]

"""Where fits of closed forms start."""
from __future__ import annotations

from typing import Mapping, Sequence

import numpy as np

from .forms import Form
from .fringes import centres_of, periods_of

STARTS = 6  # centres to begin with
BLENDED = 2, 4  # points between lines, where one starts in the middle of all


def linear(form: Form, x: np.ndarray, y: np.ndarray, sigma: np.ndarray, centres: Sequence[float],
            shared: Sequence[float]) -> tuple[float, np.ndarray]:
    """chi², and baseline and contrasts that make it least."""
    columns = np.stack([np.ones(x.size), *(form.f(x - centre, *shared) for centre in centres)], axis=1)
    found = np.linalg.lstsq(columns / sigma[:, None], y / sigma, rcond=1e-10)[0]
    return float(np.sum(((columns @ found - y) / sigma)**2)), found


def first_guesses(form: Form, x: np.ndarray, y: np.ndarray, sigma: np.ndarray, lines: int,
                   start: Mapping[str, float]) -> list[tuple[float, list[float], Sequence[float]]]:
    """With the chi² of each, the best first: centres one after the other, each where it helps most, for the best of the form's starts; of
    fringes each centre that stands out."""
    step, extent = float(np.median(np.diff(np.unique(x)))), float(np.ptp(x))
    trials = [[start.get(name, value) for name, value in zip(form.parameters, trial)]
              for trial in form.starts(periods_of(x, y, sigma) if form.period else np.geomspace(2 * step, extent, 10))]
    if form.period and lines == 1 and "centre" not in start:
        return [(chi_squared, [centre], shared) for chi_squared, centre, shared in centres_of(form.f, trials, form.period, x, y, sigma)[:STARTS]]
    candidates = x if x.size <= 201 else x[::x.size // 200]
    found = []
    for shared in trials:
        centres: list[float] = []
        for i in range(lines):
            given = start.get("centre" if lines == 1 else f"centre_{i + 1}")
            tried = [given] if given is not None else candidates
            centres.append(min(tried, key=lambda c: linear(form, x, y, sigma, [*centres, c], shared)[0]))
        found.append((linear(form, x, y, sigma, centres, shared)[0], centres, shared))
        if lines > 1 and not any(name.startswith("centre") for name in start):  # that blend into one
            for steps in BLENDED:
                split = (centres[0] + steps * step * (np.arange(lines) - (lines - 1) / 2)).tolist()
                found.append((linear(form, x, y, sigma, split, shared)[0], split, shared))
    of: dict[float, tuple[float, list[float], Sequence[float]]] = {}  # the best start by its first centre
    for one in sorted(found, key=lambda row: row[0]):
        of.setdefault(one[1][0], one)
    return list(of.values())[:STARTS]

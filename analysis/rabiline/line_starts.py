"""Where fits of closed forms start."""
from __future__ import annotations

from typing import Mapping, Sequence

import numpy as np

from .forms import Form
from .fringes import centres_of, periods_of

STARTS = 6  # centres to begin with
SAME = 1e-6  # of a step: distances that are one
TWICE = 1e-12  # of the square of a shape: what is left of one that others make
BLENDED = 2, 4  # points between lines, where one starts in the middle of all


def linear(form: Form, x: np.ndarray, y: np.ndarray, sigma: np.ndarray, centres: Sequence[float],
            shared: Sequence[float]) -> tuple[float, np.ndarray]:
    """chi², and baseline and contrasts that make it least."""
    columns = np.stack([np.ones(x.size), *(form.f(x - centre, *shared) for centre in centres)], axis=1)
    found = np.linalg.lstsq(columns / sigma[:, None], y / sigma, rcond=1e-10)[0]
    return float(np.sum(((columns @ found - y) / sigma)**2)), found


def _one_after_another(candidates: np.ndarray, shapes: np.ndarray, given: Sequence[tuple[float, np.ndarray] | None], y: np.ndarray,
                       constant: np.ndarray) -> list[float]:
    """Centres, each that of the `candidates` [c] whose shape [c, n] takes most off chi² of y [n] beside a constant [n] and those before, all in
    errors; or what is `given`, with its shape [n]."""
    taken, centres = constant[None] / np.linalg.norm(constant), []
    for one in given:
        centre, tried = (candidates, shapes) if one is None else (np.array(one[:1]), one[1][None])
        new = tried - tried @ taken.T @ taken
        sizes = np.sum(new**2, axis=1)
        sizes[sizes <= TWICE * np.sum(tried**2, axis=1)] = np.inf
        best = int(np.argmax((new @ y)**2 / sizes))
        taken = np.vstack([taken, new[best] / np.sqrt(sizes[best])])
        centres.append(float(centre[best]))
    return centres


def first_guesses(form: Form, x: np.ndarray, y: np.ndarray, sigma: np.ndarray, lines: int,
                   start: Mapping[str, float]) -> list[tuple[float, list[float], Sequence[float]]]:
    """With the chi² of each, the best first: centres one after the other, each where it helps most, for the best of the form's starts; of
    fringes each centre that stands out."""
    step, extent = float(np.median(np.diff(np.unique(x)))), float(np.ptp(x))
    trials = [[start.get(name, value) for name, value in zip(form.parameters, trial)]
              for trial in form.starts(periods_of(x, y, sigma) if form.period else np.geomspace(2 * step, extent, 10))]
    if form.period and lines == 1 and "centre" not in start:
        return [(chi_squared, [centre], shared) for chi_squared, centre, shared in centres_of(form.f, trials, form.period, x, y, sigma)[:STARTS]]
    given = [start.get("centre" if lines == 1 else f"centre_{i + 1}") for i in range(lines)]
    candidates = x if x.size <= 201 else x[::x.size // 200]
    away = x - candidates[:, None]
    _, first, which = np.unique(np.rint(away / (SAME * step)), return_index=True, return_inverse=True)  # few, of a scan in even steps
    parts = np.array_split(away.ravel()[first], -(-first.size // x.size))
    found = []
    for shared in trials:
        shapes = np.concatenate([form.f(part, *shared) for part in parts])[which].reshape(away.shape) / sigma
        centres = _one_after_another(candidates, shapes, [None if c is None else (c, form.f(x - c, *shared) / sigma) for c in given], y / sigma, 1 / sigma)
        found.append((linear(form, x, y, sigma, centres, shared)[0], centres, shared))
        if lines > 1 and not any(name.startswith("centre") for name in start):  # that blend into one
            for steps in BLENDED:
                split = (centres[0] + steps * step * (np.arange(lines) - (lines - 1) / 2)).tolist()
                found.append((linear(form, x, y, sigma, split, shared)[0], split, shared))
    of: dict[float, tuple[float, list[float], Sequence[float]]] = {}  # the best start by its first centre
    for one in sorted(found, key=lambda row: row[0]):
        of.setdefault(one[1][0], one)
    return list(of.values())[:STARTS]

"""What counts know of parameters together: their covariance, and the combinations that stay unknown."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence

import numpy as np

from .counts_problem import Fisher

MOST_POWER = 4.0  # of one parameter by which another makes up for it; more is one of them alone
SLIGHT = 0.1  # a part of a direction, or what a power is away from one, that may be the noise of slopes or their bends


@dataclass(frozen=True)
class Direction:
    """A combination of parameters that the data do not know: all changed by these parts of themselves, nothing happens."""

    names: tuple[str, ...]
    parts: np.ndarray  # relative changes, the largest 1
    weights: np.ndarray  # changes in errors that are left where the others are known, the largest 1
    hidden: bool = False  # they would know it, but for the noise of the simulation

    @property
    def involved(self) -> np.ndarray:
        """[any] The numbers of the parameters that it does not know."""
        return np.flatnonzero(np.abs(self.weights) > SLIGHT)

    def __str__(self) -> str:
        if self.hidden:
            return f"too few particles: the simulation's own noise hides what {' and '.join(f'`{self.names[i]}`' for i in self.involved)} {'change' if len(self.involved) > 1 else 'changes'}"
        changes = ", ".join(f"`{self.names[i]}` by {100 * self.parts[i]:+.3g} %" for i in self.involved)
        change = "changes" if self.involved.size == 1 else "together change"
        return f"degenerate: {changes} {change} next to nothing that this simulation could see"


def analysis(fisher: Fisher, values: np.ndarray, names: Sequence[str]
             ) -> tuple[np.ndarray, float, tuple[Direction, ...], tuple[tuple[str, float, float], ...]]:
    """Covariance, condition number, and what is degenerate."""
    _, vectors, known = fisher.directions
    covariance = fisher.covariance
    directions, combined = [], []
    for vector, hidden in zip(vectors[:, ~known].T, fisher.hidden[~known]):
        relative = vector * fisher.errors / np.where(values == 0, 1.0, values)
        directions.append(Direction(tuple(names), *(one / one[np.argmax(np.abs(one))] for one in (relative, vector)), bool(hidden)))
        combined += _combination(directions[-1], values, covariance) if np.sum(~known) == 1 and not hidden else []
    grown = np.zeros(values.size)  # what is not known has no error: as large as the parameter itself, at least
    for direction in directions:
        grown[direction.involved] = np.abs(values[direction.involved])
    covariance = covariance + np.diag(grown**2)
    return covariance, fisher.condition, tuple(directions), tuple(combined)


def _combination(direction: Direction, values: np.ndarray, covariance: np.ndarray) -> list[tuple[str, float, float]]:
    """Of two degenerate parameters, the product of powers that the data do know."""
    if direction.involved.size != 2 or (values[direction.involved] <= 0).any():
        return []
    first, second = direction.involved
    power = -direction.parts[first] / direction.parts[second]
    if not 1 / MOST_POWER <= abs(power) <= MOST_POWER:
        return []
    power = next((whole for whole in (-1.0, 1.0) if abs(power - whole) <= SLIGHT), power)
    names = direction.names[first], direction.names[second]
    name = {-1.0: " / ", 1.0: " × "}[power].join(names) if abs(power) == 1 else f"{names[0]} × {names[1]}^{power:.2f}"
    logarithm = np.zeros(values.size)
    logarithm[first], logarithm[second] = 1 / values[first], power / values[second]
    value = float(values[first] * values[second]**power)
    return [(name, value, abs(value) * float(np.sqrt(logarithm @ covariance @ logarithm)))]

"""Which law measured counts favour, in numbers and in plain words."""
from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Sequence

import numpy as np
from scipy import special

from .covariance import ChiSquared
from .likelihood import SEED, TRIALS, Model, p_value, ratio_p, same, trials

UNFIT = 0.001  # a law whose p is lower does not fit
REJECTED = float(special.ndtr(-3))  # three sigmas, for the ratio of two laws
MOST_COUNTS = 2**25  # drawn for all trials of a law together
LEAST_TRIALS = 300


@dataclass(frozen=True)
class Fit:
    """How counts fit one law."""

    deviance: float  # -2 ln L, over the largest possible L
    p: float  # share of the trials under this law with a deviance at least as large
    fitted: int  # parameters: 1 where the flux is free
    chi_squared: ChiSquared  # Pearson's, with p from its distribution

    @property
    def aic(self) -> float:
        """Akaike's criterion, -2 ln L + 2 parameters; only differences mean something."""
        return self.deviance + 2 * self.fitted


@dataclass(frozen=True)
class Pair:
    """Two laws, by number, and what the likelihood ratio of the data says."""

    one: int
    other: int
    ratio: float  # -2 ln(L_other/L_one): above 0 where the data are nearer to the first
    expected: tuple[tuple[float, float], tuple[float, float]]  # mean and standard deviation, if one, or other, holds
    # of the first law and of the other: how often it makes a ratio that speaks so much against it
    p: tuple[float, float]
    same: bool  # both expect the same


@dataclass(frozen=True)
class Verdict:
    """How counts stand to laws."""

    names: tuple[str, ...]
    fits: tuple[Fit, ...]
    pairs: tuple[Pair, ...]
    trials: int

    @property
    def words(self) -> str:
        """The conclusion."""
        fit = [i for i, found in enumerate(self.fits) if found.p >= UNFIT]
        if not fit:
            nearest = int(np.argmin([found.aic for found in self.fits]))
            neither = "neither fits" if len(self.names) == 2 else "none fits"
            close = "" if all(pair.same for pair in self.pairs) else \
                f"; the nearest is {self.names[nearest]}, which is no reason to believe it"
            return f"{neither}: each of the laws has p < {UNFIT:g}{close}"
        beaten = {pair.other for pair in self.pairs if pair.one in fit and pair.p[1] < REJECTED} \
            | {pair.one for pair in self.pairs if pair.other in fit and pair.p[0] < REJECTED}
        left = [i for i in fit if i not in beaten]
        if not left:
            return "neither fits: the likelihood ratio lies between what the laws expect, and far from both"
        if len(left) == 1:
            others = _listed([name for i, name in enumerate(self.names) if i != left[0]], "or")
            return f"the data favour {self.names[left[0]]}: it fits (p = {self.fits[left[0]].p:.2g}), and they do " \
                   f"not come from {others}"
        names = _listed([self.names[i] for i in left], "and")
        alike = all(pair.same for pair in self.pairs if pair.one in left and pair.other in left)
        reason = "they predict the same here, to the last bit" if alike else "the counts are too few for that"
        return f"cannot tell {names} apart: {reason}"


def verdict(names: Sequence[str], models: Sequence[Model], n: np.ndarray) -> Verdict:
    """Of counts n [cells]. p-values come from trials under each law, at the flux that fits where this is free."""
    generator = np.random.default_rng(SEED)
    at = [model.at(n) for model in models]
    number = int(np.clip(MOST_COUNTS // n.size, LEAST_TRIALS, TRIALS))
    drawn = [trials(model, at, generator, number) for model in at]
    observed = [float(model.deviance(n)) for model in models]
    fits = []
    for i, model in enumerate(models):
        pearson, freedom = model.pearson(n)
        squares = ChiSquared(pearson, freedom, float(special.chdtrc(freedom, pearson)) if freedom else np.nan,
                             "too few counts")
        fits.append(Fit(observed[i], p_value(observed[i], drawn[i][0][i]), int(model.free), squares))
    pairs = [_pair(i, j, at, observed, drawn) for i, j in combinations(range(len(models)), 2)]
    return Verdict(tuple(names), tuple(fits), tuple(pairs), number)


def _pair(i: int, j: int, at: Sequence[Model], observed: list[float],
          drawn: list[tuple[np.ndarray, np.ndarray]]) -> Pair:
    ratios = [deviances[j] - deviances[i] for deviances, _ in (drawn[i], drawn[j])]
    expected = tuple((float(ratio.mean()), float(ratio.std())) for ratio in ratios)
    ratio = observed[j] - observed[i]
    if same(at[i], at[j]):
        return Pair(i, j, 0.0, expected, (1.0, 1.0), True)
    together = np.concatenate(ratios)
    own, other = (np.concatenate([drawn[i][1][law], drawn[j][1][law]]) for law in (i, j))
    return Pair(i, j, ratio, expected, (ratio_p(-ratio, -together, own, other), ratio_p(ratio, together, other, own)),
                False)


def _listed(names: list[str], word: str) -> str:
    return f" {word} ".join(filter(None, ["; ".join(names[:-1]), names[-1]]))

"""Likelihoods of counts under simulated expectations, what they are worth, and how many counts tell two of them apart.

Everywhere: n counts [..., cells]; mu expected counts [..., cells], above 0; k [cells] how many simulated particles the
expectation rests on, mu²/variance, infinite where it is exact. Counts are independent and Poisson, as those of a beam
whose particles leave at random are.

The deviance of a cell is -2 ln of the likelihood over its largest possible value, with the true expectation β mu free
within what k simulated particles allow, also Poisson (Barlow and Beeston 1993, one factor per cell; in this form
Dembinski and Abdelmotteleb, Eur. Phys. J. C 82, 1043, 2022):

    2 [β mu - n + n ln(n / β mu) + k (β - 1 - ln β)],   β = (n + k)/(mu + k)
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import special

TRIALS = 2000  # simulated experiments behind a p-value
SIGMAS = 5.0
SEED = 1938  # of the simulated experiments: the same answer every time
PEARSON = 5  # expected counts of a cell in χ² (Cochran 1954)
REACHED = 10  # effective trials (Kish 1965), for a tail to be known from them
FEW = 10  # counts that tell laws apart, below which their number is no longer as good as normally distributed
MOST_DRAWS = 2**22  # counts drawn at a time


def deviance(n: np.ndarray, mu: np.ndarray, k: np.ndarray) -> np.ndarray:
    """[..., cells] as in the module's text."""
    exact = np.isinf(k)
    finite = np.where(exact, 1.0, k)
    above = np.where(exact, 0.0, (n - mu) / (mu + finite))  # β - 1
    true = mu * (1 + above)
    pull = np.where(exact, 0.0, finite * (above - np.log1p(above)))
    return 2 * (true - n + special.xlogy(n, np.where(n > 0, n, 1) / true) + pull)


def fitted_scale(n: np.ndarray, signal: np.ndarray, background: np.ndarray, k: np.ndarray) -> np.ndarray:
    """[...] The factor s on the beam's share that makes the deviance of s signal + background least; by Fisher's
    scoring, from the ratio of the sums. Never below a millionth of it: no counts leave s open downwards."""
    start = np.maximum((n - background).sum(axis=-1) / signal.sum(), 1e-6)
    scale = np.asarray(start, dtype=float)
    for _ in range(30):
        mu = scale[..., None] * signal + background
        true = np.where(np.isinf(k), mu, mu * (n + k) / (mu + k)) if np.isfinite(k).any() else mu
        slope = (signal * (true - n) / mu).sum(axis=-1)
        step = slope / (signal**2 / (mu + np.where(np.isinf(k), 0, mu**2 / k))).sum(axis=-1)
        changed = np.clip(scale - step, scale / 4, scale * 4)
        done = np.all(np.abs(changed - scale) < 1e-9 * scale)
        scale = np.maximum(changed, 1e-6 * start)
        if done:
            break
    return scale


@dataclass(frozen=True)
class Model:
    """What one law expects of a measurement."""

    signal: np.ndarray  # [cells] expected counts from the beam
    background: np.ndarray  # [cells] expected counts without it
    k: np.ndarray  # [cells] simulated particles behind `signal`
    free: bool = False  # the flux is not known: one factor on `signal` is fitted

    @property
    def expected(self) -> np.ndarray:
        """[cells]"""
        return self.signal + self.background

    @property
    def support(self) -> np.ndarray:
        """[cells] (expected counts)²/variance; the background is known."""
        return self.k * (self.expected / self.signal) ** 2

    def at(self, n: np.ndarray) -> Model:
        """With the factor that fits the counts n [cells] best; itself where the flux is known."""
        if not self.free:
            return self
        scale = float(fitted_scale(n, self.signal, self.background, self.k))
        return Model(scale * self.signal, self.background, self.k, True)

    def deviances(self, n: np.ndarray) -> np.ndarray:
        """[..., cells] of counts n [..., cells], at the best factor where the flux is free."""
        if not self.free:
            return deviance(n, self.expected, self.support)
        signal = fitted_scale(n, self.signal, self.background, self.k)[..., None] * self.signal
        mu = signal + self.background
        return deviance(n, mu, self.k * (mu / signal) ** 2)

    def deviance(self, n: np.ndarray) -> np.ndarray:
        """[...] -2 ln L of counts n [..., cells], over its largest possible value."""
        return self.deviances(n).sum(axis=-1)

    def pearson(self, n: np.ndarray) -> tuple[float, int]:
        """Pearson's χ² of counts n [cells], with the variance of the expectation added, and its degrees of freedom.
        Cells that expect fewer than `PEARSON` counts are one together, or χ² would not follow its distribution."""
        model = self.at(n)
        mu, variance = model.expected, model.expected + model.expected**2 / model.support
        many = mu >= PEARSON
        squares = np.sum((n - mu)[many] ** 2 / variance[many])
        rest = mu[~many].sum() >= PEARSON
        if rest:
            squares += (n - mu)[~many].sum() ** 2 / variance[~many].sum()
        return float(squares), max(int(many.sum()) + int(rest) - int(self.free), 0)

    def draw(self, generator: np.random.Generator, trials: int) -> np.ndarray:
        """[trials, cells] Counts of repeated measurements, each with a truth that the simulation allows: gamma
        distributed with k, as it is for Poisson counts that were simulated."""
        shape = (trials, self.signal.size)
        finite = np.isfinite(self.k)
        factor = np.ones(shape)
        factor[:, finite] = generator.gamma(self.k[finite], 1 / self.k[finite], (trials, int(finite.sum())))
        return generator.poisson(self.signal * factor + self.background).astype(float)

    def log_likelihood(self, n: np.ndarray) -> np.ndarray:
        """[..., cells] ln of the probability with which `draw` makes n, without what all models share. With a
        background that of a gamma distributed sum, of the same mean and variance."""
        mu, k = self.expected, self.support
        finite = np.where(np.isinf(k), 1.0, k)
        spread = special.gammaln(n + finite) - special.gammaln(finite) \
            - (n + finite) * np.log1p(mu / finite) + special.xlogy(n, mu / finite)
        return np.where(np.isinf(k), special.xlogy(n, mu) - mu, spread)


def trials(model: Model, statistics: list[Model], generator: np.random.Generator,
           number: int = TRIALS) -> tuple[np.ndarray, np.ndarray]:
    """[models, number] Deviances under each of the models `statistics`, and their log-likelihoods, of measurements
    drawn from `model`."""
    deviances, logs = [], []
    at_once = max(1, MOST_DRAWS // model.signal.size)
    for begin in range(0, number, at_once):
        n = model.draw(generator, min(at_once, number - begin))
        deviances.append([each.deviance(n) for each in statistics])
        logs.append([each.log_likelihood(n).sum(axis=-1) for each in statistics])
    return np.concatenate(deviances, axis=-1), np.concatenate(logs, axis=-1)


def p_value(observed: float, drawn: np.ndarray, generator: np.random.Generator | None = None) -> float:
    """The share of `drawn` [trials] at or above `observed`, which counts as one of them. With a generator ties, which
    discrete counts make, are broken at random, so that p is uniform; without it they all count, which is on the safe
    side (Davison and Hinkley 1997, eq. 4.11). Far beyond all trials it is Cantelli's limit."""
    above = np.sum(drawn > observed + 1e-9)
    ties = np.sum(np.abs(drawn - observed) <= 1e-9)
    share = 1.0 if generator is None else generator.random()
    p = float((above + share * (ties + 1)) / (drawn.size + 1))
    return p if above + ties else min(p, _cantelli(observed, float(drawn.mean()), float(drawn.std())))


def ratio_p(observed: float, drawn: np.ndarray, own: np.ndarray, other: np.ndarray) -> float:
    """The probability under a law that the statistic is at or above `observed`, from trials [2 trials], half drawn
    under it and half under the other law, with their log-likelihoods `own` and `other`; an upper limit of it where too
    few trials come there. The weights 2/(1 + L_other/L_own) of multiple importance sampling (Veach and Guibas 1995,
    balance heuristic) reach far into the tail."""
    logs, reached = special.log_expit(own - other), drawn >= observed - 1e-9
    weights = np.exp(logs) * 2 / drawn.size
    p = float(weights[reached].sum())
    relative = np.exp(logs[reached] - logs[reached].max()) if reached.any() else np.zeros(1)
    if relative.sum() ** 2 >= REACHED * max(np.sum(relative**2), 1e-300):
        return min(p, 1.0)
    mean = np.sum(weights * drawn) / weights.sum()
    deviation = np.sqrt(np.sum(weights * (drawn - mean) ** 2) / weights.sum())
    return max(p, min(6 / drawn.size, _cantelli(observed, mean, deviation)))  # 6: less than 3 trials of a half


def _cantelli(observed: float, mean: float, deviation: float) -> float:
    """Cantelli's inequality (1928): whatever the distribution, no more than this comes `observed` - `mean` above it."""
    above = max(observed - mean, 0.0)
    return float(deviation**2 / (deviation**2 + above**2)) if above > 0 else 1.0


@dataclass(frozen=True)
class Separation:
    """How well two laws are told apart where the first one is true, for each unit of exposure."""

    contributions: np.ndarray  # [cells] of q
    q: float  # mean of -2 ln(L_other/L_true), freed of what Monte Carlo errors add to it
    error: float  # one standard error of q, from the templates
    correction: float  # to the significance √(q t): it is √(q t) + correction/√(q t) at the exposure t
    models: tuple[Model, Model] | None = None  # the true and the other one, where so few counts tell that this is wrong

    @property
    def told(self) -> bool:
        """Whether the templates differ by more than their Monte Carlo errors."""
        return self.q > 3 * self.error

    def significance(self, exposure: float) -> float:
        """The median number of sigmas."""
        root = np.sqrt(max(self.q * exposure, 1e-300))
        return float(root + self.correction / root)

    def exposure(self, sigmas: float = SIGMAS) -> float:
        """The exposure at which half of the measurements reach `sigmas`; where few counts tell, found by trials."""
        if not self.told:
            return np.inf
        if self.models is not None:
            return _by_trials(*self.models, sigmas, sigmas**2 / self.q)
        root = (sigmas + np.sqrt(max(sigmas**2 - 4 * self.correction, 0.0))) / 2
        return float(root**2 / self.q)


def separation(true: Model, other: Model) -> Separation:
    """Between two models for one unit of exposure; what rejects `other` where `true` holds.

    q = 2 Σ [a ln(a/b) - a + b] over cells that expect a under the truth and b under the other law is the mean of the
    likelihood ratio t = -2 ln(L_b/L_a) (Kullback and Leibler 1951), and √q the median significance with the Asimov
    data a (Cowan, Cranmer, Gross and Vitells, Eur. Phys. J. C 71, 1554, 2011, eq. 97). For two laws without parameters,
    t is a sum of Poisson numbers with the weights l = ln(a/b). Its tail under b is that of Lugannani and Rice (1980),
    with the saddlepoint at 1 for t at its mean under a; Cornish and Fisher's median is lower by κ₃/6κ₂. Both
    change √q by

        [ln(u²/q)/2 - κ₃/6κ₂]/√q,   u² = κ₂ = Σ a l², κ₃ = Σ a l³

    A free flux takes the factor on b that is nearest to a. What Monte Carlo errors add to q is Σ (σ_a² + σ_b²)/b,
    taken off where a and b differ; where laws share their particles this takes off too much, and the exposure is too
    long rather than too short.
    """
    a, shift = true.expected, other.at(true.expected) if other.free else other
    b = shift.expected
    contributions = 2 * (special.xlogy(a, a / b) - a + b)
    logs = np.log(a / b)
    second, third = np.sum(a * logs**2), np.sum(a * logs**3)
    differ = np.abs(a - b) > 1e-12 * (a + b)
    noise = np.where(differ, (a**2 / true.support + b**2 / shift.support) / np.maximum(a, b), 0)
    q = float(contributions.sum() - noise.sum())
    slopes = (2 * logs) ** 2 * a**2 / true.support + (2 * (1 - a / b)) ** 2 * b**2 / shift.support
    error = float(np.sqrt(np.sum(slopes) + 2 * np.sum(noise**2)))
    if not differ.any() or q <= 0:
        return Separation(contributions, max(q, 0.0), error, 0.0)
    correction = np.log(second / contributions.sum()) / 2 - third / second / 6
    telling = second**2 / np.sum(a * logs**4) * SIGMAS**2 / q  # counts, at the exposure in question
    models = None if telling >= FEW else tuple(
        Model(model.expected[differ], 0 * b[differ], np.full(int(differ.sum()), np.inf)) for model in (true, shift))
    return Separation(contributions, q, error, float(correction), models)


def tails(true: Model, other: Model, number: int = TRIALS, seed: int = SEED) -> np.ndarray:
    """[number] p-values of the `other` law in measurements drawn from the `true` one, by their likelihood ratio; exact
    but for the number of trials, far into the tail too."""
    generator = np.random.default_rng(seed)
    drawn, logs = (np.concatenate(parts, axis=-1) for parts in
                   zip(*(trials(model, [true, other], generator, number) for model in (true, other))))
    return _tails(drawn[1] - drawn[0], logs[1] - logs[0], number)


def _tails(ratio: np.ndarray, logs: np.ndarray, number: int) -> np.ndarray:
    """[number] Under the other law, the probabilities of a likelihood ratio at or above each of the first `number` of
    `ratio` [2 number], from all of them and ln(L_other/L_true) in `logs`: see `ratio_p`."""
    weights = special.expit(logs) / number
    order = np.argsort(-ratio, kind="stable")
    last = np.searchsorted(-ratio[order], -ratio[:number] + 1e-9, side="right") - 1  # ties count
    return np.cumsum(weights[order])[last]


def _by_trials(true: Model, other: Model, sigmas: float, start: float) -> float:
    """The least exposure at which half of the trials reach `sigmas`, to one per cent; from a tenth to ten times
    `start`."""
    low, high = np.log(start / 10), np.log(start * 10)
    generator = np.random.default_rng(SEED)
    while high - low > 0.01:
        exposure = np.exp((low + high) / 2)
        under = [_ratios(model.signal * exposure, true.signal, other.signal, generator) for model in (true, other)]
        drawn = np.concatenate(under) - exposure * 2 * (true.signal - other.signal).sum()
        reached = np.mean(_tails(drawn, -drawn / 2, TRIALS) < special.ndtr(-sigmas)) >= 0.5
        low, high = (low, np.log(exposure)) if reached else (np.log(exposure), high)
    return float(np.exp(high))


def _ratios(mu: np.ndarray, a: np.ndarray, b: np.ndarray, generator: np.random.Generator) -> np.ndarray:
    """[TRIALS] 2 Σ n ln(a/b) of counts n that are drawn one by one, as there are few, where mu are expected."""
    numbers = generator.poisson(mu.sum(), TRIALS)
    cells = generator.choice(mu.size, numbers.sum(), p=mu / mu.sum())
    return np.bincount(np.repeat(np.arange(TRIALS), numbers), 2 * np.log(a / b)[cells], TRIALS)


def same(one: Model, other: Model) -> bool:
    """Whether two laws expect the same, to the last bit of what was simulated."""
    return bool(np.allclose(one.expected, other.expected, rtol=1e-12, atol=0))


def agreement(one: Model, other: Model) -> tuple[float, int, float]:
    """χ² between two templates within their Monte Carlo errors, as if these were independent, its degrees of freedom
    and p-value; of the cells that differ at all."""
    a, b = one.expected, other.expected
    differ = np.abs(a - b) > 1e-12 * (a + b)
    with np.errstate(divide="ignore"):
        squares = (a - b)[differ] ** 2 / (a**2 / one.support + b**2 / other.support)[differ]
    freedom = int(differ.sum())
    return float(squares.sum()), freedom, float(special.chdtrc(freedom, squares.sum())) if freedom else 1.0

"""The likelihoods of laws, calibrated on counts whose truth is known: p-values are uniform, and the promised number of
particles reaches five sigmas in half of the trials."""
from __future__ import annotations

import numpy as np
import pytest
from rabiline import likelihood
from rabiline.likelihood import Model, agreement, deviance, fitted_scale, p_value, ratio_p, separation, tails, trials
from scipy import optimize, stats

pytestmark = pytest.mark.slow

SEEDS = 1000
X = np.linspace(-3, 3, 40)
LINE = np.exp(-X**2 / 2) / np.exp(-X**2 / 2).sum()
INFINITE = np.full(X.size, np.inf)
NOTHING = np.zeros(X.size)


def exact(signal: np.ndarray, background: np.ndarray = NOTHING, free: bool = False) -> Model:
    return Model(signal, background[:signal.size], INFINITE[:signal.size], free)


def moved(by: float, floor: float = 1e-3) -> np.ndarray:
    line = np.exp(-(X - by) ** 2 / 2) + floor
    return line / line.sum()


def uniform(p: list[float]) -> float:
    return stats.kstest(p, "uniform").pvalue


def test_the_deviance_is_the_least_over_the_true_expectation() -> None:
    def minus(log_beta: float, n: float, mu: float, k: float) -> float:
        beta = np.exp(log_beta)
        return 2 * (beta * mu - n + (n * np.log(n / (beta * mu)) if n else 0) + k * (beta - 1 - np.log(beta)))

    for n, mu, k in ((0, 3.0, 25.0), (7, 3.0, 0.5), (12, 14.0, 400.0), (100, 40.0, 60.0)):
        least = optimize.minimize_scalar(minus, bounds=(-8, 8), args=(n, mu, k), method="bounded",
                                         options={"xatol": 1e-10}).fun
        assert deviance(np.array([float(n)]), np.array([mu]), np.array([k]))[0] == pytest.approx(least, abs=1e-6)


def test_without_monte_carlo_errors_the_deviance_is_that_of_poisson_counts() -> None:
    n, mu = np.array([0.0, 3.0, 12.0]), np.array([1.5, 3.0, 8.0])
    expected = 2 * (stats.poisson.logpmf(n, np.maximum(n, 1e-300)) - stats.poisson.logpmf(n, mu))
    expected[0] = 2 * mu[0]
    assert deviance(n, mu, np.full(3, np.inf)) == pytest.approx(expected)
    assert deviance(n, mu, np.full(3, 1e9)) == pytest.approx(expected, abs=1e-6)


def test_a_free_flux_is_fitted() -> None:
    n = np.random.default_rng(3).poisson(700 * LINE + 2).astype(float)
    for k in (INFINITE, np.full(X.size, 50.0)):
        def of(scale: float) -> float:
            signal = scale * 300 * LINE
            return float(deviance(n, signal + 2, k).sum())

        best = optimize.minimize_scalar(of, bounds=(0.1, 10), method="bounded", options={"xatol": 1e-9}).x
        assert fitted_scale(n, 300 * LINE, 2 + NOTHING, k) == pytest.approx(best, rel=1e-5)


@pytest.mark.parametrize("exposure", [30, 3000])
@pytest.mark.parametrize("simulated", [np.inf, 400])
@pytest.mark.parametrize("free", [False, True])
def test_p_values_of_the_true_law_are_uniform(exposure: float, simulated: float, free: bool) -> None:
    """1000 measurements under one law; with a template of 400 particles each has another truth that this allows."""
    model = Model(exposure * LINE, 0.5 + NOTHING, np.maximum(simulated * LINE, 0.5), free)
    generator = np.random.default_rng(1938)
    drawn = trials(model, [model], np.random.default_rng(1), 40000)[0][0]
    measured = model.deviance(model.draw(generator, SEEDS))
    assert uniform([p_value(float(value), drawn, generator) for value in measured]) > 0.01


@pytest.mark.parametrize("exposure", [8, 300])
def test_p_values_of_the_likelihood_ratio_are_uniform(exposure: float) -> None:
    one, other = exact(exposure * LINE), exact(exposure * moved(0.4))
    generator = np.random.default_rng(1938)
    drawn = trials(one, [one, other], np.random.default_rng(1), 40000)[0]
    n = one.draw(generator, SEEDS)
    measured = one.deviance(n) - other.deviance(n)
    assert uniform([p_value(float(value), drawn[0] - drawn[1], generator) for value in measured]) > 0.01


def test_p_values_count_ties_on_the_safe_side_or_at_random() -> None:
    drawn = np.array([1.0, 2.0, 2.0, 3.0])
    assert p_value(2.0, drawn) == pytest.approx(4 / 5)
    shares = [p_value(2.0, drawn, np.random.default_rng(seed)) for seed in range(300)]
    assert 1 / 5 <= min(shares) < 0.25 and 0.75 < max(shares) <= 4 / 5


def test_far_beyond_all_trials_p_is_small_however_few_they_are() -> None:
    drawn = np.random.default_rng(1).normal(0, 1, 200)
    assert p_value(1000.0, drawn) == pytest.approx(1e-6, rel=0.3) and p_value(5.0, drawn) == pytest.approx(1 / 201)
    one, other = exact(1e6 * LINE), exact(1e6 * moved(0.5))
    generator = np.random.default_rng(5)
    (d1, l1), (d2, l2) = (trials(model, [one, other], generator, 200) for model in (one, other))
    ratio = np.concatenate([d1[1] - d1[0], d2[1] - d2[0]])
    own, its = np.concatenate([l1[1], l2[1]]), np.concatenate([l1[0], l2[0]])
    assert ratio_p(float(d1[1][0] - d1[0][0]), ratio, own, its) < 1e-4
    assert ratio_p(0.0, ratio, own, its) < 1e-4  # between the two, where no trial comes


def test_weighted_trials_know_the_far_tail() -> None:
    """Against a sum of two Poisson numbers that is known: the probability of few counts is e^-mu times a sum."""
    one, other = exact(np.array([2.0])), exact(np.array([30.0]))
    generator = np.random.default_rng(5)
    (d1, l1), (d2, l2) = (trials(model, [one, other], generator, 4000) for model in (one, other))
    ratio = np.concatenate([d1[1] - d1[0], d2[1] - d2[0]])
    own, its = np.concatenate([l1[1], l2[1]]), np.concatenate([l1[0], l2[0]])
    def found(n: int) -> float:
        return ratio_p(float(other.deviance(np.array([n])) - one.deviance(np.array([n]))), ratio, own, its)

    for n in (1, 3, 25):
        assert found(n) == pytest.approx(stats.poisson.cdf(n, 30), rel=0.15)
    assert stats.poisson.cdf(11, 30) < found(11) < 1e-3  # no trial comes there: a limit


@pytest.mark.parametrize(("true", "other"), [
    (LINE, moved(0.3)), (moved(0.3), LINE), (LINE, moved(1.5)), (moved(1.5), LINE), (LINE, LINE * (1 + 0.02 * X)),
    (LINE + 0.01, moved(0.5) + 0.01), (LINE, 0.8 * LINE), (0.8 * LINE, LINE),
])
def test_the_promised_number_reaches_five_sigmas_in_half_of_the_trials(true: np.ndarray, other: np.ndarray) -> None:
    number = 20000
    exposure = separation(exact(true), exact(other)).exposure()
    p = tails(exact(exposure * true), exact(exposure * other), number)
    reached = np.mean(p < stats.norm.sf(5))
    assert abs(reached - 0.5) < 4 * 0.5 / np.sqrt(number) + 0.01  # 0.01: of the second order, and of discrete counts


def test_where_one_law_expects_nothing_the_other_is_rejected_by_silence() -> None:
    """No count where mu are expected has the probability e^-mu: five sigmas are 15.07."""
    found = separation(exact(np.array([1e-9])), exact(np.array([1.0]))).exposure()
    assert found == pytest.approx(-np.log(stats.norm.sf(5)), rel=0.02)


def test_monte_carlo_noise_alone_tells_no_laws_apart() -> None:
    generator = np.random.default_rng(2)
    told = 0
    for _ in range(50):
        one, other = (Model(counts, NOTHING, counts) for counts in generator.poisson(400, (2, X.size)).astype(float))
        told += separation(one, other).told
        assert agreement(one, other)[1] <= X.size
    assert told <= 2


def test_chi_squared_between_templates_follows_its_distribution() -> None:
    generator = np.random.default_rng(4)
    p = [agreement(*(Model(counts, NOTHING, counts) for counts in generator.poisson(400, (2, X.size)).astype(float)))[2]
         for _ in range(300)]
    assert uniform(p) > 0.01


def test_a_background_asks_for_more_particles() -> None:
    clean, noisy = (separation(exact(LINE, each + NOTHING), exact(moved(0.5), each + NOTHING)).exposure()
                    for each in (0.0, 0.1))
    assert noisy > 3 * clean


def test_a_free_flux_asks_for_more_particles() -> None:
    known = separation(exact(LINE), exact(0.9 * moved(0.3))).exposure()
    free = separation(exact(LINE, free=True), exact(0.9 * moved(0.3), free=True)).exposure()
    shapes = separation(exact(LINE), exact(moved(0.3))).exposure()
    assert known < free == pytest.approx(shapes, rel=1e-6)


def test_the_same_law_is_never_told_from_itself() -> None:
    found = separation(exact(LINE), exact(LINE.copy()))
    assert not found.told and found.exposure() == np.inf and likelihood.same(exact(LINE), exact(LINE.copy()))


def test_pearsons_chi_squared_follows_its_distribution() -> None:
    model = Model(800 * LINE, NOTHING, 4000 * LINE)
    drawn = model.draw(np.random.default_rng(6), SEEDS)
    p = [stats.chi2.sf(*model.pearson(n)) for n in drawn]
    assert stats.kstest(p, "uniform").statistic < 0.06  # it is an approximation


@pytest.mark.parametrize(("particles", "by"), [(4000, 0.3), (20000, 0.1)])
def test_the_noise_of_templates_does_not_shorten_the_beam_time(particles: int, by: float) -> None:
    """Laws simulated with few particles promise, on average, the number that exact templates do, within the error that
    they state."""
    generator = np.random.default_rng(11)
    promised, pulls = [], []
    exactly = separation(exact(LINE + 1e-3), exact(moved(by) + 1e-3))
    for _ in range(200):
        counts = [generator.poisson(particles * (line + 1e-3)).astype(float) for line in (LINE, moved(by))]
        found = separation(*(Model(np.maximum(n, 0.5) / particles, NOTHING, np.maximum(n, 0.5)) for n in counts))
        promised.append(found.q)
        pulls.append((found.q - exactly.q) / found.error)
    assert np.mean(promised) == pytest.approx(exactly.q, rel=0.1)
    assert 0.7 < np.std(pulls) < 1.3

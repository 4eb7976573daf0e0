"""Weights, errors and chi² with the covariance: calibrated on scans whose truth is known."""
from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
import rabiline.fit
from rabiline import results
from rabiline.agreement import with_constant, with_model
from rabiline.covariance import COUNTED, DIRECTIONS, GROUPS, WEIGHED, Spread, Weights, chi_squared, enough
from rabiline.curves import Curve
from rabiline.fit import Fit, fit
from scipy import stats
from synthetic import binomial_errors, dip, fly_shared

pytestmark = pytest.mark.slow

SEEDS = 200
X = np.linspace(0, 1, 61)
CENTRE, WIDTH, MISSING, CAUGHT, PARTICLES = 0.5, 0.2, 0.5, 0.9, 4000


def truth(centre: float = CENTRE) -> np.ndarray:
    return CAUGHT * (1 - MISSING * (1 - dip(X, centre, WIDTH, 2)))


def curve_of(y: np.ndarray, covariance: np.ndarray | None, particles: int = PARTICLES, x: np.ndarray = X) -> Curve:
    errors = binomial_errors(y, particles)
    return Curve("a curve", "", "neutron", results.Axis("H0.frequency", "Hz", x), np.arange(x.size), y, errors,
                 Spread.of(y, errors, covariance, np.full(x.size, particles)))


def without_covariance(curve: Curve) -> Curve:
    """As if its points were independent."""
    return replace(curve, spread=Spread.of(curve.y, curve.errors, None, PARTICLES))


@dataclass(frozen=True)
class Scans:
    """Repeated scans with their fits."""

    curves: list[Curve]
    fits: list[Fit]
    equal: list[Fit]  # fits with equal weights


def repeated(draw: object) -> Scans:
    curves = [draw(np.random.default_rng(seed)) for seed in range(SEEDS)]
    fits = [fit(curve) for curve in curves]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rabiline.fit, "LEAST_P", 2)
        return Scans(curves, fits, [fit(curve) for curve in curves])


@pytest.fixture(scope="module")
def shared() -> Scans:
    return repeated(lambda generator: curve_of(*fly_shared(generator, X, PARTICLES, CENTRE, WIDTH, MISSING, CAUGHT)))


@pytest.fixture(scope="module")
def independent() -> Scans:
    return repeated(lambda generator: curve_of(generator.binomial(PARTICLES, truth()) / PARTICLES, None))


@pytest.fixture(params=["shared", "independent"])
def scans(request: pytest.FixtureRequest) -> Scans:
    return request.getfixturevalue(request.param)


def centres(fits: list[Fit]) -> np.ndarray:
    return np.array([found.resonances[0].centre.value for found in fits])


def errors_of(fits: list[Fit]) -> np.ndarray:
    """Of the centres, without what the spacing of the points adds."""
    both = [(found.resonances[0].centre.error, found.resonances[0].resolution / 2) for found in fits]
    return np.array([np.sqrt(error**2 - resolution**2) for error, resolution in both])


def uniform(p: list[float]) -> float:
    """The probability that such p-values come from a uniform distribution (Kolmogorov and Smirnov)."""
    assert np.isfinite(p).all()
    return float(stats.kstest(p, "uniform").pvalue)


K = 3  # standard errors


def test_pulls_of_the_fitted_centre_have_mean_0_and_width_1(scans: Scans) -> None:
    assert np.mean([found.weighted for found in scans.fits]) > 0.97
    for fits in (scans.fits, scans.equal):
        pulls = (centres(fits) - CENTRE) / errors_of(fits)
        assert abs(pulls.mean()) < K / np.sqrt(SEEDS)
        assert abs(pulls.std() - 1) < K / np.sqrt(2 * SEEDS)
    moved = (centres(scans.fits) - 1.01 * CENTRE) / errors_of(scans.fits)
    assert abs(moved.mean()) > 3 * K / np.sqrt(SEEDS)


def test_the_covariance_in_the_weights_makes_the_centre_of_shared_points_better_than_equal_weights(
        shared: Scans) -> None:
    """Pitman and Morgan's test: of two correlated estimates the variances differ where sum and difference correlate."""
    weighted, equal = centres(shared.fits), centres(shared.equal)
    assert weighted.var() < 0.9 * equal.var()
    assert stats.pearsonr(equal + weighted, equal - weighted).statistic > K / np.sqrt(SEEDS)


def test_errors_that_ignore_the_covariance_are_wrong(shared: Scans) -> None:
    fits = [fit(without_covariance(curve)) for curve in shared.curves]
    pulls = (centres(fits) - CENTRE) / errors_of(fits)
    assert abs(pulls.std() - 1) > 2 * K / np.sqrt(2 * SEEDS)


def test_p_values_are_uniform(scans: Scans) -> None:
    assert uniform([found.chi_squared.p for found in scans.fits]) > 1e-3
    assert uniform([with_model(curve, truth()).p for curve in scans.curves]) > 1e-3
    assert uniform([with_model(curve, truth(CENTRE + 0.01)).p for curve in scans.curves]) < 1e-6


def test_p_values_of_shared_points_that_ignore_the_covariance_are_wrong(shared: Scans) -> None:
    assert uniform([with_model(without_covariance(curve), truth()).p for curve in shared.curves]) < 1e-6
    taken_for_known = [chi_squared(curve.y - truth(), replace(curve.spread, freedom=np.inf)).p
                       for curve in shared.curves]
    assert uniform(taken_for_known) < 1e-3


def test_p_values_of_two_results_are_uniform_and_find_a_difference(scans: Scans) -> None:
    def compared(one: Curve, other: Curve) -> float:
        pooled = (one.y + other.y) / 2
        spreads = [curve.spread.at(pooled, curve.y) for curve in (one, other)]
        return chi_squared(one.y - other.y, spreads[0].minus(spreads[1]),
                           counted=enough(pooled, one.spread.particle / 2)).p

    pairs = list(zip(scans.curves[::2], scans.curves[1::2]))
    assert uniform([compared(*pair) for pair in pairs]) > 1e-3
    moved = [(one, replace(other, y=other.y + truth(CENTRE + 0.01) - truth())) for one, other in pairs]
    assert uniform([compared(*pair) for pair in moved]) < 1e-6


@pytest.mark.parametrize(("points", "particles"), [(301, 2000), (21, 300)])
def test_p_values_stay_uniform_with_more_points_than_groups_and_with_one_particle_in_each(
        points: int, particles: int) -> None:
    x, p = np.linspace(0, 1, points), []
    expected = CAUGHT * (1 - MISSING * (1 - dip(x, CENTRE, WIDTH, 2)))
    for seed in range(100):
        drawn = fly_shared(np.random.default_rng(seed), x, particles, CENTRE, WIDTH, MISSING, CAUGHT)
        agreement = with_model(curve_of(*drawn, particles, x), expected)
        assert 0 < agreement.freedom <= DIRECTIONS
        p.append(agreement.p)
    assert uniform(p) > 1e-3


def test_a_wrong_model_gets_equal_weights(shared: Scans) -> None:
    side_lobes = 0.05 * np.sin((X - CENTRE) / 0.03) * (np.abs(X - CENTRE) > WIDTH)
    wrong = replace(shared.curves[0], y=shared.curves[0].y + side_lobes)
    found = fit(wrong)
    assert not found.weighted and found.chi_squared.p < 1e-6


def test_the_weights_count_few_directions_by_their_own_variance(shared: Scans) -> None:
    weights = Weights.of(shared.curves[0].spread)
    assert WEIGHED / 1.2 < weights.directions <= WEIGHED
    everything = Weights.of(replace(shared.curves[0].spread, freedom=np.inf))
    assert everything.directions == 0  # nothing learnt from noise
    assert np.linalg.cond(everything.root) > np.linalg.cond(weights.root)


def test_a_flat_line_to_the_bit_has_no_chi_squared() -> None:
    all_alike = np.full((X.size, X.size), 0.9 * 0.1 / PARTICLES)
    agreement = with_constant(curve_of(np.full(X.size, 0.9), all_alike))
    assert str(agreement) == f"no chi²: the points differ by fewer than {COUNTED} particles"
    agreement = with_constant(curve_of(np.ones(X.size), 0 * all_alike))
    assert str(agreement) == "no chi²: no point tells 10 or more particles apart"


def test_a_flat_line_of_independent_points_is_found_flat_and_a_dip_is_not() -> None:
    p = [with_constant(curve_of(np.random.default_rng(seed).binomial(PARTICLES, 0.9, X.size) / PARTICLES, None)).p
         for seed in range(SEEDS)]
    assert uniform(p) > 1e-3
    assert str(with_constant(curve_of(truth(), None))).endswith("p < 1e-6")


def test_shared_points_whose_covariance_is_missing_have_no_chi_squared() -> None:
    agreement = with_constant(replace(curve_of(truth(), None), covariance_missing=True))
    assert str(agreement) == "no chi²: the points share particles, and their covariance is not in the file"


def test_points_at_which_all_particles_did_the_same_err_together_by_half_a_particle() -> None:
    y = np.array([1.0, 1.0, 0.0, 0.5])
    spread = Spread.of(y, np.array([0, 0, 0, 0.01]), np.diag([0, 0, 0, 1e-4]), 999)
    np.testing.assert_allclose(spread.errors, [5e-4, 5e-4, 5e-4, 0.01])
    np.testing.assert_allclose(spread.correlation, [[1, 1, 0, 0], [1, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def test_errors_move_to_those_of_another_fraction_as_binomial_ones_do() -> None:
    y = np.array([0.0, 0.3, 0.999])
    expected = np.array([0.01, 0.4, 1.2])
    moved = Spread.of(y, binomial_errors(y, 999), None, 999).at(expected, y)
    np.testing.assert_allclose(moved.errors, binomial_errors(np.clip(expected, 0, 1), 999))


def test_a_difference_has_the_freedom_of_both_estimates() -> None:
    generator = np.random.default_rng(1938)
    one = curve_of(*fly_shared(generator, X, PARTICLES, CENTRE, WIDTH, MISSING, CAUGHT)).spread
    known = replace(one, freedom=np.inf)
    assert one.minus(one).freedom == pytest.approx(2 * (GROUPS - 1))
    assert one.minus(known).freedom == pytest.approx(4 * (GROUPS - 1))
    assert known.minus(known).freedom == np.inf
    np.testing.assert_allclose(one.minus(one).covariance, 2 * one.covariance)

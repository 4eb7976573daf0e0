"""Bounds on the strength of the hypothesis, from likelihoods that are known."""
from __future__ import annotations

import numpy as np
import pytest
from rabiline.kappa import NoBound, profile
from scipy import stats

LEVEL = stats.chi2.isf(0.05, 1)


def test_a_parabola_gives_the_interval_of_two_sigmas() -> None:
    kappa = np.linspace(-1, 1, 21)
    found = profile(kappa, ((kappa - 0.05) / 0.2) ** 2 + 7)
    assert found.connected.low == pytest.approx(0.05 - 0.2 * np.sqrt(LEVEL), abs=0.005)
    assert found.connected.high == pytest.approx(0.05 + 0.2 * np.sqrt(LEVEL), abs=0.005)
    assert not (found.connected.open_low or found.connected.open_high or found.others or found.coarse)
    assert found.best == pytest.approx(0.05, abs=0.051) and found.values.min() == 0


def test_where_it_vanishes_again_the_interval_is_that_connected_to_zero() -> None:
    kappa = np.linspace(0, 2.2, 111)
    found = profile(kappa, (kappa * (2 - kappa) / 0.15) ** 2)
    assert found.connected.low == 0 and found.connected.open_low
    assert found.connected.high == pytest.approx(1 - np.sqrt(1 - 0.15 * np.sqrt(LEVEL)), abs=0.003)
    assert len(found.others) == 1 and found.others[0].low < 2 < found.others[0].high


def test_a_zero_that_is_rejected_has_no_bound_connected_to_it() -> None:
    kappa = np.linspace(0, 1, 41)
    found = profile(kappa, ((kappa - 0.6) / 0.1) ** 2)
    assert found.connected is None and found.quoted is None and len(found.others) == 1
    assert found.others[0].low == pytest.approx(0.6 - 0.1 * np.sqrt(LEVEL), abs=0.005)


def test_a_scan_that_ends_early_leaves_the_interval_open() -> None:
    kappa = np.linspace(0, 0.1, 11)
    found = profile(kappa, (kappa / 0.2) ** 2)
    assert found.connected.open_high and found.connected.high == 0.1 and not found.coarse


def test_a_flat_likelihood_accepts_all() -> None:
    found = profile(np.linspace(0, 2, 5), np.full(5, 3.0))
    assert found.connected.open_low and found.connected.open_high and not found.others


def test_a_coarse_scan_is_bounded_by_the_next_point_that_is_rejected() -> None:
    kappa = np.array([0.0, 1.0, 2.0])
    found = profile(kappa, np.array([0.0, 400.0, 900.0]))
    assert found.coarse and found.quoted.high == 1.0 and found.connected.high < 0.5


def test_a_rough_likelihood_raises_the_level() -> None:
    kappa = np.linspace(0, 1, 41)
    noise = np.random.default_rng(3).normal(0, 0.5, kappa.size)
    smooth, rough = profile(kappa, (kappa / 0.2) ** 2), profile(kappa, (kappa / 0.2) ** 2 + noise)
    assert smooth.rough < 1e-6 and 0.3 < rough.rough < 0.7
    assert rough.level == pytest.approx(LEVEL + 2 * rough.rough)


def test_the_order_of_the_points_does_not_matter() -> None:
    kappa = np.linspace(0, 1, 21)
    values = (kappa / 0.3) ** 2
    shuffled = np.random.default_rng(1).permutation(21)
    assert profile(kappa[shuffled], values[shuffled]).connected == profile(kappa, values).connected


def test_a_scan_without_zero_is_refused() -> None:
    with pytest.raises(NoBound, match="must hold κ = 0"):
        profile(np.array([0.1, 0.2]), np.array([0.0, 1.0]))


def test_the_interval_covers_the_truth_as_often_as_it_says() -> None:
    """κ measured with a gaussian error: 95 % away from the edge at 0, no less at it."""
    kappa = np.linspace(0, 3, 61)
    generator = np.random.default_rng(8)
    for truth in (0.0, 0.02, 0.3):
        covered = 0
        for _ in range(400):
            found = profile(kappa, ((kappa - generator.normal(truth, 0.4)) / 0.4) ** 2)
            intervals = [*found.others, *([found.connected] if found.connected else [])]
            covered += any(interval.low <= truth <= interval.high for interval in intervals)
        assert covered / 400 > 0.95 - 3 * 0.011

"""Straight lines through the spin's angles: the rates, and whether they scatter as their errors say."""
from __future__ import annotations

import numpy as np
import pytest
from rabiline.angle_plots import ABOUT_ERROR, Angles, NoAngles, line_through

RATE, PLANES = 18324.7, 60


def angles(seed: int, noise: float, bend: float = 0.0) -> Angles:
    """Means over particles of different speeds, which all planes share, with something of their own in each plane."""
    generator = np.random.default_rng(seed)
    slowness = 1 / generator.normal(1000, 20, 500)
    entered = 0.35 * slowness
    times = np.linspace(0.35, 0.75, PLANES)[:, None] * slowness
    values = (0.3 + RATE * (times - entered)).mean(axis=1)
    means = times.mean(axis=1)
    values += generator.normal(0, noise, PLANES) + bend * np.sin(3e4 * (means - entered.mean()))
    return line_through("azimuth φ", means, values, values)


def test_rates_scatter_from_seed_to_seed_as_their_error_says() -> None:
    found = [angles(seed, 1e-6) for seed in range(200)]
    pulls = np.array([(one.rate - RATE) / one.rate_error for one in found])
    assert np.std(pulls) == pytest.approx(1, abs=0.2) and abs(np.mean(pulls)) < 0.25


def test_particles_of_many_speeds_alone_make_no_error() -> None:
    assert angles(1, 0.0).rate == pytest.approx(RATE, rel=1e-12) and angles(1, 0.0).rate_error < 1e-8 * RATE


def test_a_bent_line_has_a_larger_error_than_its_scatter_from_plane_to_plane() -> None:
    bent, straight = angles(1, 1e-9, bend=1e-4), angles(1, 1e-4 / np.sqrt(2))
    assert bent.rate_error > 3 * straight.rate_error
    assert abs(bent.rate - RATE) < 3 * bent.rate_error


def test_a_rate_says_what_its_error_is() -> None:
    assert ABOUT_ERROR in str(angles(1, 1e-6))


def test_two_planes_make_no_line() -> None:
    with pytest.raises(NoAngles, match="fewer than three planes"):
        line_through("azimuth φ", np.arange(3.0), np.arange(3.0), np.zeros(3))

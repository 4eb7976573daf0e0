"""Where curves turn."""
from __future__ import annotations

import numpy as np
from rabiline.swings import central, maxima
from scipy import signal


def test_maxima_are_those_of_their_prominence() -> None:
    generator = np.random.default_rng(3)
    for turn in range(300):
        y = generator.normal(size=generator.integers(3, 60))
        y = np.cumsum(y) if turn % 2 else y
        least = abs(generator.normal())
        assert maxima(y, least).tolist() == signal.find_peaks(y, prominence=least)[0].tolist()


def test_what_is_flat_or_only_rises_has_none() -> None:
    assert not any(maxima(y, 0.0).size for y in (np.ones(5), np.arange(5.0), -np.arange(5.0), np.zeros(1)))


def test_two_or_three_lines_have_no_central_fringe_between_them() -> None:
    x = np.linspace(-5, 5, 201)
    for centres in ((-2, 2), (-3, 0, 3), (-3, -1, 1, 3)):
        for sign in (1, -1):
            y = sign * sum(np.exp(-(x - centre)**2 / 0.2) for centre in centres)
            assert central(y, 0.25, 0.01) is None
    y = np.cos(2 * x) * np.exp(-x**2 / 8)
    assert central(y[np.abs(x) < 2.6], 0.3, 0.01)[:1] == (1,) and central(-y[np.abs(x) < 2.6], 0.3, 0.01)[:1] == (-1,)

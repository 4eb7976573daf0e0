"""Where curves turn."""
from __future__ import annotations

import numpy as np
from rabiline.swings import maxima
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

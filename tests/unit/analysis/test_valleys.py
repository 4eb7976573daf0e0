"""Fits of closed forms whose likelihood has several minima, or none that is narrow."""
from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rabiline.forms import FORMS, lorentz, rabi, rabi_over, ramsey
from rabiline.line_report import described
from rabiline.line_starts import first_guesses, linear
from rabiline.lines import Poisson, fit_line

COUNTS = 1000  # where the curve is 1


def measured(clean: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A share of counts, and its errors."""
    counts = np.random.default_rng(seed).poisson(COUNTS * clean)
    return counts / COUNTS, np.sqrt(np.maximum(counts, 1)) / COUNTS


@pytest.mark.parametrize("turns", [0.5, 0.7, 0.8, 0.9, 1.0, 1.25, 1.4, 1.5, 1.7])
def test_a_line_that_is_driven_beyond_a_flip_is_found_with_its_strength(turns: float) -> None:
    """With a dip in the middle, and side lobes that look like lines of their own."""
    time, x = 0.03, np.linspace(-150, 150, 101)
    for seed in range(2):
        found = fit_line(x, *measured(0.1 + 0.6 * rabi(x - 3, turns / time, time), seed), "rabi")
        for name, true in (("centre", 3), ("strength", turns / time), ("time", time), ("contrast", 0.6)):
            value, error = found[name]
            assert abs(value - true) < 5 * error < 0.5 * abs(true) + 10 * (name == "centre"), name


def test_so_is_one_of_many_speeds() -> None:
    slowness, x = np.linspace(2e-3, 4e-3, 30), np.linspace(-150, 150, 101)
    form = rabi_over(slowness, np.exp(-((slowness - 3e-3) / 4e-4)**2))
    found = fit_line(x, *measured(0.1 + 0.6 * form.f(x - 3, 40.0, 10.0), 1), form)
    assert abs(found["strength"][0] - 40) < 4 * found["strength"][1] < 4 and abs(found["length"][0] - 10) < 4 * found["length"][1] < 2


@pytest.mark.parametrize("extent", [640, 1000])
def test_fringes_of_a_short_scan_have_errors_that_cover_what_it_does_not_know(extent: float) -> None:
    """Two fringes hardly tell the strength from the time in a field: with one of them the other goes anywhere, and the time between takes part in it."""
    time, pulse, x = 2.375e-3, 0.125e-3, np.linspace(-extent / 2, extent / 2, 81)
    pulls = []
    for seed in range(5):
        found = fit_line(x, *measured(0.1 + 0.6 * ramsey(x - 3, 0.25 / pulse, pulse, time, 0.08), seed), "ramsey")
        if abs(found["centre"][0] - 3) < 4:
            pulls.append((found["time"][0] - time) / found["time"][1])
        centres = [found["centre"][0], *(centre for (centre,), _ in found.others)]
        assert abs(found["centre"][0]) < extent / 2 and min(abs(centre - 3) for centre in centres) < 4
    assert len(pulls) > 2 and np.abs(pulls).max() < 3.5


def test_other_sets_of_lines_and_contrasts_of_both_signs_are_told() -> None:
    x = np.linspace(-150, 150, 61)
    found = fit_line(x, 1 - 0.5 * lorentz(x + 40, 20.0) + 0.2 * lorentz(x - 50, 20.0), 0.01, "lorentz", lines=2)
    told = "\n".join(described(replace(found, others=(((-41.0, 48.0), 12.0),) * 7), "Hz"))
    assert "or other lines: centres -41 Hz and 48 Hz with chi² 12.0" in told and "and 2 more that are as good" in told
    assert "contrasts have opposite signs" in told


def test_the_width_and_the_contrast_of_a_faint_line_are_as_well_known_as_they_say() -> None:
    x, pulls = np.linspace(-300, 300, 61), []
    for seed in range(25):
        counts = np.random.default_rng(seed).poisson(12 * (1 - 0.6 * lorentz(x - 7, 40.0))).astype(float)
        found = fit_line(x, counts, Poisson(), "lorentz")
        if abs(found["centre"][0] - 7) < 60:  # no dip that chance has made
            pulls.append([(np.log(found["width"][0] / 40)) * found["width"][0] / found["width"][1], (found["contrast"][0] + 7.2) / found["contrast"][1]])
    assert len(pulls) > 18 and (np.sqrt(np.mean(np.square(pulls), axis=0)) < 1.2).all() and np.abs(pulls).max() < 3.5


@pytest.mark.parametrize("form", ["gauss", "rabi", "ramsey"])
def test_places_that_were_measured_twice_make_no_step_of_zero(form: str) -> None:
    x = np.repeat(np.linspace(-4, 4, 21), 2)
    found = fit_line(x, *measured(0.2 + 0.5 * np.exp(-x**2), 3), form)
    assert abs(found["centre"][0]) < 1


@pytest.mark.parametrize("uneven", [0.0, 0.3])
def test_where_several_lines_start_a_form_is_asked_for_each_distance_once_and_takes_what_helps_most(uneven: float) -> None:
    """Three lines of the form ramsey took minutes of a fit that others do in a second."""
    x = np.arange(121.0) + uneven * np.random.default_rng(1).uniform(-1, 1, 121)
    y, sigma, asked = 1 - 0.3 * sum(lorentz(x - centre, 5.0) for centre in (25, 60, 92)), np.full(121, 0.01), []

    def counting(d: np.ndarray, width: float) -> np.ndarray:
        asked.append(d.size)
        return lorentz(d, width)

    form = replace(FORMS["lorentz"], f=counting)
    guesses = first_guesses(form, x, y, sigma, 3, {})
    assert sum(asked) < 10 * (2 * 121 + 9 * 121 if uneven == 0 else 121**2 + 9 * 121)
    chi_squared, centres, width = min(guesses, key=lambda one: one[0])
    for i, centre in enumerate(centres):
        tried = [linear(form, x, y, sigma, [*centres[:i], one], width)[0] for one in x]
        assert centre == x[np.argmin(tried)]
    assert np.abs(np.sort(centres) - [25, 60, 92]).max() < 2 and chi_squared == pytest.approx(min(tried))

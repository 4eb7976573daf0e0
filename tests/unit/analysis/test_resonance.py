"""The dip or peak of a curve: found, fitted, and with errors that hold."""
from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rabiline import results
from rabiline.curves import Curve, NoResonance, curves, half_maximum
from rabiline.fit import fit
from synthetic import DORADO, Axis, binomial_errors, dip, frequencies, laws, write_results

CENTRE, WIDTH = 291.65e3, 7.3e3


def curve_of(y: np.ndarray, covariance: np.ndarray, x: np.ndarray) -> Curve:
    return Curve("a curve", DORADO, "neutron", results.Axis("H0.frequency", "Hz", x), np.arange(x.size), y,
                 np.sqrt(np.diag(covariance)), covariance)


def independent_points(steepness: float = 2, particles: int = 10000, seed: int = 1938) -> Curve:
    """A curve with the noise of particles that differ from point to point."""
    x = frequencies().values
    truth = dip(x, CENTRE, WIDTH, steepness)
    y = np.random.default_rng(seed).binomial(particles, truth) / particles
    return curve_of(y, np.diag(binomial_errors(y, particles) ** 2), x)


@pytest.mark.parametrize("steepness", [2, 4, 16])
@pytest.mark.parametrize("measure", [lambda curve: fit(curve).resonance, half_maximum])
def test_centre_and_width_come_out_within_three_errors_and_one_percent_more_does_not(
        measure: object, steepness: float) -> None:
    found = measure(independent_points(steepness, particles=1_000_000))
    assert found.kind == "dip"
    assert abs(found.centre.value - CENTRE) < 3 * found.centre.error
    assert abs(found.width.value - WIDTH) < 3 * found.width.error
    assert abs(found.centre.value - 1.01 * CENTRE) > 10 * found.centre.error
    if measure is not half_maximum or steepness == 2:  # straight lines between points 0.5 kHz apart allow no more
        assert abs(found.width.value - 1.01 * WIDTH) > 3 * found.width.error


def test_a_peak_is_measured_like_a_dip() -> None:
    upside_down = independent_points()
    found = fit(replace(upside_down, y=1 - upside_down.y)).resonance
    as_dip = fit(upside_down).resonance
    assert found.kind == "peak"
    assert found.centre.value == pytest.approx(as_dip.centre.value, rel=1e-6)
    assert found.width.value == pytest.approx(as_dip.width.value, rel=1e-4)


def test_the_errors_of_independent_points_are_the_scatter_of_repeated_fits() -> None:
    fits = [fit(independent_points(seed=seed)).resonance for seed in range(80)]
    for measured in ("centre", "width", "depth"):
        values = [getattr(found, measured).value for found in fits]
        error = np.mean([getattr(found, measured).error for found in fits])
        assert np.std(values) == pytest.approx(error, rel=0.3)  # 80 repeats: 8 % standard error


def test_points_that_share_particles_need_the_covariance() -> None:
    """Slow and fast particles move the whole dip to and fro, together at all points: errors that leave the covariance
    out are wrong, those from the covariance are the scatter of repeated fits."""
    x, shift, noise = frequencies().values, 50.0, 1e-3
    slope = (dip(x, CENTRE + 1, WIDTH, 2) - dip(x, CENTRE - 1, WIDTH, 2)) / 2
    covariance = shift**2 * np.outer(slope, slope) + noise**2 * np.eye(x.size)
    generator = np.random.default_rng(1938)
    with_it, without_it = [], []
    for _ in range(80):
        y = dip(x, CENTRE + shift * generator.normal(), WIDTH, 2) + noise * generator.normal(size=x.size)
        with_it.append(fit(curve_of(y, covariance, x)).resonance.centre)
        without_it.append(fit(curve_of(y, np.diag(np.diag(covariance)), x)).resonance.centre)
    scatter = np.std([centre.value for centre in with_it])
    assert np.mean([centre.error for centre in with_it]) == pytest.approx(scatter, rel=0.3)
    assert np.mean([centre.error for centre in without_it]) < 0.5 * scatter
    found = half_maximum(curve_of(dip(x, CENTRE, WIDTH, 2), covariance, x)).centre.error
    assert found == pytest.approx(shift, rel=0.3)


def test_a_singular_covariance_does_no_harm() -> None:
    x = frequencies().values
    found = fit(curve_of(dip(x, steepness=2), np.full((x.size, x.size), 1e-6), x)).resonance
    assert found.baseline.error == pytest.approx(1e-3, rel=0.01)  # a common shift moves the baseline,
    assert found.depth.error < 1e-5  # and nothing else


def test_a_curve_that_the_model_misses_gets_larger_errors() -> None:
    curve = independent_points(particles=1_000_000)
    side_lobes = 0.05 * np.sin((curve.x - CENTRE) / 1e3) * (np.abs(curve.x - CENTRE) > WIDTH)
    honest, missed = fit(curve), fit(replace(curve, y=curve.y + side_lobes))
    assert honest.misfit < 1.3 and missed.misfit > 20
    assert missed.resonance.centre.error > 10 * honest.resonance.centre.error


def test_a_flat_line_has_no_resonance() -> None:
    x = frequencies().values
    y = np.random.default_rng(1938).binomial(10000, 0.9, x.size) / 10000
    with pytest.raises(NoResonance, match="nothing stands out"):
        fit(curve_of(y, np.diag(binomial_errors(y, 10000) ** 2), x))
    with pytest.raises(NoResonance, match="nothing stands out"):
        half_maximum(curve_of(np.ones(101), np.zeros((101, 101)), x))


def test_a_dip_that_the_scan_cuts_off_is_refused() -> None:
    x = np.linspace(266.6e3, 292e3, 101)
    with pytest.raises(NoResonance, match="the scan ends before"):
        half_maximum(curve_of(dip(x), np.eye(101) * 1e-8, x))


def test_a_scan_over_laws_has_one_curve_per_law(tmp_path: Path) -> None:
    axis = frequencies(21)
    detected = np.concatenate([np.ones(21), dip(axis.values)])
    covariance = np.diag(np.arange(42.0))
    path = write_results(tmp_path / "a.h5", [laws("quantum", DORADO), axis], detected,
                         law=["quantum"] * 21 + [DORADO] * 21, covariance=covariance, bins=4)
    quantum, dorado = curves(results.read(path))
    assert quantum.label == "quantum" and dorado.label == "dorado (hypothesis), torque, κ = 1"
    assert dorado.points.tolist() == list(range(21, 42))
    np.testing.assert_allclose(dorado.y, dip(axis.values))
    np.testing.assert_allclose(np.diag(dorado.covariance), np.arange(21, 42))


def test_the_first_axis_may_be_the_one_that_the_curve_runs_along(tmp_path: Path) -> None:
    axis, amplitudes = frequencies(21), Axis("H0.amplitude", np.array([0.1e-6, 0.3e-6]), "T")
    detected = np.stack([np.ones(21), dip(axis.values)], axis=1).ravel()
    path = write_results(tmp_path / "a.h5", [axis, amplitudes], detected, law=[DORADO], bins=4)
    weak, strong = curves(results.read(path))
    assert strong.label == "dorado (hypothesis), torque, κ = 1, H0.amplitude = 300 nT"
    np.testing.assert_allclose(strong.y, dip(axis.values))
    assert weak.points.tolist() == list(range(0, 42, 2))


def test_no_variance_is_smaller_than_the_binomial_one(tmp_path: Path) -> None:
    axis = frequencies(21)
    path = write_results(tmp_path / "a.h5", [axis], dip(axis.values), law=[DORADO], bins=4,
                         covariance=np.zeros((21, 21)))
    (curve,) = curves(results.read(path))
    np.testing.assert_allclose(np.diag(curve.covariance), curve.errors**2)

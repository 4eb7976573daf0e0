"""The dip or peak of a curve: found, fitted, and with errors that hold."""
from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rabiline import results
from rabiline.covariance import Spread
from rabiline.curves import Curve, NoResonance, Resonance, curves, half_maxima
from rabiline.fit import fit
from rabiline.forms import rabi
from synthetic import DORADO, Axis, binomial_errors, dip, frequencies, laws, write_results

pytestmark = pytest.mark.slow

CENTRE, WIDTH = 291.65e3, 7.3e3


def curve_of(y: np.ndarray, covariance: np.ndarray, x: np.ndarray, particles: int = 10**9) -> Curve:
    """A curve whose covariance is known."""
    errors = np.sqrt(np.diag(covariance))
    return Curve("a curve", DORADO, "neutron", results.Axis("H0.frequency", "Hz", x), np.arange(x.size), y, errors,
                 Spread.of(y, errors, covariance, particles, known=True))


def fitted(curve: Curve) -> Resonance:
    """The only dip or peak, fitted."""
    (found,) = fit(curve).resonances
    return found


def half_maximum(curve: Curve) -> Resonance:
    """The only dip or peak, without a model."""
    (found,) = half_maxima(curve)
    return found


def independent_points(steepness: float = 2, particles: int = 10000, seed: int = 1938) -> Curve:
    """A curve with the noise of particles that differ from point to point."""
    x = frequencies().values
    truth = dip(x, CENTRE, WIDTH, steepness)
    y = np.random.default_rng(seed).binomial(particles, truth) / particles
    return curve_of(y, np.diag(binomial_errors(y, particles) ** 2), x)


@pytest.mark.parametrize("steepness", [2, 4, 16])
@pytest.mark.parametrize("measure", [fitted, half_maximum])
def test_centre_and_width_come_out_within_three_errors_and_one_percent_more_does_not(
        measure: object, steepness: float) -> None:
    found = measure(independent_points(steepness, particles=1_000_000))
    assert found.kind == "dip"
    assert abs(found.centre.value - CENTRE) < 3 * found.centre.error
    assert abs(found.width.value - WIDTH) < 3 * found.width.error
    assert abs(found.centre.value - 1.01 * CENTRE) > 10 * found.centre.error
    if steepness == 2:  # points 0.5 kHz apart allow no more for steeper edges
        assert abs(found.width.value - 1.01 * WIDTH) > 3 * found.width.error


def test_a_curve_of_a_hundred_thousand_points_is_measured_and_not_fitted() -> None:
    x = np.linspace(250e3, 330e3, 100_000)
    y, errors = dip(x, CENTRE, WIDTH, 2), np.full(x.size, 1e-3)
    long = Curve("a curve", DORADO, "neutron", results.Axis("H0.frequency", "Hz", x), np.arange(x.size), y, errors,
                 Spread.of(y, errors, None, 10**6))
    few = curve_of(y[::1000], np.diag(errors[::1000]**2), x[::1000])
    found, expected = half_maximum(long), half_maximum(few)
    assert found.centre.value == pytest.approx(CENTRE, abs=1) and found.depth.error == pytest.approx(expected.depth.error, rel=0.1)
    with pytest.raises(NoResonance, match="100000 points are too many"):
        fit(long)


def test_a_peak_is_measured_like_a_dip() -> None:
    upside_down = independent_points()
    found = fitted(replace(upside_down, y=1 - upside_down.y))
    as_dip = fitted(upside_down)
    assert found.kind == "peak"
    assert found.centre.value == pytest.approx(as_dip.centre.value, rel=1e-6)
    assert found.width.value == pytest.approx(as_dip.width.value, rel=1e-4)


def test_the_errors_of_independent_points_are_the_scatter_of_repeated_fits() -> None:
    fits = [fitted(independent_points(seed=seed)) for seed in range(80)]
    for measured in ("centre", "width"):
        values = [getattr(found, measured).value for found in fits]
        spacing = {"centre": 0.5, "width": 1.0}[measured]  # of the points, which does not scatter
        both = [(getattr(found, measured).error, spacing * found.resolution) for found in fits]
        error = np.mean([np.sqrt(whole**2 - resolution**2) for whole, resolution in both])
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
        with_it.append(fitted(curve_of(y, covariance, x)).centre)
        without_it.append(fitted(curve_of(y, np.diag(np.diag(covariance)), x)).centre)
    scatter = np.std([centre.value for centre in with_it])
    assert np.mean([centre.error for centre in with_it]) == pytest.approx(scatter, rel=0.3)
    assert np.mean([centre.error for centre in without_it]) < 0.5 * scatter
    found = half_maximum(curve_of(dip(x, CENTRE, WIDTH, 2), covariance, x)).centre.error
    assert found == pytest.approx(shift, rel=0.3)


def test_a_singular_covariance_does_no_harm() -> None:
    x = frequencies().values
    found = fitted(curve_of(dip(x, steepness=2), np.full((x.size, x.size), 1e-6), x))
    assert found.baseline.error == pytest.approx(1e-3, rel=0.01)  # a common shift moves the baseline,
    assert found.depth.error < 1e-5  # and nothing else


def test_a_curve_that_the_model_misses_gets_larger_errors() -> None:
    curve = independent_points(particles=1_000_000)
    side_lobes = 0.05 * np.sin((curve.x - CENTRE) / 1e3) * (np.abs(curve.x - CENTRE) > WIDTH)
    honest, missed = fit(curve), fit(replace(curve, y=curve.y + side_lobes))
    assert honest.misfit < 1.3 and missed.misfit > 20
    (honest_dip,), (missed_dip,) = honest.resonances, missed.resonances
    assert missed_dip.centre.error > 10 * (honest_dip.centre.error - honest_dip.resolution / 2)
    assert missed_dip.centre.error > 5 * honest_dip.centre.error


def trapezoid(x: np.ndarray, centre: float, rise: float) -> np.ndarray:
    """A dip 7.3 kHz wide at half its depth with straight edges: no bell."""
    return np.clip((np.abs(x - centre) - WIDTH / 2) / rise + 0.5, 0, 1)


@pytest.mark.parametrize("measure", [fitted, half_maximum])
@pytest.mark.parametrize("edge", [10.0, 200.0, 500.0, 1000.0])  # Hz
def test_edges_between_points_are_known_no_better_than_the_points_are_apart(measure: object, edge: float) -> None:
    """Whatever the grid, the true centre lies within two errors, also without any statistical error."""
    pulls = []
    for shift in np.linspace(0, 500, 25, endpoint=False):
        x = frequencies().values + shift
        y = trapezoid(x, CENTRE, edge)
        found = measure(curve_of(y, np.diag(np.full(x.size, 1e-10)), x))
        assert abs(found.centre.value - CENTRE) < 2 * found.centre.error
        assert abs(found.width.value - WIDTH) < 2 * found.width.error
        assert found.centre.error < 0.75 * 500 / np.sqrt(12) or measure is fitted
        pulls.append((found.centre.value - CENTRE) / found.centre.error)
    if edge < 500:
        assert np.std(pulls) > 0.2  # and the error is no larger than it has to be; which fits stand on an edge, rounding decides


def test_a_finer_grid_makes_the_error_statistical() -> None:
    errors = {}
    for points in (101, 401, 1601):
        x = frequencies(points).values
        y = dip(x, CENTRE, WIDTH, 16)
        found = fitted(curve_of(y, np.diag(binomial_errors(y, 10**4) ** 2), x))
        errors[points] = found.centre.error, found.resolution / 2
    assert errors[101][1] > 0.9 * errors[101][0]
    assert errors[1601][1] < 0.3 * errors[1601][0]
    coarse = fitted(independent_points(steepness=2))
    assert coarse.resolution / 2 < 0.6 * coarse.centre.error  # 15 points on the width of a smooth dip are enough


def two_dips(first: float, second: float, x: np.ndarray, depth: float = 0.5) -> Curve:
    y = 1 - 0.5 * (1 - dip(x, first, WIDTH, 8)) - depth * (1 - dip(x, second, WIDTH, 8))
    return curve_of(y, np.diag(binomial_errors(y, 10**4) ** 2), x)


@pytest.mark.parametrize("measure", [lambda curve: fit(curve).resonances, half_maxima])
@pytest.mark.parametrize("depth", [0.5, 0.3])
def test_each_of_two_dips_is_measured_even_where_they_reach_into_the_ends_of_the_scan(
        measure: object, depth: float) -> None:
    low, high = measure(two_dips(291.65e3, 350e3, np.linspace(285e3, 355e3, 141), depth))
    assert abs(low.centre.value - 291.65e3) < 2 * low.centre.error < 1e3
    assert abs(high.centre.value - 350e3) < 2 * high.centre.error < 1e3
    for found, height in ((low, 0.5), (high, depth)):
        assert abs(found.width.value - WIDTH) < 2 * found.width.error
        assert found.depth.value == pytest.approx(height, abs=0.01)
        assert found.baseline.value == pytest.approx(1, abs=0.01)


def test_dips_that_overlap_are_refused_rather_than_taken_for_one() -> None:
    x = np.linspace(270e3, 320e3, 201)
    for second in (299.2e3, 299.4e3, 300e3):
        with pytest.raises(NoResonance, match="overlap"):
            half_maxima(two_dips(291.65e3, second, x))
    assert len(half_maxima(two_dips(291.65e3, 304e3, x))) == 2


def test_side_lobes_are_no_dips_and_a_comb_of_fringes_is_refused() -> None:
    x = np.linspace(-30.0, 30.0, 241)
    lobes = curve_of(1 - np.sinc(x / 6) ** 2, np.diag(np.full(x.size, 1e-6)), x)
    assert half_maximum(lobes).centre.value == pytest.approx(0, abs=1e-6)
    fringes = curve_of(1 - np.exp(-(x / 15) ** 2) * np.cos(np.pi * x / 3) ** 2, np.diag(np.full(x.size, 1e-6)), x)
    with pytest.raises(NoResonance, match="too many"):
        half_maxima(fringes)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("begin", [0.9, 1.0, 1.2, 2.0])  # 1/time from the resonance
@pytest.mark.parametrize("tip", [0.5, 1.0, 3.0])  # pi
def test_side_lobes_without_their_resonance_are_not_measured(side: int, begin: float, tip: float) -> None:
    x = np.linspace(begin, begin + 8, 161)
    y = 1 - rabi(x, tip / 2, 1.0) + np.random.default_rng(1938).normal(0, 1e-5, x.size)
    with pytest.raises(NoResonance):
        half_maxima(curve_of(y[::side], np.diag(np.full(x.size, 1e-10)), side * x[::side]))


@pytest.mark.parametrize("begin", [-6.0, -3.0, -1.2])
def test_a_resonance_with_its_side_lobes_is_measured_wherever_the_scan_begins(begin: float) -> None:
    x = np.linspace(begin, begin + 10, 201)
    assert half_maximum(curve_of(1 - rabi(x, 0.5, 1.0), np.diag(np.full(x.size, 1e-8)), x)).centre.value == pytest.approx(0, abs=1e-2)


def test_fringes_that_rise_towards_the_end_of_a_scan_have_no_central_one() -> None:
    for x in (np.linspace(300.0, 2300.0, 401), np.linspace(-2300.0, -300.0, 401)):
        y = 0.1 + 0.06 * np.exp(-np.abs(x) / 900) * np.cos(2 * np.pi * x / 500)
        with pytest.raises(NoResonance, match="central one may lie outside"):
            half_maxima(curve_of(y, np.diag(np.full(x.size, 1e-8)), x))


def test_between_two_lines_there_is_no_third() -> None:
    x = np.linspace(-1.0, 1.0, 101)
    y = 1 - 1e-3 / (1 + (x - 2)**2) - 1e-3 / (1 + (x + 2)**2)
    with pytest.raises(NoResonance, match="more than half"):
        half_maxima(curve_of(y, np.full((x.size, x.size), 9e-10) + np.diag(np.full(x.size, 1e-14)), x))


def test_the_top_of_a_curve_without_its_baseline_is_refused() -> None:
    # The width of a parabola would be whatever the scan's range is.
    for points in (11, 21, 81):
        x = np.linspace(-1.0, 1.0, points)
        with pytest.raises(NoResonance):
            half_maxima(curve_of(0.5 - 0.1 * x**2, np.diag(np.full(points, 1e-8)), x))


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
    covariance = np.add.outer(np.arange(42.0), np.arange(42.0)) + 200 * np.eye(42)
    path = write_results(tmp_path / "a.h5", [laws("quantum", DORADO), axis], detected,
                         law=["quantum"] * 21 + [DORADO] * 21, covariance=covariance, bins=4)
    quantum, dorado = curves(results.read(path))
    assert quantum.label == "quantum" and dorado.label == "dorado (hypothesis), torque, κ = 1"
    assert dorado.points.tolist() == list(range(21, 42))
    np.testing.assert_allclose(dorado.y, dip(axis.values))
    np.testing.assert_allclose(dorado.spread.correlation[3, 4], 49 / np.sqrt(248 * 250))


def test_the_first_axis_may_be_the_one_that_the_curve_runs_along(tmp_path: Path) -> None:
    axis, amplitudes = frequencies(21), Axis("H0.amplitude", np.array([0.1e-6, 0.3e-6]), "T")
    detected = np.stack([np.ones(21), dip(axis.values)], axis=1).ravel()
    path = write_results(tmp_path / "a.h5", [axis, amplitudes], detected, law=[DORADO], bins=4)
    weak, strong = curves(results.read(path))
    assert strong.label == "dorado (hypothesis), torque, κ = 1, H0.amplitude = 300 nT"
    np.testing.assert_allclose(strong.y, dip(axis.values))
    assert weak.points.tolist() == list(range(0, 42, 2))


def test_the_variances_are_the_binomial_ones_and_nowhere_zero(tmp_path: Path) -> None:
    axis = frequencies(21)
    path = write_results(tmp_path / "a.h5", [axis], dip(axis.values), law=[DORADO], bins=4,
                         covariance=np.zeros((21, 21)))
    (curve,) = curves(results.read(path))
    np.testing.assert_allclose(np.diag(curve.covariance), curve.errors**2)


def test_of_fringes_only_the_central_one_is_measured() -> None:
    x = np.linspace(-1000.0, 1000.0, 201)
    y = 0.1 + 0.06 * np.exp(-(x / 500) ** 2) * np.cos(2 * np.pi * (x - 7) / 500)
    curve = curve_of(y, np.diag(np.full(x.size, 1e-8)), x)
    (central,) = half_maxima(curve)
    assert central.centre.value == pytest.approx(7, abs=3) and central.kind == "peak"
    with pytest.raises(NoResonance, match="fringes are no dips"):
        fit(curve)


@pytest.mark.parametrize("parameter, units", [
    ("wire.offset.z", "m"), ("second.phase", "rad"), ("law.kappa", ""), ("H0.amplitude", "T"), ("magnet.gradient", "T/m")])
def test_only_a_frequency_or_a_static_field_is_tuned_through_a_resonance(parameter: str, units: str) -> None:
    x = np.linspace(-1e-3, 1e-3, 101)
    curve = curve_of(np.exp(-(x / 2e-4) ** 2), np.diag(np.full(x.size, 1e-8)), x)
    with pytest.raises(NoResonance, match="tunes neither"):
        half_maxima(replace(curve, axis=replace(curve.axis, parameter=parameter, units=units)))
    assert half_maxima(replace(curve, axis=replace(curve.axis, parameter="C.field", units="T")))


def fringes(x: np.ndarray, centre: float = 0.0) -> np.ndarray:
    """A comb 240 Hz apart that falls off on both sides, as a clock has it."""
    return 0.3 + 0.1 * np.exp(-((x - centre) / 300)**2) * np.cos(2 * np.pi * (x - centre) / 240)


@pytest.mark.parametrize("noise", [1e-5, 5e-4])
@pytest.mark.parametrize("shift", [0.0, 0.07])
def test_the_error_of_a_central_fringe_is_its_scatter_whether_points_err_together_or_each_by_itself(shift: float, noise: float) -> None:
    """Of points 12 to a fringe's width."""
    x, generator, found = np.arange(-500.0, 501.0, 10.0), np.random.default_rng(1938), []
    slope = (fringes(x, 0.1) - fringes(x, -0.1)) / 0.2
    covariance = shift**2 * np.outer(slope, slope) + noise**2 * np.eye(x.size)
    for _ in range(300):
        y = fringes(x, shift * generator.normal()) + noise * generator.normal(size=x.size)
        found.append(half_maximum(curve_of(y, covariance, x)).centre)
    scatter = np.std([centre.value for centre in found])
    if scatter > 0.05:  # less may be the points'
        assert np.mean([centre.error for centre in found]) == pytest.approx(scatter, rel=0.2)
    assert np.mean([abs(centre.value) < 2 * centre.error for centre in found]) > 0.93


def test_a_centre_between_fine_and_coarse_points_is_known_no_better_than_the_coarse_edge() -> None:
    x = np.geomspace(10.0, 2000.0, 24)
    found = half_maximum(curve_of(0.1 + 0.1 * np.exp(-np.log(x / 170)**2), np.full((24, 24), 1e-12) + np.eye(24) * 1e-12, x))
    assert found.centre.error == pytest.approx(found.resolution / 2, rel=0.2)

"""Fits of what moves particles across edges find the minimum, and know how far it may be."""
from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402
from rabiline.counts import Counts  # noqa: E402
from rabiline.counts_problem import Exposure, Problem, shares_of_simulation
from rabiline.surface import Surface
from rabiline.fitting import fit_counts
from rabiline.profiles import halves  # noqa: E402

CLOCK = rabiline.load(Path(__file__).parents[2] / "beamline/caesium-clock.yaml").scan()
X = np.linspace(9192631271.5, 9192632271.5, 51)
PLACES = tuple(f"{x!r} Hz" for x in X.tolist())


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    """[n] Fractions at the values of the file, where the gradient of the second magnet and the place of the wire are at the top of the curve."""
    return np.ravel(CLOCK.set(seed=77, particles=2000000).scan("first.frequency", PLACES).fly().detected)


def counted(expected: np.ndarray, seed: int) -> Counts:
    counts = np.random.default_rng(seed).poisson(40000 * expected).astype(float)
    return Counts("counts", "first.frequency", PLACES, X, "Hz", counts, None, None, None)


@pytest.mark.parametrize(("free", "true", "seed"), [("B.gradient", 105.0, 4), ("wire.at", 1.9, 2)])
def test_a_parameter_at_the_top_of_a_curve_is_found_there(expected: np.ndarray, free: str, true: float, seed: int) -> None:
    fit = fit_counts(CLOCK.set(particles=100000, seed=1000 + seed), counted(expected, seed), [free])
    value, error = fit[free]
    assert abs(value - true) < 3.5 * error < 0.04 * true
    low, high = fit.intervals[0]
    assert 0.9 * error < (high - low) / 2 < 1.1 * error  # of a parameter that bends the curve the error is that of its profile
    assert fit.p > 1e-3 and not fit.degenerate


def test_spins_and_geometry_are_fitted_together(expected: np.ndarray) -> None:
    truth = {"C.field": 6e-6, "first.amplitude+second.amplitude": 0.46e-6, "B.gradient": 105.0}
    fit = fit_counts(CLOCK.set(particles=20000, seed=1002), counted(expected, 2), list(truth), intervals=False)
    assert fit.p > 1e-3
    for name, true in truth.items():
        assert abs(fit[name][0] - true) < 3.5 * fit[name][1] < true, name


def test_two_lengths_that_trade_against_each_other_hold_the_truth_within_their_errors(expected: np.ndarray) -> None:
    fit = fit_counts(CLOCK.set(particles=50000, seed=1003), counted(expected, 3), ["B.gradient", "wire.at"], intervals=False)
    assert fit.p > 1e-3 and not fit.degenerate
    assert abs(fit["B.gradient"][0] - 105) < 3.5 * fit["B.gradient"][1] < 9 and abs(fit["wire.at"][0] - 1.9) < 3.5 * fit["wire.at"][1] < 0.04


def test_a_slit_and_a_free_scale_that_imitate_each_other_do_not_stop_a_fit_early() -> None:
    """What 20,000 particles know of the slit is noise for the most part: its direction is followed nevertheless, as the counts ask for it."""
    truth, x = {"magnet.gradient": 1460.0, "slit.height": 42e-6}, np.linspace(-0.3e-3, 0.3e-3, 61)
    silver = rabiline.load(Path(__file__).parents[2] / "beamline/stern-gerlach.yaml").scan().set({"plate.height": "20 um", "plate.bins": [1, 1]})
    places = tuple(f"{z!r} m" for z in x.tolist())
    y = np.ravel(silver.set(truth).set(seed=1003, particles=1000000).scan("plate.offset.z", places).fly().detected)
    counts = Counts("counts", "plate.offset.z", places, x, "m", np.random.default_rng(3).poisson(40000 * y).astype(float), None, None, None)
    far, near = (fit_counts(silver.set(particles=20000), counts, [*truth, "scale"], start=start) for start in ({}, truth))
    assert far.chi_squared < near.chi_squared + 5
    assert abs(far["slit.height"][0] - 42e-6) < 4e-6 and abs(far["magnet.gradient"][0] - 1460) < 3.5 * far["magnet.gradient"][1]


def test_fits_are_calibrated_by_a_script(tmp_path: Path) -> None:
    tool, fringes = (Path(__file__).parents[2] / name for name in ("tools/calibrate-fit", "docs/example/ramsey-fringes.yaml"))
    done = subprocess.run([tool, fringes, "--free", "guide.field=1.0003e-3", "--experiments", "2", "--particles", "300", "--truth", "3000"],
                          capture_output=True, text=True)
    assert done.returncode == 0 and "2 measurements fitted, 0 not" in done.stdout and "guide.field: pull " in done.stdout, done.stderr


def bent(slope: float, bend: float, of: np.ndarray) -> Problem:
    """Counts of 100 at each point, which change by (slope d + bend d^2) standard deviations in the direction `of` [n] over d steps."""
    n, direction = of.size, 10 * of / np.linalg.norm(of)
    surface = Surface(np.zeros(1), np.ones(1), np.full(n, 100.0), slope * direction[None], bend * direction[None, None], np.zeros((n, n)),
                      np.zeros((4, 1, n)), np.zeros((4, 1, 1, n)))
    exposure = Exposure(np.ones(n), np.ones(n), np.zeros(n), True)
    return Problem(np.full(n, 100.0), exposure, surface, ("scale",))


@pytest.mark.parametrize(("slope", "bend"), [(1.0, 0.0), (0.0, 0.3), (0.0, 2.0), (1.0, 0.3)])
def test_a_parameter_without_a_slope_is_known_by_its_bend(slope: float, bend: float) -> None:
    """F = slope^2 + 4 bend^2 / F, and none of it where a free factor explains the bend."""
    shape = np.array([1.0, -1.0, 0.0, 1.0, -1.0])
    values = np.array([0.0, 1.0])
    fisher = bent(slope, bend, shape).fisher(values, np.zeros((5, 0)))
    assert fisher.errors[0]**-2 == pytest.approx(slope**2 / 2 + np.sqrt(slope**4 / 4 + 4 * bend**2), rel=1e-3)
    assert bent(slope, bend, np.ones(5)).fisher(values, np.zeros((5, 0))).matrix[0, 0] == pytest.approx(slope**2, abs=1e-9)


def test_where_few_simulated_particles_come_by_chance_pulls_neither_a_parameter_nor_the_factor() -> None:
    """An edge that moves, beyond which next to none come, and four counts for each particle: were points with too few weighed more than those with too many, or
    the factor's slope as noisy as the curve, both would be off by half an error on the average."""
    draw, x, particle = np.random.default_rng(1), np.linspace(-2, 2, 51), 1 / 50000
    expected = 5e-3 / (1 + np.exp((1.2 - np.abs(x)) / 0.12))
    slopes = -expected**2 / 5e-3 * np.exp((1.2 - np.abs(x)) / 0.12) * (np.abs(x) / 12)[None]
    exposure, pulls = Exposure(np.full(51, 200000.0), np.ones(51), np.zeros(51), False), []
    for _ in range(200):
        y = draw.poisson(expected / particle) * particle
        surface = Surface(np.zeros(1), np.ones(1), y, slopes, np.zeros((1, 1, 51)), np.diag(np.maximum(y, particle) * particle), np.zeros((4, 1, 51)),
                          np.zeros((4, 1, 1, 51)))
        problem = Problem(draw.poisson(200000 * expected).astype(float), exposure, surface, ("scale",))
        found, _ = problem.least(np.array([0.0, 1.0]))
        errors = np.sqrt(np.diag(problem.fisher(found, problem.modes(found)).covariance))
        pulls.append((found - [0.0, 1.0]) / errors)
    assert np.abs(np.mean(pulls, axis=0)).max() < 0.25 and np.abs(np.std(pulls, axis=0) - 1).max() < 0.15


@pytest.mark.parametrize("counts_of_one", [0.25, 4.0])
def test_the_share_of_the_simulation_is_that_of_its_particles(counts_of_one: float) -> None:
    """Also where points have a slope to which no particle came: they know nothing, however little they expect."""
    draw, x, particle = np.random.default_rng(1), np.linspace(-2, 2, 51), 1 / 50000
    y = np.maximum(draw.poisson(np.maximum(1.2 - np.abs(x), 0) / particle / 100), 1e-5) * particle
    slopes = draw.normal(size=51)[None] * np.where(y > particle / 2, 1e-3, 1e-5)
    surface = Surface(np.zeros(1), np.ones(1), y, slopes, np.zeros((1, 1, 51)), np.diag(np.maximum(y, particle) * particle), np.zeros((4, 1, 51)), np.zeros((4, 1, 1, 51)))
    exposure = Exposure(np.full(51, counts_of_one / particle), np.ones(51), np.zeros(51), False)
    problem = Problem(draw.poisson(counts_of_one / particle * y).astype(float), exposure, surface, ("scale",))
    assert shares_of_simulation(problem, np.array([0.0, 1.0]))[0] == pytest.approx(counts_of_one / (1 + counts_of_one), rel=0.15)


def test_a_profile_is_read_from_two_halves_of_parabolas() -> None:
    at = np.linspace(-3, 3, 13)
    q = 50 + np.where(at < 0.12, 4 * (at - 0.12)**2, 0.25 * (at - 0.12)**2)
    middle, least, (low, high) = halves(at, q)
    assert middle == pytest.approx(0.12, abs=0.04) and least == pytest.approx(50, abs=0.05)
    assert low == pytest.approx(0.12 - 0.5, abs=0.05) and high == pytest.approx(0.12 + 2, abs=0.1)
    trembling = halves(at, q + 0.5 * np.random.default_rng(5).normal(size=at.size))[2]
    assert trembling == pytest.approx((low, high), abs=0.5)
    assert halves(at, np.where(at > 1, np.inf, q))[2][0] == pytest.approx(low, abs=0.1)  # values that cannot be
    assert halves(at, np.where(at < 0, 4 * at**2, 0))[2][1] == np.inf


PROFILE = """rabiline: 1
species: K-39 atom
law: quantum
source: {speed: {kind: effusive, temperature: 500 K}, opening: {width: 0.5 mm, height: 0.02 mm}, direction: {kind: box, x: 0.1 mrad, z: 0.1 mrad}}
parts:
  - {name: magnet, kind: gradient_magnet, at: 0.1 m, length: 0.1 m, field: 0.1 T, gradient: 80 T/m}
  - {name: slit, kind: slit, at: 0.5 m, width: 4 mm, height: 1.2 mm}
  - {name: wire, kind: detector, at: 1 m, width: 2 mm, height: 0.05 mm, bins: [1, 1]}
particles: 20000
seed: 3
scan: {parameter: wire.offset.z, from: -2 mm, to: 2 mm, points: 41}
"""


@pytest.mark.parametrize(("free", "true", "at_best"), [("slit.height", 1.1e-3, 2.6e-6), ("magnet.length", 0.104, 4e-4)])
def test_edges_that_come_in_within_a_step_do_not_make_errors_small(free: str, true: float, at_best: float) -> None:
    """`at_best` is what the counts allow, as 10^6 particles tell."""
    profile = rabiline.load(PROFILE)
    z = np.linspace(-2e-3, 2e-3, 41)
    y = np.ravel(profile.set({free: true}).set(seed=7, particles=1000000).fly().detected)
    pulls = []
    for seed in range(2):
        counts = np.random.default_rng(seed).poisson(100000 * y).astype(float)
        table = Counts("counts", "wire.offset.z", tuple(f"{one!r} m" for one in z.tolist()), z, "m", counts, None, np.full(41, 1e5), None)
        fit = fit_counts(profile.set(seed=1000 + seed).scan(), table, [free])
        value, error = fit[free]
        assert at_best < error < 10 * at_best and fit.freedom < 35  # since nothing arrives at the ends
        pulls.append((value - true) / error)
    assert np.abs(pulls).max() < 3.5 and np.mean(np.square(pulls)) < 4


BETWEEN = """rabiline: 1
species: neutron
law: quantum
source: {speed: {kind: single, value: 500 m/s}, opening: {width: 0.3 mm, height: 1 mm}, direction: {kind: gaussian, x: 1 mrad, z: 1 mrad}}
parts:
  - {name: S, kind: slit, at: 0.5 m, width: 0.5 mm, height: 2 mm}
  - {name: B, kind: beam_stop, at: 0.8 m, width: 1 mm, height: 10 mm, offset: {x: 0.9 mm}}
  - {name: D, kind: detector, at: 1 m, width: 0.1 mm, height: 4 mm, bins: [1, 1]}
particles: 20000
seed: 1
scan: {parameter: D.offset.x, from: -1.5 mm, to: 1.5 mm, points: 31}
"""


def test_a_place_that_few_simulated_particles_tell_is_no_better_known_than_they_tell_it() -> None:
    """Where the slit's half shadow ends one particle arrives, or four: -2 ln L trembles, and its dips are narrower than the error."""
    setup = rabiline.load(BETWEEN)
    x = np.linspace(-1.5e-3, 1.5e-3, 31)
    y = np.ravel(setup.set({"S.at": 0.44}).set(seed=99, particles=1000000).fly().detected)
    for seed in range(3):
        counts = np.random.default_rng(seed).poisson(200000 * y).astype(float)
        fit = fit_counts(setup.scan(), Counts("counts", "D.offset.x", tuple(f"{one!r} m" for one in x.tolist()), x, "m", counts, None, None, None), ["S.at"])
        value, error = fit["S.at"]
        assert 0.002 < error < 0.005 and abs(value - 0.44) < 3 * error and np.ptp(fit.intervals[0]) > 1.5 * error


def test_an_offset_that_is_zero_has_an_error_and_leaves_others_theirs() -> None:
    """Steps of a tenth of its value moved nothing over an edge: it was of no effect, or all was degenerate with it."""
    x = np.linspace(-0.3e-3, 0.3e-3, 41)
    silver = rabiline.load(Path(__file__).parents[2] / "beamline/stern-gerlach.yaml").scan().set({"plate.height": "20 um", "plate.bins": [1, 1], "slit.offset.z": "50 nm"})
    places = tuple(f"{z!r} m" for z in x.tolist())
    y = np.ravel(silver.set(seed=1003, particles=1000000).scan("plate.offset.z", places).fly().detected)
    counts = Counts("counts", "plate.offset.z", places, x, "m", np.random.default_rng(3).poisson(20000 * y).astype(float), None, None, None)
    fit = fit_counts(silver.set(particles=50000), counts, ["magnet.gradient", "slit.offset.z"], intervals=False)
    assert not fit.degenerate and abs(fit["slit.offset.z"][0]) < 3.5 * fit["slit.offset.z"][1] < 3e-6
    assert fit["magnet.gradient"][1] < 0.02 * fit["magnet.gradient"][0]


def test_points_that_are_farther_apart_than_a_line_is_wide_are_searched_from_both_sides() -> None:
    """One search from the file's 50 µT and 1.6 µT ends 60 errors off, with chi² 1850."""
    potassium, x = rabiline.load(Path(__file__).parents[2] / "beamline/kusch-millman-rabi-potassium.yaml").scan().set({"wire.bins": [1, 1]}), np.linspace(460.42e6, 463.02e6, 105)
    places, truth = tuple(f"{f!r} Hz" for f in x.tolist()), {"C.field": 52e-6, "RF.amplitude": 1.8e-6}
    y = np.ravel(potassium.set(truth).set(seed=77, particles=100000).scan("RF.frequency", places).fly().detected)
    counts = Counts("counts", "RF.frequency", places, x, "Hz", np.random.default_rng(1).poisson(20000 * y).astype(float), None, None, None)
    fit = fit_counts(potassium.set(particles=4000), counts, list(truth), intervals=False)
    assert fit.searches > 1 and fit.sparse and fit.p > 1e-3 and f"the best of {fit.searches} searches" in str(fit)
    assert all(abs(fit[name][0] - true) < 3.5 * fit[name][1] < 0.1 * true for name, true in truth.items())


TUBE = """rabiline: 1
species: {name: caesium, charge: 0 e, structure: {I: 7/2, J: 1/2, coupling: "${A}", g_J: 2.00254, g_I: -0.000398854}, mass: 132.905 u}
law: quantum
variables: {A: 2298.1579425 MHz}
source: {speed: {kind: gaussian, mean: 280 m/s, sigma: 40 m/s}, opening: {radius: 1 nm}, direction: parallel, spin: {kind: levels, levels: [F=3 m=0]}}
parts:
  - {name: C, kind: uniform_field, at: 0.06 m, length: 0.4 m, field: 6 uT}
  - {name: R1, kind: oscillating_field, at: 0.12 m, length: 10 mm, amplitude: 0.7 uT, frequency: 9192631770 Hz, direction: z,
     approximation: rotating_wave, phase: random}
  - {name: R2, kind: oscillating_field, at: 0.30 m, length: 10 mm, amplitude: 0.7 uT, oscillator: R1, direction: z, approximation: rotating_wave, phase: locked}
  - {name: filter, kind: spin_filter, at: 0.47 m, levels: [F=4 m=0], up: 1, down: 0}
  - {name: wire, kind: detector, at: 0.6 m, width: 10 mm, height: 1 mm, bins: [1, 1]}
particles: 3000
seed: 7
"""


def test_what_moves_a_line_out_of_the_scan_by_a_thousandth_is_known_to_a_part_of_its_width() -> None:
    """The hyperfine splitting is 4 A, and the fringes are .6 kHz wide: from 4 Hz off A."""
    x = np.linspace(9192629.77e3, 9192633.77e3, 41)
    places = tuple(f"{f!r} Hz" for f in x.tolist())
    tube = rabiline.load(TUBE).scan()
    y = np.ravel(tube.set(seed=99, particles=100000).scan("R1.frequency", places).fly().detected)
    counts = Counts("counts", "R1.frequency", places, x, "Hz", np.random.default_rng(3).poisson(20000 * y).astype(float), None, np.full(41, 2e4), None)
    fit = fit_counts(tube.set({"variables.A": "2298.1579465 MHz"}), counts, ["variables.A"], intervals=False)
    value, error = fit["variables.A"]
    assert abs(value - 2298157942.5) < 3.5 * error < 2 and fit.p > 1e-3

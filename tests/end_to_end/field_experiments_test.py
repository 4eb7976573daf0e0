"""Shipped experiments in fields that differ from place to place give what their headers promise."""

import re
import subprocess

import h5py
import numpy as np
import pytest
from constants import BOHR, GAMMA, PLANCK
from experiments import EXPERIMENTS, RABILINE, crossings


@pytest.mark.experiment("frisch-segre")
def test_a_bare_spin_past_a_wire_flips_as_an_integration_of_its_equations_does(run):
    file = run("frisch-segre")
    flipped = file["entry/screen_levels/levels"][:, 0]
    # dS/dt = gamma S x B with the same field, by scipy's DOP853 to 1e-11
    expected = [0.06522171, 0.22508549, 0.40273464, 0.61433842, 0.731346, 0.84734518, 0.89549986, 0.93575899]
    assert np.abs(flipped - expected).max() < 2e-5
    assert file["entry/field_check/spin"][()] < 1e-6
    assert np.all(np.diff(flipped) > 0)  # the measured points fall from 0.1 A on


@pytest.mark.experiment("neutron-spin-echo")
def test_spins_come_back_where_both_fields_of_an_echo_are_equal(run):
    file = run("neutron-spin-echo")
    x, passed = file["entry/scan/second_field"][:], file["entry/scan/detected"][:]
    assert abs(x[np.argmax(passed)] + 100e-6) < 1e-9 and passed.max() > 0.999
    # gamma dB L/v of half a turn, L the integral of the field on the axis over its value in the middle
    length, radius, reach = 0.4, 0.04, 0.5
    ends = [np.hypot(reach + side * length / 2, radius) for side in (1, -1)]
    on_axis = (ends[0] - ends[1]) * np.hypot(length / 2, radius) / (length / 2)
    half_turn = np.pi * 500 / (GAMMA if GAMMA > 0 else -GAMMA) / on_axis
    near = abs(x + 100e-6) < 16e-6
    left, right = crossings(x[near], passed[near], 0.5)
    assert abs((right - left) / half_turn - 1) < 0.03
    assert file["entry/field_check/spin"][()] < 1e-6


@pytest.mark.experiment("frisch-segre-quadrupole")
def test_a_bare_spin_past_a_quadrupole_leaves_its_level_as_landau_and_zener_say(run):
    file = run("frisch-segre-quadrupole")
    gradient = file["entry/scan/zero_gradient_longitudinal"][:]
    followed = file["entry/screen_levels/levels"][:, 0]
    follows_not = np.exp(-np.pi * 2 * np.pi * 28.02495e9 * gradient * (105e-6) ** 2 / (2 * 800))
    # The slab ends where B_y/B_z is 0.012, so that a swing of sin(angle) root(P(1 - P)) at either end is left.
    assert np.abs(1 - followed - follows_not).max() < 0.012
    # dS/dt = gamma S x B in the same slab, by scipy's DOP853 to 1e-11
    expected = [0.05971536, 0.09885556, 0.14632567, 0.28058721, 0.50105504, 0.66837121, 0.81647111, 0.96755288]
    assert np.abs(followed - expected).max() < 2e-5
    assert file["entry/field_check/spin"][()] < 1e-6


@pytest.mark.experiment("adiabatic-flipper")
def test_an_adiabatic_flipper_leaves_what_its_closed_form_says(run):
    file = run("adiabatic-flipper")
    k = abs(GAMMA) * 65e-6 * 0.4 / file["entry/scan/source_speed_value"][:] / np.pi
    left = np.sin(np.pi / 2 * np.sqrt(1 + k**2)) ** 2 / (1 + k**2)
    levels = file["entry/screen_levels/levels"][:]
    assert np.abs(levels[:, 0] - left).max() < 2e-6
    assert np.abs(levels[:, 0] - np.sin(np.pi / 2 * np.sqrt(1 + (1.01 * k) ** 2)) ** 2 / (1 + (1.01 * k) ** 2)).max() > 1e-3


@pytest.mark.experiment("majorana-losses")
def test_spins_close_to_a_zero_of_the_field_are_lost_as_landau_and_zener_say(run):
    file = run("majorana-losses")
    gradient = file["entry/scan/reversal_gradient_longitudinal"][:][:, None]
    speed = 500 + 50 * np.linspace(-5, 5, 201)
    weight = np.exp(-(((speed - 500) / 50) ** 2) / 2)
    u = np.pi * abs(GAMMA) * gradient * (2e-3) ** 2 / (8 * speed)
    expected = ((1 - np.exp(-u)) / u) @ weight / weight.sum()
    lost, errors = file["entry/scan/detected"][:], file["entry/scan/detected_errors"][:]
    assert np.abs((lost - expected) / errors).max() < 4
    assert errors.max() < 0.01
    # All of them 1 mm beside the axis: one radius, and sharp enough for a hundredth of the gradient.
    thin = run("majorana-losses", "--no-scan", "--set", "source.opening.radius=1 nm", "--set", "reversal.offset.x=1 mm", "--set",
               "reversal.gradient.longitudinal=3 T/m")
    lost = thin["entry/scan/detected"][:].item()

    def beside(gradient):
        return np.exp(-np.pi * abs(GAMMA) * gradient * 1e-6 / (8 * speed)) @ weight / weight.sum()

    assert abs(lost - beside(3)) < 0.0015
    assert abs(lost - beside(3.03)) > 0.0015


@pytest.mark.experiment("neutron-ramsey-map")
def test_fringes_in_a_mapped_field_stand_at_its_mean_along_the_falling_path(run):
    falling = run("neutron-ramsey-map", "--particles", "100")
    x, here = falling["entry/scan/RF1_frequency"][:], falling["entry/screen_levels/levels"][:, 1]
    straight = run("neutron-ramsey-map", "--particles", "100", "--set", "gravity=0 m/s^2")["entry/screen_levels/levels"][:, 1]
    slope = np.gradient(straight, x)
    inner = slice(1, -1)
    shift = -np.sum(((here - straight) * slope)[inner]) / np.sum((slope**2)[inner])
    table = np.loadtxt(EXPERIMENTS.parent / "geometries" / "guide-field.csv", delimiter=",", skiprows=1)
    axis = table[table[:, 0] == 0]
    y, z = np.unique(axis[:, 1]), np.unique(axis[:, 2])
    size = 1e-6 * np.linalg.norm(axis[:, 3:], axis=1).reshape(len(y), len(z))
    steps = (y >= 150) & (y <= 1050)  # between the middles of the zones
    fall = 0.5 * 9.81 * (y * 1e-3 / 50) ** 2 * 1e3
    below = np.array([np.interp(-drop, z, row) for drop, row in zip(fall, size, strict=True)])
    expected = abs(GAMMA) / (2 * np.pi) * np.mean((below - size[:, z == 0][:, 0])[steps])
    assert abs(shift / expected - 1) < 0.1
    # One neutron on the axis through the coils themselves instead of their map, by scipy's DOP853: 0.253165 of it flips at 1290 Hz.
    one = run("neutron-ramsey-map", "--no-scan", "--set", "source.speed={kind: single, value: 50 m/s}", "--set", "source.opening.radius=1 nm",
              "--set", "RF1.frequency=1290 Hz", "--set", "RF1.phase=locked", "--particles", "8")
    assert np.abs(one["entry/screen_levels/levels"][:].reshape(-1)[1] - 0.253165) < 2e-5
    assert one["entry/field_check/spin"][()] < 1e-6


def distance_of_lines(file):
    profile = file["entry/screen_z"]
    counts, z = profile["counts"][:], profile["z"][:]
    up = z > 0
    assert abs(counts[up].sum() / counts.sum() - 0.5) < 0.01
    return np.average(z[up], weights=counts[up]) - np.average(z[~up], weights=counts[~up])


@pytest.mark.experiment("iron-magnet-map")
def test_a_magnet_by_finite_elements_deflects_as_the_integral_of_its_gradient_says(run):
    real = distance_of_lines(run("iron-magnet-map"))
    ideal = distance_of_lines(run("iron-magnet-map", "--set", "mapped.enabled=false", "--set", "ideal.enabled=true"))
    table = np.loadtxt(EXPERIMENTS.parent / "geometries" / "iron-magnet.csv", delimiter=",", skiprows=1)
    plane = table[table[:, 0] == 0]
    y, z = np.unique(plane[:, 1]), np.unique(plane[:, 2])
    size = np.linalg.norm(plane[:, 3:], axis=1).reshape(len(y), len(z))
    gradient = np.gradient(size, z, axis=1)[:, len(z) // 2]
    of_map = 2 * np.trapz(gradient, y)
    of_poles = -2 * 1.2 / (1 + 1.2**2) / 4 * 500 * 40  # G/B = -2 z/(a^2 + z^2) at z = 1.2 a, on their length
    assert abs(real / ideal / (of_map / of_poles) - 1) < 0.005
    assert abs(real / ideal - 1.0876) < 0.002
    assert abs(gradient[0] / size[0, len(z) // 2] / (-2 * 1.2 / (1 + 1.2**2) / 4) - 0.964) < 0.002


def test_check_tells_larmor_frequency_and_detuning_in_a_mapped_field():
    page = subprocess.run([RABILINE, "check", EXPERIMENTS / "neutron-ramsey-map.yaml"], capture_output=True, text=True, check=True)
    assert page.stderr == ""
    table = np.loadtxt(EXPERIMENTS.parent / "geometries" / "guide-field.csv", delimiter=",", skiprows=1)
    axis = table[(table[:, 0] == 0) & (table[:, 2] == 0)]
    y = np.linspace(100, 200, 101)
    size = np.interp(y, axis[:, 1], 1e-6 * np.linalg.norm(axis[:, 3:], axis=1)).mean()
    larmor = abs(GAMMA) / (2 * np.pi) * size
    told = re.search(r"0\.1000 to 0\.2000 m, 2 ms: Larmor ([\d.]+) kHz.*?off resonance by ([-+\d.]+) Hz", page.stdout, re.DOTALL)
    assert abs(1e3 * float(told[1]) - larmor) < 1
    assert abs(float(told[2]) - (1250 - larmor)) < 1


SWEPT = """rabiline: 1
species: H atom
law: quantum
source:
  speed: {kind: single, value: 1000 m/s}
  opening: {radius: 1 um}
  direction: parallel
  spin: {kind: levels, levels: [F=1 m=1]}
parts:
  - {name: B, kind: uniform_field, at: 0 m, length: 1 m, field: 100 uT}
  - {name: H0, kind: rotating_field, at: 0.2 m, length: 0.2 m, amplitude: 2 uT, frequency: 1.2 MHz, sense: positive, phase: random,
     sweep: {to: 1.6 MHz, begin: 0.2 ms, end: 0.4 ms}}
  - {name: screen, kind: detector, at: 1 m, width: 4 mm, height: 4 mm, bins: [1, 1]}
particles: 8
seed: 1
"""


def test_a_sweep_turns_hydrogen_round_as_its_whole_hamiltonian_does(tmp_path):
    (tmp_path / "swept.yaml").write_text(SWEPT)
    subprocess.run([RABILINE, "run", tmp_path / "swept.yaml", "-o", tmp_path / "swept.h5", "--progress", "none"], check=True, capture_output=True)
    with h5py.File(tmp_path / "swept.h5") as file:
        found = file["entry/screen_levels/levels"][:].reshape(-1)
    # A I.J + (g_J J + g_I I) mu_B B, in the frame that turns with the field, where it changes only by the sweep.
    sx, sy, sz = np.array([[0, 1], [1, 0]]) / 2, np.array([[0, -1j], [1j, 0]]) / 2, np.diag([0.5, -0.5])
    j, i = ([np.kron(s, np.eye(2)) for s in (sx, sy, sz)], [np.kron(np.eye(2), s) for s in (sx, sy, sz)])
    per_tesla = BOHR / PLANCK
    moment = [2.00228386 * a - 0.003042064412 * b for a, b in zip(j, i)]
    static = 1420405751.768 * sum(a @ b for a, b in zip(j, i)) + per_tesla * 100e-6 * moment[2]
    steps, duration = 20000, 0.2e-3
    frequency = 1.2e6 + 0.4e6 * (np.arange(steps) + 0.5) / steps
    energies, states = np.linalg.eigh(static + per_tesla * 2e-6 * moment[0] - frequency[:, None, None] * (j[2] + i[2]))
    levels = np.linalg.eigh(static)[1]
    state = levels[:, 3].astype(complex)
    for energy, basis in zip(energies, states):
        state = basis @ (np.exp(-2j * np.pi * energy * duration / steps) * (basis.conj().T @ state))
    expected = abs(levels.conj().T @ state)[::-1] ** 2
    assert 0.9 < expected[2] < 0.99
    assert np.abs(found - expected).max() < 2e-6


INSIDE = """rabiline: 1
species: neutron
law: quantum
source: {speed: {kind: single, value: 1000 m/s}, opening: {width: 0.2 mm, height: 1 mm}, direction: parallel, spin: {kind: polarised, axis: x, degree: 1}}
parts:
  - {name: B, %s}
  - {name: screen, kind: detector, at: 1 m, width: 0.2 m, height: 0.2 m, bins: [80, 80]}
particles: 20
seed: 1
"""


@pytest.mark.parametrize("field", ["kind: coil_pair, radius: 5 cm, at: 0.6 m, field: 1 mT",
                                   "kind: uniform_field, at: 0.5 m, length: 0.4 m, field: 1 mT, fringe: {kind: tanh, length: 2 cm}"])
def test_flights_are_checked_where_a_detector_stands_in_their_field(tmp_path, field):
    (tmp_path / "inside.yaml").write_text(INSIDE % field)
    subprocess.run([RABILINE, "run", tmp_path / "inside.yaml", "-o", tmp_path / "a.h5"], check=True, capture_output=True)
    with h5py.File(tmp_path / "a.h5") as file:
        check = file["entry/field_check"]
        assert check["particles"][()] == 16 and 0 < check["spin"][()] < 1e-6


def test_a_field_that_rises_along_the_beam_parts_no_paths(tmp_path):
    """The speed that it takes it gives back: a resonance in a field with fringes is flown as one without."""
    text = (EXPERIMENTS / "kusch-millman-rabi-potassium.yaml").read_text()
    (tmp_path / "fringe.yaml").write_text(text.replace("length: 0.20 m, field: 50 uT", "length: 0.20 m, field: 50 uT, fringe: {kind: tanh, length: 1 cm}"))
    told = subprocess.run([RABILINE, "check", tmp_path / "fringe.yaml"], capture_output=True, text=True)
    assert told.returncode == 0 and "levels stay coherent, and atoms fly straight here: their paths come apart by 0.2" in told.stdout, told.stdout


@pytest.mark.parametrize(("speed", "says"), [(8, "levels are sorted"), (80, "levels stay coherent")])
def test_levels_that_a_field_slows_by_a_hundredth_are_sorted(tmp_path, speed, says):
    """2 mu B/(m v^2) is 0.09 and 0.0009 in half a tesla."""
    text = (INSIDE % "kind: uniform_field, at: 0.4 m, length: 0.2 m, field: 0.5 T, fringe: {kind: tanh, length: 2 cm}").replace("1000 m/s", f"{speed} m/s")
    (tmp_path / "slow.yaml").write_text(text.replace("width: 0.2 mm, height: 1 mm", "width: 1 um, height: 1 um").replace("law:", "gravity: 0 m/s^2\nlaw:"))
    told = subprocess.run([RABILINE, "check", tmp_path / "slow.yaml"], capture_output=True, text=True)
    assert told.returncode == 0 and says in told.stdout, told.stdout

"""Shipped experiments with the levels of atoms in fields of any direction give what their headers promise."""

import re
import subprocess

import numpy as np
import pytest
from constants import BOHR, PLANCK
from experiments import RABILINE

CAESIUM, G_J, G_I = 9192631770, 2.00254032, -3.9885395e-4


@pytest.mark.experiment("clock-majorana")
def test_a_stray_field_mixes_all_levels_of_a_clock_as_an_integration_of_both_manifolds_does(run):
    levels = run("clock-majorana")["entry/states_levels/levels"][:].reshape(6, 16)
    # F=4 and F=3 by their own g factors and the quadratic shift in the frame of 9.19 GHz, B of both rings by Biot and Savart, Magnus' steps, 1e-8
    none = np.zeros(16)
    none[[4, 12]] = 0.50399478, 0.49600522
    at_7 = [0.00005181, 0.00256665, 0.03727178, 0.16004064, 0.13761409, 0.18334908, 0.03940477, 0.00254102, 0.00005182,
            0.00033587, 0.01496434, 0.1484494, 0.13502205, 0.12514209, 0.01283289, 0.0003617]
    at_9 = [0.12023666, 0.03194974, 0.04660364, 0.0399022, 0.03185709, 0.03314915, 0.04255565, 0.03041561, 0.12023347,
            0.14212377, 0.0241527, 0.0628699, 0.03246884, 0.06962311, 0.02819973, 0.14365874]
    assert np.abs(levels[0] - none).max() < 5e-6
    assert np.abs(levels[3] - at_7).max() < 2e-5
    assert np.abs(levels[4] - at_9).max() < 2e-5
    assert levels[1, [4, 12]].sum() > 0.999 and levels[4, [4, 12]].sum() < 0.1


def fringe(frequency, phase):
    """Two levels, two pulses of 50 us 2.5 ms apart from begin to begin, the second one ahead by a phase."""
    line = CAESIUM + ((G_J - G_I) * BOHR / PLANCK * 6e-6) ** 2 / (2 * CAESIUM)
    coupling = (G_J - G_I) * BOHR / PLANCK / 2 * 0.357e-6 / 2

    def pulse(ahead):
        h = np.array([[line - frequency, coupling * np.exp(-1j * ahead)], [coupling * np.exp(1j * ahead), 0]])
        energy, states = np.linalg.eigh(h)
        return states @ np.diag(np.exp(-2j * np.pi * energy * 50e-6)) @ states.conj().T

    free = np.diag([np.exp(-2j * np.pi * (line - frequency) * 2.45e-3), 1])
    return abs((pulse(phase) @ free @ pulse(0))[1, 0]) ** 2


@pytest.mark.experiment("clock-cavity-phase")
def test_the_phase_of_a_cavity_shifts_a_clock_by_where_atoms_cross_it(run):
    file = run("clock-cavity-phase")
    frequency, changed = file["entry/scan/first_frequency"][:], file["entry/states_levels/levels"][:].reshape(41, 16)[:, 12]
    over = [np.mean([fringe(f, 0.03 * x) for x in np.linspace(0, 2, 41)]) for f in frequency]
    assert np.abs(changed - over).max() < 3e-3
    slope = np.gradient([fringe(f, 0) for f in frequency], frequency)
    shift = -np.sum((changed - [fringe(f, 0) for f in frequency]) * slope) / np.sum(slope**2)
    assert abs(shift + 0.03 / (2 * np.pi * (2.45e-3 + 4 / np.pi * 50e-6))) < 0.3  # [Hz]
    # One of them, 1 mm beside the middle.
    thin = run("clock-cavity-phase", "--set", "source.opening={radius: 1 nm}", "--particles", "8")["entry/states_levels/levels"][:].reshape(41, 16)[:, 12]
    assert np.abs(thin - [fringe(f, 0.03) for f in frequency]).max() < 5e-6
    assert np.abs(thin - [fringe(f, 0.0303) for f in frequency]).max() > 1e-4


@pytest.mark.experiment("polarised-deuterium")
def test_three_units_exchange_the_levels_of_deuterium_that_they_are_for(run):
    states = run("polarised-deuterium")["entry/ioniser_states/counts"][:].reshape(2, 2, 2, 6, 6)
    # The program's order is F=3/2 m=3/2 ... -3/2, F=1/2 m=1/2, -1/2: 1, 2, 3, 4, 6, 5.
    states = states[..., [0, 1, 2, 3, 5, 4], :][..., [0, 1, 2, 3, 5, 4]]
    of = states / np.maximum(states.sum(-1, keepdims=True), 1e-300)
    weak, medium, strong = of[1, 0, 0], of[0, 1, 0], of[0, 0, 1]
    assert min(weak[0, 3], weak[1, 2], weak[2, 1]) > 0.99
    assert min(medium[0, 0], medium[1, 1], medium[2, 3]) > 0.99
    assert min(strong[0, 0], strong[1, 5], strong[2, 2]) > 0.99
    out = of[..., :3, :].mean(-2)  # of levels 1, 2, 3, as many of each
    n = [out @ (np.array([1, 0, -1, -1, 0, 1]) == m) for m in (1, 0, -1)]
    p_z, p_zz = n[0] - n[2], 1 - 3 * n[1]
    for units, vector, tensor in (((0, 0, 0), 0, 0), ((0, 0, 1), 1 / 3, 1), ((1, 0, 0), -2 / 3, 0), ((1, 0, 1), -1 / 3, 1), ((0, 1, 1), 1 / 3, 1)):
        assert abs(p_z[units] - vector) < 0.02 and abs(p_zz[units] - tensor) < 0.03, units


@pytest.mark.experiment("ortho-hydrogen-solenoid")
def test_ortho_hydrogen_through_a_solenoid_turns_as_an_integration_of_all_nine_levels_says(run):
    levels = run("ortho-hydrogen-solenoid")["entry/states_levels/levels"][:].reshape(11, 9)
    # Ramsey's Hamiltonian, the field of a sheet of current on its axis, Magnus' steps, 1e-10
    assert abs(levels[0, 0] - 1) < 1e-9
    assert np.abs(levels[2] - [0.00044048, 0.00895323, 0.07915304, 0.34470254, 0.5667507, 0, 0, 0, 0]).max() < 2e-6
    assert np.abs(levels[10] - [0.45791887, 0.0246294, 0.18162404, 0.23068109, 0.10512614, 0.00000918, 0.00000605, 0.00000522, 0]).max() < 2e-6


@pytest.mark.experiment("strip-line-cavity")
def test_a_strip_line_cavity_splits_the_line_of_hydrogen(run):
    for species in ("H atom", "antihydrogen"):
        file = run("strip-line-cavity", "--set", f"species={species}")
        x, flipped = file["entry/scan/cavity_frequency"][:] - 1420405751.768, file["entry/screen_levels/levels"][:, 1]
        peak, width = 0.64174 * 900 / 0.1055, x[1] - x[0]
        for side in (-1, 1):
            half = side * x > 0
            assert abs(x[half][np.argmax(flipped[half])] - side * peak) < width
            assert flipped[half].max() > 0.998
        assert flipped[abs(x) < width].max() < 2e-3
        assert abs(flipped - flipped[::-1]).max() < 5e-3


@pytest.mark.experiment("frisch-segre-potassium")
def test_potassium_past_a_wire_leaves_its_levels_as_an_independent_integration_says(run):
    file = run("frisch-segre-potassium")
    states = file["entry/screen_states/counts"][:]
    stays = states[4, 0, 0] / states[4, 0].sum()  # F=2 m=2 at 0.1 A
    assert abs(stays - 0.000197) < 5e-7  # spin F turned by steps of its own, with Breit and Rabi's energies between
    flipped = file["entry/screen_levels/levels"][:, 4]
    assert np.all(np.diff(flipped) > 0) and 0.24 < flipped[-1] < 0.28  # the measured points fall from 0.1 A on
    assert abs(states[:, :, 5:].sum()) < 1e-9 * states.sum()


@pytest.mark.experiment("sona-unit")
def test_metastable_hydrogen_leaves_a_zero_of_the_field_as_majorana_says(run):
    file = run("sona-unit")
    r, levels = file["entry/ioniser_levels/source_offset_x"][:], file["entry/ioniser_levels/levels"][:]
    assert levels[0, 1] + levels[0, 2] > 1 - 1e-6
    zero, one = levels[0, 1], levels[0, 2]  # the parts that began in m = 0 and m = 1

    def field(y):  # of a solenoid on its axis, from its middle
        ends = np.array([y + 0.2, y - 0.2])
        return 57.5e-3 * np.diff(-ends / np.hypot(ends, 0.06))[0] / (2 * 0.2 / np.hypot(0.2, 0.06))

    slope = abs(field(0.5005) - field(0.4995)) / 1e-3 * 2
    for k in (1, 2, 3):
        across, change = r[k] / 2 * slope, 310e3 * slope
        q = 1 - np.exp(-np.pi * 2 * np.pi * 14.0e9 * across**2 / (2 * change))
        expected = one * q**2 + zero * 2 * q * (1 - q)
        assert abs(levels[k, 0] / expected - 1) < 0.02


@pytest.mark.experiment("rf-transition-unit")
def test_a_weak_field_unit_turns_every_level_of_deuterium_round(run):
    states = run("rf-transition-unit")["entry/behind_states/counts"][:]
    for level in range(3):
        assert states[0, level, level] > 0.9999 * states[0, level].sum()
        assert states[1, level, 3 - level] > 0.99 * states[1, level].sum()


def test_molecules_in_a_weak_solenoid_leave_it_as_an_independent_integration_says(run):
    # Energies commute with one another: steps that only compare themselves with their halves miss their error.
    check = run("ortho-hydrogen-solenoid", "--no-scan", "--set", "solenoid.current=25 mA", "--particles", "40")["entry/field_check"]
    assert check["particles"][()] == 16 and check["levels"][()] < 1e-6


def told_of_steps(run, name, *arguments):
    """The line on steps of `rabiline summary`."""
    told = subprocess.run([RABILINE, "summary", run(name, *arguments).filename], capture_output=True, text=True, check=True)
    return next(line for line in told.stdout.splitlines() if line.startswith("  steps"))


def test_summary_tells_how_far_levels_are_from_an_integration_or_that_there_is_none(run):
    assert re.fullmatch(r"  steps +within [1-9.]+e-\d+ of an independent integration of one particle; 0.0001 asked for",
                        told_of_steps(run, "rf-transition-unit", "--particles", "20"))
    assert "not checked: where levels are driven in the rotating-wave approximation" in told_of_steps(run, "clock-majorana", "--particles", "20", "--no-scan")
    idle = [word for unit in ("weak", "medium", "strong") for word in ("--set", f"{unit}.amplitude=0 mT")]
    assert "not checked: an independent integration takes longer" in told_of_steps(
        run, "polarised-deuterium", "--particles", "20", "--no-scan", *idle)

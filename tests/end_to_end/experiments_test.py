"""Every shipped experiment gives the result that its header promises."""

import os
import pathlib
import subprocess

import h5py
import numpy as np
import pytest

RABILINE = os.environ["RABILINE_PROGRAM"]
EXPERIMENTS = pathlib.Path(__file__).resolve().parents[2] / "beamline"
LARMOR = 29.1646935e6 * 10e-3  # Hz, neutron in 10 mT


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("experiments")

    def run_experiment(name, *arguments):
        output = folder / f"{name}.h5"
        subprocess.run([RABILINE, "run", EXPERIMENTS / f"{name}.yaml", "-o", output, "--progress", "none", *arguments],
                       check=True, stdout=subprocess.DEVNULL)
        return h5py.File(output)

    return run_experiment


def crossings(x, y, level):
    """Where the curve passes the level, by straight lines between points."""
    s = np.sign(y - level)
    i = np.nonzero(s[:-1] * s[1:] < 0)[0]
    return x[i] + (level - y[i]) / (y[i + 1] - y[i]) * (x[i + 1] - x[i])


def test_every_shipped_experiment_is_tested_here():
    tested = {"suggested-experiment", "two-species", "rabi-flop", "ramsey"}
    assert {p.stem for p in EXPERIMENTS.glob("*.yaml")} == tested


def test_the_suggested_experiment_loses_the_beam_at_the_larmor_frequency(run):
    file = run("suggested-experiment")
    x, detected = file["entry/scan/H0_frequency"][:], file["entry/scan/detected"][:]
    assert detected[np.argmin(abs(x - LARMOR))] == 0
    left, right = crossings(x, detected, 0.5)
    assert abs((left + right) / 2 - LARMOR) < 150  # points stand 500 Hz apart
    assert abs(right - left - 7300) < 200
    assert detected[abs(x - LARMOR) > 8000].min() >= 0.99
    assert abs((left + right) / 2 - 1.01 * LARMOR) > 2000


def test_two_species_give_two_dips_each_at_its_own_larmor_frequency(run):
    file = run("two-species")
    x, detected = file["entry/scan/H0_frequency"][:], file["entry/scan/detected"][:]
    for centre, bottom in ((LARMOR, 0.6), (350e3, 0.4)):
        near = abs(x - centre) < 10e3
        assert detected[near].min() == bottom
        left, right = crossings(x[near], detected[near], (1 + bottom) / 2)
        assert abs((left + right) / 2 - centre) < 150
    assert detected[abs(x - 320e3) < 10e3].min() >= 0.99


def test_rabis_resonance_has_his_width_zero_and_sidelobe(run):
    file = run("rabi-flop")
    x, flipped = file["entry/scan/H0_frequency"][:] - LARMOR, file["entry/screen_levels/levels"][:, 0]
    assert abs(flipped.max() - 1) < 1e-6
    left, right = crossings(x, flipped, 0.5)
    assert abs(right - left - 0.79869 * 5000) < 10
    inner = abs(x) < 6000
    assert abs(abs(x[inner][np.argmin(flipped[inner])]) - 0.8660254 * 5000) <= 50 and flipped[inner].min() < 1e-3
    lobe = flipped[(x > 5000) & (x < 8500)].max()
    assert abs(lobe - 0.11644) < 1e-4
    assert np.ptp(file["entry/scan/detected"][:]) == 0


def test_ramseys_central_fringe_is_as_narrow_as_the_time_between_the_zones_allows(run):
    file = run("ramsey")
    x, flipped = file["entry/scan/first_frequency"][:] - LARMOR, file["entry/screen_levels/levels"][:, 0]
    central = abs(x) < 700
    left, right = crossings(x[central], flipped[central], 0.5)
    expected = 1 / (2 * (0.5e-3 + 4 / np.pi * 0.1e-3))
    assert abs(right - left - expected) < 0.01 * expected
    assert abs(left + right) < 5
    assert flipped.max() > 0.999


@pytest.mark.parametrize("name", ["suggested-experiment", "two-species"])
def test_standard_laws_see_a_flat_line_in_the_experiments_of_the_hypothesis(run, name):
    file = run(name, "--scan", "law=quantum,classical", "--particles", "500")
    assert np.ptp(file["entry/scan/detected"][:]) == 0
    counts = file["entry/screen/counts"][:]
    assert (counts == counts[:1, :1]).all()

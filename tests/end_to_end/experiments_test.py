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
    tested = {"suggested-experiment", "two-species", "rabi-flop", "ramsey", "ramsey-effusive", "polarised-neutrons",
              "alvarez-bloch", "broad-beam", "stern-gerlach", "rabi-licl"}
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


def test_an_effusive_beam_keeps_the_central_fringe_and_loses_those_aside(run):
    file = run("ramsey-effusive")
    centre = 32.436045e6 * 10e-3  # Hz, helion in 10 mT
    x, flipped = file["entry/scan/first_frequency"][:] - centre, file["entry/screen_levels/levels"][:, 1]
    alpha = np.sqrt(2 * 1.380649e-23 * 300 / (3.0160293 * 1.66053907e-27))
    top, foot = flipped.max(), flipped[abs(x) < 2500].min()
    assert abs(top - 0.766) < 0.01
    near = abs(x) < 1300
    left, right = crossings(x[near], flipped[near], top / 2)
    assert abs(right - left - 1456) < 20
    assert abs(right - left - 0.65 * alpha / (0.5 + 1.27 * 0.05)) < 40
    assert abs(left + right) < 20
    beyond = abs(x) > 2500
    assert np.ptp(flipped[beyond & (abs(x) < 4500)]) < 0.15 * (top - foot)


def test_the_flipper_of_the_neutron_line_turns_all_spins_at_the_larmor_frequency(run):
    file = run("polarised-neutrons", "--particles", "200000")
    x, detected = file["entry/scan/flipper_frequency"][:], file["entry/scan/detected"][:]
    errors = file["entry/scan/detected_errors"][:]
    up, down = 0.98, 0.02
    on = np.argmin(detected)
    assert abs(x[on] - 29.1646935e3) <= 126  # half the distance between points
    left_over = np.pi**2 / 4 * 0.01**2
    assert abs(detected[on] - (up * down + left_over * (up - down)**2 / 2)) < 4 * errors[on]
    assert abs(detected.max() - (up**2 + down**2) / 2) < 0.02
    assert abs(detected.max() / detected[on] - 24) < 2
    rate, background = file["entry/scan/count_rate"][:], file["entry/counter/background"][()]
    assert np.allclose(rate, 1e6 * detected + background) and background == 3


def test_alvarez_and_blochs_neutrons_show_their_moment(run):
    file = run("alvarez-bloch", "--particles", "200000", "--set", "scan.particles=shared")
    x, detected = file["entry/scan/H0_field"][:], file["entry/scan/detected"][:]
    dip = 1 - detected / detected.max()
    resonant = 1.843e6 / 29.1646935e6
    left, right = crossings(x, dip, dip.max() / 2)
    assert abs((left + right) / 2 - resonant) < 0.02e-3  # points stand 0.1 mT apart
    assert abs((left + right) / 2 - 1.01 * resonant) > 0.2e-3
    # Flips on resonance over the flux, w1 of half the amplitude.
    y = np.linspace(1e-3, 6, 20001)
    alpha = np.sqrt(2 * 1.380649e-23 * 300 / 1.67492750056e-27)
    gamma, w1, p2 = 1.83247e8, 1.83247e8 * 0.5e-3, ((0.33 - 0.27) / 0.60)**2

    def passed(field):  # by the second iron, over the flux, relative to an unpolarised beam
        rate = np.hypot(w1, gamma * (field - resonant))
        flip = (w1 / rate)**2 * np.sin(rate * 0.1 / (2 * alpha * y))**2
        return 1 + p2 * (1 - 2 * np.trapz(2 * y**3 * np.exp(-y**2) * flip, y))

    expected = 1 - np.array([passed(field) for field in x]) / max(passed(field) for field in x)
    assert np.abs(dip - expected).max() < 0.01 * dip.max()


def test_a_broad_beam_dips_under_the_hypothesis_and_not_under_standard_laws(run):
    file = run("broad-beam")
    x, detected = file["entry/scan/H0_frequency"][:], file["entry/scan/detected"][:]
    quantum, classical, dorado = detected
    assert np.ptp(quantum) == 0 and (quantum == classical).all() and quantum[0] > 0.95
    middle = (dorado.max() + dorado.min()) / 2
    left, right = crossings(x, dorado, middle)
    assert abs((left + right) / 2 - LARMOR) < 500
    assert 7300 < right - left < 10000  # wider than for one speed
    assert dorado.min() < 0.2 and dorado[0] > 0.95


def test_silver_draws_two_lines_and_a_classical_moment_one_smear(run):
    file = run("stern-gerlach")
    z, counts = file["entry/plate_z/z"][:], file["entry/plate_z/counts"][:]
    quantum, classical = counts
    up, down = z[z > 0][np.argmax(quantum[z > 0])], z[z < 0][np.argmax(quantum[z < 0])]
    assert 0.16e-3 < up - down < 0.22e-3
    middle = abs(z) < 10e-6
    assert quantum[middle].mean() < 0.3 * quantum.max()
    assert abs(z[np.argmax(classical)]) < 40e-6 and classical[middle].mean() > 0.9 * classical.max()


def test_the_moment_of_lithium_7_is_where_rabis_dip_is(run):
    file = run("rabi-licl")
    x, detected = file["entry/scan/C_field"][:], file["entry/scan/detected"][:]
    resonant = 3.518 / 16.54828
    assert detected[abs(x - resonant) > 2e-3].min() > 0.8 and detected.min() < 0.4
    left, right = crossings(x, detected, (detected.max() + detected.min()) / 2)[[0, -1]]
    assert abs((left + right) / 2 - resonant) < 0.05e-3
    assert abs((left + right) / 2 - 1.01 * resonant) > 1e-3


@pytest.mark.parametrize("name", ["suggested-experiment", "two-species"])
def test_standard_laws_see_a_flat_line_in_the_experiments_of_the_hypothesis(run, name):
    file = run(name, "--scan", "law=quantum,classical", "--particles", "500")
    assert np.ptp(file["entry/scan/detected"][:]) == 0
    counts = file["entry/screen/counts"][:]
    assert (counts == counts[:1, :1]).all()

"""Every shipped experiment gives the result that its header promises."""

import re
import subprocess

import atom_experiments_test
import electric_test
import field_experiments_test
import level_experiments_test
import numpy as np
import paper_test
import pytest
from constants import BOLTZMANN, DALTON, GAMMA, NEUTRON, PLANCK
from experiments import EXPERIMENTS, RABILINE, crossings, dip_centre

LARMOR = -GAMMA / (2 * np.pi) * 10e-3  # Hz, neutron in 10 mT


def test_every_shipped_experiment_has_a_test_of_what_its_header_promises():
    tests = [test for module in (paper_test, atom_experiments_test, electric_test, field_experiments_test, level_experiments_test) for test in vars(module).values()] + [*globals().values()]
    marks = [mark for test in tests for mark in getattr(test, "pytestmark", []) if mark.name == "experiment"]
    assert {path.stem for path in EXPERIMENTS.glob("*.yaml")} == {name for mark in marks for name in mark.args}


def test_check_warns_of_no_shipped_experiment():
    for path in EXPERIMENTS.glob("*.yaml"):
        told = subprocess.run([RABILINE, "check", path], text=True, capture_output=True, check=True)
        assert "warning" not in told.stderr, told.stderr


@pytest.mark.experiment("suggested-experiment")
def test_the_suggested_experiment_loses_the_beam_at_the_larmor_frequency(run):
    file = run("suggested-experiment")
    x, detected = file["entry/scan/H0_frequency"][:], file["entry/scan/detected"][:]
    assert detected[np.argmin(abs(x - LARMOR))] == 0
    left, right = crossings(x, detected, 0.5)
    assert abs((left + right) / 2 - LARMOR) < 150  # points stand 500 Hz apart
    assert abs(right - left - 7300) < 200
    assert detected[abs(x - LARMOR) > 8000].min() >= 0.99
    assert abs((left + right) / 2 - 1.01 * LARMOR) > 2000


@pytest.mark.experiment("two-species")
def test_two_species_give_two_dips_each_at_its_own_larmor_frequency(run):
    file = run("two-species")
    x, detected = file["entry/scan/H0_frequency"][:], file["entry/scan/detected"][:]
    for centre, bottom in ((LARMOR, 0.6), (350e3, 0.4)):
        near = abs(x - centre) < 10e3
        assert detected[near].min() == bottom
        left, right = crossings(x[near], detected[near], (1 + bottom) / 2)
        assert abs((left + right) / 2 - centre) < 150
    assert detected[abs(x - 320e3) < 10e3].min() >= 0.99


@pytest.mark.experiment("rabi-flop")
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


@pytest.mark.experiment("ramsey")
def test_ramseys_central_fringe_is_as_narrow_as_the_time_between_the_zones_allows(run):
    file = run("ramsey")
    x, flipped = file["entry/scan/first_frequency"][:] - LARMOR, file["entry/screen_levels/levels"][:, 0]
    central = abs(x) < 700
    left, right = crossings(x[central], flipped[central], 0.5)
    expected = 1 / (2 * (0.5e-3 + 4 / np.pi * 0.1e-3))
    assert abs(right - left - expected) < 0.01 * expected
    assert abs(left + right) < 5
    assert flipped.max() > 0.999


@pytest.mark.experiment("ramsey-effusive")
def test_an_effusive_beam_keeps_the_central_fringe_and_loses_those_aside(run):
    file = run("ramsey-effusive")
    centre = 32.436045e6 * 10e-3  # Hz, helion in 10 mT
    x, flipped = file["entry/scan/first_frequency"][:] - centre, file["entry/screen_levels/levels"][:, 1]
    alpha = np.sqrt(2 * BOLTZMANN * 300 / (3.0160293 * DALTON))
    top, foot = flipped.max(), flipped[abs(x) < 2500].min()
    assert abs(top - 0.766) < 0.01
    near = abs(x) < 1300
    left, right = crossings(x[near], flipped[near], top / 2)
    assert abs(right - left - 1456) < 20
    assert abs(right - left - 0.65 * alpha / (0.5 + 1.27 * 0.05)) < 40
    assert abs(left + right) < 20
    beyond = abs(x) > 2500
    assert np.ptp(flipped[beyond & (abs(x) < 4500)]) < 0.15 * (top - foot)


@pytest.mark.experiment("polarised-neutrons")
def test_the_flipper_of_the_neutron_line_turns_all_spins_at_the_larmor_frequency(run):
    file = run("polarised-neutrons", "--particles", "200000")
    x, detected = file["entry/scan/flipper_frequency"][:], file["entry/scan/detected"][:]
    errors = file["entry/scan/detected_errors"][:]
    up, down = 0.98, 0.02
    on = np.argmin(detected)
    assert abs(x[on] - 58.329387e3) <= 126  # half the distance between points
    left_over = np.pi**2 / 4 * 0.01**2
    assert abs(detected[on] - (up * down + left_over * (up - down)**2 / 2)) < 4 * errors[on]
    assert abs(detected.max() - (up**2 + down**2) / 2) < 0.02
    assert abs(detected.max() / detected[on] - 24) < 2
    rate, background = file["entry/scan/count_rate"][:], file["entry/counter/background"][()]
    assert np.allclose(rate, 1e6 * detected + background) and background == 3


@pytest.mark.experiment("alvarez-bloch")
def test_alvarez_and_blochs_neutrons_show_their_moment(run):
    file = run("alvarez-bloch", "--particles", "2000000", "--set", "scan.particles=shared")
    x, detected = file["entry/scan/H0_field"][:], file["entry/scan/detected"][:]
    dip = 1 - detected / detected.max()
    resonant = 1.843e6 / 29.1646935e6
    left, right = crossings(x, dip, dip.max() / 2)
    assert abs((left + right) / 2 - resonant) < 0.02e-3  # points stand 0.1 mT apart
    assert abs((left + right) / 2 - 1.01 * resonant) > 0.2e-3
    # Flips on resonance over the flux, w1 of half the amplitude.
    y = np.linspace(1e-3, 6, 20001)
    alpha = np.sqrt(2 * BOLTZMANN * 300 / NEUTRON)
    gamma, w1, p2 = -GAMMA, -GAMMA * 0.5e-3, ((0.33 - 0.27) / 0.60)**2

    def passed(field):  # by the second iron, over the flux, relative to an unpolarised beam
        rate = np.hypot(w1, gamma * (field - resonant))
        flip = (w1 / rate)**2 * np.sin(rate * 0.1 / (2 * alpha * y))**2
        return 1 + p2 * (1 - 2 * np.trapz(2 * y**3 * np.exp(-y**2) * flip, y))

    expected = 1 - np.array([passed(field) for field in x]) / max(passed(field) for field in x)
    # What starts up and down is even to 1/sqrt(N), and passes unlike: 10/sqrt(N) of the dip.
    assert np.abs(dip - expected).max() < 3.5 * 10 / np.sqrt(2000000) * dip.max()


@pytest.mark.experiment("broad-beam")
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


@pytest.mark.experiment("stern-gerlach")
def test_silver_draws_two_lines_and_a_classical_moment_one_smear(run):
    file = run("stern-gerlach")
    z, counts = file["entry/plate_z/z"][:], file["entry/plate_z/counts"][:]
    quantum, classical = counts
    up, down = (np.average(z[line], weights=quantum[line]) for line in ((z > 0) & (quantum > 0.8 * quantum.max()), (z < 0) & (quantum > 0.8 * quantum.max())))
    assert 0.16e-3 < up - down < 0.22e-3
    middle = abs(z) < 10e-6
    assert quantum[middle].mean() < 0.3 * quantum.max()
    assert abs(z[np.argmax(classical)]) < 40e-6 and classical[middle].mean() > 0.9 * classical.max()


@pytest.mark.experiment("rabi-licl")
def test_the_moment_of_lithium_7_is_where_rabis_dip_is(run):
    file = run("rabi-licl")
    x, detected = file["entry/scan/C_field"][:], file["entry/scan/detected"][:]
    resonant = 3.518 / 16.54828
    assert detected[abs(x - resonant) > 2e-3].min() > 0.8 and detected.min() < 0.4
    left, right = crossings(x, detected, (detected.max() + detected.min()) / 2)[[0, -1]]
    assert abs((left + right) / 2 - resonant) < 0.05e-3
    assert abs((left + right) / 2 - 1.01 * resonant) > 1e-3


# Hamiltonians of two spins, written and solved here once more.


@pytest.mark.experiment("refocusing")
@pytest.mark.slow
def test_rabis_magnets_bring_every_speed_back_to_the_image_of_the_slits(run):
    file = run("refocusing", "--particles", "200000000")
    counts, errors = file["entry/detector_z/counts"][:], file["entry/detector_z/counts_errors"][:]
    z = file["entry/detector_z/z"][:]
    # Sum of two uniform ones, 20 and 40 um wide.
    near = np.linspace(-100e-6, 100e-6, 20001)
    trapezoid = np.clip((30e-6 - abs(near)) / 20e-6, 0, 1)
    trapezoid /= trapezoid.sum()
    own = np.histogram(near, bins=100, range=(-100e-6, 100e-6), weights=trapezoid)[0]
    exact, n = counts[0], counts[0].sum()
    assert (exact[abs(z) > 30e-6] == 0).all()
    width = np.sqrt((exact * z**2).sum() / n - (2e-6)**2 / 12)
    expected = np.hypot(20e-6, 40e-6) / np.sqrt(12)
    assert abs(width / expected - 1) < 0.005  # 4 standard errors
    hit = own * n > 50
    chi2 = (((exact - own * n) / np.maximum(errors[0], 1))[hit]**2).sum()
    assert 0.4 < chi2 / hit.sum() < 1.8, chi2
    # The oven's speeds, above those that would need to start steeper than 12 mrad.
    alpha = np.sqrt(2 * BOLTZMANN * 500 / (38.9637 * DALTON))
    speeds, speed_errors = file["entry/detector_speeds/counts"][0], file["entry/detector_speeds/counts_errors"][0]
    y2 = (np.arange(33) * 50 / alpha)**2
    share = -np.diff((1 + y2) * np.exp(-y2))[5:]
    there, there_errors = speeds[5:], speed_errors[5:]
    total = there.sum() / share.sum()
    enough = share * total > 50
    assert 0.3 < ((there - share * total)[enough]**2 / there_errors[enough]**2).sum() / enough.sum() < 2
    speed = (np.arange(32) + 0.5)[5:] * 50
    expected_mean = (share * speed).sum() / share.sum()
    assert abs((there * speed).sum() / there.sum() / expected_mean - 1) < 0.004  # 0.7 m/s, by 180 m/s and the root of 2e5
    # 5 % off: a speed's shift is 5 % of what B does to it.
    v = np.linspace(1, 3000, 30000)
    per_tesla = 27.9925e9 * PLANCK / 2 / (38.9637 * DALTON * v**2)
    slope = 8 * per_tesla * 0.20 / 0.80
    flux = v**3 * np.exp(-(v / alpha)**2) * (slope < 12e-3)
    shift = 0.05 * 6 * per_tesla * 0.16
    inside = np.concatenate([[0], np.cumsum(trapezoid)])
    edges = np.append(near - 5e-9, near[-1] + 5e-9)
    stays = np.interp(30e-6 - shift, edges, inside) - np.interp(-30e-6 - shift, edges, inside)
    expected = (flux * stays).sum() / flux.sum()
    smeared = counts[1][abs(z) < 30e-6].sum() / n
    assert expected < 0.8 and abs(smeared - expected) < 0.004


@pytest.mark.experiment("rabi-1938-nuclei")
def test_three_nuclei_come_into_resonance_one_after_the_other(run):
    file = run("rabi-1938-nuclei")
    x, detected = file["entry/scan/C_field"][:], file["entry/scan/detected"][:]
    for gamma, depth in ((40.07758, 0.1), (16.54828, 0.15), (6.26613, 0.1)):
        resonant = 3.518 / gamma
        near = abs(x / resonant - 1) < 0.03
        y = detected[near]
        assert near.sum() == 21 and y.max() - y.min() > depth
        assert abs(dip_centre(x[near], y) / resonant - 1) < 2e-4


def experiments_with_magnets():
    has_magnet = lambda path: "_magnet" in path.read_text() or "weak-deflection" in path.read_text()
    return sorted(path.stem for path in EXPERIMENTS.glob("*.yaml") if has_magnet(path))


@pytest.mark.parametrize("name", experiments_with_magnets())
@pytest.mark.slow
def test_shared_out_weights_and_drawn_levels_agree(run, name, tmp_path):
    # Behind a tally levels are drawn anyway.
    text = re.sub(r", tallies: \[.*\]}", "}", (EXPERIMENTS / f"{name}.yaml").read_text())
    (tmp_path / f"{name}.yaml").write_text(text.replace("../geometries", str(EXPERIMENTS.parent / "geometries")))
    particles = {"refocusing": 20000000, "hydrogen-source": 200000, "ortho-hydrogen": 2000}.get(name, 5000)
    file = run(tmp_path / name, "--particles", str(particles), "--set", "seed=11", "--set", "scan.particles=independent",
               "--scan", "law=quantum,{name: quantum, outcomes: sample}")
    split, sample = file["entry/scan/detected"][:].reshape(2, -1)
    errors = np.hypot(*file["entry/scan/detected_errors"][:].reshape(2, -1))
    z = (split - sample) / errors
    n = z.size
    assert np.abs(z).max() < 4.5
    # Wilson's errors are too large where all particles arrive; else chi^2 is n +- sqrt(2n).
    assert (z**2).sum() < n + 4.5 * np.sqrt(2 * n) + 8
    # And where they arrive.
    detector = next(group[:-2] for group in file["entry"] if group.endswith("_z"))
    counts = file[f"entry/{detector}_z/counts"][:].reshape(2, n, -1)
    bars = np.hypot(*file[f"entry/{detector}_z/counts_errors"][:].reshape(2, n, -1))
    enough = counts.min(axis=0) > 25
    deviations = ((counts[0] - counts[1]) / np.where(enough, bars, 1))[enough]
    assert np.abs(deviations).max() < 5.2  # of up to 1e5 bins
    assert (deviations**2).mean() < 1 + max(0.3, 4.5 * np.sqrt(2 / deviations.size))


def test_errors_of_shared_out_weights_are_how_results_scatter(run):
    results = [run("rabi-licl", "--particles", "2000", "--set", f"seed={seed}", "--set", "scan.particles=independent")
               for seed in range(1, 31)]
    detected, errors = (np.array([file[f"entry/scan/{name}"][:] for file in results])
                        for name in ("detected", "detected_errors"))
    ratio = (errors**2).mean(axis=0) / detected.var(axis=0, ddof=1)  # of each, 1 within 26 %
    assert abs(ratio.mean() - 29 / 27) < 0.15
    assert ratio.min() > 0.4 and ratio.max() < 3


@pytest.mark.parametrize("name", ["suggested-experiment", "two-species"])
def test_standard_laws_see_a_flat_line_in_the_experiments_of_the_hypothesis(run, name):
    file = run(name, "--scan", "law=quantum,classical", "--particles", "500")
    assert np.ptp(file["entry/scan/detected"][:]) == 0
    counts = file["entry/screen/counts"][:]
    assert (counts == counts[:1, :1]).all()


@pytest.mark.experiment("bloch-siegert")
def test_the_whole_field_shifts_the_resonance_as_bloch_and_siegert_say(run):
    def centre(*arguments):
        file = run("bloch-siegert", *arguments)
        x, flipped = file["entry/scan/RF_frequency"][:] - 10e3, file["entry/screen_levels/levels"][:, 1]
        assert abs(flipped.max() - 0.5) < 0.01
        # averaged over time 1/P = 2 (1 + (detuning/w1)^2)
        curve, slope, _ = np.polyfit(x, 1 / flipped, 2)
        assert abs(np.sqrt(2 / curve) / 1002.5 - 1) < 0.01
        return -slope / (2 * curve)

    assert abs(centre() - 25.14) < 1.5
    assert abs(centre("--set", "RF.approximation=rotating_wave")) < 1.5


@pytest.mark.experiment("millman")
def test_a_field_that_turns_along_the_beam_tells_the_sign_of_the_moment(run):
    def shifts(*arguments, middle=LARMOR):
        file = run("millman", *arguments)
        x, flipped = file["entry/scan/H0_frequency"][:], file["entry/screen_levels/levels"][..., 0]
        assert flipped.max(axis=1).min() > 0.99
        return [sum(crossings(x, curve, 0.5)) / 2 - middle for curve in flipped]

    for found, expected in zip(shifts(), (1250, 0, -1250)):
        assert abs(found - expected) < 8
    helium = 32.43604e6 * 10e-3
    changes = ("--set", "species=He-3", "--set", f"H0.amplitude={85.719 * LARMOR / helium} uT", "--no-scan", "--scan", "H0.twist=-90 deg,0 deg,90 deg",
               "--scan", f"H0.frequency={helium - 5e3} Hz:{helium + 5e3} Hz:101")
    for found, expected in zip(shifts(*changes, middle=helium), (1250, 0, -1250)):
        assert abs(found - expected) < 10


@pytest.mark.experiment("dressed-spin")
def test_dressed_spins_precess_by_the_bessel_function_of_the_field(run):
    file = run("dressed-spin")
    x = -GAMMA * file["entry/scan/dressing_amplitude"][:] / (2 * np.pi * 50e3)
    outcomes = file["entry/screen_along_x/counts"][:]
    along = (outcomes[:, 1] - outcomes[:, 0]) / outcomes.sum(axis=1)
    angles = np.linspace(0, np.pi, 2001)
    bessel = np.cos(np.outer(x, np.sin(angles)))[:, 1::2].mean(axis=1)  # J0(x) = <cos(x sin(angle))>
    assert abs(along - np.cos(4 * np.pi * bessel)).max() < 0.01
    assert abs(along - np.cos(4 * np.pi * 1.01 * bessel)).max() > 0.05
    # H = w0/2 sigma_z + x w/2 cos(wt) sigma_x turns at .674523 w0 for x = 1.189007 and w0 = w/10, by scipy
    amplitude = 1.189007 * 50e3 / 29.1646935e6
    file = run("dressed-spin", "--no-scan", "--set", f"dressing.amplitude={amplitude} T", "--set", "B.field=171.44017 uT",
               "--scan", "B.length,dressing.length=0.4 m:2.4 m:251")
    time, outcomes = file["entry/scan/B_length"][:] / 1000, file["entry/screen_along_x/counts"][:]
    along = (outcomes[:, 1] - outcomes[:, 0]) / outcomes.sum(axis=1)

    def misfit(rate):
        waves = np.stack([np.cos(2 * np.pi * rate * time), np.sin(2 * np.pi * rate * time)]).T
        return np.linalg.lstsq(waves, along, rcond=None)[1][0]

    rates = 2.4e3 + np.arange(0, 2e3, 0.5)
    assert abs(rates[np.argmin([misfit(rate) for rate in rates])] - 3372.6) < 3  # J0 alone: 3383

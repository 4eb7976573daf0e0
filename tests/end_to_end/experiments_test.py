"""Every shipped experiment gives the result that its header promises."""

import re

import electric_test
import field_experiments_test
import level_experiments_test
import numpy as np
import paper_test
import pytest
from constants import BOHR, BOLTZMANN, DALTON, GAMMA, NEUTRON, PLANCK
from experiments import EXPERIMENTS, crossings

LARMOR = -GAMMA / (2 * np.pi) * 10e-3  # Hz, neutron in 10 mT


def test_every_shipped_experiment_has_a_test_of_what_its_header_promises():
    tests = [test for module in (paper_test, electric_test, field_experiments_test, level_experiments_test) for test in vars(module).values()] + [*globals().values()]
    marks = [mark for test in tests for mark in getattr(test, "pytestmark", []) if mark.name == "experiment"]
    assert {path.stem for path in EXPERIMENTS.glob("*.yaml")} == {name for mark in marks for name in mark.args}


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
    assert abs(x[on] - 29.1646935e3) <= 126  # half the distance between points
    left_over = np.pi**2 / 4 * 0.01**2
    assert abs(detected[on] - (up * down + left_over * (up - down)**2 / 2)) < 4 * errors[on]
    assert abs(detected.max() - (up**2 + down**2) / 2) < 0.02
    assert abs(detected.max() / detected[on] - 24) < 2
    rate, background = file["entry/scan/count_rate"][:], file["entry/counter/background"][()]
    assert np.allclose(rate, 1e6 * detected + background) and background == 3


@pytest.mark.experiment("alvarez-bloch")
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
    alpha = np.sqrt(2 * BOLTZMANN * 300 / NEUTRON)
    gamma, w1, p2 = -GAMMA, -GAMMA * 0.5e-3, ((0.33 - 0.27) / 0.60)**2

    def passed(field):  # by the second iron, over the flux, relative to an unpolarised beam
        rate = np.hypot(w1, gamma * (field - resonant))
        flip = (w1 / rate)**2 * np.sin(rate * 0.1 / (2 * alpha * y))**2
        return 1 + p2 * (1 - 2 * np.trapz(2 * y**3 * np.exp(-y**2) * flip, y))

    expected = 1 - np.array([passed(field) for field in x]) / max(passed(field) for field in x)
    assert np.abs(dip - expected).max() < 0.01 * dip.max()


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
    up, down = z[z > 0][np.argmax(quantum[z > 0])], z[z < 0][np.argmax(quantum[z < 0])]
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


def spin_matrices(j):
    """J_z and J_x, m from the top down."""
    m = np.arange(j, -j - 1, -1)
    up = np.diag(np.sqrt(j * (j + 1) - m[1:] * (m[1:] + 1)), 1)
    return np.diag(m), (up + up.T) / 2, up


def hamiltonian(i, j, a, g_j, g_i, field, d=0):
    """H/h = a I.J + (mu_B/h) B (g_J J_z + g_I I_z) + d [3 (I.J)^2 + (3/2) I.J - I(I+1) J(J+1)], in hertz; J is outside."""
    (iz, ix, iu), (jz, jx, ju) = spin_matrices(i), spin_matrices(j)
    product = np.kron(jz, iz) + (np.kron(ju, iu.T) + np.kron(ju.T, iu)) / 2
    one_i, one_j = np.eye(len(iz)), np.eye(len(jz))
    h = a * product + BOHR / PLANCK * field * (g_j * np.kron(jz, one_i) + g_i * np.kron(one_j, iz))
    return h + d * (3 * product @ product + 1.5 * product - i * (i + 1) * j * (j + 1) * np.eye(len(h)))


def by_m(i, j, *constants):
    """Of each m_F: its states' numbers in the product basis, energies upwards, and vectors."""
    h = hamiltonian(i, j, *constants)
    m = np.add.outer(np.arange(j, -j - 1, -1), np.arange(i, -i - 1, -1)).ravel()
    return {k: (np.nonzero(m == k)[0], *np.linalg.eigh(h[np.ix_(m == k, m == k)])) for k in np.unique(m)}


def dip_centre(x, y, baseline=None):
    """Halfway between where a dip passes half of its depth."""
    level = (y.min() + (y.max() if baseline is None else baseline)) / 2
    found = crossings(x, y, level)
    return (found[0] + found[-1]) / 2


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


LITHIUM = (3 / 2, 1 / 2, 803.504087e6 / 2, 2.0023010, -1.1822130e-3)
POTASSIUM = (3 / 2, 1 / 2, 461.719720e6 / 2, 2.00229421, -1.4193489e-4)


def lines_of_1940(constants, field):
    """Between F = 2 and F = 1 with m changing by one: where they are and how strong for a weak field, by the Zeeman shift
    in units of mu_B B/2h."""
    levels, lines = by_m(*constants, field), {}
    turn = np.kron(spin_matrices(1 / 2)[1], np.eye(4))
    for upper in (2, 1, 0, -1, -2):
        for lower in (upper - 1, upper + 1):
            if abs(lower) <= 1:
                (above, energies, states), (below, energies_below, states_below) = levels[upper], levels[lower]
                element = states[:, -1] @ turn[np.ix_(above, below)] @ states_below[:, 0]
                lines.setdefault(upper + lower, []).append((energies[-1] - energies_below[0], element**2))
    return lines


def hz(value):
    return f"{value:.3f} Hz"


@pytest.mark.experiment("kusch-millman-rabi-lithium", "kusch-millman-rabi-potassium")
@pytest.mark.parametrize("name, constants, seen", [("kusch-millman-rabi-lithium", LITHIUM, (-1, 1, 3)),
                                                   ("kusch-millman-rabi-potassium", POTASSIUM, (-3, -1, 1, 3))])
@pytest.mark.slow
def test_hyperfine_lines_of_atoms_are_those_of_the_hamiltonian(run, name, constants, seen):
    lines = lines_of_1940(constants, 50e-6)
    assert {k: len(v) for k, v in lines.items()} == {3: 1, 1: 2, -1: 2, -3: 1}
    file = run(name)
    x, detected = file["entry/scan/RF_frequency"][:], file["entry/scan/detected"][:]
    for shift, found in lines.items():
        line = np.average([f for f, _ in found], weights=[w for _, w in found])
        near = abs(x - line) < 50e3
        depth = detected.max() - detected[near].min()
        assert depth > 0.07 if shift in seen else depth < 0.01
        if shift not in seen:
            continue
        # Off centre, with a weak field: others shift and widen it less.
        middle = line + 1500
        fine = run(name, "--particles", "4000", "--set", "RF.amplitude=0.8 uT", "--scan",
                   f"RF.frequency={hz(middle - 30e3)}:{hz(middle + 30e3)}:61")
        centre = dip_centre(fine["entry/scan/RF_frequency"][:], fine["entry/scan/detected"][:])
        assert abs(centre - line) < 60, (shift, centre - line)


def quadratic_shift(field):
    """Of the caesium line between the levels m = 0, by Breit and Rabi's formula."""
    x = (2.00254032 + 0.00039885395) * BOHR / PLANCK * field / 9192631770
    return 9192631770 * (np.sqrt(1 + x**2) - 1)


def clock(run, *arguments, particles=5000):
    file = run("caesium-clock", "--particles", str(particles), *arguments)
    return file["entry/scan/first_frequency"][:], file["entry/scan/detected"][:]


def peak_centre(x, y):
    """Of the central one: halfway between where it passes half its height, by cubics through four points."""
    top, level = np.argmax(y), (y.max() + y.min()) / 2
    signs = np.sign(y - level)
    sides = np.nonzero(signs[:-1] * signs[1:] < 0)[0]

    def place(i):
        near = slice(i - 1, i + 3)
        return x[i] + np.polynomial.Polynomial.fit(y[near] - level, x[near] - x[i], 3)(0)

    return (place(sides[sides < top].max()) + place(sides[sides >= top].min())) / 2


@pytest.mark.experiment("caesium-clock")
@pytest.mark.slow
def test_the_caesium_clock_shows_the_second_and_its_quadratic_shift(run):
    assert abs(quadratic_shift(6e-6) - 427.45 * 0.06**2) < 1e-3
    # All levels: those with other m add 1 % of ripples. The two with m = 0 alone: 1 % of the shift is 0.015 and 1.5 Hz.
    selected = ("--set", "source.spin={kind: levels, levels: [F=4 m=0, F=3 m=0]}")
    for field, tolerance, particles, *more in ((6, 0.01, 5000, *selected), (60, 0.01, 5000, *selected), (6, 0.2, 20000)):
        line = 9192631770 + quadratic_shift(field * 1e-6)
        x, y = clock(run, "--set", f"C.field={field} uT", "--scan",
                     f"first.frequency={hz(line - 97)}:{hz(line + 103)}:41", *more, particles=particles)
        assert abs(peak_centre(x, y) - line) < tolerance, peak_centre(x, y) - line
    # Width: half a period of the fringes of the speeds that arrive.
    left, right = crossings(x, y, (y.max() + y.min()) / 2)
    speeds = run("caesium-clock", "--particles", "5000")["entry/behind_speeds/counts"][50]
    speed = (speeds * (np.arange(80) + 0.5) * 10).sum() / speeds.sum()
    assert abs((right - left) / (speed / 2) - 1) < 0.15


def test_the_phase_of_the_second_zone_moves_the_clocks_fringe(run):
    line = 9192631770 + quadratic_shift(6e-6)
    scan = f"first.frequency={hz(line - 150)}:{hz(line + 150)}:31"
    curves = {}
    for phase in (0, 90, 180, -90):
        x, curves[phase] = clock(run, "--set", f"second.phase={phase} deg", "--scan", scan)
    contrast = np.ptp(curves[0])
    assert np.abs(curves[90] - curves[-90][::-1]).max() < 0.01 * contrast
    assert np.abs(curves[0] + curves[180] - curves[90] - curves[-90]).max() < 0.01 * contrast
    near = abs(x - line) < 30
    assert abs(x[np.argmin(np.where(near, curves[180], 1))] - line) < 1
    # It is seen at 2 pi (f - f0) T + phase = 0, T the period's inverse.
    period = 2 * abs(x[np.argmin(curves[0])] - line)
    assert abs(x[np.argmax(curves[90])] - line + period / 4) < 0.15 * period / 4 + 5
    assert abs(x[np.argmax(curves[-90])] - line - period / 4) < 0.15 * period / 4 + 5


@pytest.mark.experiment("ortho-hydrogen")
def test_ortho_hydrogen_has_six_lines_about_the_protons(run):
    magneton = BOHR / PLANCK
    proton, rotation, c, d, field = 42.577478461e6, 6.71e6, 113.904e3, 57.671e3, 0.18
    h = hamiltonian(1, 1, -c, -rotation / magneton, -proton / magneton, field, d)
    energy, vectors = np.linalg.eigh(h)
    turns = vectors.T @ np.kron(np.eye(3), spin_matrices(1)[1]) @ vectors
    lines = np.sort([abs(energy[i] - energy[k]) for i in range(9) for k in range(i) if abs(turns[i, k]) > 0.5])
    assert len(lines) == 6 and abs(lines.mean() - proton * field) < 10e3
    file = run("ortho-hydrogen")
    x, detected = file["entry/scan/RF_frequency"][:], file["entry/scan/detected"][:]
    for line in lines:
        assert detected[abs(x - line) < 4e3].min() < 0.9
    away = np.all(abs(x[:, None] - lines) > 25e3, axis=1)
    assert away.sum() > 100 and detected[away].min() > 0.98
    for line in lines:  # weak and long, so that neighbours matter less; off centre
        fine = run("ortho-hydrogen", "--particles", "4000", "--set", "RF.amplitude=30 uT", "--scan",
                   f"RF.frequency={hz(line - 7.6e3)}:{hz(line + 8.4e3)}:65")
        centre = dip_centre(fine["entry/scan/RF_frequency"][:], fine["entry/scan/detected"][:])
        assert abs(centre - line) < 100, centre - line


def sextupoles(moment, n=200000):
    """Share of hydrogen with this moment (of |B|, in Bohr magnetons) that arrives; its standard error. Leapfrog."""
    draw = np.random.default_rng(1)
    v = np.linspace(1000, 2700, 4001)
    u = np.sqrt(5 * BOLTZMANN * 80 / (1.007825 * DALTON))
    flux = np.cumsum(v**3 * np.exp(-100 * (v / u - 1)**2))
    speed = np.interp(draw.random(n), flux / flux[-1], v)
    radius, at = np.sqrt(draw.random(n)) * 1e-3, 2 * np.pi * draw.random(n)
    place = radius * np.exp(1j * at)
    cosine = 1 - draw.random(n) * (1 - np.cos(50e-3))
    along = speed * cosine
    across = speed * np.sqrt(1 - cosine**2) * np.exp(2j * np.pi * draw.random(n))
    flies, dy = np.ones(n, bool), 1e-3
    time = dy / along
    place = place + across * 0.10 / along
    for steps, drift in ((150, 0.50), (200, 0.25)):
        for _ in range(steps):
            flies &= abs(place) < 10e-3
            place = place + across * time / 2
            r = abs(place)
            field = 1.5 * (r / 10e-3)**2
            force = moment(field) * BOHR * 1.5 * 2 * place / 10e-3**2
            across = across + force / (1.007825 * DALTON) * time
            place = place + across * time / 2
        flies &= abs(place) < 10e-3
        place = place + across * drift / along
    p = (flies & (abs(place) < 5e-3)).mean()
    return p, np.sqrt(p * (1 - p) / n)


def weak_transition(hydrogen, amplitude, speeds):
    """P(from -> to) of m = 1, 0, -1 behind 5 cm of the field at 1.4 MHz, in the frame that turns with it, over the speeds."""
    v = 1000 + (np.arange(160) + 0.5) * 10
    levels, basis = by_m(1 / 2, 1 / 2, *hydrogen, 0.1e-3), np.zeros((4, 3))
    for column, m in enumerate((1, 0, -1)):
        basis[levels[m][0], column] = levels[m][2][:, -1]
    half_x = spin_matrices(1 / 2)[1]
    moment = hydrogen[1] * np.kron(half_x, np.eye(2)) + hydrogen[2] * np.kron(np.eye(2), half_x)
    h = np.diag([levels[m][1][-1] - m * 1.4e6 for m in (1, 0, -1)])
    energy, vectors = np.linalg.eigh(h + BOHR / PLANCK * amplitude / 2 * basis.T @ moment @ basis)
    turned = vectors @ (np.exp(-2j * np.pi * np.outer(0.05 / v, energy))[:, :, None] * vectors.T)
    return np.average(abs(turned)**2, axis=0, weights=speeds)


@pytest.mark.experiment("hydrogen-source")
@pytest.mark.slow
def test_the_hydrogen_source_polarises_electrons_and_with_its_transition_nuclei(run):
    file = run("hydrogen-source")
    labels = [label.decode() for label in file["entry/target_levels/level_index_labels"][:]]
    assert labels == ["F=1 m=+1", "F=1 m=0", "F=1 m=-1", "F=0 m=0"]
    off, on = file["entry/target_levels/levels"][:]
    # <2 I_z> and <2 J_z> of the levels in the holding field; basis m_J outside.
    hydrogen = (1420.405751768e6, 2.0022838, -0.0030420642)
    states = by_m(1 / 2, 1 / 2, *hydrogen, 0.3)
    vector = {"F=1 m=+1": (1, 1), "F=1 m=0": (0, 1), "F=1 m=-1": (-1, 0), "F=0 m=0": (0, 0)}
    nuclear, electron = [], []
    for label in labels:
        m, which = vector[label]
        numbers, _, vectors = states[m]
        weight = vectors[:, min(which, len(numbers) - 1)]**2
        nuclear.append((weight * np.array([1, -1, 1, -1])[numbers]).sum())
        electron.append((weight * np.array([1, 1, -1, -1])[numbers]).sum())
    x = 0.3 / 50.67e-3
    assert abs(nuclear[1] + x / np.sqrt(1 + x**2)) < 1e-4 and abs(electron[1] + nuclear[1]) < 1e-9
    assert abs(off @ electron - 0.99) < 0.01
    # m = 0, with a smaller moment in weak fields, is focused otherwise: both paths are flown here too.
    fates = file["entry/fates"]
    row = [k.decode() for k in fates["fate"][:]].index("detected")
    ledger, emitted = fates["particles_by_level"][row], fates["emitted_by_level"][:][0]
    arrive = [sextupoles(moment) for moment in (lambda b: -1.0 + 0 * b, lambda b: -b / np.hypot(b, 50.67e-3))]
    for level in (0, 1):
        p, error = arrive[level]
        assert abs(ledger[0, level] / emitted[level] - p) < 4 * np.hypot(error, np.sqrt(p * (1 - p) / emitted[level]))
    expected = (arrive[0][0] + arrive[1][0] * nuclear[1]) / (arrive[0][0] + arrive[1][0])
    assert abs(off @ nuclear - expected) < 0.025  # 4 standard errors
    half = run("hydrogen-source", "--scan", "RF.amplitude=0 uT,1.305 uT")
    for flown, amplitude in ((file, 2.61e-6), (half, 1.305e-6)):
        counts, speeds = flown["entry/behind_states/counts"][1], flown["entry/behind_speeds/counts"][1]
        expected = weak_transition(hydrogen, amplitude, speeds)
        matrix = (counts / counts.sum(axis=1, keepdims=True))[:3, :3]  # F = 1
        assert np.abs(matrix[:2] - expected[:2]).max() < 0.002 and np.abs(matrix[2] - expected[2]).max() < 0.01
    detected = file["entry/scan/detected"][:]
    assert abs(off @ nuclear) < 0.05 and on @ nuclear < -0.88 and 0.8 < on @ electron < 0.9
    assert 0.5 < detected[1] / detected[0] < 0.6
    # The same from the ledger: atoms of m = +1 are thrown out, those of m = 0 stay.
    assert np.allclose(ledger.sum(axis=1), fates["particles"][row], rtol=1e-9)
    assert ledger[1, 0] < 0.15 * ledger[0, 0] and ledger[1, 1] > 0.95 * ledger[0, 1]


@pytest.mark.experiment("deflection-potassium", "deflection-potassium-point")
def test_potassium_in_a_weak_field_draws_the_lines_of_its_levels(run):
    file, point = run("deflection-potassium"), run("deflection-potassium-point")
    z, (quantum, classical) = file["entry/screen_z/z"][:], file["entry/screen_z/counts"][:]
    alone = point["entry/screen_z/counts"][:].reshape(-1)
    assert quantum.sum() > 0.999 * 200000 and classical.sum() > 0.999 * 200000
    # dE/dB by differences; the gradient of two wires on their symmetry line, at 1.2 a.
    field, step = 8.24e-3, 1e-7
    up, down = (np.concatenate([by_m(*POTASSIUM, b)[m][1] for m in (2, 1, 0, -1, -2)]) for b in
                (field + step, field - step))
    moments = np.sort(-(up - down) / (2 * step) * PLANCK)
    gradient = 2 * 1.2 / (1 + 1.2**2) * field / 2e-3
    way = 0.3**2 / 2 + 0.3 * 1.0
    place = moments * gradient * way / (38.9637064848 * DALTON * 600**2) * (1 + 3 * 0.02**2)
    pairs = (place[4:] - place[3::-1]) / 2  # half of the distance between lines of opposite moments
    assert pairs[0] < 1e-6
    bounds = np.append((pairs[1:] + pairs[:-1]) / 2, 0.9e-3)
    for k in (1, 2, 3):
        sides = [(side * z > bounds[k - 1]) & (side * z <= bounds[k]) for side in (-1, 1)]
        low, high = ((quantum[s] * z[s]).sum() / quantum[s].sum() for s in sides)
        assert abs((high - low) / 2 / pairs[k] - 1) < 0.005, k
        for s in sides:
            assert abs(quantum[s].sum() - 25000) < 1500
    middle = abs(z) < bounds[0]
    assert abs((quantum[middle] * z[middle]).sum() / quantum[middle].sum()) < 2e-6
    assert abs(quantum[middle].sum() - 50000) < 1500
    assert abs((alone * abs(z)).sum() / alone.sum() / pairs[3] - 1) < 0.005
    assert abs((classical * abs(z)).sum() / classical.sum() / (pairs[3] / 2) - 1) < 0.005
    inner = abs(z) < 0.8 * pairs[3]
    assert np.ptp(classical[inner]) < 0.2 * classical[inner].mean()


def experiments_with_magnets():
    has_magnet = lambda path: "_magnet" in path.read_text() or "weak-deflection" in path.read_text()
    return sorted(path.stem for path in EXPERIMENTS.glob("*.yaml") if has_magnet(path))


@pytest.mark.parametrize("name", experiments_with_magnets())
@pytest.mark.slow
def test_shared_out_weights_and_drawn_levels_agree(run, name, tmp_path):
    # Behind a tally levels are drawn anyway.
    text = re.sub(r", tallies: \[.*\]}", "}", (EXPERIMENTS / f"{name}.yaml").read_text())
    (tmp_path / f"{name}.yaml").write_text(text.replace("../geometries", str(EXPERIMENTS.parent / "geometries")))
    particles = {"refocusing": 20000000, "hydrogen-source": 200000}.get(name, 5000)
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
    assert (deviations**2).mean() < 1.3


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

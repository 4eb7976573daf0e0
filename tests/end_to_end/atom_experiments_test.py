"""Shipped experiments with the lines and the levels of atoms and molecules give what their headers promise."""

import numpy as np
import pytest
from constants import BOHR, BOLTZMANN, DALTON, PLANCK
from experiments import crossings, dip_centre


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
    for field, tolerance, particles, *more in ((6, 0.01, 5000, *selected), (60, 0.01, 5000, *selected), (6, 0.2, 100000)):
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

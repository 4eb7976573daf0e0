"""The systems that the paper treats, each against its closed form; and what is known about the hypothesis."""

import pathlib
import re
import subprocess

import h5py
import numpy as np
import pytest
from matplotlib.testing.compare import compare_images
from constants import CHARGE, DALTON, GAMMA, HBAR, NUCLEAR, PROTON
from experiments import EXPERIMENTS, RABILINE, crossings

DOCS = EXPERIMENTS.parent / "docs"
LAWS = {"quantum": "law=quantum", "torque": "law.closure=torque", "larmor": "law.closure=larmor"}


def turn(axis, angle):
    """The matrix of a right-handed rotation (Rodrigues)."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def exact_velocity(closure, time, gamma=GAMMA, b=15e-6, h0=25e-6, entry=2e-4, omega=-GAMMA * 15e-6):
    """Of unit size, at a time after the entry into B and H0 together with S = -z and v = y. In the frame that turns with H0 spins
    turn about n = (w1, 0, w0 - omega), seen from the laboratory at the entry. Closure torque: the velocity follows the spin,
    but for the turning about S itself, chi = int w.S dt. Closure larmor: it follows w = -gamma B as the spin does."""
    w0, w1 = -gamma * b, -gamma * h0
    n = np.array([w1 * np.cos(omega * entry), w1 * np.sin(omega * entry), w0 - omega])
    rate, start = np.linalg.norm(n), np.array([0, 0, -1.0])
    both = turn([0, 0, 1], omega * time) @ turn(n, rate * time)
    if closure == "larmor":
        return both @ [0, 1, 0]
    u = n / rate
    p = u * (u @ start)
    q = start - p
    s_z = p[2] * time + q[2] * np.sin(rate * time) / rate + np.cross(u, q)[2] * (1 - np.cos(rate * time)) / rate
    chi = omega * s_z + n @ start * time
    return both @ turn(start, -chi) @ [0, 1, 0]


def findings(folder, name, *arguments):
    """Value and expected value by name, of a model's file."""
    output = folder / "model.h5"
    subprocess.run([RABILINE, "run", EXPERIMENTS / f"{name}.yaml", "-o", output, *arguments], check=True,
                   stdout=subprocess.DEVNULL)
    with h5py.File(output) as file:
        found = file["entry/findings"]
        return {key.decode(): pair for key, pair in zip(found["name"][:], zip(found["value"][:], found["expected"][:]))}


def agrees(pair, at=1e-8):
    value, expected = pair
    return abs(value - expected) <= at * abs(expected) < abs(value - 1.01 * expected)


@pytest.mark.experiment("rotating-cylinder")
def test_a_precessing_cylinder_is_the_papers_circle_and_one_at_rest_nods_about_it(tmp_path):
    steady = findings(tmp_path, "rotating-cylinder", "--set", "model.axis_start=precessing")
    assert all(agrees(steady[name]) for name in ("precession", "radius", "tilt"))
    assert steady["path_distance"][0] < 1e-11
    for name in ("p_theta_drift_paper", "hamiltonian_drift_paper", "p_theta_drift_euler", "hamiltonian_drift_euler",
                 "energy_balance", "angular_momentum_balance", "speed_drift"):
        assert abs(steady[name][0]) < 1e-11, name
    nodding = findings(tmp_path, "rotating-cylinder")
    assert agrees(nodding["precession"], 1e-9)
    assert nodding["rates"][0] < 1e-8 * 0.64 and agrees(nodding["radius"], 1e-4)
    assert abs(nodding["path_distance"][0] - 3 * nodding["fast_top"][0]) < 1e-5  # and slow tops are far off
    slow = findings(tmp_path, "rotating-cylinder", "--set", "model.spin=5 Hz")
    assert slow["fast_top"][0] > 1 and slow["path_distance"][0] > 3


@pytest.mark.experiment("charged-particle")
def test_a_charge_follows_its_closed_forms_and_the_two_theories_differ_by_half_its_g(tmp_path):
    for species, g in (("electron", 2.00231930436), ("muon+", 2.00233184), ("proton", 5.5856946893),
                       ("deuteron", 1.7140255)):
        found = findings(tmp_path, "charged-particle", "--set", f"model.species={species}")
        for name in ("standard_frequency", "standard_radius", "larmor_frequency", "larmor_radius", "radius_ratio"):
            assert agrees(found[name]), (species, name)
        assert all(abs(pair[0]) < 1e-12 for name, pair in found.items() if name.endswith("_drift")), species
        gamma = 1 / np.sqrt(1 - (1e6 / 299792458) ** 2)
        assert abs(found["radius_ratio"][0] / (g / 2 * gamma) - 1) < 1e-7
    equal = "model.species={name: ion, mass: 7.015 u, charge: 1 e, spin: 3/2, g_factor: 2}"
    found = findings(tmp_path, "charged-particle", "--set", equal, "--set", "model.speed=1 m/s")
    assert abs(found["radius_ratio"][0] - 1) < 1e-8


@pytest.mark.experiment("muon-storage-ring")
def test_a_muon_precesses_against_its_momentum_as_storage_rings_see_it(tmp_path):
    found = findings(tmp_path, "muon-storage-ring")
    assert agrees(found["anomalous_frequency"]) and abs(found["anomalous_frequency"][0] - 229.08e3) < 10
    assert agrees(found["standard_radius"]) and abs(found["standard_radius"][0] - 7.112) < 2e-3
    assert found["larmor_angle_drift"][0] < 1e-12 and agrees(found["larmor_spin_turns"])


@pytest.mark.experiment("bound-charge")
def test_a_bound_orbit_precesses_with_half_the_cyclotron_frequency_and_half_of_eq_74(tmp_path):
    harmonic = "model.binding={kind: harmonic, frequency: 80 GHz, radius: 100 nm}"
    assert findings(tmp_path, "bound-charge", "--set", harmonic)["closed_form"][0] < 1e-9
    found = findings(tmp_path, "bound-charge")
    assert agrees(found["precession"], 1e-5) and agrees(found["over_cyclotron"], 1e-5)
    assert abs(found["over_cyclotron"][0] - 0.5) < 4e-4 and abs(found["eq74_over_precession"][0] - 2) < 2e-3
    assert agrees(found["mean_torque"], 1e-4) and abs(found["mean_torque"][0] - 0.5) < 3e-3
    assert found["energy_drift"][0] < 1e-11 and found["canonical_drift"][0] < 1e-11
    free = findings(tmp_path, "bound-charge", "--set", "model.binding={kind: free, speed: 1600 km/s}")
    assert agrees(free["turn"]) and agrees(free["over_larmor"])


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """Time, place and velocity of one neutron of `trajectories`, by the name of a law."""
    folder = tmp_path_factory.mktemp("paths")

    def trace(law, *arguments):
        output = folder / "path.h5"
        subprocess.run([RABILINE, "trace", EXPERIMENTS / "trajectories.yaml", "-n", "1", "--set", LAWS[law],
                        *arguments, "-o", output], check=True, stdout=subprocess.DEVNULL)
        with h5py.File(output) as file:
            track = file["entry/particle_0"]
            return track["t"][:], *(np.stack([track[name][:] for name in names], axis=1)
                                    for names in (("x", "y", "z"), ("vx", "vy", "vz")))

    return trace


def test_trajectory_one_is_straight(path):
    _, place, velocity = path("quantum")
    assert np.all(place[:, [0, 2]] == 0) and np.all(velocity == [0, 1000, 0])


@pytest.mark.experiment("trajectories")
@pytest.mark.parametrize("closure", ["torque", "larmor"])
def test_trajectory_two_is_the_exact_solution(path, closure):
    time, place, velocity = path(closure)
    within = (place[:, 1] > 0.2) & (place[:, 1] <= 0.5)
    assert within.sum() > 5
    for t, v in zip(time[within], velocity[within]):
        assert np.abs(v / 1000 - exact_velocity(closure, t - 2e-4)).max() < 1e-8
    assert np.abs(np.linalg.norm(velocity, axis=1) / 1000 - 1).max() < 1e-14
    t, v = time[within][-1], velocity[within][-1]
    for wrong in ({"b": 1.01 * 15e-6}, {"h0": 1.01 * 25e-6}, {"gamma": 1.01 * GAMMA}):
        assert np.abs(v / 1000 - exact_velocity(closure, t - 2e-4, **wrong)).max() > 1e-3
    # Place where the fields end: the integral of the exact velocity, by Gauss and Legendre.
    nodes, weights = np.polynomial.legendre.leggauss(60)
    taken = t - 2e-4
    mean = sum(w * exact_velocity(closure, taken * (1 + x) / 2) for x, w in zip(nodes, weights)) / 2
    assert np.abs(place[within][-1] - [0, 0.2, 0] - 1000 * taken * mean).max() < 3e-9  # of 0.3 m


@pytest.mark.parametrize("field", ["from: z, to: x", "from: z, to: y"])
def test_steps_are_of_fourth_order_and_keep_the_path_error_where_fields_turn_along_the_beam(tmp_path, field):
    (tmp_path / "guide.yaml").write_text(f"""
rabiline: 1
title: A guide field
species: neutron
law: {{name: dorado, closure: torque, kappa: 0.5}}
source: {{speed: {{kind: single, value: 1000 m/s}}, opening: {{width: 0 m, height: 0 m}}, direction: parallel,
         spin: {{kind: polarised, axis: -z, degree: 1}}}}
parts:
  - {{name: guide, kind: guide_field, at: 0.1 m, length: 0.5 m, field: 100 uT, {field}}}
  - {{name: screen, kind: detector, at: 1 m, width: 10 m, height: 10 m, bins: [1, 1]}}
particles: 1
seed: 1
""")

    def end(error):
        subprocess.run([RABILINE, "trace", tmp_path / "guide.yaml", "-n", "1", "--set", f"law.path_error={error}", "-o",
                        tmp_path / "path.h5"], check=True, stdout=subprocess.DEVNULL)
        with h5py.File(tmp_path / "path.h5") as file:
            track = file["entry/particle_0"]
            last = np.argmin(abs(track["y"][:] - 0.6))
            return np.array([track[name][last] for name in ("x", "y", "z")])

    exact = end(1e-9)
    far = [np.abs(end(error) - exact).max() / 0.5 for error in (1e-3, 1e-5, 1e-7)]
    assert all(distance < error for distance, error in zip(far, (1e-3, 1e-5, 1e-7)))
    assert 30 < far[0] / far[1] < 400 and 70 < far[1] / far[2] < 150  # a hundred: the fourth power of the steps


@pytest.mark.experiment("rabi-neutrons")
@pytest.mark.slow
def test_in_rabis_arrangement_quantum_theory_gives_his_line_and_the_hypothesis_no_beam(run):
    file = run("rabi-neutrons")
    x = file["entry/scan/H0_frequency"][:]
    quantum, classical, torque, larmor = file["entry/scan/detected"][:]
    centre = abs(GAMMA) * 10e-3 / (2 * np.pi)
    near = abs(x - centre) < 4000
    left, right = crossings(x[near], quantum[near], 0.5)
    assert abs((left + right) / 2 - centre) < 30
    assert abs(right - left - 0.79869 * 5000) < 100  # points stand 500 Hz apart
    assert quantum.min() < 2e-3 and abs(quantum[abs(x - centre) < 8000][0] - 1) < 0.12
    assert abs(1 - quantum[abs(abs(x - centre) - 6700) < 300].min() - 0.11644) < 0.01  # Rabi's first sidelobe
    left, right = crossings(x[near], classical[near], 0.5)
    assert right - left > 5500 and abs((left + right) / 2 - centre) < 150
    assert torque.max() == 0 and larmor.max() == 0


@pytest.mark.experiment("unaligned-beam")
def test_spins_that_nothing_has_aligned_leave_at_every_frequency_under_the_hypothesis(run):
    quantum, torque, larmor = run("unaligned-beam")["entry/scan/detected"][:]
    assert (quantum == 1).all() and torque.max() < 0.005 and larmor.max() == 0
    # At full strength the velocity turns about the field by gamma B T (1 - |cos theta|): at 2.2 mrad the beam hits,
    # at 3.2 mrad it is beside the screen.
    for tilt, hit in ((2.2e-3, 1), (3.2e-3, 0)):
        spin = f"source.spin={{kind: polarised, axis: [{np.sin(tilt)}, 0, {np.cos(tilt)}], degree: 1}}"
        file = run("unaligned-beam", "--scan", "law=dorado", "--set", "H0.amplitude=0 T", "--set", spin, "--particles", "200",
                   "--scan", "H0.frequency=280 kHz")
        assert abs(file["entry/scan/detected"][0, 0] - hit) < 0.02
    # A weak hypothesis: a spin at an angle theta to the field moves by kappa gamma B sum(T (way to the screen)) sin^2 theta,
    # and isotropic spins have sin^2 theta < s with probability 1 - sqrt(1 - s). Opening and speeds are averaged over.
    kappa = 4e-6
    file = run("unaligned-beam", "--scan", f"law={{name: dorado, kappa: {kappa}}}", "--set", "H0.amplitude=0 T",
               "--particles", "40000", "--scan", "H0.frequency=280 kHz")
    start, speed = np.meshgrid(np.linspace(-0.995e-4, 0.995e-4, 100), 1000 + 10 * np.linspace(-4, 4, 401))
    weight = np.exp(-(((speed - 1000) / 10) ** 2) / 2)
    moved = kappa * abs(GAMMA) * 10e-3 * (0.10 * (1.2 - 0.15) + 0.25 * (1.2 - 0.425)) / speed
    expected = [np.average(1 - np.sqrt(1 - np.minimum(1, (2e-3 + start) / (moved * factor))), weights=weight)
                for factor in (1, 1.01)]
    detected, error = file["entry/scan/detected"][0, 0], file["entry/scan/detected_errors"][0, 0]
    assert abs(detected - expected[0]) < 3 * error < abs(detected - expected[1])


def place_behind_a_field(radius):
    """x at 0.8 m behind 0.1 m of field in which the radius is that."""
    y = np.sqrt(radius**2 - 0.1**2)
    return radius - y + 0.8 * 0.1 / y


@pytest.mark.experiment("proton-in-a-field")
def test_protons_land_where_the_lorentz_force_puts_them_and_elsewhere_under_the_hypothesis(run):
    scan = run("proton-in-a-field")["entry"]
    names = [name.decode() for name in scan["scan/detector_names"][:]]
    laws = [name.decode() for name in scan["scan/law_labels"][:]]
    assert laws == ["quantum", "classical", "dorado (larmor, kappa = 1)", "dorado (torque, kappa = 1)"]
    seen = np.moveaxis(np.array([np.isfinite(scan[f"{name}_place/x_mean"][:]) for name in names]), 0, 1)
    assert [[names[i] for i in np.nonzero(row)[0]] for row in seen] == [["standard"], ["standard"], ["larmor"],
                                                                      ["straight"]]
    for name, row in zip(names, seen.T):
        assert np.allclose(scan[f"{name}/counts"][:].sum(axis=(1, 2)), 10000 * row)  # all, or none
    mass_over_charge, gamma = PROTON / CHARGE, 2 * np.pi * 42.577478461e6
    spread = 4 * scan["standard_place/x_mean_errors"][1]
    for name, law, radius in (("standard", 1, mass_over_charge * 1e6 / 10e-3), ("larmor", 2, 1e6 / (gamma * 10e-3))):
        place = scan[f"{name}_place/x_mean"][law]
        assert abs(place - place_behind_a_field(radius)) < spread
        assert abs(place - place_behind_a_field(1.01 * radius)) > spread
    assert abs(scan["straight_place/x_mean"][3]) < spread


def test_a_proton_with_g_of_two_lands_at_one_place_under_both(tmp_path):
    text = (EXPERIMENTS / "proton-in-a-field.yaml").read_text()
    own = f"species: {{name: g2, mass: {PROTON} kg, charge: 1 e, spin: 1/2, g_factor: 2}}"
    (tmp_path / "g2.yaml").write_text(text.replace("species: proton", own))
    subprocess.run([RABILINE, "run", tmp_path / "g2.yaml", "-o", tmp_path / "g2.h5", "--progress", "none", "--threads", "1"],
                   check=True, stdout=subprocess.DEVNULL)
    with h5py.File(tmp_path / "g2.h5") as file:
        quantum, classical, larmor, _ = file["entry/standard_place/x_mean"][:]
    assert quantum == classical and abs(larmor / classical - 1) < 1e-6  # a tally has 2^24 places in 20 mm


@pytest.mark.experiment("muon-precession")
def test_the_spin_of_a_muon_gains_its_anomaly_on_the_velocity(run):
    entry = run("muon-precession")["entry"]
    turns = entry["scan/B_length"][:] / 5e-3
    x, z = entry["screen_spin_x/spin_mean"][:], entry["screen_spin_z/spin_mean"][:]
    angle = np.unwrap(np.arctan2(z, x)) / (2 * np.pi)
    anomaly = 8.89059704 * NUCLEAR / (HBAR / 2) * 0.1134289257 * DALTON / CHARGE - 1
    assert abs(anomaly - 0.00116592) < 1e-7
    assert np.allclose(angle, anomaly * turns, atol=1e-6) and not np.allclose(angle, 1.01 * anomaly * turns, atol=1e-4)
    assert np.allclose(np.hypot(x, z), 1, atol=1e-6)
    assert np.allclose(entry["screen_angle_x/angle_x_mean"][:], 10e-3, atol=1e-6)


@pytest.mark.experiment("spin-angles")
@pytest.mark.parametrize("law", ["dorado", "classical"])
def test_the_angles_of_the_spin_fall_and_turn_as_the_fields_say(run, law):
    file = run("spin-angles", "--set", f"law={law}")

    def means(tally, quantity):
        return file[f"entry/path_{tally}/{quantity}_mean"][:].ravel()

    t, theta, phi = means("clock", "time_of_flight"), means("polar", "spin_polar_angle"), means("azimuth", "spin_azimuth")
    fall, turn = np.polyfit(t, theta, 1)[0], np.polyfit(t[1:], np.unwrap(phi[1:]), 1)[0]
    assert abs(fall / (GAMMA * 4.8e-6) - 1) < 1e-6
    assert abs(turn / (-GAMMA * 0.1e-3) - 1) < 1e-5  # the mean direction of unequal speeds
    assert abs(np.degrees(theta[0]) - 180) < 1e-4 and phi[0] < 1e-6
    assert abs(np.degrees(theta[-1]) - (159.57 if law == "dorado" else 159.84)) < 0.01
    energy = -GAMMA * HBAR / 2 * 0.1e-3 * np.cos(theta)  # eq. 72
    assert abs(energy[0] + 9.66e-31) < 0.01e-31 and abs(1 - energy[-1] / energy[0] - 0.062) < 0.002
    assert np.all(file["entry/path/passed"][:] == 1)
    assert file["entry/scan/detected"][()].item() == (0 if law == "dorado" else 1)


def bound(name, folder, *arguments):
    """The 95 % bound on kappa that bound-kappa quotes."""
    output = folder / "kappa.h5"
    subprocess.run([RABILINE, "run", EXPERIMENTS / f"{name}.yaml", "-o", output, "--progress", "none", "--threads", "1",
                    *arguments], check=True, stdout=subprocess.DEVNULL)
    words = subprocess.run(["/usr/bin/python3", "-m", "rabiline", "bound-kappa", output, "--data",
                            EXPERIMENTS / f"{name}.csv"], check=True, capture_output=True, text=True).stdout
    return words, float(re.search(r"bound +0 ≤ κ ≤ (\S+)", words)[1])


# Closed forms for the strength at which half of the beam misses: by file, parameter and closure.
GUIDED = 10e-3 * 2 * 2200 / (abs(GAMMA) * 1e-3 * 2.0**2)
FLIPPED = 1e-3 / (abs(GAMMA) * 68.6e-3 * 50e-3 / 989.107)
TURNED = 10e-3 / (np.pi / 2 * (0.25 + 0.25))


@pytest.mark.experiment("known-guided-neutrons", "known-rf-flipper", "known-turned-guide-field")
@pytest.mark.parametrize("name, closure, half", [("known-guided-neutrons", "larmor", GUIDED),
                                                 ("known-rf-flipper", "torque", 2 * FLIPPED),
                                                 ("known-rf-flipper", "larmor", FLIPPED),
                                                 ("known-turned-guide-field", "torque", TURNED)])
@pytest.mark.slow
def test_what_is_known_bounds_the_strength_of_the_hypothesis(run, tmp_path, name, closure, half):
    file = run(name, "--set", f"law.closure={closure}", "--particles", "4000")
    (middle,) = crossings(file["entry/scan/law_kappa"][:], file["entry/scan/detected"][:], 0.5)
    assert abs(middle / half - 1) < 0.004
    assert abs(middle / half / 1.01 - 1) > 0.005
    words, limit = bound(name, tmp_path, "--set", f"law.closure={closure}")
    assert "p = 1 at" in words and 0.93 < limit / half < 1


@pytest.mark.parametrize("name, straight", [("known-guided-neutrons", True), ("known-turned-guide-field", False)])
def test_spins_along_a_field_that_keeps_its_direction_are_no_evidence_against_torque(run, name, straight):
    file = run(name, "--set", "law.closure=torque", "--scan", "law.kappa=0,0.005,1")
    detected = file["entry/scan/detected"][:]
    assert detected[0] == 1 and (detected[-1] == 1) == straight


@pytest.mark.slow
def test_the_readme_and_the_page_on_the_paper_show_figures_that_one_command_draws(tmp_path):
    page = (DOCS / "what-the-paper-predicts.md").read_text()
    shown = set(re.findall(r"\]\(figures/([\w-]+\.png)\)", page))
    shown |= set(re.findall(r"\]\(docs/figures/([\w-]+\.png)\)", (DOCS.parent / "README.md").read_text()))
    shown |= {name for guide in (DOCS / "guide").glob("*.md")
              for name in re.findall(r"\]\(\.\./figures/([\w-]+\.png)\)", guide.read_text())}
    subprocess.run([DOCS / "draw-figures", tmp_path], check=True, stdout=subprocess.DEVNULL)
    assert shown == {path.name for path in tmp_path.iterdir()} == {path.name for path in (DOCS / "figures").iterdir()}
    for name in sorted(shown):  # those in the page are not out of date
        assert compare_images(str(DOCS / "figures" / name), str(tmp_path / name), tol=10) is None, name
    for experiment in re.findall(r"`(?:beamline/)?([\w-]+)\.yaml`", page):
        assert (EXPERIMENTS / f"{experiment}.yaml").exists(), experiment
    for link in re.findall(r"\]\((?!http|figures/|#)([^)]+)\)", page):
        assert (DOCS / link).exists(), link
    assert pathlib.Path(DOCS / "draw-figures").stat().st_mode & 0o111

"""An atom that has one spin, whose levels are carried as amplitudes, and the point spin that it is."""
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from fields_test import BOX, MAGNET, experiment, levels_of, run

FREE_SPIN = ("species: {name: spin, mass: 1.00866491595 u, charge: 0 e, structure: {I: 0, J: 1/2, g_J: 0.0020837513, g_I: 0}, "
             "source: the moment of a neutron}")

RAISES = np.diag(np.sqrt([3, 4, 3]), 1)
SPIN_32 = (RAISES + RAISES.T) / 2, (RAISES - RAISES.T) / 2j, np.diag([1.5, 0.5, -0.5, -1.5])
SPIN_12 = np.array([[0, 1], [1, 0]]) / 2, np.array([[0, -1j], [1j, 0]]) / 2, np.diag([0.5, -0.5])


def of_atom(path: Path) -> Path:
    """The same file for an atom that has one spin, whose levels are carried as amplitudes."""
    text = path.read_text().replace("species: neutron", FREE_SPIN).replace("sense: co", "sense: positive")
    atom = path.with_name("atom-" + path.name)
    atom.write_text(text)
    return atom


def test_an_atom_of_one_spin_is_flipped_by_pulses_as_a_point_spin_is(tmp_path: Path) -> None:
    path = experiment(tmp_path, "kind: uniform_field, length: 0.2 m, field: 1 mT}\n  - {name: H0, kind: rotating_field, at: 1.02 m, length: 15 cm, "
                      "amplitude: 250 uT, frequency: 29.3 kHz, sense: co, phase: locked, pulses: {begin: 1.04 ms, end: 1.053 ms, period: 31 us, times: 4}")
    levels = [levels_of(path), levels_of(of_atom(path))]
    assert 0.05 < levels[0][0] < 0.95
    assert np.abs(levels[0] - levels[1]).max() < 1e-6


def test_an_atom_meets_fields_that_begin_with_a_step_as_a_point_spin_does(tmp_path: Path) -> None:
    # Where they begin and end is not always a place that the atom's path hits to the bit.
    boxes = "".join(f"}}\n  - {{name: F{i}, at: {at} m, kind: formula_field, formula: {{Bx: '{3e-4 * (-1)**i}', Bz: 1e-4, width: 1 cm, height: 1 cm, "
                    "length: 2 cm, step: 1 mm}" for i, at in enumerate((1.03, 1.05, 1.23, 1.35, 1.41, 1.45)))
    path = experiment(tmp_path, "kind: uniform_field, length: 50 cm, field: 0.2 mT" + boxes)
    levels = [levels_of(path), levels_of(of_atom(path))]
    assert np.abs(levels[0] - levels[1]).max() < 1e-6
    with h5py.File(path.with_name("atom-" + path.name).with_suffix(".h5")) as file:
        assert file["entry/field_check/levels"][()] < 1e-6


def test_an_atom_is_driven_by_a_field_that_begins_with_nothing_as_a_point_spin_is(tmp_path: Path) -> None:
    path = experiment(tmp_path, "kind: oscillating_field, length: 20 cm, amplitude: 0.4 mT, frequency: 3 kHz, phase: 30 deg, approximation: none, "
                      "profile: half_sine")
    levels = [levels_of(path), levels_of(of_atom(path))]  # a path that ends in time is worked out for a while
    assert np.abs(levels[0] - levels[1]).max() < 1e-6


def test_atoms_that_leave_a_map_end_there_as_point_spins_do(tmp_path: Path) -> None:
    path = experiment(tmp_path, "kind: formula_field, formula: {Bz: B0 + G*z, Bx: -G*x, constants: {B0: 1 uT, G: 1 uT/m}, " + BOX + "}, outside: error")
    path.write_text(path.read_text().replace("width: 0.2 mm, height: 0.2 mm", "width: 14 mm, height: 2 mm").replace("particles: 100", "particles: 2000"))
    left = []
    for each in (path, of_atom(path)):
        levels_of(each)
        with h5py.File(each.with_suffix(".h5")) as file:
            left.append(file["entry/fates/particles"][:][file["entry/fates/fate"][:] == b"left_map"].sum())
    assert left[0] == left[1]
    assert abs(left[0] / 2000 - 4 / 14) < 0.05


def test_what_a_magnet_pushes_out_of_its_map_has_left_the_map(tmp_path: Path) -> None:
    """72 um aside over a map that is .1 mm high and evenly filled, in each level."""
    path = tmp_path / "magnet.yaml"
    magnet = ("{name: magnet, kind: formula_field, at: 0.15 m, formula: {Bz: 0.5 + 100*z, Bx: -100*x, width: 1 cm, height: 0.1 mm, length: 10 cm, "
              "step: 1 mm}, outside: error}")
    text = MAGNET.format(more="", gap="").replace("height: 10 um", "height: 0.1 mm").replace("particles: 4000", "particles: 60000")
    path.write_text(re.sub(r"{name: magnet, .*}", magnet, text))
    assert (out := run("run", path, "-o", tmp_path / "a.h5", "--progress", "none")).returncode == 0, out.stderr
    with h5py.File(tmp_path / "a.h5") as file:
        fates = {name: file["entry/fates/particles"][:][file["entry/fates/fate"][:] == name].sum() for name in (b"left_map", b"stopped", b"detected")}
    acceleration = 9.2740e-24 * 100 / (107.868 * 1.66054e-27)
    aside = acceleration * (0.1 / 600)**2 / 2
    assert abs(fates[b"left_map"] / 60000 - aside / 1e-4) < 3 * 0.0018 and fates[b"stopped"] == 0
    assert fates[b"left_map"] + fates[b"detected"] == 60000


@pytest.mark.parametrize("part", [
    "kind: formula_field, formula: {Bx: 2e-5, Bz: 5e-5*(1 + x/0.1), By: 5e-5*z/0.1, width: 4 cm, height: 1 cm, length: 10 cm, step: 2 mm}, tilt: {x: 15 deg, z: 20 deg}",
    "kind: solenoid, winding: 8 cm, radius: 3 cm, direction: x, field: 0.1 mT, reach: 0.3 m",
    "kind: straight_wire, radius: 3 mm, current: 0.1 A, reach: 0.25 m, direction: [1, 0, 0.2]",
    "kind: current_sheet, width: 6 cm, current: 5 A, reach: 0.25 m, tilt: {x: 20 deg, y: 10 deg, z: 30 deg}",
], ids=["slanting faces", "through windings", "through a wire", "through a sheet of current"])
def test_what_flies_through_a_jump_of_the_field_that_no_edge_of_a_part_is_agrees_with_an_independent_integration(tmp_path: Path, part: str) -> None:
    path = experiment(tmp_path, part + "}\n  - {name: B, kind: uniform_field, at: 0.8 m, length: 50 cm, field: 20 uT, direction: [1, 0, 1]")
    path.write_text(path.read_text().replace("direction: parallel", "direction: {kind: cone, half_angle: 2 mrad}"))
    levels = [levels_of(each) for each in (path, of_atom(path))]
    assert np.abs(levels[0] - levels[1]).max() < 1e-6
    for each, what in ((path, "spin"), (path.with_name("atom-" + path.name), "levels")):
        with h5py.File(each.with_suffix(".h5")) as file:
            check = file["entry/field_check"]
            assert check["particles"][()] == 16 and check[what][()] < 1e-7


IN_A_FIELD = "}\n  - {name: B, kind: uniform_field, at: 0.7 m, length: 70 cm, field: 1 mT, direction: [0.1, 0, 1]"
SWINGS = "oscillates: {frequency: 29.1 kHz, phase: 30 deg}"


@pytest.mark.parametrize("part", [
    f"kind: current_loop, radius: 4 cm, direction: [1, 1, 0], field: 0.3 mT, reach: 0.25 m, {SWINGS}",
    f"kind: solenoid, winding: 8 cm, radius: 3 cm, direction: [1, 2, 0], field: 0.2 mT, reach: 0.25 m, {SWINGS}",
    f"kind: coil_pair, radius: 5 cm, distance: 5 cm, direction: x, field: 200 uT, reach: 0.2 m, {SWINGS.replace('30 deg', 'random')}",
    f"kind: straight_wire, radius: 1 mm, current: 15 A, reach: 0.2 m, offset: {{z: 2 cm}}, {SWINGS}",
    f"kind: multipole_field, length: 20 cm, poles: 4, field: 0.1 mT, radius: 1 cm, offset: {{x: 6 mm, z: 2 mm}}, {SWINGS}",
    "kind: formula_field, formula: {Bx: A*cos(2*pi*(f*t - y/L))*(1 + z/0.05), By: A*sin(2*pi*f*t)^2, Bz: A*sin(4*pi*f*t), constants: {A: 200 uT, f: 31.6 kHz, L: 0.4 m}, "
    "frequency: 31.6 kHz, phase: random, width: 6 cm, height: 4 cm, length: 10 cm, step: 4 mm}, tilt: {x: 8 deg, z: 12 deg}",
    f"kind: formula_field, formula: {{Bx: 1e-4*(1 + y/0.1), Bz: 3e-5*x/0.01, width: 1 cm, height: 1 cm, length: 10 cm, step: 2 mm}}, scale: 0.8, {SWINGS}",
], ids=["a ring", "through windings", "a pair of random phase", "a wire", "a quadrupole", "a wave with harmonics and slanting faces", "a formula"])
def test_an_atom_is_driven_by_a_field_that_swings_as_a_point_spin_is(tmp_path: Path, part: str) -> None:
    path = experiment(tmp_path, part + IN_A_FIELD)
    path.write_text(path.read_text().replace("direction: parallel", "direction: {kind: cone, half_angle: 2 mrad}\n  spin: {kind: polarised, axis: z, degree: 1}"))
    atom = of_atom(path)
    atom.write_text(atom.read_text().replace("{kind: polarised, axis: z, degree: 1}", "{kind: levels, levels: [F=1/2 m=1/2]}"))
    weaker = experiment(tmp_path, "kind: uniform_field, length: 1 mm, field: 0 T" + IN_A_FIELD, "without.yaml")
    weaker.write_text(weaker.read_text().replace("parallel", "parallel\n  spin: {kind: polarised, axis: z, degree: 1}"))
    levels = [levels_of(each) for each in (path, atom, weaker)]
    assert np.abs(levels[0] - levels[2]).max() > 0.05
    assert np.abs(levels[0] - levels[1]).max() < 1e-6, levels
    with h5py.File(atom.with_suffix(".h5")) as file:
        check = file["entry/field_check"]
        assert check["particles"][()] == 16 and check["levels"][()] < 3e-7


@pytest.mark.parametrize("turn", [60, 89.99, 90.01, 120, 180])
def test_levels_that_a_field_turns_at_once_are_those_of_the_state_that_stays(tmp_path: Path, turn: float) -> None:
    """Where hyperfine structure and field are alike: |<level along the new field|level along the old one>|^2."""
    def levels(angle: float) -> np.ndarray:
        energies, states = np.linalg.eigh(1e6 * sum(np.kron(i, j) for i, j in zip(SPIN_32, SPIN_12)) + 2.0023 * 1.39962449e10 * 20e-6 *
                                          np.kron(np.eye(4), np.sin(angle) * SPIN_12[0] + np.cos(angle) * SPIN_12[2]))
        return states[:, ::-1]  # F = 2 first, from m = 2 on; then F = 1, from m = -1 on

    path = experiment(tmp_path, "kind: uniform_field, length: 10 cm, field: 20 uT}\n  - {name: G, kind: uniform_field, at: 1.1 m, length: 1.1 m, field: 20 uT, "
                      f"direction: [{np.sin(np.radians(turn))}, 0, {np.cos(np.radians(turn))}]")
    path.write_text(path.read_text().replace("species: neutron", "species: {name: alkali, mass: 23 u, charge: 0 e, structure: {I: 3/2, J: 1/2, coupling: 1 MHz, g_J: 2.0023, g_I: 0}}")
                    .replace("direction: parallel", "direction: parallel\n  spin: {kind: levels, levels: [F=2 m=+1]}"))
    found = levels_of(path)
    wanted = np.abs(levels(np.radians(turn)).conj().T @ levels(0)[:, 1])**2
    assert np.abs(found - wanted[[0, 1, 2, 3, 4, 7, 6, 5]]).max() < 1e-6


def test_a_swinging_field_that_vanishes_on_the_axis_drives_the_atoms_beside_it(tmp_path: Path) -> None:
    path = experiment(tmp_path, "kind: uniform_field, length: 20 cm, field: 20 uT}\n  - {name: Q, kind: multipole_field, at: 1.05 m, length: 10 cm, poles: 4, radius: 1 cm, "
                      "field: 5 uT, oscillates: {frequency: 280 kHz, phase: locked}")
    path.write_text(path.read_text().replace("species: neutron", "species: H atom").replace("direction: parallel", "direction: parallel\n  offset: {x: 3 mm}"))
    assert "drives no transition" not in run("check", path).stdout

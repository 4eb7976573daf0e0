"""Fields as formulas in place and time whose t does not repeat."""
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from fields_test import levels_of, run
from formula_fields_test import of_formula, same_levels
from lives_test import bits
from one_spin_test import of_atom

GAMMA = 1.83247172e8  # of the neutron [rad/(s T)]
ALONG_Z = "direction: parallel\n  spin: {kind: polarised, axis: z, degree: 1}"


def flipped(folder: Path, course: str, *, turn: float, area: float, duration: str, name: str = "formula.yaml") -> tuple[float, Path]:
    """The share of spins along z that a field along x turns, which flies past from 1 to 1.2 ms, and has the integral `area` of its course [s] there."""
    path = of_formula(folder, f"Bx: 'A*{course}', constants: {{A: {turn / GAMMA / area!r}}}, duration: {duration}", name, beside="")
    path.write_text(path.read_text().replace("direction: parallel", ALONG_Z))
    return 1 - levels_of(path)[0], path


@pytest.mark.parametrize(("course", "area", "duration"), [
    ("min(max((t - 1.05e-3)/30e-6, 0), 1)", 135e-6, "20 ms"),
    ("min(max((t - 1.05e-3)/30e-6, 0), 1)", 135e-6, "1.1 ms"),
    ("exp(-((t - 1.137e-3)/2e-6)^2)", np.sqrt(np.pi) * 2e-6, "20 ms"),
    ("exp(-(t - 1e-3)/40e-6)", 40e-6 * (1 - np.exp(-5)), "1.3 ms"),
    ("t", (1.2e-3**2 - 1e-3**2) / 2, "1.2 ms"),
], ids=["ramp", "ramp that stays", "short pulse", "decay", "sweep"])
def test_a_field_that_does_not_repeat_turns_spins_by_its_integral(tmp_path: Path, course: str, area: float, duration: str) -> None:
    found, path = flipped(tmp_path, course, turn=2.0, area=area, duration=duration)
    assert abs(found - np.sin(1.0) ** 2) < 2e-6
    with h5py.File(path.with_suffix(".h5")) as file:
        assert file["entry/field_check/particles"][()] == 16 and file["entry/field_check/spin"][()] < 1e-6


def test_a_field_that_repeats_is_the_same_with_a_duration(tmp_path: Path) -> None:
    turning = "Bx: A*cos(2*pi*f*t)*(1 + y/L), By: A*sin(2*pi*f*t), constants: {A: 40 uT, f: -29.2 kHz, L: 0.5 m}"
    same_levels(of_formula(tmp_path, f"{turning}, frequency: 29.2 kHz"), of_formula(tmp_path, f"{turning}, duration: 1.5 ms", "course.yaml"))


def test_a_sum_of_courses_drives_the_levels_of_an_atom_as_the_point_spin_that_it_is(tmp_path: Path) -> None:
    path = of_formula(tmp_path, "Bx: A*exp(-((t - 1.1e-3)/30e-6)^2)*cos(2*pi*f*t)*(1 + x/0.1), By: 'A*min(t/1e-3, 1)*y/0.2', Bz: A*tanh((t - 1.1e-3)/20e-6), "
                      "constants: {A: 200 uT, f: 29.1 kHz}, duration: 2 ms")
    path.write_text(path.read_text().replace("direction: parallel", "direction: {kind: cone, half_angle: 2 mrad}" + ALONG_Z[19:]))
    atom = of_atom(path)
    atom.write_text(atom.read_text().replace("{kind: polarised, axis: z, degree: 1}", "{kind: levels, levels: [F=1/2 m=1/2]}"))
    levels = [levels_of(each) for each in (path, atom)]
    assert 0.05 < levels[0][0] < 0.95
    assert np.abs(levels[0] - levels[1]).max() < 1e-6
    for isa in ("x86-64", "avx2"):
        narrow = run("run", path, "-o", tmp_path / f"{isa}.h5", "--progress", "none", "--isa", isa)
        assert "this processor has no" in narrow.stderr or bits(tmp_path / f"{isa}.h5") == bits(path.with_suffix(".h5")), narrow.stderr
    for each, what in ((path, "spin"), (atom, "levels")):
        with h5py.File(each.with_suffix(".h5")) as file:
            assert file["entry/field_check/particles"][()] == 16 and file[f"entry/field_check/{what}"][()] < 1e-6


ATOM = """
rabiline: 1
title: An atom through a field along its axis that swings
species: {{name: own, mass: 200 u, charge: 0 e, structure: {{I: 1/2, J: 1/2, coupling: 120 kHz, g_J: 1.5, g_I: 0.02}}}}
law: {{name: quantum, tolerance: 1e-8}}
source:
  speed: {{kind: single, value: 2000 m/s}}
  opening: {{width: 0 m, height: 0 m}}
  direction: parallel
  spin: {{kind: levels, levels: [F=1 m=0]}}
parts:
  - {{name: C, kind: uniform_field, at: 0 m, length: 1 m, field: 6 uT}}
  - {{name: F, kind: formula_field, at: 0.2 m, formula: {{Bz: '2e-6*cos(2*pi*50e3*t + 0.4)', width: 1 cm, height: 1 cm, length: 0.2 m, step: 5 mm, {time}}}}}
  - {{name: D, kind: detector, at: 0.95 m, width: 2 m, height: 2 m, bins: [1, 1]}}
particles: 2
seed: 3
"""


@pytest.mark.parametrize("time", ["duration: 0.5 ms", "frequency: 50 kHz, phase: locked"])
def test_ends_of_what_moves_in_time_leave_the_state_of_an_atom(tmp_path: Path, time: str) -> None:
    """0.0179505 in F = 0 by DOP853. As if its size changed slowly it would be 0.000478."""
    (tmp_path / "atom.yaml").write_text(ATOM.format(time=time))
    assert levels_of(tmp_path / "atom.yaml")[3] == pytest.approx(0.0179505, abs=1e-7)


@pytest.mark.parametrize("formula", ["Bz: 'B0*exp(-t/tau)', constants: {B0: 100 uT, tau: 0.3 ms}, duration: 2 ms", "Bz: B0*(1 + y/L), constants: {B0: 100 uT, L: 0.5 m}"], ids=["course", "map"])
def test_scan_points_that_change_a_formula_have_each_its_own_field(tmp_path: Path, formula: str) -> None:
    """Each point's maps must outlive the beamline that they were made for."""
    path = of_formula(tmp_path, formula)
    scanned = run("run", path, "--scan", "F.formula.constants.B0=100 uT:320 uT:12", "-o", tmp_path / "scan.h5", "--progress", "none", "--max-time", "20 s")
    assert scanned.returncode == 0, scanned.stderr
    with h5py.File(tmp_path / "scan.h5") as file:
        levels = file["entry/D_levels/levels"][:].reshape(12, -1)
    for i in (0, 4, 11):
        alone = path.with_name(f"{i}.yaml")
        alone.write_text(path.read_text().replace("B0: 100 uT", f"B0: {100 + 20 * i} uT"))
        assert np.abs(levels[i] - levels_of(alone)).max() < 1e-9


def test_check_looks_at_a_formula_at_all_times(tmp_path: Path) -> None:
    """Its field is largest, and has currents, when its first table has none of that."""
    turning = of_formula(tmp_path, "Bx: A*cos(2*pi*f*t), Bz: 'B0*exp(-t/tau)', constants: {A: 10 uT, B0: 100 uT, tau: 0.3 ms, f: 3 kHz}, duration: 2 ms")
    assert "up to 100.5 uT on the axis" in run("check", turning).stdout
    assert re.search(r"formula: [2-8] tables of 5 x \d+ x 5 nodes, followed for 2 ms", run("check", turning).stdout)
    late = of_formula(tmp_path, "Bz: 'B0*exp(-t/tau) + G*y*min(t/1e-3, 1)', constants: {B0: 10 mT, tau: 0.1 ms, G: 0.03 T/m}, duration: 2 ms")
    assert "is no field without currents" in run("check", late).stdout


def test_a_drawing_shows_a_course_as_a_path_meets_it(tmp_path: Path) -> None:
    pytest.importorskip("rabiline._core", reason="built without pybind11")
    import rabiline
    from rabiline import apparatus

    experiment = rabiline.load(of_formula(tmp_path, "Bx: 'A*min(max((t - 1e-3)/0.1e-3, 0), 1)', constants: {A: 10 uT}, duration: 2 ms", beside=""))
    fields = apparatus.fields_along(experiment, apparatus.pieces_of(experiment), 2.0, experiment.trace(1))
    size = np.interp([0.9, 1.05, 1.15, 1.3], fields.y, fields.static)  # at 1000 m/s
    assert np.abs(size - [0, 5e-6, 10e-6, 0]).max() < 1e-7


def test_probe_tells_a_course_at_a_time(tmp_path: Path) -> None:
    path = of_formula(tmp_path, "Bx: 'G*z*min(t/1e-3, 1)', Bz: 'G*x*min(t/1e-3, 1)', constants: {G: 1 T/m}, duration: 2 ms", beside="")
    for time, size in (("0.1 ms", "200 uT"), ("0.25 ms", "500 uT"), ("1.5 ms", "2 mT"), ("1 s", "2 mT")):
        assert f"B = ({size}" in run("probe", path, "--at", "0 m,1.1 m,2 mm", "--time", time).stdout, time


PULSE = "Bx: 'A*max(0, 1 - abs(y - 0.03)/0.01)*max(0, 1 - abs(t - 1.03e-3)/10e-6)', constants: {A: 1 mT}"


def test_a_pulse_at_one_place_is_found_however_long_the_duration_is(tmp_path: Path) -> None:
    same_levels(of_formula(tmp_path, f"{PULSE}, duration: 1.05 ms", beside=""), of_formula(tmp_path, f"{PULSE}, duration: 2.2 ms", "long.yaml", beside=""))


def test_check_tells_the_field_that_a_particle_meets(tmp_path: Path) -> None:
    """Not that of t = 0 or of a course that is always 1."""
    path = of_formula(tmp_path, "Bz: 'B*exp(-t/0.1e-3)', constants: {B: 20 uT}, duration: 5 ms", beside="}\n  - {name: C, kind: uniform_field, at: 1 m, length: 20 cm, field: 20 uT}\n  - "
                      "{name: R, kind: rotating_field, at: 1 m, length: 20 cm, amplitude: 1 uT, frequency: 583.29 Hz, sense: co, phase: locked")
    assert "Larmor 583.3 Hz" in run("check", path).stdout
    checked = run("check", of_atom(path))
    assert "nan" not in checked.stdout and "drives no transition" not in checked.stdout


def test_a_course_begins_to_change_at_t_0_for_particles_emitted_before(tmp_path: Path) -> None:
    path = of_formula(tmp_path, "Bx: 'B*t/1e-3', constants: {B: 1 mT}, duration: 4 ms", beside="")
    path.write_text(path.read_text().replace("direction: parallel", "direction: parallel\n  pulse: {shape: gaussian, sigma: 0.2 ms}").replace("name: F, at: 1 m", "name: F, at: 1 cm"))
    levels_of(path)
    with h5py.File(path.with_suffix(".h5")) as file:
        assert file["entry/field_check/particles"][()] > 0 and file["entry/field_check/spin"][()] < 1e-6


def test_a_formula_without_a_value_is_refused_where_it_is_an_exponential(tmp_path: Path) -> None:
    for formula in ("exp(x/w)", "tanh(0/w)", "2^(0/w)", "erf(0/w)"):
        out = run("check", of_formula(tmp_path, f"Bz: '1e-5*{formula}', constants: {{w: 0 mm}}"))
        assert out.returncode == 2 and "no finite value" in out.stdout + out.stderr

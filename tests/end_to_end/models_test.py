"""Models from the file to the picture: what is written, what the header of the file promises, what is refused."""
from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

import nexus_test

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ["RABILINE_PROGRAM"]
CYLINDER = ROOT / "beamline" / "rotating-cylinder.yaml"
L = 0.5 * 0.05**2 * 2 * np.pi * 100  # kg m2/s
I1 = 0.05**2 / 4 + 0.2**2 / 12  # kg m2


def rabiline(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([PROGRAM, *map(str, arguments)], text=True, capture_output=True, timeout=600)


def solve(output: Path, *arguments: object) -> h5py.File:
    done = rabiline("run", CYLINDER, "-o", output, *arguments)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    return h5py.File(output)


def findings(file: h5py.File) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    group = file["entry/findings"]
    return {name.decode(): (value, expected)
            for name, value, expected in zip(group["name"], group["value"], group["expected"])}


def test_the_cylinder_does_what_the_header_of_its_file_promises(tmp_path: Path) -> None:
    file = solve(tmp_path / "c.h5")
    found = findings(file)
    k = L / I1  # the nodding, of which a part of a turn is left at the end
    for omega, agrees in ((0.5 / L, True), (1.01 * 0.5 / L, False)):
        assert (abs(found["precession"][1] - omega * (1 - np.sin(10 * k) / (10 * k))) < 1e-12) == agrees
        assert (abs(found["precession"][0] - omega) < 2e-3 * omega) == agrees
        assert (abs(found["radius"][0] - 2 / omega) < 1e-3) == agrees
    assert 0.009 < found["path_distance"][0] < 0.0097
    nutation = file["entry/euler/nutation"]
    turn = file["entry/euler/time"][:] < 0.1
    assert abs(nutation[:][turn].max() - 2 * 0.5 * I1 / L**2) < 2e-2 * 2 * 0.5 * I1 / L**2
    for kept in ("p_theta_drift_paper", "hamiltonian_drift_paper", "speed_drift", "energy_balance",
                 "angular_momentum_balance", "spin_drift"):
        assert found[kept][0] < 1e-12, kept
    assert (file["entry/standard/z"][:] == 0).all()
    assert file["entry/model"][()] == b"rotating_cylinder"
    assert b"rotating_cylinder" in file["entry/simulation/input_0/data"][()]


def test_a_scan_shows_where_the_fast_top_fails(tmp_path: Path) -> None:
    file = solve(tmp_path / "s.h5", "--scan", "model.spin=3 Hz:300 Hz:5:log")
    spin, apart = file["entry/findings/model_spin"][:], file["entry/findings/path_distance"][:]
    np.testing.assert_allclose(spin, np.geomspace(3, 300, 5), rtol=1e-12)
    assert (np.diff(apart) < 0).all() and apart[0] > 1 and apart[-1] < 1e-3
    assert file["entry/point_4/paper/y"].shape == (2001,)
    assert file["entry/findings/value"].shape == (len(file["entry/findings/name"]), 5)


def test_a_torque_fixed_in_space_does_not_stay_perpendicular(tmp_path: Path) -> None:
    found = findings(solve(tmp_path / "f.h5", "--set", "model.torque={kind: space_fixed, size: 0.5 N m}"))
    assert found["torque_along_axis"][0] > 0.95
    assert abs(found["growth"][0] - (np.hypot(1, 5 / L) - 1)) < 1e-9


def test_a_finding_that_a_point_does_not_have_is_no_number_there(tmp_path: Path) -> None:
    file = solve(tmp_path / "v.h5", "--scan", "model.speed=0 m/s,2 m/s", "--set", "model.samples=3")
    assert np.isnan(file["entry/findings/radius"][0]) and np.isfinite(file["entry/findings/radius"][1])
    assert np.isfinite(file["entry/findings/precession"][:]).all()


def test_run_prints_every_finding_that_any_point_of_a_scan_has(tmp_path: Path) -> None:
    done = rabiline("run", CYLINDER, "-o", tmp_path / "p.h5", "--scan", "model.speed=0 m/s:2 m/s:3", "--set",
                    "model.samples=101")
    assert done.returncode == 0
    lines = {line.split()[0]: line for line in done.stdout.splitlines() if line.startswith("  ")}
    assert lines["radius"].endswith(" m, at 2 of the points")
    assert "points" not in lines["precession"]
    with h5py.File(tmp_path / "p.h5") as file:
        assert set(lines) - {"over"} == {name.decode() for name in file["entry/findings/name"]}


def test_findings_say_what_is_expected_of_them(tmp_path: Path) -> None:
    with solve(tmp_path / "w.h5") as file:
        group = file["entry/findings"]
        words = dict(zip(group["name"].asstr(), group["expectation"].asstr()))
    assert {word: sum(w == word for w in words.values()) for word in set(words.values())} == {
        "supposed": 9, "conserved": 5, "closed_form": 3}
    assert words["fast_top"] == words["path_distance"] == words["radius"] == "supposed"
    told = rabiline("run", CYLINDER, "-o", tmp_path / "w2.h5").stdout
    for name, expected in (("precession", ", closed form 0.636930805 rad/s"), ("energy_balance", ", conserved"),
                           ("fast_top", ", the paper supposes 0"), ("tilt", ", closed form 0.00641692022 rad")):
        line = next(line for line in told.splitlines() if line.split()[0] == name)
        assert expected in line, line


def test_an_angle_may_be_180_degrees(tmp_path: Path) -> None:
    particle, charge = ROOT / "beamline" / "charged-particle.yaml", ROOT / "beamline" / "bound-charge.yaml"
    for file, key in ((particle, "pitch"), (particle, "spin_angle"), (charge, "inclination")):
        for value in ("180 deg", "3.141592653589793 rad"):
            checked = rabiline("check", file, "--set", f"model.{key}={value}")
            assert checked.returncode == 0, checked.stderr
        refused = rabiline("check", file, "--set", f"model.{key}=180.001 deg")
        assert refused.returncode == 2 and "between 0 and 180 deg" in refused.stderr


def test_a_missing_key_is_suggested_as_the_example_of_its_model_has_it(tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text("rabiline: 1\nmodel: {kind: rotating_cylinder}\n")
    told = rabiline("check", tmp_path / "m.yaml").stderr
    for help in ("mass: 1 kg", "radius: 5 cm", "torque: {kind: body_fixed, size: 0.5 N m}", "spin: 100 Hz"):
        assert f"add `{help}`" in told, told
    (tmp_path / "b.yaml").write_text("rabiline: 1\nmodel: {kind: bound_charge, species: H atom}\n")
    told = rabiline("check", tmp_path / "b.yaml").stderr
    assert "add `binding: {kind: coulomb, charge: 1 e, radius: 100 nm}`" in told


def test_help_says_that_a_file_may_hold_a_model() -> None:
    for verb in ("run", "check"):
        assert "an experiment or a model" in rabiline(verb, "--help").stdout
    assert "or a model" not in rabiline("trace", "--help").stdout


@pytest.mark.parametrize("scan", [(), ("--scan", "model.spin=50 Hz:100 Hz:3"),
                                  ("--scan", "model.axis_start=at_rest,precessing")])
@pytest.mark.slow
def test_viewers_plot_the_file_and_so_does_plot_motion(tmp_path: Path, scan: tuple[str, ...]) -> None:
    path = tmp_path / "m.h5"
    with solve(path, *scan) as file:
        nexus_test.check_root(file)
        nexus_test.check_datasets(file)
        for group in nexus_test.groups_of_class(file, "NXdata"):
            nexus_test.check_data(group)
        default = nexus_test.get_default(file)
        assert default.group.name == ("/entry/findings" if scan else "/entry/paper")
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "analysis")}
    subprocess.run([sys.executable, "-m", "rabiline", "plot-motion", path, "-o", tmp_path / "m.png"], check=True,
                   env=environment)
    assert (tmp_path / "m.png").stat().st_size > 10000


def test_check_tells_the_derived_numbers() -> None:
    told = rabiline("check", CYLINDER)
    assert told.returncode == 0
    for line in ("Omega      0.63662 rad/s", "r          3.142 m", "fast top   0.003209", "nutation   31.58 Hz"):
        assert line in told.stdout, line


def test_what_has_no_meaning_for_a_model_is_refused(tmp_path: Path) -> None:
    output = tmp_path / "x.h5"
    for option, value in (("--threads", "2"), ("--isa", "avx2"), ("--progress", "none"), ("--batch", "8")):
        refused = rabiline("run", CYLINDER, "-o", output, option, value)
        assert (refused.returncode, refused.stderr) == (
            2, f"error: {option} has no meaning for a model: it is solved, not flown\n  help: omit it\n")
    for option in ("--particles", "--seed"):
        refused = rabiline("run", CYLINDER, "-o", output, option, "7")
        assert refused.returncode == 2
        assert f"`{option[2:]}` has no meaning for a model: it is solved, not flown" in refused.stderr
    traced = rabiline("trace", CYLINDER, "-o", output)
    assert traced.returncode == 2 and "which has no beam and no particles" in traced.stderr
    assert rabiline("resume", output).returncode == 3
    assert not output.exists()


def test_describe_explains_models_and_their_example_runs(tmp_path: Path) -> None:
    told = rabiline("describe", "rotating_cylinder")
    assert told.returncode == 0 and "N m" in told.stdout
    example = told.stdout.split("Example\n")[1]
    (tmp_path / "e.yaml").write_text("rabiline: 1\n" + example.replace("  model", "model"))
    assert rabiline("run", tmp_path / "e.yaml", "-o", tmp_path / "e.h5").returncode == 0
    assert "rotating_cylinder" in rabiline("describe").stdout

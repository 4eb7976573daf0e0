"""Deflecting magnets: where they stand, and forces that turn over."""
import re
from pathlib import Path

import h5py
import numpy as np
import pytest
from fields_test import experiment, run
from runs import rabiline

CROSSING = """rabiline: 1
species: K-39 atom
law: quantum
source:
  speed: {{kind: single, value: {speed} m/s}}
  opening: {{width: 0 mm, height: 0 mm}}
  direction: parallel
  spin: {{kind: levels, levels: ["F=2 m=+2"]}}
parts:
  - {{name: A, kind: gradient_magnet, at: 0.1 m, length: 0.1 m, field: {field}, gradient: 100 T/m}}
  - {{name: D, kind: detector, at: 0.6 m, radius: 1 m, bins: [1, 1], tallies: [{{name: place, axes: [{{quantity: z, from: -0.1 m, to: 0.1 m, bins: 1}}]}}]}}
particles: 2
seed: 1
"""


def test_magnets_that_stand_one_inside_the_other_are_told_of(tmp_path: Path) -> None:
    magnet = "kind: multipole_magnet, length: 10 cm, poles: 6, radius: 1 cm, pole_field: 1 T"
    path = experiment(tmp_path, f"{magnet}}}\n  - {{name: S, at: 1.05 m, {magnet}")
    assert "the magnets `F` and `S` stand one inside the other from 1.05 m to 1.1 m" in run("check", path).stdout
    path.write_text(path.read_text().replace("1.05 m", "1.1 m"))
    assert "one inside" not in run("check", path).stdout


def test_a_drive_before_a_magnet_is_refused_where_gravity_acts_along_the_beam(tmp_path: Path) -> None:
    path = experiment(tmp_path, "kind: rotating_field, length: 5 cm, amplitude: 0.2 mT, frequency: 30 kHz, sense: co, phase: locked}\n  - {name: M, kind: gradient_magnet, "
                      "at: 1.5 m, length: 0.05 m, field: 1 T, gradient: 1000 T/m")
    path.write_text(path.read_text() + "gravity: {acceleration: 9.81 m/s^2, direction: y}\n")
    out = run("run", path, "-o", tmp_path / "out.h5")
    assert out.returncode == 2 and "gravity acts along the beam" in out.stderr


@pytest.mark.parametrize("speed", [400, 200, 100])
def test_the_force_on_a_level_turns_over_where_the_field_of_its_magnet_vanishes(tmp_path: Path, speed: float) -> None:
    def lands(field: str) -> float:
        (tmp_path / "a.yaml").write_text(CROSSING.format(speed=speed, field=field))
        done = run("run", tmp_path / "a.yaml", "-o", tmp_path / "a.h5")
        assert done.returncode == 0, done.stderr
        with h5py.File(tmp_path / "a.h5") as file:
            return file["entry/D_place/z_mean"][...].item()

    stay, behind = 0.1 / speed, 0.4 / speed
    pull = abs(lands("3 T")) / (stay**2 / 2 + stay * behind)  # towards weaker fields, of constant size
    z, v, left = 0.3e-3, 0.0, stay  # from where the field of 30 mT vanishes
    while left > 0:
        side = np.sign(z or v)
        until = min(left, (side * v + np.sqrt(v * v + 2 * pull * abs(z))) / pull)
        z, v, left = (z + v * until - side * pull * until**2 / 2 if until == left else 0.0), v - side * pull * until, left - until
    assert lands("30 mT") == pytest.approx(z - 0.3e-3 + v * behind, rel=3e-6, abs=1e-9)


FRINGED = """rabiline: 1
species: {{name: silver, mass: 107.87 u, charge: 0 e, spin: 1/2, gyromagnetic_ratio: -28 GHz/T}}
law: {law}
source: {{speed: {{kind: single, value: 600 m/s}}, opening: {{radius: 0.2 mm}}, direction: parallel, spin: {{kind: populations, values: [0.5, 0.5]}}}}
parts:
  - {{name: M, at: 0.1 m, length: 0.1 m, kind: {magnet}}}
  - {{name: D, kind: detector, at: 0.6 m, width: 10 mm, height: 10 mm, bins: [5, 50]}}
particles: 500
seed: 1
"""
TANH = ", fringe: {kind: tanh, length: 4 mm}"


def image(folder: Path, magnet: str, law: str = "quantum") -> np.ndarray:
    """[x, z]"""
    (folder / "a.yaml").write_text(FRINGED.format(magnet=magnet, law=law))
    done = run("run", folder / "a.yaml", "-o", folder / "a.h5")
    assert done.returncode == 0, done.stderr
    with h5py.File(folder / "a.h5") as file:
        return file["entry/D/counts"][...]


@pytest.mark.parametrize(("magnet", "field", "on_axis"), [
    ("gradient_magnet, field: 0.5 T, gradient: 300 T/m", "uniform_field, field: 0.5 T, gradient: {quadrupole: 300 T/m}", f"uniform_field, field: 0.5 T{TANH}"),
    ("multipole_magnet, poles: 6, radius: 2 mm, pole_field: 0.5 T", "multipole_field, poles: 6, radius: 2 mm, field: 0.5 T", "uniform_field, field: 0 T")])
def test_a_magnet_with_a_fringe_is_the_field_that_it_is_made_of(tmp_path: Path, magnet: str, field: str, on_axis: str) -> None:
    fringed = image(tmp_path, magnet + TANH)
    assert np.array_equal(fringed, image(tmp_path, field + TANH))
    hard = image(tmp_path, magnet)
    assert "fields that are followed along each path" not in run("check", tmp_path / "a.yaml").stdout
    assert abs(spread(fringed) - spread(hard)) < 0.01 * spread(hard)
    assert np.array_equal(image(tmp_path, magnet + TANH, "dorado"), image(tmp_path, on_axis, "dorado"))


@pytest.mark.parametrize("magnet", ["two_wire_magnet, half_distance: 6 mm, wire_radius: 1 mm, field: 3 T",
                                    "iron_magnet, half_distance: 6 mm, convex: 4 mm, concave: 11 mm, width: 12 mm, field: 3 T, offset: {x: 1 mm}, tilt: {y: 30 deg}"])
def test_magnets_of_two_wires_push_with_a_short_fringe_as_with_none(tmp_path: Path, magnet: str) -> None:
    fringed, inside = image(tmp_path, magnet + TANH), run("probe", tmp_path / "a.yaml", "--at", "1 mm, 150 mm, 0.7 mm").stdout
    hard, closed = image(tmp_path, magnet), run("probe", tmp_path / "a.yaml", "--at", "1 mm, 150 mm, 0.7 mm").stdout
    assert "fields that are followed along each path" not in run("check", tmp_path / "a.yaml").stdout
    assert abs(spread(fringed) - spread(hard)) < 0.02 * spread(hard) and spread(hard) > 1e-3  # edges focus a little
    ways = [re.search(r"B = \((.*), .*, (.*)\), ", said).groups() for said in (inside, closed)]
    assert ways[0] == ways[1]  # tilted and moved alike


@pytest.mark.parametrize(("magnet", "wall"), [
    ("gradient_magnet, field: 0.5 T, gradient: 300 T/m", ", gap: {width: 0.15 mm, height: 8 mm}"), ("multipole_magnet, poles: 6, pole_field: 0.5 T, radius: ", "")])
def test_the_walls_of_a_magnet_with_a_fringe_stop_what_touches_them(tmp_path: Path, magnet: str, wall: str) -> None:
    narrow = magnet + (wall or "0.1 mm")
    fringed, hard = image(tmp_path, narrow + TANH).sum(), image(tmp_path, narrow).sum()
    assert 0.75 * hard < fringed < 1.25 * hard and 0 < hard < 300


def spread(counts: np.ndarray) -> float:
    """[m] Root of the mean square of z."""
    z = (np.arange(50) - 24.5) * 0.2e-3
    return float(np.sqrt(np.sum(counts * z**2) / counts.sum()))


CHECKED = """rabiline: 1
species: Cs-133 atom
law: {{name: quantum, tolerance: {tolerance}}}
source:
  speed: {{kind: effusive, temperature: 400 K}}
  opening: {{radius: 0.5 mm}}
  direction: {{kind: box, x: 2 mrad, z: 2 mrad}}
parts:
  - {{name: A, at: 0.1 m, length: 0.2 m, {magnet}}}
  - {{name: D, kind: detector, at: 0.6 m, radius: 1 m, bins: [1, 1]}}
particles: 100
seed: 1
"""


@pytest.mark.parametrize("magnet", ["kind: multipole_magnet, poles: 6, radius: 5 mm, pole_field: 1 T", "kind: two_wire_magnet, half_distance: 3 mm, wire_radius: 2 mm, field: 1 T",
                                    "kind: gradient_magnet, field: 0.5 T, gradient: 100 T/m"])
def test_every_run_holds_its_magnets_against_an_independent_integration_to_any_tolerance(tmp_path: Path, magnet: str) -> None:
    for tolerance in (1e-6, 1e-10):
        (tmp_path / "a.yaml").write_text(CHECKED.format(magnet=magnet, tolerance=tolerance))
        done = run("run", tmp_path / "a.yaml", "-o", tmp_path / "a.h5")
        assert done.returncode == 0, done.stderr
        assert "are off by" not in done.stderr
        with h5py.File(tmp_path / "a.h5") as file:
            check = {name: number[()] for name, number in file["entry/field_check"].items()}
        assert check["particles"] > 5 and check["tolerance"] == tolerance and check["levels"] == check["spin"] == 0
        assert 1e-14 < check["place"] < tolerance and 1e-14 < check["direction"] < tolerance


@pytest.mark.parametrize("part", ["kind: gradient_magnet, length: 0.2 m, field: 0.03 mT, gradient: 2 mT/m, along: x, offset: {x: 2 mm, z: 1 mm}",
                                  "kind: multipole_magnet, length: 0.2 m, poles: 6, radius: 1 cm, pole_field: 1 mT"])
def test_probe_shows_the_field_of_a_magnet_that_flies(tmp_path: Path, part: str) -> None:
    # A magnet has no gradient under dorado: 0.03 mT - 2 mT/m x 2 mm on the axis along z, or nothing, wherever a particle is.
    path = experiment(tmp_path, part)
    with_gradient = run("probe", path, "--at", "1 mm,1.1 m,3 mm").stdout
    assert "gradient" in with_gradient
    path.write_text(path.read_text().replace("law: quantum", "law: dorado"))
    shown = {run("probe", path, "--at", at).stdout.split("B = ")[1].split("\n")[0] for at in ("1 mm,1.1 m,3 mm", "0 m,1.15 m,0 m")}
    assert len(shown) == 1 and with_gradient.count(shown.pop()) == 0


def test_check_says_all_of_the_axis_of_levels_that_a_fringe_finds(tmp_path: Path) -> None:
    """Beside the middle of a gradient, where the field of the fringe's tail has a part along the beam: B_x/B_z = G x/(B_0 - G z), and of a tail
    exp(2 y/l) B_y = (2/l) times the potential."""
    (tmp_path / "a.yaml").write_text(CROSSING.format(speed=500, field="0.5 T, offset: {x: 0.5 mm, z: 0.3 mm}, fringe: {kind: tanh, length: 8 mm}")
                                     .replace("K-39 atom", "{name: bare, mass: 40 u, charge: 0 e, spin: 1/2, gyromagnetic_ratio: -28.02495 GHz/T}")
                                     .replace('levels, levels: ["F=2 m=+2"]', "populations, axis: z, values: [1, 0]"))
    told = re.search(r"in one level along \[(.*)\]", run("check", tmp_path / "a.yaml").stdout)
    assert told is not None
    axis = np.array([float(one) for one in told[1].split(",")])
    x, z, b, g, rate = -0.5e-3, -0.3e-3, 0.5, 100.0, 2 / 8e-3
    field = np.array([-g * x, rate * (b * z + g * (z**2 - x**2) / 2), b + g * z])
    wanted = field / np.linalg.norm(field)
    assert axis[[0, 2]] == pytest.approx(wanted[[0, 2]], abs=2e-4) and axis[1] == pytest.approx(wanted[1], rel=0.01)  # the tail is one nearly


BESIDE = """rabiline: 1
species: K-39 atom
law: quantum
source: {{speed: {{kind: single, value: 500 m/s}}, opening: {{width: 0.01 mm, height: 0.01 mm}}, direction: parallel, offset: {{{source}}}}}
parts:
  - {{name: G, at: 0.05 m, length: 0.1 m, offset: {{{magnet}}}, {kind}}}
  - {{name: D, kind: detector, at: 0.8 m, width: 60 mm, height: 60 mm, bins: [1, 1]}}
particles: 8
seed: 1
"""


@pytest.mark.parametrize(("kind", "source", "magnet", "wrong"), [
    ("kind: gradient_magnet, field: 10 mT, gradient: 5 T/m", "z: 3 mm", "z: 3 mm", ""),
    ("kind: gradient_magnet, field: 10 mT, gradient: 5 T/m", "z: -3 mm", "z: 0 mm", "does not point along +z"),
    ("kind: multipole_magnet, poles: 6, pole_field: 1 T, radius: 5 mm", "x: 8 mm", "x: 8 mm", ""),
    ("kind: multipole_magnet, poles: 6, pole_field: 1 T, radius: 5 mm", "x: 8 mm", "x: 0 mm", "the beam's axis meets the wall of `G`"),
    ("kind: iron_magnet, field: 0.5 T, half_distance: 4 mm, convex: 3 mm, concave: 7 mm, width: 6 mm", "x: 8 mm", "x: 8 mm", "")])
def test_a_magnet_is_judged_where_the_source_looks(tmp_path: Path, kind: str, source: str, magnet: str, wrong: str) -> None:
    (tmp_path / "beside.yaml").write_text(BESIDE.format(kind=kind, source=source, magnet=magnet))
    done = rabiline("check", tmp_path / "beside.yaml")
    assert done.returncode == (2 if wrong else 0) and wrong in done.stderr, done.stderr


def test_spins_are_sorted_along_the_field_where_the_beam_is(tmp_path: Path) -> None:
    """In a quadrupole 3 mm beside its axis the field lies across that on the axis of the apparatus: half of the spins go each way."""
    spread = []
    for source, part in (("x: 3 mm", "x: 0 mm"), ("x: 0 mm", "x: -3 mm")):
        (tmp_path / "beside.yaml").write_text(BESIDE.format(source=source, magnet=part, kind="kind: multipole_field, poles: 4, field: 1 T, radius: 6 mm")
                                              .replace("K-39 atom", "neutron").replace("500 m/s", "300 m/s").replace("particles: 8", "particles: 200")
                                              .replace("direction: parallel,", "direction: parallel, spin: {kind: polarised, axis: z, degree: 1},")
                                              .replace("bins: [1, 1]", "bins: [1, 1], tallies: [{name: across, axes: [{quantity: x, from: -30 mm, to: 30 mm, bins: 60}]}]"))
        assert rabiline("run", tmp_path / "beside.yaml", "-o", tmp_path / "a.h5").returncode == 0
        with h5py.File(tmp_path / "a.h5") as file:
            spread.append(float(file["entry/D_across/x_deviation"][0]))
    assert spread[0] > 3e-4 and spread[0] == pytest.approx(spread[1], rel=1e-3)

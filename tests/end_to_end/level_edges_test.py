"""Levels of atoms where drives and static fields begin and end at the same place: as a hair's breadth beside it."""
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from experiments import RABILINE
from runs import rabiline

HAIR = 1e-7  # [m]

ATOM = """rabiline: 1
species: {species}
law: quantum
source:
  speed: {{kind: single, value: {speed} m/s}}
  opening: {{radius: 0 mm}}
  offset: {{x: {offset}, z: {offset}}}
  direction: parallel
  spin: {start}
parts:
{parts}
  - {{name: m, kind: monitor, at: {asked} m, radius: 1 m, tallies: [{{name: found, axes: [level]}}]}}
  - {{name: d, kind: detector, at: 0.4 m, radius: 1 m, bins: [1, 1]}}
particles: 8
seed: 1
"""


def levels(folder: Path, parts: list[str], start: str, asked: float = 0.2, species: str = "D atom", speed: float = 1500,
           offset: str = "0 m") -> np.ndarray:
    spin = start if start.startswith("{") else f"{{kind: levels, levels: [{start}]}}"
    path = folder / "levels.yaml"
    path.write_text(ATOM.format(parts="\n".join(f"  - {{{part}}}" for part in parts), start=spin, asked=asked, species=species, speed=speed,
                                offset=offset))
    assert rabiline("run", path, "-o", path.with_suffix(".h5")).returncode == 0
    with h5py.File(path.with_suffix(".h5")) as file:
        return file["entry/m_found/counts"][:].ravel() / 8


def drive(at: float, amplitude: str = "100 uT", frequency: str = "5 MHz") -> str:
    return (f"name: R, kind: oscillating_field, at: {at!r} m, length: 1 cm, amplitude: {amplitude}, direction: x, frequency: {frequency}, "
            "approximation: none, phase: 20 deg")


@pytest.mark.parametrize("amplitude", ["10 uT", "30 uT", "100 uT"])
def test_a_drive_that_begins_where_the_size_of_a_static_field_changes_mixes_no_F(tmp_path: Path, amplitude: str) -> None:
    fields = ["name: B1, kind: uniform_field, at: 0 m, length: 0.1 m, field: 0.1 T", "name: B2, kind: uniform_field, at: 0.1 m, length: 0.2 m, field: 1 mT"]
    at_once, behind = (levels(tmp_path, [*fields, drive(0.1 + by, amplitude)], "F=3/2 m=-1/2") for by in (0, HAIR))
    assert behind[2] > 0.99
    assert np.abs(at_once - behind).max() < 2e-4


def test_a_drive_that_ends_where_the_size_of_a_static_field_changes_mixes_no_F(tmp_path: Path) -> None:
    fields = ["name: B1, kind: uniform_field, at: 0 m, length: 0.1 m, field: 1 mT", "name: B2, kind: uniform_field, at: 0.1 m, length: 0.2 m, field: 0.1 T"]
    at_once, before = (levels(tmp_path, [*fields, drive(0.09 - by)], "F=3/2 m=-1/2") for by in (0, HAIR))
    assert before[4:].sum() < 1e-3
    assert np.abs(at_once - before).max() < 2e-3


def test_levels_at_the_end_of_a_drive_are_those_of_the_static_field(tmp_path: Path) -> None:
    field = "name: B, kind: uniform_field, at: 0 m, length: 0.3 m, field: 1 mT"
    at_once, behind = (levels(tmp_path, [field, drive(0.1, frequency="9 MHz")], "F=3/2 m=3/2", asked) for asked in (0.11, 0.11 + HAIR))
    assert 0.1 < behind[0] < 0.5
    assert np.abs(at_once - behind).max() < 1e-5


def test_levels_at_a_source_inside_a_drive_are_those_of_the_static_field(tmp_path: Path) -> None:
    found = levels(tmp_path, [
        "name: B, kind: uniform_field, at: 0 m, length: 0.05 m, field: 99.818 uT, direction: [-0.428, 0.054, 0.885], tilt: {x: -11.11 deg, y: 4.3 deg, z: 34.08 deg}",
        "name: P, kind: rotating_field, at: 0 m, length: 6.6 mm, amplitude: 29.31 uT, frequency: 2797280 Hz, sense: negative, phase: 166.6 deg, "
        "tilt: {x: -18.88 deg, y: 17.13 deg, z: 37.14 deg}"], "F=1 m=1", 0.03, "He-4(2S)", 1000)
    # Schroedinger's equation of the spin 1 in the laboratory, by scipy's DOP853 with a tolerance of 1e-12.
    assert np.abs(found - [0.23125, 0.49927, 0.26948]).max() < 2e-5


@pytest.mark.parametrize("gap", [0, HAIR], ids=["touching", "behind a gap"])
@pytest.mark.parametrize("magnet_first", [False, True], ids=["before a magnet", "behind a magnet"])
def test_a_spin_stays_where_a_tilted_field_meets_a_magnet(tmp_path: Path, magnet_first: bool, gap: float) -> None:
    length = 0.11
    tilted = f"name: B, kind: uniform_field, at: {0.02 + gap if magnet_first else 0!r} m, length: {length} m, field: 1 mT, direction: [1, 0, 1]"
    magnet = f"name: A, kind: gradient_magnet, at: {0 if magnet_first else length + gap!r} m, length: 0.02 m, field: 0.1 T, gradient: 0.01 T/m"
    found = levels(tmp_path, [tilted, magnet], "F=3/2 m=3/2", 0.1 if magnet_first else 0.2)
    # d of J = 3/2 by 45 degrees; in 1 mT F are mixed a little.
    c, s = np.cos(np.pi / 8) ** 2, np.sin(np.pi / 8) ** 2
    assert np.abs(found[:4] - [c**3, 3 * c**2 * s, 3 * c * s**2, s**3]).max() < 1e-3


@pytest.mark.parametrize("speed", [1000, 2000, 3000])
def test_levels_keep_their_phase_in_a_gap_without_a_field(tmp_path: Path, speed: float) -> None:
    def found(approximations: tuple[str, str], between: str) -> np.ndarray:
        zones = [part for number, (at, own, how) in enumerate(((0.1, "frequency: 177.571 MHz, phase: locked", approximations[0]), (0.16, "oscillator: R1, phase: locked", approximations[1])), 1)
                 for part in (f"name: C{number}, kind: uniform_field, at: {at} m, length: 3 cm, field: 10 uT",
                              f"name: R{number}, kind: oscillating_field, at: {at + 0.01} m, length: 1 cm, amplitude: 3.57 uT, direction: z, {own}, approximation: {how}")]
        guide = f"name: G, kind: uniform_field, at: 0.13 m, length: 3 cm, field: {between}"
        return levels(tmp_path, [*zones, *([guide] if between else [])], "F=0 m=0", asked=0.3, species="H(2S) atom", speed=speed)

    whole = found(("none", "none"), "")
    assert 0.02 < whole[1] < 0.4
    assert np.abs(whole - found(("none", "none"), "1 nT")).max() < 1e-6
    for approximations in (("rotating_wave", "rotating_wave"), ("none", "rotating_wave"), ("rotating_wave", "none")):
        assert np.abs(whole - found(approximations, "")).max() < 1e-3


@pytest.mark.parametrize("to", ["z", "[0.01, 0, 1]", "x"])
def test_a_guide_field_that_begins_and_ends_at_once_mixes_no_F(tmp_path: Path, to: str) -> None:
    guide = f"name: g, kind: guide_field, at: 0.05 m, length: 0.1 m, field: 50 mT, from: z, to: {to}"
    inside, behind = (levels(tmp_path, [guide], "F=1 m=0", asked, species="H atom", speed=1000) for asked in (0.12, 0.2))
    assert inside[1] > 0.9999 and inside[3] < 1e-6 and behind[3] < 1e-6


def test_a_guide_field_is_the_static_field_of_its_formula(tmp_path: Path) -> None:
    box = "width: 1 cm, height: 1 cm, length: 0.1 m, step: 1 mm"  # too short for levels to follow
    ways = ("name: g, kind: guide_field, at: 0.05 m, length: 0.1 m, field: 0.3 uT, from: z, to: x",
            f"name: g, kind: formula_field, at: 0.05 m, formula: {{Bx: A*sin(k*y), Bz: A*cos(k*y), constants: {{A: 0.3 uT, k: {np.pi / 0.2} 1/m}}, {box}}}")
    guide, formula = (levels(tmp_path, [way], "F=1 m=+1", 0.14, species="H atom", speed=1000) for way in ways)
    assert 0.1 < guide[0] < 0.9
    assert np.abs(guide - formula).max() < 1e-5


@pytest.mark.parametrize("at", ["0.3", "0.9"])
def test_the_far_tail_of_a_fringe_gives_levels_no_axis(tmp_path: Path, at: str) -> None:
    fields = ["name: C, kind: uniform_field, at: 0.05 m, length: 1.5 m, field: 10 uT",
              f"name: X, kind: uniform_field, at: {at} m, length: 0.3 m, field: 1 uT, direction: x, fringe: {{kind: tanh, length: 45 mm}}"]
    found = levels(tmp_path, fields, "F=3 m=+3", 0.06, species="Rb-85 atom", speed=300)  # at 0.3 m about 1 pT are at the source
    assert found[0] > 0.9999


RISING = """rabiline: 1
species: {species}
law: quantum
source:
  speed: {{kind: single, value: 3000 m/s}}
  opening: {{radius: {radius}}}
  direction: parallel
  spin: {{kind: levels, levels: [{start}]}}
parts:
  - {{name: B, kind: uniform_field, at: 0.1 m, length: 0.2 m, field: 20 uT, direction: [0.6, 0, 0.8], {shape}}}
  - {{name: d, kind: detector, at: 0.6 m, radius: 1 m, bins: [1, 1]}}
particles: 4
seed: 1
"""


@pytest.mark.parametrize(("species", "start"), [("H(2S) atom", "F=1 m=1"), ("D atom", "F=3/2 m=1/2")])
@pytest.mark.parametrize("shape", ["profile: half_sine", "fringe: {kind: sine, length: 5 cm}"])
@pytest.mark.parametrize("radius", ["1 nm", "1 um", "30 um", "1 mm"])
def test_a_field_that_rises_from_zero_turns_levels_as_fast_as_it_does_beside_the_axis(tmp_path: Path, species: str, start: str, shape: str,
                                                                                      radius: str) -> None:
    """Where it begins it points along the beam, and a few radii farther it points as it does on the axis."""
    path = tmp_path / "rising.yaml"
    path.write_text(RISING.format(species=species, start=start, shape=shape, radius=radius))
    done = rabiline("run", path, "-o", path.with_suffix(".h5"))
    assert done.returncode == 0 and "warning" not in done.stderr, done.stderr
    with h5py.File(path.with_suffix(".h5")) as file:
        check = file["entry/field_check"]
        assert check["particles"][()] > 0 and check["levels"][()] < 1e-6


def test_a_field_that_is_nothing_at_one_place_of_the_way_is_followed_on_both_sides_of_it(tmp_path: Path) -> None:
    """Half-way along, where a search for where it begins might stop, on the axis, or a micrometre farther."""
    found = [levels(tmp_path, ["name: C1, kind: uniform_field, at: 0.05 m, length: 0.05 m, field: 20 uT, direction: [0.6, 0, 0.8]",
                               f"name: F, kind: formula_field, at: 0.1 m, formula: {{Bx: '{shape}', Bz: '{shape}', constants: {{A: 20 uT, L: 0.1 m}}, "
                               "width: 2 mm, height: 2 mm, length: 0.2 m, step: 1 mm}",
                               "name: C2, kind: uniform_field, at: 0.3 m, length: 0.05 m, field: 20 uT, direction: y"], "F=3/2 m=1/2", 0.38, speed=3000)
             for shape in ("A*((y-L)/L)^2", "A*((y-L-1e-5*L)/L)^2")]
    assert 0.1 < found[0][0] < 0.5
    assert np.abs(found[0] - found[1]).max() < 1e-6


def test_a_field_that_swings_beside_the_axis_alone_takes_the_other_f_along(tmp_path: Path) -> None:
    """A quadrupole about atoms that fly 2.5 mm from its axis, where its field is nothing; numbers of an integration of both spins (DOP853)."""
    (tmp_path / "in.yaml").write_text("""rabiline: 1
title: beside the axis
species: H(2S) atom
law: quantum
source: {speed: {kind: single, value: 2000 m/s}, opening: {radius: 0 m}, direction: parallel, offset: {x: 2 mm, z: -1.5 mm}, spin: {kind: levels, levels: [F=1 m=0]}}
parts:
  - {name: H, kind: uniform_field, at: 0.02 m, length: 0.3 m, field: 0.2 mT}
  - {name: B, kind: multipole_field, at: 0.1 m, length: 0.1 m, field: 1 mT, poles: 4, radius: 10 mm, profile: half_sine, oscillates: {frequency: 2.8 MHz, phase: 30 deg}}
  - {name: D, kind: detector, at: 0.25 m, width: 200 mm, height: 200 mm, bins: [1, 1]}
particles: 1
seed: 1
""")
    done = rabiline("run", tmp_path / "in.yaml", "-o", tmp_path / "out.h5", "--threads", "1")
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "out.h5") as file:
        assert file["entry/D_levels/levels"][:] == pytest.approx([0.30937717, 0.43920113, 0.25142168, 1.8e-8], abs=1e-6)


def test_a_drive_at_half_of_a_line_acts_by_two_photons_where_the_field_is_not_along_z(tmp_path: Path) -> None:
    fields = ["name: C, kind: uniform_field, at: 0 m, length: 0.3 m, field: 3 mT", "name: S, kind: uniform_field, at: 0 m, length: 0.3 m, field: 1 uT, direction: x"]
    drive_at_half = ("name: R, kind: oscillating_field, at: 0.1 m, length: 4 cm, amplitude: 0.3 mT, frequency: 233.7502 MHz, direction: [1, 0, 1], phase: 0.7 rad, "
                     "approximation: ")
    turning, whole = (levels(tmp_path, [*fields, drive_at_half + how], "F=2 m=+1", species="K-39 atom", speed=1000) for how in ("rotating_wave", "none"))
    assert whole.max() == pytest.approx(0.871, abs=1e-3) and np.abs(turning - whole).max() < 1e-3


NARROW = "{name: X, mass: 30 u, charge: 0 e, structure: {I: 3/2, J: 1/2, coupling: 2 MHz, g_J: 2.0, g_I: -0.001}}"  # few periods between its F
BETWEEN_F = "name: R, kind: oscillating_field, at: 0.1 m, length: 0.1 m, amplitude: {} uT, frequency: {} MHz, phase: 10 deg, direction: z, approximation: {}"


@pytest.mark.parametrize(("field", "within"), [
    ("name: S, kind: oscillating_field, at: 0.1 m, length: 0.1 m, amplitude: 0.3 uT, frequency: 70 kHz, phase: 80 deg, direction: x, approximation: none", 2e-4),
    ("name: S, kind: oscillating_field, at: 0.1 m, length: 0.1 m, amplitude: 0.3 uT, frequency: 70 kHz, phase: 70 deg, direction: x, approximation: rotating_wave", 0.02),
    ("name: L, kind: current_loop, at: 0.15 m, radius: 3 mm, current: 20 mA, turns: 1, direction: x, reach: 50 mm, offset: {x: -0.5 mm, z: -0.3 mm}", 2e-4)])
def test_what_acts_within_F_acts_where_a_drive_in_the_rotating_wave_joins_two(tmp_path: Path, field: str, within: float) -> None:
    """All of it was left out without a word: the frame asked what static fields on the axis mix, and had the frequency of one drive."""
    still = "name: C, kind: uniform_field, at: 0 m, length: 0.4 m, field: 10 uT"
    turning, whole = (levels(tmp_path, [still, BETWEEN_F.format(0.1, 4.0098, how), field.replace("rotating_wave", how)], "F=1 m=0", 0.3, NARROW, 600)
                      for how in ("rotating_wave", "none"))
    assert 0.02 < whole[1] + whole[3] < 0.98 and np.abs(turning - whole).max() < within


def test_a_whole_drive_between_the_F_of_a_frame_that_turns_is_told_to_be_left_out(tmp_path: Path) -> None:
    drives = [BETWEEN_F.format(0.1, 4.0098, "rotating_wave"), BETWEEN_F.format(0.3, 4.075, "none").replace("name: R", "name: S").replace("direction: z", "direction: x")]
    levels(tmp_path, ["name: C, kind: uniform_field, at: 0 m, length: 0.4 m, field: 10 uT", *drives], "F=1 m=0", 0.3, NARROW, 600)
    assert "the rotating-wave approximation of `R` is poor" in rabiline("check", tmp_path / "levels.yaml").stdout


def test_a_box_of_field_turned_by_a_little_is_followed_to_its_end(tmp_path: Path) -> None:
    """Its faces are met inside the piece of the beam that holds it: the field was followed to the middle of that alone. The values at no tilt are those of
    the spin of one moment whose direction turns by DOP853, with the binomial shares of its angle."""
    box = ("name: Q, kind: formula_field, at: 0.05 m, formula: {Bx: 'b*cos(k*y)', By: 'b*sin(k*y)*0.6', Bz: '0.8*b*sin(k*y)', constants: {b: 0.2 uT, "
           "k: 25 rad/m}, width: 2 cm, height: 2 cm, length: 40 cm, step: 2 mm}, ")
    for tilt in ("z: 0 rad", "z: 1e-5 rad", "x: -1e-5 rad"):
        found = levels(tmp_path, [box + f"tilt: {{{tilt}}}"], "F=2 m=2", 0.39, "Rb-87 atom", 900)
        assert found[:5] == pytest.approx([0.0286, 0.1637, 0.3517, 0.3358, 0.1202], abs=4e-4), tilt
    behind = [levels(tmp_path, [box.replace("40 cm", "20 cm") + f"tilt: {{z: {tilt} rad}}"], "F=2 m=2", 0.39, "Rb-87 atom", 900) for tilt in (0, 1e-5)]
    assert behind[0].max() < 0.9 and behind[0] == pytest.approx(behind[1], abs=1e-4)


@pytest.mark.parametrize("tilt", ["z: 0 deg", "z: 2 deg", "z: -0.5 deg"])
def test_levels_keep_their_names_at_faces_that_are_met_aslant(tmp_path: Path, tilt: str) -> None:
    """As at all hard edges of static fields; the independent integration of the run does so too. The state alone would keep .53 of the first level."""
    box = ("name: M, kind: formula_field, at: 0.1 m, formula: {Bz: B0 + G*x, Bx: G*z, constants: {B0: 6 mT, G: 2 T/m}, width: 3 cm, height: 3 cm, "
           f"length: 10 cm, step: 2.5 mm}}, tilt: {{{tilt}}}")
    for asked in (0.15, 0.3):
        assert levels(tmp_path, [box], "F=1 m=0", asked, "H(2S) atom", 300000) == pytest.approx([0, 1, 0, 0], abs=1e-5)
    assert "off by" not in rabiline("run", tmp_path / "levels.yaml", "-o", tmp_path / "again.h5").stderr


@pytest.mark.parametrize("seed", [3088, 3097, 3195])
def test_steps_see_what_passes_between_their_points(seed: int) -> None:
    """3.8e-5 where steps passed by a coil's zero, 9e-6 where one ended in the last cell of a map that falls to nothing, 1.7e-6 where the
    slope of a map was taken from points in a few of its cells, 3e-6 where F of a large moment exchange amplitudes."""
    script = Path(__file__).resolve().parents[2] / "tools" / "random-levels"
    told = subprocess.run([script, RABILINE, "--boxes", "--first", str(seed), "--count", "1"], capture_output=True, text=True, check=False)
    assert told.returncode == 0 and told.stdout.startswith("1 of 1 set-ups compared"), told.stdout + told.stderr


def test_a_field_that_begins_to_turn_slowly_but_ever_faster_is_followed(tmp_path: Path) -> None:
    """What turns levels by the slope of the field is nothing where that begins, and by its curvature is much."""
    turning = 'name: M, kind: formula_field, at: 0.05 m, formula: {Bx: "0.001*sin(pi*y/0.1)^2", width: 1 cm, height: 1 cm, length: 0.1 m, step: 0.25 mm}'
    found = levels(tmp_path, [turning, "name: B, kind: uniform_field, at: 0 m, length: 0.3 m, field: 50 uT"], "F=1/2 m=-1/2", 0.25, "D(2S) atom", 75000)
    # Schroedinger's equation of I and J in the laboratory, by scipy's DOP853 with a tolerance of 1e-10.
    assert np.abs(found - [0, 0, 0, 0, 0.870937, 0.129063]).max() < 2e-6


@pytest.mark.parametrize(("course", "tilt"), [("profile: half_sine", "x: 0.5 deg"), ("fringe: {kind: sine, length: 4 cm}", "x: 3 deg, z: -4 deg")])
def test_where_a_tilted_field_begins_and_ends_an_atom_turns_as_a_point_spin(tmp_path: Path, course: str, tilt: str) -> None:
    """Beside its axis the field jumps on a face that leans."""
    parts = [f"name: P, kind: multipole_field, at: 0.05 m, length: 0.2 m, poles: 4, field: 400 uT, radius: 10 mm, {course}, tilt: {{{tilt}}}",
             "name: B, kind: uniform_field, at: 0.01 m, length: 0.37 m, field: 20 uT, direction: [0.2, 0, 1]"]
    atom = "{name: X, mass: 1e6 u, charge: 0 e, structure: {I: 0, J: 1/2, g_J: -0.0015, g_I: 0}}"
    point = "{name: X, mass: 1e6 u, charge: 0 e, spin: 1/2, gyromagnetic_ratio: 20994367.37565 Hz/T}"
    found = levels(tmp_path, parts, "F=1/2 m=1/2", 0.39, atom, 400, offset="2 mm")
    as_point = levels(tmp_path, parts, "{kind: populations, axis: z, values: [1, 0]}", 0.39, point, 400, offset="2 mm")
    assert 0.05 < found[0] < 0.95 and np.abs(found - as_point).max() < 2e-5


@pytest.mark.parametrize(("species", "speed", "start", "formula", "step", "guide"), [
    ("{I: 2, J: 3/2, coupling: 4.6961 MHz, g_J: 2.002, g_I: -0.001}", 11711.45, "F=7/2 m=3/2",
     "7.00856e-05*sin(pi*y/0.1)^2*cos(80*y)", "0.3 mm", "field: 0.013252 mT, direction: [0.3, 0, 1]"),
    ("{I: 3/2, J: 1/2, coupling: 4.4194 MHz, g_J: 2.002, g_I: -0.001}", 1155.8, "F=2 m=2", "0.000265453*sin(pi*y/0.1)^4", "0.25 mm", "field: 0.017405 mT")], ids=["F that nearly keep to themselves", "phases alone"])
def test_what_levels_leave_out_along_a_field_of_sines_is_within_the_tolerance(tmp_path: Path, species: str, speed: float, start: str, formula: str, step: str,
                                                                              guide: str) -> None:
    """As an independent integration of the whole Hamiltonian finds."""
    parts = [f'name: M, kind: formula_field, at: 0.05 m, formula: {{Bx: "{formula}", width: 1 cm, height: 1 cm, length: 0.1 m, step: {step}}}',
             f"name: B, kind: uniform_field, at: 0 m, length: 0.35 m, {guide}"]
    levels(tmp_path, parts, start, 0.3, f"{{name: Y, mass: 4 u, charge: 0 e, structure: {species}}}", speed)
    with h5py.File(tmp_path / "levels.h5") as file:
        assert file["entry/field_check/levels"][()] < 2e-7

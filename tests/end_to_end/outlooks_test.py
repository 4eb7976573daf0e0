"""What `check` reckons before a flight, against closed forms and what a flight gives."""
import re
import subprocess
from pathlib import Path

import h5py
import pytest

from experiments import RABILINE
from level_filters_test import HEAD

NEUTRONS = """rabiline: 1
title: neutrons
species: neutron
law: quantum
source:
  speed: {kind: single, value: %s m/s}
  opening: {width: 1 mm, height: 1 mm}
  direction: parallel
  spin: {kind: polarised, axis: %s, degree: 1}
parts:
%s
particles: 400
seed: 1
"""
ATOM = HEAD + """%s
  - {name: det, kind: detector, at: 0.1 m, width: 40 mm, height: 40 mm, bins: [1, 1], tallies: [{name: st, axes: [level]}]}
particles: 1
seed: 7
"""
OWN = "{name: my, mass: 20 u, charge: 0 e, structure: {I: 3/2, J: 1/2, coupling: 30 MHz, g_J: 2.002, g_I: -0.001}}"
METRES = {"pm": 1e-12, "nm": 1e-9, "um": 1e-6, "µm": 1e-6, "mm": 1e-3, "m": 1.0}


def check(folder: Path, text: str, verb: str = "check", *options: str) -> subprocess.CompletedProcess:
    (folder / "in.yaml").write_text(text)
    return subprocess.run([RABILINE, verb, folder / "in.yaml", *options], capture_output=True, text=True, timeout=100)


def run(folder: Path, text: str) -> h5py.Group:
    done = check(folder, text, "run", "-o", str(folder / "out.h5"))
    assert done.returncode == 0, done.stderr
    return h5py.File(folder / "out.h5")["entry"]


def parts(told: str) -> list[float]:
    """[pi, sigma+, sigma-] of the first field [uT]."""
    found = re.search(r"pi (\S+) (\S?T), sigma\+ (\S+) (\S?T), sigma- (\S+) (\S?T)", told)
    scale = {"T": 1e6, "mT": 1e3, "uT": 1.0, "nT": 1e-3, "pT": 1e-6}
    return [float(found[i]) * scale[found[i + 1]] for i in (1, 3, 5)]


@pytest.mark.parametrize("more", ["", "  - {name: L, at: 1.2 m, kind: current_loop, radius: 5 cm, field: 1 uT}\n"])
def test_paths_split_by_where_the_gradient_stands_and_not_by_what_else_is_flown_through_in_steps(tmp_path: Path, more: str) -> None:
    told = check(tmp_path, NEUTRONS % (200, "x", "  - {name: GF, at: 0 m, length: 2.4 m, kind: uniform_field, field: 20 uT}\n" + more +
                 "  - {name: U, at: 2.1 m, length: 0.1 m, kind: uniform_field, field: 0.1 mT, gradient: {quadrupole: 1 T/m}}\n"
                 "  - {name: A, at: 2.4 m, kind: spin_filter, axis: x, up: 1, down: 0}\n"
                 "  - {name: D, kind: detector, at: 2.41 m, width: 40 cm, height: 40 cm, bins: [10, 10]}")).stdout
    moment, mass, length, lever = 9.6623651e-27, 1.67492750056e-27, 0.1, 0.21
    expected = 2 * moment / mass * (length**2 / 2 + length * lever) / 200**2
    number, unit = re.search(r"paths come apart by (\S+) (\S?m) ", told).groups()
    assert abs(float(number) * METRES[unit] / expected - 1) < 0.003, told


def test_what_falls_along_the_beam_is_reckoned_at_the_speed_that_it_has_there(tmp_path: Path) -> None:
    text = NEUTRONS.replace("seed: 1", "seed: 1\ngravity: {acceleration: 9.81 m/s^2, direction: -y}") % (7, "z",
        "  - {name: U, at: 1 m, length: 1 m, kind: uniform_field, field: 2 uT}\n"
        "  - {name: R, at: 1.5 m, length: 0.2 m, kind: rotating_field, amplitude: 0.5 uT, frequency: 58.33 Hz, sense: co, phase: locked}\n"
        "  - {name: D, kind: detector, at: 2.1 m, width: 40 cm, height: 40 cm, bins: [1, 1], tallies: [{name: st, axes: [level]}]}")
    told = check(tmp_path, text).stdout
    flip = float(re.search(r"flip probability of spin 1/2 here (\S+)", told)[1])
    flown = run(tmp_path, text)["D_levels/levels"][1]
    assert abs(flown - 0.666) < 0.001 and abs(flip - flown) < 0.002


@pytest.mark.parametrize("turned", ["direction: y, tilt: {x: 1 deg}", "direction: x", "direction: z", "direction: [0, 0.6, 0.8]"])
def test_nothing_has_left_a_map_in_front_of_it_or_behind(tmp_path: Path, turned: str) -> None:
    rows = [f"{r},{z},0,{1 + r * r / 1e4}" for r in range(0, 31, 5) for z in range(-120, 121, 10)]
    (tmp_path / "round.csv").write_text("\n".join(["r [mm],z [mm],Br [uT],Bz [uT]", *rows]) + "\n")
    text = NEUTRONS.replace("width: 1 mm, height: 1 mm", "width: 10 mm, height: 10 mm") % (800, "z",
        f"  - {{name: M, at: 0.3 m, kind: field_map, map: round.csv, outside: error, {turned}}}\n"
        "  - {name: D, kind: detector, at: 0.6 m, width: 40 cm, height: 40 cm, bins: [1, 1]}")
    assert run(tmp_path, text)["instrument/D/data"][:].sum() == 400
    aside = text.replace("width: 10 mm, height: 10 mm", "width: 10 mm, height: 400 mm").replace("map: round.csv", "offset: {x: 31 mm}, map: round.csv")
    if turned != "direction: x":
        assert run(tmp_path, aside)["instrument/D/data"][:].sum() < 400


@pytest.mark.parametrize("static, tilt, expected", [
    ("direction: x", "0 deg", (20, 10, 10)), ("direction: [0, 1, 1]", "0 deg", (14.142, 17.071, 2.929)), ("direction: z", "30 deg", (10, 18.660, 1.340))])
def test_a_rotating_field_has_its_parts_about_the_static_one(tmp_path: Path, static: str, tilt: str, expected: tuple[float, ...]) -> None:
    text = ATOM % ("Na-23 atom", "F=2 m=2", f"  - {{name: C, kind: uniform_field, at: 0 m, length: 0.2 m, field: 1 mT, {static}}}\n"
                   "  - {name: R, kind: rotating_field, at: 0.02 m, length: 0.005 m, amplitude: 20 uT, frequency: 6.91518 MHz, sense: positive, "
                   f"phase: locked, tilt: {{x: {tilt}}}}}")
    told = check(tmp_path, text)
    assert "drives no transition" not in told.stdout and parts(told.stdout) == pytest.approx(expected, abs=2e-3)


def test_what_check_says_that_a_field_across_its_axis_flips_is_flown(tmp_path: Path) -> None:
    text = ATOM % (OWN, "F=2 m=2", "  - {name: C, kind: uniform_field, at: 0 m, length: 0.2 m, field: 0.3 mT, direction: [1, 0, 0.2]}\n"
                   "  - {name: R, kind: rotating_field, at: 0.02 m, length: 0.02 m, amplitude: 0.4 uT, frequency: FREQUENCY, sense: positive, phase: locked}")
    line = re.search(r"F=2 m=\+2 - F=2 m=\+1 at (\S+) MHz", check(tmp_path, text.replace("FREQUENCY", "2 MHz")).stdout)[1]
    text = text.replace("FREQUENCY", f"{line} MHz")
    flips = float(re.search(r"F=2 m=\+2 - F=2 m=\+1 at .*, alone it flips ([0-9.]+)", check(tmp_path, text).stdout)[1])
    flown = run(tmp_path, text)["det_levels/levels"][:]
    assert 0.02 < flips < 0.5 and abs(flown[1] - flips) < 0.007 * flips


def test_two_fields_whose_photons_together_meet_a_line_are_told(tmp_path: Path) -> None:
    drive = ("  - {name: %s, kind: oscillating_field, at: 0.02 m, length: 0.04 m, direction: %s, amplitude: 30 uT, frequency: %s MHz, "
             "approximation: rotating_wave, phase: locked}")
    text = ATOM % (OWN, "F=1 m=0", "\n".join(["  - {name: C, kind: uniform_field, at: 0 m, length: 0.2 m, field: 0.3 mT}",
                                              drive % ("R", "x", 40), drive % ("S", "z", 37.980600)]))
    poor = r"the rotating-wave approximation of `R` and `S` is poor: amplitudes up to (\S+) are left out"
    left_out = float(re.search(poor, check(tmp_path, text).stdout)[1])
    flown = run(tmp_path, text.replace("approximation: rotating_wave", "approximation: none"))["det_levels/levels"][:]
    assert abs(left_out - flown[5]**0.5) < 0.006 and run(tmp_path, text)["det_levels/levels"][5] < 1e-6
    assert not re.search(poor, check(tmp_path, text.replace("amplitude: 30 uT", "amplitude: 1 uT")).stdout)


def test_what_swings_is_told_at_its_largest(tmp_path: Path) -> None:
    for phase in ("0 deg", "90 deg", "random"):
        told = check(tmp_path, NEUTRONS % (800, "z", f"  - {{name: L, at: 0.3 m, reach: 0.1 m, kind: current_loop, radius: 2 cm, field: 1 mT, oscillates: {{frequency: 3 kHz, phase: {phase}}}}}\n"
                     "  - {name: D, kind: detector, at: 0.6 m, width: 4 cm, height: 4 cm, bins: [1, 1]}")).stdout
        largest = re.search(r"up to (\S+) uT on the axis", told)
        assert "up to 1 mT on the axis" in told or float(largest[1]) > 999, told


@pytest.mark.parametrize("drives", [0, 1])
def test_precession_about_a_field_that_turns_is_told_by_its_size(tmp_path: Path, drives: int) -> None:
    told = check(tmp_path, NEUTRONS % (900, "z", "  - {name: W, kind: guide_field, at: 0.1 m, length: 0.5 m, field: 1 mT, from: z, to: [0.02, 0, -1]}\n" + drives *
                 "  - {name: R, kind: oscillating_field, at: 0.3 m, length: 0.1 m, amplitude: 10 uT, frequency: 30 kHz, approximation: none, direction: y, phase: locked}\n" +
                 "  - {name: D, kind: detector, at: 0.8 m, width: 60 mm, height: 60 mm, bins: [1, 1]}")).stdout
    rates = re.findall(r"Larmor (\S+ \S+),", told)
    assert rates and set(rates) == {"29.16 kHz"}, told


def test_the_precession_in_a_pair_of_coils_that_swings_is_that_of_both_together(tmp_path: Path) -> None:
    rabiline = pytest.importorskip("rabiline", reason="without the Python package")
    swings = ", oscillates: {frequency: 29 kHz, phase: 50 deg}"
    text = NEUTRONS % (900, "z", "  - {name: G, kind: uniform_field, at: 0.1 m, length: 0.5 m, field: 0.9 mT}\n"
                       f"  - {{name: L, kind: coil_pair, at: 0.35 m, radius: 60 mm, field: 30 uT, direction: x, reach: 0.12 m{swings}}}\n"
                       "  - {name: D, kind: detector, at: 0.8 m, width: 60 mm, height: 60 mm, bins: [1, 1]}")
    turned = float(re.search(r"oscillates at 29 kHz, (\S+) deg", check(tmp_path, text).stdout)[1])
    places = [(0.0, 0.23 + 0.24 * (i + 0.5) / 400, 0.0) for i in range(400)]
    steady = rabiline.load(text.replace(swings, "")).field(places)["L"]
    assert turned == pytest.approx(360 * 29.1646935e6 * (steady**2).sum(axis=1).__pow__(0.5).mean() * 0.24 / 900, rel=1e-3)


@pytest.mark.parametrize(("sense", "plus", "minus"), [("", 0.3, 0.0), ("-", 0.0, 0.3)])
def test_cosine_and_sine_of_one_formula_drive_levels_together(tmp_path: Path, sense: str, plus: float, minus: float) -> None:
    told = check(tmp_path, f"""rabiline: 1
species: Rb-87 atom
law: quantum
source: {{speed: {{kind: single, value: 900 m/s}}, opening: {{radius: 1 nm}}, direction: parallel, spin: {{kind: levels, levels: [F=2 m=+2]}}}}
parts:
  - {{name: G, kind: uniform_field, at: 0.1 m, length: 0.5 m, field: 60 uT}}
  - {{name: Fo, kind: formula_field, at: 0.3 m, formula: {{Bx: 'A*cos(2*pi*f*t)', By: '{sense}A*sin(2*pi*f*t)', constants: {{A: 0.3 uT, f: 419.7 kHz}}, width: 8 mm,
     height: 8 mm, length: 0.1 m, step: 2 mm, frequency: 419.7 kHz, phase: locked}}}}
  - {{name: D, kind: detector, at: 0.8 m, width: 60 mm, height: 60 mm, bins: [1, 1]}}
particles: 10
seed: 9
""").stdout
    _, up, down = parts(told)
    assert (up, down) == pytest.approx((plus, minus), abs=1e-3), told
    assert ("Rabi frequency 4.197 kHz" in told) == (plus > 0) and "as Fo does" not in told


@pytest.mark.parametrize("field", ["tan(pi/2)", "1e20"])
def test_what_would_fly_for_ever_has_a_cost_all_the_same(tmp_path: Path, field: str) -> None:
    """Far more turns than the field on the axis of the first of them lets one reckon: some fly for two seconds at most."""
    done = check(tmp_path, NEUTRONS % (50, "z", f"  - {{name: Q, kind: formula_field, at: 0.2 m, formula: {{Bz: '{field}', width: 1 cm, height: 1 cm, length: 10 cm, "
                                                "step: 2 mm}}\n  - {name: D, kind: detector, at: 1.2 m, width: 40 mm, height: 40 mm, bins: [1, 1]}"))
    assert done.returncode == 0 and float(re.search(r"cost +about (\S+) s", done.stdout)[1]) > 10, done.stderr


def test_a_line_that_one_photon_drives_is_told_no_shift_by_two(tmp_path: Path) -> None:
    """At 16 kHz, the frequency of the line itself, Omega^2/4 delta is no shift: 29 kHz of it were told."""
    told = check(tmp_path, """rabiline: 1
species: Rb-87 atom
law: quantum
source: {speed: {kind: single, value: 300 m/s}, opening: {radius: 1 nm}, direction: parallel, spin: {kind: levels, levels: [F=2 m=2]}}
parts:
  - {name: G, kind: uniform_field, at: 0.1 m, length: 0.3 m, field: 2.29 uT, direction: [0.4, 0.2, 1]}
  - {name: RF, kind: oscillating_field, at: 0.15 m, length: 0.2 m, amplitude: 0.4 uT, direction: x, frequency: 16 kHz, approximation: none, phase: 30 deg, profile: half_sine}
  - {name: D, kind: detector, at: 0.5 m, width: 20 mm, height: 20 mm, bins: [1, 1]}
particles: 6
seed: 1
""").stdout
    assert "Rabi frequency" in told and "by two photons" not in told, told


DRESSED = """rabiline: 1
title: a microwave, and beside it a radio frequency
species: {name: X, mass: 10 u, charge: 0 e, structure: {I: 3/2, J: 1/2, coupling: 1 MHz, g_J: 2, g_I: -0.001}}
law: quantum
source:
  speed: {kind: single, value: 150 m/s}
  opening: {width: 0 mm, height: 0 mm}
  direction: parallel
  spin: {kind: levels, levels: [F=1 m=0]}
parts:
  - {name: C, kind: uniform_field, at: 0.1 m, length: 0.5 m, field: 10 uT}
  - {name: R, kind: oscillating_field, at: 0.2 m, length: 0.3 m, direction: z, amplitude: 0.69 uT, frequency: 2.019513 MHz, approximation: FIRST, phase: 30 deg}
  - {name: S, kind: oscillating_field, at: 0.2 m, length: 0.3 m, direction: x, amplitude: 0.03 uT, frequency: 67.2 kHz, approximation: SECOND, phase: 80 deg}
  - {name: det, kind: detector, at: 0.55 m, width: 40 mm, height: 40 mm, bins: [1, 1]}
particles: 1
seed: 1
"""


def test_a_weak_drive_on_the_line_of_levels_that_a_strong_one_dresses_is_followed(tmp_path: Path) -> None:
    """S is 2.8 kHz off the line of the bare levels, and R splits them by 9.7 kHz. Whole fields are an independent way to fly, and of these there are
    F=2 m=0, F=2 m=-1, F=1 m=0 and F=1 m=-1 by Dormand and Prince's integration of the 8 levels in the laboratory."""
    def flown(first: str, second: str) -> h5py.Dataset:
        return run(tmp_path, DRESSED.replace("FIRST", first).replace("SECOND", second))["det_levels/levels"][:]
    exact = flown("none", "none")
    assert abs(flown("rotating_wave", "rotating_wave") - exact).max() < 0.02
    assert exact[[2, 3, 6, 7]] == pytest.approx([0.1832, 0.3610, 0.3355, 0.1190], abs=1e-4)  # without S, m=0 has all


def test_whole_fields_beside_waves_are_told_to_be_lost(tmp_path: Path) -> None:
    told = check(tmp_path, DRESSED.replace("150 m/s", "1000 m/s").replace("FIRST", "none").replace("SECOND", "rotating_wave")).stdout
    assert "its frame does not follow whole fields that drive at the same place: give all of them the same `approximation`" in told


def test_choppers_and_guides_that_are_not_seen_as_one_expects_are_told(tmp_path: Path) -> None:
    chopped = NEUTRONS.replace("  spin:", "  rate: 1e6 1/s\n  spin:") % (800, "z", "  - {name: ch, kind: chopper, at: 0.2 m, open: 5 %, frequency: 50 Hz}\n"
                                                                       "  - {name: D, kind: detector, at: 0.6 m, width: 4 cm, height: 4 cm, bins: [1, 1]}")
    unpulsed = "all particles start at t = 0: behind `ch` rates are not those of a beam that flows all the time"
    assert unpulsed in check(tmp_path, chopped).stdout
    assert unpulsed not in check(tmp_path, chopped.replace("  spin:", "  pulse: {shape: rectangle, length: 20 ms}\n  spin:")).stdout
    guided = NEUTRONS % (300, "z", "  - {name: G, kind: guide_field, at: 0.3 m, length: 0.3 m, field: 0.1 mT, from: z, to: x}\n"
                         "  - {name: D, kind: detector, at: 1 m, width: 4 cm, height: 4 cm, bins: [1, 1], tallies: [{name: ad, axes: [{quantity: adiabaticity, from: 0, to: 100, bins: 10}]}]}")
    closed = "`G` turns spins by a closed form: it is not among them"
    assert closed in check(tmp_path, guided).stdout
    assert closed not in check(tmp_path, guided.replace("to: x}", "to: x, fringe: {kind: tanh, length: 10 mm}}")).stdout


def test_a_misspelt_key_is_told_once_and_a_topic_may_be_named_with_its_kind(tmp_path: Path) -> None:
    told = check(tmp_path, DRESSED.replace("2.019513 MHz", "2 MHz").replace("frequency: 67", "frequenzy: 67").replace("FIRST", "none").replace("SECOND", "none"))
    assert told.returncode == 2 and "did you mean `frequency`?" in told.stderr and "needs `frequency`" not in told.stderr
    described = subprocess.run([RABILINE, "describe", "law", "quantum"], capture_output=True, text=True)
    assert described.returncode == 0 and described.stdout.startswith("quantum (law): ")
    assert "default -z" in subprocess.run([RABILINE, "describe", "gravity"], capture_output=True, text=True).stdout


def test_what_is_left_out_counts_for_each_pulse(tmp_path: Path) -> None:
    def left_out(times: int) -> float:
        text = ATOM % (OWN, "F=2 m=2", "  - {name: C, kind: uniform_field, at: 0 m, length: 0.2 m, field: 0.3 mT}\n"
                       "  - {name: R, kind: oscillating_field, at: 0.02 m, length: 0.04 m, direction: [1, 0, 0.5], amplitude: 1 uT, frequency: 2.1 MHz, "
                       f"approximation: rotating_wave, phase: locked, sweep: {{to: 2.2 MHz, begin: 20 us, end: 60 us}}, pulses: {{begin: 22 us, end: 24 us, period: 4 us, times: {times}}}}}")
        return float(re.search(r"amplitudes? up to ([0-9.e-]+)", check(tmp_path, text).stdout)[1])
    assert left_out(4) == pytest.approx(4 * left_out(1), rel=0.05)

"""Fields as formulas in place and time."""
from pathlib import Path

import h5py
import numpy as np
import pytest
from fields_test import BOX, experiment, levels_of, run

BESIDE = "}\n  - {name: B, kind: uniform_field, at: 1 m, length: 20 cm, field: 1 mT"


def of_formula(folder: Path, formula: str, name: str = "formula.yaml", beside: str = BESIDE, rest: str = "") -> Path:
    return experiment(folder, f"kind: formula_field, formula: {{{formula}, {BOX}}}{rest}{beside}", name)


def same_levels(one: Path, other: Path, within: float = 2e-6) -> None:
    levels = [levels_of(one), levels_of(other)]
    assert 0.05 < levels[0][0] < 0.95
    assert np.abs(levels[0] - levels[1]).max() < within


@pytest.mark.parametrize(("period", "coarse"), [("1 mm", True), ("0.25 mm", True), ("50 mm", False)])
def test_check_says_what_is_missed_between_the_places_of_a_formula(tmp_path: Path, period: str, coarse: bool) -> None:
    box = "width: 1 cm, height: 1 cm, length: 10 cm, step: 1 mm"  # with which the period may agree
    path = experiment(tmp_path, f"kind: formula_field, formula: {{Bz: B0*cos(2*pi*y/P), constants: {{B0: 1 mT, P: {period}}}, {box}}}")
    assert ("is coarse" in run("check", path).stdout) == coarse


@pytest.mark.parametrize("phase", ["locked", "70 deg", "random"])
def test_a_formula_with_t_turns_as_the_rotating_field_that_it_states(tmp_path: Path, phase: str) -> None:
    formula = of_formula(tmp_path, f"Bx: A*cos(2*pi*f*t), By: A*sin(2*pi*f*t), constants: {{A: 40 uT, f: -29.2 kHz}}, frequency: 29.2 kHz, phase: {phase}")
    turning = experiment(tmp_path, "kind: rotating_field, length: 20 cm, amplitude: 40 uT, frequency: 29.2 kHz, sense: negative, "
                         f"phase: {phase.replace('70', '-70')}" + BESIDE, "turning.yaml")
    same_levels(formula, turning)


def test_a_wave_along_the_beam_has_the_frequency_that_a_particle_meets(tmp_path: Path) -> None:
    wavelength, speed = 0.23, 1000.0  # from the part's begin, 1 m behind the source
    formula = of_formula(tmp_path, f"Bx: A*cos(2*pi*(f*t - y/L)), constants: {{A: 80 uT, f: 33.6 kHz, L: {wavelength} m}}, frequency: 33.6 kHz")
    met = 33.6e3 - speed / wavelength
    swinging = experiment(tmp_path, f"kind: oscillating_field, length: 20 cm, amplitude: 80 uT, frequency: {met!r} Hz, phase: {2 * np.pi / wavelength!r} rad, "
                          "approximation: none" + BESIDE, "swinging.yaml")
    same_levels(formula, swinging)


def test_a_formula_has_several_harmonics_of_its_frequency(tmp_path: Path) -> None:
    f = 29.2e3 / 3
    formula = of_formula(tmp_path, f"Bx: A*cos(2*pi*f*t)^3, Bz: B*sin(2*pi*f*t)^2, constants: {{A: 160 uT, B: 30 uT, f: {f} Hz}}, frequency: {f} Hz, phase: 25 deg")
    # cos^3 a = (3 cos a + cos 3a)/4, sin^2 a = (1 - cos 2a)/2
    drive = "kind: oscillating_field, length: 20 cm, approximation: none"
    sum_of_them = experiment(tmp_path, f"{drive}, amplitude: 120 uT, frequency: {f} Hz, phase: 25 deg}}\n"
                             f"  - {{name: F3, {drive}, at: 1 m, amplitude: 40 uT, frequency: {3 * f} Hz, phase: 75 deg}}\n"
                             f"  - {{name: F2, {drive}, at: 1 m, direction: z, amplitude: 15 uT, frequency: {2 * f} Hz, phase: 230 deg}}\n"
                             "  - {name: F0, kind: uniform_field, at: 1 m, length: 20 cm, field: 15 uT" + BESIDE, "sum.yaml")
    same_levels(formula, sum_of_them)


def test_a_phase_that_is_drawn_is_that_of_all_harmonics(tmp_path: Path) -> None:
    # Across no other field the spin turns about x, by gamma A times the integral of cos(wt + p) + cos(2wt + 2p) over a quarter of the period.
    turn, quarter = 2.0, 2e-4
    w = np.pi / 2 / quarter
    path = of_formula(tmp_path, f"Bx: A*(cos(2*pi*f*t) + cos(4*pi*f*t)), constants: {{A: {turn * w / 1.83247172e8!r} T, f: {w / 2 / np.pi!r} Hz}}, frequency: {w / 2 / np.pi!r} Hz, "
                      "phase: random", beside="")
    path.write_text(path.read_text().replace("particles: 100", "particles: 10000").replace("direction: parallel", "direction: parallel\n  spin: {kind: polarised, axis: z, degree: 1}"))
    p = np.linspace(0, 2 * np.pi, 4096, endpoint=False)

    def flipped(double: np.ndarray) -> float:
        return np.mean(np.sin(turn / 2 * (np.cos(p) - np.sin(p) - np.sin(double))) ** 2)

    found = 1 - levels_of(path)[0]
    assert abs(found - flipped(2 * p)) < 4 * 0.5 / 100
    assert abs(flipped(p) - flipped(2 * p)) > 8 * 0.5 / 100  # were it added to the angle of each


def test_probe_tells_a_formula_at_a_time(tmp_path: Path) -> None:
    path = of_formula(tmp_path, "Bx: G*z*cos(2*pi*f*t), Bz: G*x*cos(2*pi*f*t), constants: {G: 1 T/m, f: 10 kHz}, frequency: 10 kHz", beside="")
    for time, size in (("0 s", "2 mT"), ("20 us", "618 uT"), ("50 us", "-2 mT")):
        assert size in run("probe", path, "--at", "0 m,1.1 m,2 mm", "--time", time).stdout


def test_an_electric_formula_is_the_electric_field_that_it_states(tmp_path: Path) -> None:
    beside = BESIDE.replace("1 mT", "1 uT") + "}\n  - {name: H0, kind: rotating_field, at: 1.02 m, length: 4 cm, amplitude: 100 uT, frequency: 29.2 Hz, sense: co, phase: locked"
    paths = [of_formula(tmp_path, "Ex: E0*(1 + 0*z), Ez: -E0/2, constants: {E0: 1 MV/m}", beside=beside),
             experiment(tmp_path, f"kind: electric_field, length: 20 cm, field: {1e6 * 1.25 ** 0.5!r} V/m, direction: [1, 0, -0.5]" + beside, "plates.yaml")]
    for path in paths:
        path.write_text(path.read_text().replace("species: neutron", "species: {name: n, mass: 1.00866491606 u, charge: 0 e, spin: 1/2, gyromagnetic_ratio: -29.1646935 MHz/T, "
                                                 "electric_dipole_moment: 1e-15 e cm}"))
        assert "1 MV/m" in run("probe", path, "--at", "0 m,1.1 m,0 m").stdout
    same_levels(*paths)
    without = experiment(tmp_path, "kind: uniform_field, length: 20 cm, field: 0 T" + beside, "without.yaml")
    assert np.abs(levels_of(without) - levels_of(paths[0])).max() > 1e-3


@pytest.mark.parametrize(("formula", "rest", "message", "help_"), [
    ("Bz: 1e-3*t", "", "`t` is not a place", "repeat in time, `frequency: 10 kHz`, or how long"),
    ("Bz: 1e-3, frequency: 10 kHz", "", "no component has t: the field stands", "omit `frequency`"),
    ("Bz: 1e-3*exp(-t*1e4), frequency: 10 kHz", "", "do not repeat with this frequency in four harmonics", "slowest part"),
    ("Bz: 1e-3*cos(2*pi*1.5e4*t), frequency: 10 kHz", "", "do not repeat with this frequency in four harmonics", "slowest part"),
    ("Bz: 1e-3*cos(2*pi*17e4*t), frequency: 10 kHz", "", "do not repeat with this frequency in four harmonics", "slowest part"),
    ("Bz: 1e-3, phase: random", "", "a formula without a frequency has no phase", "state `frequency`"),
    ("Bz: 1e-3*cos(2*pi*1e4*t), frequency: 10 kHz", ", oscillates: {frequency: 10 kHz, phase: locked}", "`oscillates` would multiply them", "into the formulas"),
    ("Ez: 1e3, Bz: 1e-3", "", "components of B and of E", "two parts"),
    ("Ez: 1e3, frequency: 10 kHz", "", "electric fields stand still", "omit `frequency`"),
    ("Ez: 1e3", ", oscillates: {frequency: 10 kHz, phase: locked}", "is an electric field, and these stand still", "omit `oscillates`"),
    ("Bz: 1e-3, duration: 2 ms", "", "no component has t: the field stands", "omit `duration`"),
    ("Bz: 1e-3*(t > 1e-3), duration: 2 ms", "", "the formulas jump in t", "a steep slope"),
    ("Bz: 1e-3*exp(-((y - 100*t)/0.01)^2), duration: 2 ms", "", "no sum of up to eight fields with a course in time each", "state `frequency` instead"),
    ("Bz: 1e-3*cos(2*pi*1e4*t), frequency: 10 kHz, duration: 2 ms", "", "a formula with a frequency repeats, and has no duration", "omit `duration`"),
    ("Bz: 1e-3*t, duration: 2 ms, phase: random", "", "a formula without a frequency has no phase", "omit `phase`"),
    ("Bz: 1e-3*t, duration: 2 ms", ", oscillates: {frequency: 10 kHz, phase: locked}", "`oscillates` would multiply them", "into the formulas"),
    ("Ez: 1e3*t, duration: 2 ms", "", "electric fields stand still", "omit `duration`"),
    ("Bz: 1e-3/(t - 1e-3), duration: 2 ms", "", "the formula has no finite value", "finite there"),
    ("Bz: 1e-3*t, duration: 0 s", "", "`duration` must be greater than zero", ""),
])
def test_what_is_wrong_with_a_formula_in_time_has_its_place(tmp_path: Path, formula: str, rest: str, message: str, help_: str) -> None:
    out = run("check", of_formula(tmp_path, formula, rest=rest))
    assert out.returncode == 2
    assert message in out.stderr and help_ in out.stderr and ":9:" in out.stderr, out.stderr


LEVELS = "\n  spin: {kind: levels, levels: [F=1 m=1]}"


@pytest.mark.parametrize("scale", [1.0, 0.0])
def test_levels_of_an_atom_are_driven_by_a_formula_as_by_oscillating_fields_of_its_size(tmp_path: Path, scale: float) -> None:
    static = "}\n  - {name: B, kind: uniform_field, at: 0.9 m, length: 40 cm, field: 20 uT"
    formula = of_formula(tmp_path, "Bx: A*cos(2*pi*f*t), By: A/2*sin(2*pi*f*t), constants: {A: 3 uT, f: 286 kHz}, frequency: 286 kHz, phase: 20 deg",
                         rest=f", scale: {scale}", beside=static)
    drive = "kind: oscillating_field, length: 20 cm, frequency: 286 kHz, approximation: none"
    fields = experiment(tmp_path, f"{drive}, amplitude: {3 * scale} uT, phase: 20 deg}}\n  - {{name: Y, at: 1 m, {drive}, amplitude: {1.5 * scale} uT, direction: y, phase: -70 deg"
                        + static, "fields.yaml")
    for path in (formula, fields):
        path.write_text(path.read_text().replace("species: neutron", "species: H atom").replace("direction: parallel", "direction: parallel" + LEVELS))
    levels = [levels_of(path) for path in (formula, fields)]
    assert np.abs(levels[0] - levels[1]).max() < 1e-6
    assert levels[0].max() < 0.9 if scale > 0 else levels[0].max() > 1 - 1e-9


def test_levels_of_an_atom_through_a_map_that_swings_end_where_nothing_may_leave_it(tmp_path: Path) -> None:
    path = of_formula(tmp_path, "Bx: 1e-6*cos(2*pi*1e4*t), frequency: 10 kHz", rest=", outside: error")
    path.write_text(path.read_text().replace("species: neutron", "species: H atom").replace("width: 0.2 mm, height: 0.2 mm", "width: 14 mm, height: 2 mm")
                    .replace("particles: 100", "particles: 2000").replace("direction: parallel", "direction: parallel" + LEVELS))
    levels_of(path)
    with h5py.File(path.with_suffix(".h5")) as file:
        left = file["entry/fates/particles"][:][file["entry/fates/fate"][:] == b"left_map"].sum()
    assert abs(left / 2000 - 4 / 14) < 0.05

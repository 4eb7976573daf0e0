"""Fields with a clock that rise and fall beyond their ends, against Bloch's equation in the field of that curve."""
from pathlib import Path

import h5py
import numpy as np
import pytest
from fields_test import experiment, levels_of, run
from one_spin_test import of_atom
from scipy.integrate import solve_ivp

GAMMA = -2 * np.pi * 29.1646935e6  # [rad/(s T)] of a neutron
SPEED, BEGIN, END, EDGE = 1000.0, 1.2, 1.35, 0.012  # [m/s], [m] of the drive, and the length of its fringe
FREQUENCY, AMPLITUDE, STATIC = 29.4e3, 90e-6, 1e-3  # [Hz], [T], [T]
GUIDE = f"kind: uniform_field, length: 0.6 m, field: {STATIC} T"
DRIVE = f"length: {END - BEGIN} m, amplitude: {AMPLITUDE} T, fringe: {{kind: tanh, length: {EDGE} m}}"
SHORT = ", fringe: {kind: sine, length: 1 um}"


def curve(y: complex) -> complex:
    return (1 - np.tanh((BEGIN - y) / EDGE)) / 2 * (1 - np.tanh((y - END) / EDGE)) / 2


def up(field) -> float:
    """The probability that a spin along z is that in the end; field(y, t) [T] beside the guide's."""
    def rate(t: float, s: np.ndarray) -> list[float]:
        bx, by, bz = field(SPEED * t, t)
        bz += STATIC
        return [GAMMA * (s[1] * bz - s[2] * by), GAMMA * (s[2] * bx - s[0] * bz), GAMMA * (s[0] * by - s[1] * bx)]

    spin = solve_ivp(rate, (1 / SPEED, 1.6 / SPEED), (0, 0, 1), "DOP853", rtol=1e-10, atol=1e-11).y[:, -1]
    return (1 + spin[2]) / 2


def on_axis(path: Path, offset: float = 0) -> Path:
    path.write_text(path.read_text().replace("opening: {width: 0.2 mm, height: 0.2 mm}", "opening: {radius: 1 nm}\n  spin: {kind: polarised, axis: z, degree: 1}\n"
                                             f"  offset: {{x: {offset} m}}"))
    return path


def test_an_oscillating_field_has_a_part_along_the_beam_beside_its_axis(tmp_path: Path) -> None:
    x, phase = 2e-3, np.pi / 6

    def field(y: float, t: float) -> np.ndarray:  # of the potential Im F(y + ix), F' the curve
        f = AMPLITUDE * np.cos(2 * np.pi * FREQUENCY * t + phase) * curve(y + 1j * x)
        return f.real, f.imag, 0

    path = experiment(tmp_path, GUIDE + f"}}\n  - {{name: RF, kind: oscillating_field, at: {BEGIN} m, frequency: {FREQUENCY} Hz, phase: 30 deg, approximation: none, " + DRIVE)
    found = levels_of(on_axis(path, x))[0]
    assert 0.05 < found < 0.95
    assert found == pytest.approx(up(field), abs=3e-6)
    with h5py.File(path.with_suffix(".h5")) as file:
        assert file["entry/field_check/spin"][()] < 1e-6
    atom = of_atom(path)
    atom.write_text(atom.read_text().replace("{kind: polarised, axis: z, degree: 1}", "{kind: levels, levels: [F=1/2 m=+1/2]}"))
    assert levels_of(atom)[0] == pytest.approx(found, abs=2e-6)


@pytest.mark.parametrize(("sense", "turns", "amplitude"), [("co", 1, AMPLITUDE), ("counter", -1, 20 * AMPLITUDE)])
def test_a_rotating_field_turns_on_its_axis_as_it_does_without_a_fringe(tmp_path: Path, sense: str, turns: int, amplitude: float) -> None:
    def field(y: float, t: float) -> np.ndarray:
        azimuth = turns * 2 * np.pi * FREQUENCY * t + 0.4
        return amplitude * curve(y).real * np.array([np.cos(azimuth), np.sin(azimuth), 0])

    path = experiment(tmp_path, GUIDE + f"}}\n  - {{name: H0, kind: rotating_field, at: {BEGIN} m, frequency: {FREQUENCY} Hz, sense: {sense}, phase: 0.4 rad, "
                      + DRIVE.replace(f"{AMPLITUDE} T", f"{amplitude} T"))
    assert levels_of(on_axis(path))[0] == pytest.approx(up(field), abs=3e-6)


@pytest.mark.parametrize("phase", ["random", "20 deg"])
@pytest.mark.parametrize("kind", ["rotating_field, sense: counter", "rotating_field, sense: co", "oscillating_field, approximation: none"])
def test_a_short_fringe_is_a_hard_edge_whoever_follows_whose_clock(tmp_path: Path, kind: str, phase: str) -> None:
    shared, levels = "length: 3 cm, amplitude: 250 uT", []
    for number, fringes in enumerate([("", ""), (SHORT, ""), ("", SHORT)]):
        follower = kind.partition(", sense")[0]
        path = experiment(tmp_path, GUIDE + f"}}\n  - {{name: C1, at: 1.1 m, kind: {kind}, frequency: {FREQUENCY} Hz, phase: {phase}, {shared}{fringes[0]}}}"
                          f"\n  - {{name: C2, at: 1.4 m, kind: {follower}, oscillator: C1, phase: 50 deg, {shared}{fringes[1]}", f"{number}.yaml")
        levels.append(levels_of(on_axis(path))[0])
    assert ("counter" in kind) == (levels[0] > 0.97) and np.ptp(levels) < 1e-6


@pytest.mark.parametrize("kind", ["rotating_field, sense: co", "oscillating_field, approximation: none"])
def test_a_sweep_goes_on_in_a_fringe_and_in_those_that_follow(tmp_path: Path, kind: str) -> None:
    shared, swept, levels = "length: 10 cm, amplitude: 60 uT", "frequency: 28 kHz, sweep: {begin: 1.13 ms, end: 1.45 ms, to: 31 kHz}", []
    for number, fringes in enumerate([("", ""), (SHORT, ""), ("", SHORT)]):
        path = experiment(tmp_path, GUIDE + f"}}\n  - {{name: C1, at: 1.1 m, kind: {kind}, {swept}, phase: 20 deg, {shared}{fringes[0]}}}"
                          f"\n  - {{name: C2, at: 1.4 m, kind: {kind.partition(', sense')[0]}, oscillator: C1, phase: 50 deg, {shared}{fringes[1]}", f"{number}.yaml")
        levels.append(levels_of(on_axis(path))[0])
    assert levels[0] < 0.9 and np.ptp(levels) < 1e-6


def test_what_a_field_with_a_fringe_cannot_have_is_told(tmp_path: Path) -> None:
    for more, key in (("twist: 10 deg", "twist"), ("pulses: {begin: 1 ms, end: 2 ms}", "pulses"), ("profile: half_sine", "profile"),
                      ("phase_gradient: {x: 10 deg/mm}", "phase_gradient")):
        told = run("check", experiment(tmp_path, f"kind: rotating_field, sense: co, frequency: 1 kHz, phase: locked, {DRIVE}, {more}"))
        assert told.returncode == 2 and f"`F` cannot have both a `fringe` and `{key}`" in told.stderr, told.stderr
    told = run("check", experiment(tmp_path, f"kind: oscillating_field, approximation: rotating_wave, frequency: 1 kHz, phase: locked, {DRIVE}"))
    assert told.returncode == 2 and "`F` has a fringe, so that its whole field acts" in told.stderr and "write `approximation: none`" in told.stderr

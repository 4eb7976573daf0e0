"""Filters, polarizers and coils for atoms with levels."""
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

from experiments import RABILINE

HEAD = """rabiline: 1
title: levels
species: %s
law: quantum
source:
  speed: {kind: single, value: 1000 m/s}
  opening: {radius: 1 nm}
  direction: parallel
  spin: {kind: levels, levels: [%s]}
parts:
"""
SCREEN = """  - {name: behind, kind: detector, at: 0.5 m, width: 20 mm, height: 20 mm, bins: [1, 1]}
particles: 4000
seed: 1968
"""
HARD = "  - {name: B, kind: uniform_field, at: 0.1 m, length: 0.2 m, field: 10 mT}\n"
SOFT = HARD.replace("10 mT}", "10 mT, fringe: {kind: tanh, length: 5 mm}}")
PASS = "  - {name: F, kind: spin_filter, at: 0.2 m, levels: [%s], up: 0.9, down: 0.1}\n"
EVERY = "F=1 m=+1, F=1 m=0, F=1 m=-1, F=0 m=0"


def flown(path: Path, text: str) -> tuple[np.ndarray, h5py.File]:
    """[level] Of the emitted particles, what is detected in each level."""
    (path / "in.yaml").write_text(text)
    subprocess.run([RABILINE, "run", path / "in.yaml", "-o", path / "out.h5"], check=True, capture_output=True)
    file = h5py.File(path / "out.h5")
    caught = file["entry/instrument/behind/data"][:].sum() / 4000
    return np.asarray(file["entry/behind_levels/levels"][:]) * caught, file


def refused(path: Path, text: str) -> str:
    (path / "in.yaml").write_text(text)
    done = subprocess.run([RABILINE, "check", path / "in.yaml"], capture_output=True, text=True)
    assert done.returncode == 1 or done.returncode == 2, done.stdout
    return done.stderr


@pytest.mark.parametrize("field", ["", HARD, SOFT])
def test_a_filter_lets_named_levels_pass_and_the_others_as_it_says(tmp_path: Path, field: str) -> None:
    levels, file = flown(tmp_path, HEAD % ("H(2S) atom", EVERY) + field + PASS % "F=1 m=+1, F=0 m=0" + SCREEN)
    emitted = file["entry/fates/emitted_by_level"][0] / 4000
    assert levels == pytest.approx(emitted * [0.9, 0.1, 0.1, 0.9], rel=1e-9)
    names = [name.decode() for name in file["entry/fates/fate"][:]]
    stopped = file["entry/fates/particles_by_level"][names.index("stopped")].sum()
    assert stopped == pytest.approx(4000 * (emitted * [0.1, 0.9, 0.9, 0.1]).sum(), rel=1e-9)


def test_a_filter_finds_levels_and_ends_what_they_were_to_one_another(tmp_path: Path) -> None:
    """Between two turns of a line by the same angle, a filter that lets all levels pass leaves no interference of the two ways."""
    field = "  - {name: B, kind: uniform_field, at: 0.1 m, length: 0.3 m, field: 1 mT}\n"
    pulse = "  - {name: %s, kind: rotating_field, at: %s m, length: 0.05 m, amplitude: %s uT, %s}\n"
    first = pulse % ("RF1", 0.12, 0.2, "frequency: 13.8523026 MHz, sense: positive, phase: locked")

    def share(second: float, between: str = "") -> float:
        other = pulse % ("RF2", 0.27, second, "oscillator: RF1, phase: 0 deg")
        return float(flown(tmp_path, HEAD % ("H atom", "F=1 m=+1") + field + first + between + other + SCREEN)[0][0])

    stays = share(0)
    assert 0.05 < stays < 0.95
    open_filter = "  - {name: F, kind: spin_filter, at: 0.2 m, levels: [F=1 m=+1], up: 1, down: 1}\n"
    assert abs(share(0.2) - share(0.2, open_filter)) > 0.1
    with_it = share(0.2, open_filter)
    closed = "  - {name: F, kind: spin_filter, at: 0.2 m, levels: [F=1 m=+1], up: 1, down: 0}\n"
    assert share(0.2, closed) == pytest.approx(stays**2, abs=4 * np.sqrt(stays / 4000))
    assert with_it > share(0.2, closed)


@pytest.mark.parametrize(("atom", "against", "along"), [("H(2S) atom", "F=1 m=+1", "F=1 m=-1"), ("antihydrogen", "F=1 m=-1", "F=1 m=+1"),
                                                       ("K-39 atom", "F=2 m=+2", "F=2 m=-2")])
def test_a_polarizer_puts_atoms_into_the_levels_whose_moments_are_along_its_field(tmp_path: Path, atom: str, against: str, along: str) -> None:
    """The moment of the electron is against its spin, that of the positron along it. Behind the field levels are those along +z."""
    part = "  - {name: P, kind: polarizer, at: 0.1 m, length: 0.1 m, field: %s mT, alignment: 0.5}\n"
    for field in (10, -10):
        levels, file = flown(tmp_path, HEAD % (atom, along) + part % field + SCREEN)
        names = [name.decode() for name in file["entry/behind_levels/level_index_labels"][:]]
        expected, other = (along, against) if field > 0 else (against, along)
        assert levels[names.index(expected)] == pytest.approx(0.75, abs=4 * np.sqrt(0.75 * 0.25 / 4000))
        assert levels[names.index(expected)] + levels[names.index(other)] == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize("degrees", [60, 180])
def test_a_coil_turns_an_atom_without_a_nuclear_spin_by_its_angle(tmp_path: Path, degrees: int) -> None:
    """Spin 1: cos^4, 2 sin^2 cos^2 and sin^4 of half the angle, cos^4 (theta/2), sin^2(theta)/2, sin^4 (theta/2) (E. Majorana)."""
    levels, _ = flown(tmp_path, HEAD % ("He-4(2S)", "F=1 m=+1") +
                      f"  - {{name: C, kind: coil, at: 0.1 m, length: 0.1 m, axis: x, angle: {degrees} deg, speed: 1000 m/s}}\n" + SCREEN)
    half = np.radians(degrees) / 2
    assert levels == pytest.approx([np.cos(half) ** 4, np.sin(2 * half) ** 2 / 2, np.sin(half) ** 4], abs=1e-6)


def test_what_filters_and_coils_cannot_mean_is_told(tmp_path: Path) -> None:
    head = HEAD % ("H(2S) atom", "F=1 m=0")
    assert "has no level `F=3 m=0`" in refused(tmp_path, head + PASS % "F=3 m=0" + SCREEN)
    assert "is the level `F=1 m=0` again" in refused(tmp_path, head + PASS % "F=1 m=0, F=1 m=0" + SCREEN)
    assert "`levels: [F=1" in refused(tmp_path, head + PASS.replace("levels: [%s]", "axis: z") + SCREEN)
    assert "needs `axis` or `levels`" in refused(tmp_path, head + PASS.replace("levels: [%s], ", "") + SCREEN)
    neutron = head.replace("H(2S) atom", "neutron").replace("\n  spin: {kind: levels, levels: [F=1 m=0]}", "")
    assert "has one moment and no levels" in refused(tmp_path, neutron + PASS % "F=1 m=0" + SCREEN)
    coil = "  - {name: C, kind: coil, at: 0.1 m, length: 0.1 m, axis: x, angle: 90 deg, speed: 1000 m/s}\n"
    assert "has two, I and J" in refused(tmp_path, head + coil + SCREEN)
    tilted = PASS.replace("levels:", "tilt: {x: 90 deg}, levels:") % "F=1 m=0"
    assert "omit `tilt`" in refused(tmp_path, head + tilted + SCREEN)


def test_a_path_says_what_filters_have_left_of_its_particle(tmp_path: Path) -> None:
    (tmp_path / "in.yaml").write_text(HEAD % ("H atom", EVERY) + HARD + PASS % "F=1 m=+1" + SCREEN)
    subprocess.run([RABILINE, "trace", tmp_path / "in.yaml", "-n", "40", "-o", tmp_path / "tracks.h5"], check=True, capture_output=True)
    one = subprocess.run([RABILINE, "trace", tmp_path / "in.yaml", "-n", "12", "-o", tmp_path / "few.h5"], check=True, capture_output=True, text=True)
    with h5py.File(tmp_path / "tracks.h5") as file:
        paths = [track for name, track in file["entry"].items() if name.startswith("particle_")]
        left = [{part: track["weight"][:][place] for part, place in (("before", track["y"][:] < 0.2), ("behind", track["y"][:] > 0.2))} for track in paths]
    assert all((path["before"] == 1).all() for path in left)
    shares = [float(path["behind"][-1]) for path in left]
    assert {round(share, 9) for share in shares} == {0.1, 0.9}
    assert one.stdout.count("detected at behind, 0.9 of it") + one.stdout.count("detected at behind, 0.1 of it") == 12
    assert abs(np.mean(shares) - 0.3) < 4 * 0.8 * np.sqrt(3 / 16 / 40)  # a quarter of them are in the level that passes

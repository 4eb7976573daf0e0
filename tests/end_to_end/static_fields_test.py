"""Static fields take from a path what they give back, and a map of one is that field."""
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rabiline._core", reason="built without pybind11")
import rabiline  # noqa: E402

SILVER = """
rabiline: 1
species: {{name: silver, mass: 107.87 u, charge: 0 e, spin: 1/2, gyromagnetic_ratio: -28 GHz/T}}
law: {{name: quantum, tolerance: {tolerance}}}
source: {{speed: {{kind: single, value: 600 m/s}}, opening: {{radius: 0.2 mm}}, direction: parallel, spin: {{kind: populations, values: [{up}, {down}]}}}}
parts:
  - {{name: M, {part}}}
  - {{name: D, kind: detector, at: 0.6 m, width: 10 mm, height: 10 mm, bins: [5, 50]}}
particles: 500
seed: 1
"""
WIRES = "kind: two_wire_magnet, half_distance: 6 mm, wire_radius: 1 mm, field: 3 T"
TAKEN = 6.62607015e-34 * 28e9 * 3.0 / (107.87 * 1.66053906660e-27 * 600**2)  # 2 mu B/(m v^2), mu = h gamma/(4 pi)
HALF_DISTANCE, HEIGHT = 6e-3, 7.2e-3  # of the wires, and of the beam above them


def paths(folder: Path, part: str, up: int, tolerance: float = 1e-6) -> list[rabiline.Track]:
    (folder / "a.yaml").write_text(SILVER.format(part=part, up=up, down=1 - up, tolerance=tolerance))
    return list(rabiline.load(folder / "a.yaml").trace(5).tracks)


@pytest.mark.parametrize("up", [0, 1])
@pytest.mark.parametrize("part", ["kind: uniform_field, field: 3 T", WIRES])
def test_a_static_fringe_gives_back_the_energy_that_it_takes(tmp_path: Path, part: str, up: int) -> None:
    """Within a hundredth of the tolerance or so: 1e-9 at 1e-7, where the field takes a thousandth of it."""
    for one in paths(tmp_path, f"at: 0.1 m, length: 0.1 m, {part}, fringe: {{kind: tanh, length: 4 mm}}", up, 1e-7):
        squared = np.sum(np.asarray(one.velocity)**2, axis=1) / 600**2 - 1
        assert np.abs(squared).max() == pytest.approx(TAKEN, rel=1e-3 if "uniform" in part else 0.1) and abs(squared[-1]) < 1e-9


def write_map(path: Path, steps: int) -> None:
    """Of the two wires across 2 mm and along 0.1 m, as their closed form has it: k (z, -x)/r^2 of each, turned about."""
    across = np.linspace(-1e-3, 1e-3, steps + 1)
    y = np.linspace(-0.05, 0.05, 5)

    def field(x: np.ndarray, z: np.ndarray) -> np.ndarray:
        each = [sign * np.stack([-(z + HEIGHT), x - place]) / ((x - place)**2 + (z + HEIGHT)**2) for sign, place in ((1, -HALF_DISTANCE), (-1, HALF_DISTANCE))]
        return sum(each)

    scale = 3.0 / field(np.zeros(1), np.zeros(1))[1, 0]
    x, along, z = np.meshgrid(across, y, across, indexing="ij")
    bx, bz = scale * field(x, z)
    rows = np.column_stack([each.ravel() for each in (x, along, z, bx, np.zeros_like(x), bz)])
    np.savetxt(path, rows, delimiter=",", header="x [m],y [m],z [m],Bx [T],By [T],Bz [T]", comments="", fmt="%.17g")


@pytest.mark.parametrize("up", [0, 1])
def test_a_map_of_two_wires_deflects_as_they_do_the_better_the_finer_it_is(tmp_path: Path, up: int) -> None:
    fallen = [one.position[-1] for one in paths(tmp_path, f"at: 0.1 m, length: 0.1 m, {WIRES}", up)]
    off = []
    for steps in (4, 8):
        write_map(tmp_path / "wires.csv", steps)
        mapped = paths(tmp_path, "at: 0.15 m, kind: field_map, map: wires.csv", up)
        start = [one.position[0] for one in mapped]
        deflected = np.array([np.hypot(*(end - begin)[[0, 2]]) for end, begin in zip(fallen, start)])
        off.append(np.max([np.hypot(*(its.position[-1] - end)[[0, 2]]) for its, end in zip(mapped, fallen)] / deflected))
    assert deflected.min() > 1e-4 and off[0] < 0.01 and off[1] < 0.3 * off[0], off

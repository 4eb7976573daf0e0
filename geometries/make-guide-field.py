#!/usr/bin/env python3
"""Writes guide-field.csv: the field of two rectangular coils above and below a beam, as a probe would measure it.

The coils lie in the planes z = -0.2 m and z = +0.2 m, 0.8 m wide along x and 1.6 m long along y, and carry 25 and 20 A turns,
so that the field points up and decreases upwards. Straight wires: J. D. Jackson, Classical Electrodynamics, chapter 5.
"""
from pathlib import Path

import numpy as np

MU_0 = 1.25663706127e-6  # [N/A^2]


def of_wire(place, begin, end, current):
    """B [T] at places (n, 3) of a straight wire: mu_0 I/(4 pi) (a x b) (|a| + |b|)/(|a| |b| (|a| |b| + a . b))."""
    a, b = place - begin, place - end
    size_a, size_b = np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1)
    share = (size_a + size_b) / (size_a * size_b * (size_a * size_b + np.sum(a * b, axis=1)))
    return MU_0 * current / (4 * np.pi) * np.cross(a, b) * share[:, None]


def of_coils(place):
    field = np.zeros_like(place)
    for height, turns in ((-0.2, 25.0), (0.2, 20.0)):
        corner = np.array([[-0.4, -0.2, height], [0.4, -0.2, height], [0.4, 1.4, height], [-0.4, 1.4, height]])
        for i in range(4):
            field += of_wire(place, corner[i], corner[(i + 1) % 4], turns)
    return field


def main():
    x, y, z = np.linspace(-15, 15, 5), np.linspace(0, 1200, 41), np.linspace(-15, 15, 7)  # [mm]
    place = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    field = of_coils(place * 1e-3) * 1e6
    np.savetxt(Path(__file__).with_name("guide-field.csv"), np.hstack([place, field]), fmt=["%g"] * 3 + ["%.6f"] * 3, delimiter=",", comments="",
               header="x [mm], y [mm], z [mm], Bx [uT], By [uT], Bz [uT]")


if __name__ == "__main__":
    main()

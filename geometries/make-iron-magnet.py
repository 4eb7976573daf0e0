#!/usr/bin/env python3
"""Writes iron-magnet.csv: the field of an iron magnet by finite elements (gmsh and getdp), for `iron_magnet` to be compared with.

    apt-get install gmsh getdp; /usr/bin/python3 make-iron-magnet.py          # half a minute

getdp solves for the scalar potential. At each place of the map B is the gradient of the harmonic polynomial of degree 5 that fits
the potential best within 0.4 mm across the beam and 0.8 mm along it, so that edges of elements leave no steps in the field. The
map is a quarter of the magnet, whose origin is the beam's place in its middle; there the field is scaled to 0.5 T. Twice as many
elements change it by 2.5e-4 of that (rms), by 7e-3 at the sharp end of the convex pole, and its integrated gradient by 6e-4.
"""
import subprocess
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
BEAM = 4.8  # [mm] above the plane of the wires of the same field
DEGREE = 5


def potential():
    """Places along x, y, z [mm], and the potential there."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["gmsh", "-3", HERE / "iron-magnet.geo", "-format", "msh22", "-o", f"{folder}/mesh.msh", "-v", "2"], check=True)
        subprocess.run(["getdp", HERE / "iron-magnet.pro", "-msh", f"{folder}/mesh.msh", "-name", f"{folder}/magnet", "-solve", "Magnet", "-pos",
                        "Potential", "-v", "2", "-ksp_type", "cg", "-pc_type", "ilu", "-ksp_rtol", "1e-12"], check=True, cwd=folder)
        table = np.loadtxt(f"{folder}/potential.txt")
    axes = [np.unique(np.round(table[:, 5 + i], 6)) for i in range(3)]
    return axes, table[:, 8].reshape([len(axis) for axis in axes])


def harmonics():
    """The harmonic polynomials up to DEGREE, as pairs of exponents and coefficients: what the Laplacian makes zero."""
    for degree in range(DEGREE + 1):
        above = [(i, j, degree - i - j) for i in range(degree + 1) for j in range(degree + 1 - i)]
        below = [(i, j, degree - 2 - i - j) for i in range(degree - 1) for j in range(degree - 1 - i)]
        laplacian = np.zeros((len(below), len(above)))
        for column, powers in enumerate(above):
            for axis, power in enumerate(powers):
                if power >= 2:
                    lower = tuple(p - 2 * (a == axis) for a, p in enumerate(powers))
                    laplacian[below.index(lower), column] += power * (power - 1)
        kept = np.linalg.svd(laplacian)[2][len(below):] if below else np.eye(len(above))
        for coefficients in kept:
            yield above, coefficients


def gradient_weights(offsets):
    """What the potential at the offsets is multiplied by to give its gradient where they begin."""
    values, slopes = [], []
    for powers, coefficients in harmonics():
        values.append(sum(c * np.prod(offsets**p, axis=1) for p, c in zip(powers, coefficients)))
        slopes.append([sum(c for p, c in zip(powers, coefficients) if p == tuple(np.eye(3, dtype=int)[axis])) for axis in range(3)])
    return np.array(slopes).T @ np.linalg.pinv(np.array(values).T)


def main():
    axes, phi = potential()
    # Even in x and y.
    phi = np.concatenate([phi[:0:-1], phi], axis=0)
    phi = np.concatenate([phi[:, :0:-1], phi], axis=1)
    axes = [np.concatenate([-axes[0][:0:-1], axes[0]]), np.concatenate([-axes[1][:0:-1], axes[1]]), axes[2]]
    across, along = np.arange(-0.4, 0.41, 0.2), np.arange(-0.8, 0.81, 0.4)
    offsets = np.stack(np.meshgrid(across, along, across, indexing="ij"), axis=-1).reshape(-1, 3)
    weights = gradient_weights(offsets)
    x, y, z = np.arange(4) * 0.3, np.arange(91) * 0.4, np.arange(-4, 5) * 0.2
    place = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)
    around = place[:, None, :] + offsets + [0, 0, BEAM]
    index = tuple(np.rint((around[..., i] - axes[i][0]) / (axes[i][1] - axes[i][0])).astype(int) for i in range(3))
    field = -phi[index] @ weights.T
    field *= 500 / field[np.all(place == 0, axis=1), 2]
    field[place[:, 0] == 0, 0] = 0
    field[place[:, 1] == 0, 1] = 0
    np.savetxt(HERE / "iron-magnet.csv", np.hstack([place, field + 0.0]), fmt=["%.1f"] * 3 + ["%.4f"] * 3, delimiter=",", comments="",
               header="x [mm], y [mm], z [mm], Bx [mT], By [mT], Bz [mT]")


if __name__ == "__main__":
    main()

"""The magnetic field along a line, from the table that `rabiline probe --along` prints."""
from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from . import style
from .hdf5 import FileError
from .style import INK, OTHERS
from .units import fitting_scale

COLUMNS = ["x [m]", "y [m]", "z [m]", "Bx [T]", "By [T]", "Bz [T]", "|B| [T]"]


@dataclass(frozen=True)
class FieldLine:
    """B at places on a line along x, y or z."""

    along: str
    place: np.ndarray  # [n] m
    field: np.ndarray  # [n, 3] T


def read_field(path: Path) -> FieldLine:
    """Raises FileError where the file is no such table."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if not rows or rows[0][:len(COLUMNS)] != COLUMNS:
        raise FileError(path, "this is no table of `rabiline probe --along`")
    try:
        table = np.array([[float(cell) for cell in row] for row in rows[1:]], dtype=float)
    except ValueError as problem:
        raise FileError(path, str(problem)) from None
    if table.ndim != 2 or len(table) < 2 or table.shape[1] != len(rows[0]):
        raise FileError(path, "the table has fewer than two rows")
    axis = int(np.argmax(np.ptp(table[:, :3], axis=0)))
    return FieldLine("xyz"[axis], table[:, axis], table[:, 3:6])


def draw_field(line: FieldLine, title: str) -> Figure:
    """The three components and the size."""
    size = np.linalg.norm(line.field, axis=1)
    across, up = fitting_scale(line.place, "m"), fitting_scale(np.append(size, 0), "T")
    figure, axes = plt.subplots(figsize=style.size(7.2, 4.8), layout="constrained")
    at = across.apply(line.place)
    for name, values, look in zip("xyz", line.field.T, OTHERS):
        axes.plot(at, up.apply(values), color=look[0], linewidth=1.4, label=f"$B_{name}$")
    axes.plot(at, up.apply(size), color=INK, linewidth=1.0, linestyle="--", label="|B|")
    axes.set_xlabel(across.label(line.along))
    axes.set_ylabel(up.label("B"))
    axes.grid(axis="y")
    style.write_title(figure, title)
    style.legend_below(figure, axes, 4)
    return figure

"""The fields along a line, from the table that `rabiline probe --along` prints."""
from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

from . import style
from .hdf5 import FileError, require_file
from .regions import Region, shade
from .style import INK, OTHERS
from .units import fitting_scale

COLUMNS = ["x [m]", "y [m]", "z [m]", "Bx [T]", "By [T]", "Bz [T]", "|B| [T]"]
NOTHING = 1e-9  # of the field: a component that is not there
ELECTRIC = ["Ex [V/m]", "Ey [V/m]", "Ez [V/m]"]


@dataclass(frozen=True)
class FieldLine:
    """B and E at places on a line along x, y or z."""

    along: str
    place: np.ndarray  # [n] m
    field: np.ndarray  # [n, 3] T
    electric: np.ndarray  # [n, 3] V/m


def read_field(path: Path) -> FieldLine:
    """Raises FileError where the file is no such table, and OSError."""
    require_file(path)
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
    except (UnicodeDecodeError, csv.Error):
        rows = []
    if not rows or rows[0][:len(COLUMNS)] != COLUMNS:
        raise FileError(path, "this is no table of `rabiline probe --along`")
    try:
        table = np.array([[float(cell) for cell in row] for row in rows[1:]], dtype=float)
    except ValueError as problem:
        raise FileError(path, str(problem)) from None
    if table.ndim != 2 or len(table) < 2 or table.shape[1] != len(rows[0]):
        raise FileError(path, "the table has fewer than two rows")
    axis = int(np.argmax(np.ptp(table[:, :3], axis=0)))
    electric = [rows[0].index(name) for name in ELECTRIC if name in rows[0]]
    return FieldLine("xyz"[axis], table[:, axis], table[:, 3:6], table[:, electric] if len(electric) == 3 else np.zeros_like(table[:, 3:6]))


def draw_field(line: FieldLine, title: str, regions: Sequence[Region] = ()) -> Figure:
    """The three components and the size of B, and below it those of E where there is any. `regions` along a line along the beam."""
    fields = [("B", "T", line.field)] if line.field.any() or not line.electric.any() else []
    fields += [("E", "V/m", line.electric)] if line.electric.any() else []
    figure, panels = plt.subplots(len(fields), 1, sharex=True, squeeze=False, figsize=style.size(7.2, 4.8), layout="constrained")
    across = fitting_scale(line.place, "m")
    for axes, (symbol, unit, field) in zip(panels[:, 0], fields):
        size = np.linalg.norm(field, axis=1)
        up = fitting_scale(np.append(size, 0), unit)
        for name, values, look in zip("xyz", field.T, OTHERS):
            nothing = np.abs(values).max() <= NOTHING * size.max()
            axes.plot(across.apply(line.place), up.apply(values), color=look[0], linewidth=0.7 if nothing else 1.4, zorder=1.5 if nothing else 2,
                      label=f"${symbol}_{name}$" + (" = 0" if nothing else ""))
        axes.plot(across.apply(line.place), up.apply(size), color=INK, linewidth=1.0, linestyle="--", label=f"|{symbol}|")
        axes.set_ylabel(up.label(symbol))
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        axes.grid(axis="y")
    panels[0, 0].set_xlim(*across.apply(line.place[[0, -1]]))
    inside = [Region(region.name, across.apply(region.begin), across.apply(region.end)) for region in regions
              if region.end > line.place.min() and region.begin < line.place.max()]
    for axes in panels[:, 0]:
        shade(axes, inside, named=axes is panels[0, 0])
    panels[-1, 0].set_xlabel(across.label(line.along))
    style.write_title(figure, title)
    return figure

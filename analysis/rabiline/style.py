"""How rabiline's pictures look: one colour per law, colour-blind safe, readable when small."""
from __future__ import annotations

import textwrap
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Sequence

from matplotlib import pyplot as plt
from matplotlib.colors import Colormap, LinearSegmentedColormap
from matplotlib.figure import Figure

INK, GREY, PALE = "#222222", "#6b6b6b", "#e9e9e9"
# Okabe and Ito, Color Universal Design (2008), without the yellow that white paper swallows
LAWS = {"quantum": ("#0072B2", "o"), "classical": ("#009E73", "s"), "dorado": ("#D55E00", "D")}
OTHERS = [("#CC79A7", "^"), ("#56B4E9", "v"), ("#E69F00", "P"), ("#000000", "X")]
# one hue from paper white to ink: read the same by every eye, and an empty bin is white
COUNTS: Colormap = LinearSegmentedColormap.from_list(
    "counts", ["#ffffff", "#c6dff0", "#6aaed6", "#2272b4", "#0b3c73", "#041c3a"])

RULES = {
    "font.family": "DejaVu Sans", "font.size": 10, "mathtext.fontset": "dejavusans",
    "axes.titlesize": 10.5, "axes.labelsize": 10, "axes.edgecolor": INK, "axes.linewidth": 0.8,
    "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True,
    "grid.color": PALE, "grid.linewidth": 0.8, "xtick.labelsize": 9, "ytick.labelsize": 9,
    "legend.frameon": False, "legend.fontsize": 9, "figure.dpi": 100, "savefig.dpi": 200,
    "axes.formatter.useoffset": False, "axes.formatter.limits": (-9, 12),
    "text.color": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK,
}


def write_title(figure: Figure, title: str) -> None:
    """Above the figure, in lines that fit its width."""
    figure.suptitle(in_lines(title, figure.get_figwidth(), TITLE), fontsize=TITLE)


def in_lines(text: str, inches: float, size: float) -> str:
    """Wrapped to a width, for letters of a size in points."""
    letters = max(10, int(inches * 72 / (0.58 * size)))
    return "\n".join(line for part in text.splitlines() for line in textwrap.wrap(part, letters) or [""])


def here() -> AbstractContextManager:
    """What is drawn in this context looks so; a notebook's other pictures stay as they are."""
    return plt.rc_context(RULES)



TITLE = 11.5  # points


@dataclass(frozen=True)
class Look:
    """How one curve or one file's tracks are drawn."""

    colour: str
    marker: str


def looks(laws: Sequence[str]) -> list[Look]:
    """One look per law name: the law's own colour the first time, another one when it comes again."""
    taken: set[str] = set()
    spare = iter(OTHERS * (len(laws) // len(OTHERS) + 1))
    result = []
    for law in laws:
        name = law.split(" ")[0]
        result.append(Look(*(LAWS[name] if name in LAWS and name not in taken else next(spare))))
        taken.add(name)
    return result


def save(figure: Figure, path: Path | str, dpi: float = 200) -> None:
    """Writes the figure, as what its ending says, and forgets it. Raises OSError or ValueError."""
    try:
        with here():
            figure.savefig(path, facecolor="white", dpi=dpi)
    finally:
        plt.close(figure)

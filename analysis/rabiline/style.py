"""How rabiline's pictures look: one colour per law, colour-blind safe, readable when small."""
from __future__ import annotations

import re
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from math import ceil, floor, log10
from pathlib import Path
from typing import Callable, Iterator, Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib import rcParamsDefault
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import Colormap, LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.textpath import text_to_path

from . import asked
from .errors import InputError
from .units import SUPERSCRIPT, wrapped
from .writing import require_place, whole

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


class PictureWarning(UserWarning):
    """What a picture does not show as it should."""


def write_title(figure: Figure, title: str) -> None:
    """Above the figure, in lines that fit its width; nothing where it is blank."""
    title = title.strip()
    if not title:
        return
    size = TITLE * (SMALLER if figure.get_figwidth() < NARROW else 1)
    figure.suptitle(in_lines(shortened(title), figure.get_figwidth(), size), fontsize=scaled(size), parse_math=False)


def shortened(title: str) -> str:
    """To what a picture has room for."""
    return title if len(title) <= LONGEST else f"{title[:LONGEST - 1].rstrip()}…"


def scaled(points: float) -> float:
    """The size of letters in a picture that is drawn `in_proportion`."""
    return _factor * points


def pad_in_space(axes: Axes, labels: dict[str, float], numbers: dict[str, float] | None = None) -> None:
    """Distances [points] of the `labels` of "x", "y" and "z", and of their `numbers`, from axes in three dimensions, to which matplotlib
    adds fixed ones."""
    for name, pad in labels.items():
        axis = getattr(axes, f"{name}axis")
        axis.labelpad = scaled(pad + 21) - 21
        axis.set_tick_params(labelsize=scaled(8), pad=scaled((numbers or {}).get(name, 1) + 8) - 8)


def in_proportion(draw: Callable[..., Figure]) -> Callable[..., Figure]:
    """For pictures with a shape of their own: where a size is asked for they fill it one way, everything, letters too, smaller or larger
    by one factor. Where letters would become too small, the picture is drawn once more with less `room`; raises InputError where that does
    not suffice."""
    @wraps(draw)
    def fitted(*arguments: object, **options: object) -> Figure:
        global _asked, _room
        asked, _asked = _asked, None

        def factor_to(size: np.ndarray, least: float | None) -> float:
            global _room
            _room = None if least is None else tuple(size / least)
            with letters_by(1.0):
                natural = draw(*arguments, **options)
            plt.close(natural)
            return min(size / natural.get_size_inches())

        try:
            if asked is None:
                return draw(*arguments, **options)
            size, least, factor = np.array(asked), NEARLY * LEAST, factor_to(np.array(asked), None)
            factor = factor if factor > least else factor_to(size, LEAST)
            while factor <= least:
                size = size * max(1.02, LEAST / factor)
                factor = factor_to(size, LEAST)
            if tuple(size) != tuple(asked):
                raise InputError("--size: letters would become too small; " + "x".join(f"{ceil(25.4 * length)}" for length in size) + " or more is needed in this shape")
            with letters_by(factor):
                figure = draw(*arguments, **options)
            figure.set_size_inches(factor * figure.get_size_inches())
            for line in figure.findobj(Line2D):
                line.set(linewidth=factor * line.get_linewidth(), markersize=factor * line.get_markersize())
            return figure
        finally:
            _asked, _room = asked, None
    return fitted


def room() -> tuple[float, float] | None:
    """[inches] Width and height that a picture with a shape of its own should not exceed, at the usual size of letters; None where it need not care."""
    return _room


def size(width: float, height: float) -> tuple[float, float]:
    """[inches] Of a new figure: what was asked for with `here`, else these."""
    return _asked or (width, height)


def upright(figure: Figure, text: str, foot: float = 0.0) -> str:
    """For the side of one panel, above a `foot` [inches] and below the title: in lines that fit its height. Raises InputError where a
    figure whose size was asked for is too low for the longest of its words."""
    letter = points("axes.labelsize")
    height = figure.get_figheight() - foot - max(0.7, head_of(figure) + BELOW * letter)
    longest = max(len(word) for word in text.split()) * LETTER * letter / 72
    if _asked and 0.95 * height < longest:
        width, now = 25.4 * figure.get_size_inches()
        plt.close(figure)
        raise InputError(f"--size: {width:.0f}x{now:.0f} leaves no room for curves between the letters; make it "
                         f"{25.4 * (longest / 0.95 - height) + 1:.0f} mm higher")
    lines = in_lines(text, 0.95 * height, letter)
    return lines if lines.count("\n") < 3 else in_lines(text.partition("\n(")[0], 0.95 * height, letter)  # without what is said of errors


def columns_of(labels: Sequence[str], room: int, most: int = 4) -> int:
    """As many columns of a legend as fit into `room` letters."""
    for columns in range(min(most, len(labels)), 1, -1):
        rows = -(-len(labels) // columns)
        widths = [max(map(len, labels[first:first + rows])) + 7 for first in range(0, len(labels), rows)]
        if sum(widths) <= room:
            return columns
    return 1


def head_of(figure: Figure) -> float:
    """[inches] The height of its title, which has been written."""
    title = figure._suptitle
    return (1 + title.get_text().count("\n")) * LINE * title.get_fontsize() / 72 + 0.04 if title else 0.0


def legend_at_foot(figure: Figure, items: Sequence[object], labels: Sequence[str], title: str = "", **looks: object) -> float:
    """For a figure whose size was asked for, which cannot grow: room at its foot, as many columns as fit. Gives back the height
    [inches]."""
    labels = [wrapped(label, letters(figure) - 8) for label in labels]
    columns = max(1, min(len(labels), letters(figure) // (8 + widest(labels))))
    tall = 1.7 if any("$" in label for label in labels) else 1.5  # formulas are taller
    high = max(sum(tall + LINE * label.count("\n") for label in column) for column in np.array_split(labels, columns))  # as legends fill their columns
    foot = (high + (tall + LINE * title.count("\n") if title else 0)) * points("legend.fontsize") / 72 + 0.06
    room = foot / (_factor * figure.get_figheight())  # what is drawn in proportion has yet to become as small as its letters
    figure.get_layout_engine().set(rect=(0, room, 1, 1 - room))
    figure.legend(items, labels, loc="lower center", bbox_to_anchor=(0.5, 0), ncol=columns, borderaxespad=0.2, title=title or None,
                  title_fontsize=points("legend.fontsize"), **looks)
    return foot


def legend_below(figure: Figure, axes: Axes, columns: int, title: str = "") -> float:
    """Below the axes, in so many columns at most, for which the figure grows; at the foot of a figure whose size was asked for. Gives
    back the height [inches] of that foot."""
    items, labels = axes.get_legend_handles_labels()
    if _asked:
        return legend_at_foot(figure, items, labels, title)
    labels = [wrapped(label, letters(figure) - 12) for label in labels]
    columns = max(1, min(columns, letters(figure) // (8 + widest(labels))))
    lines = -(-len(labels) // columns) * (1 + max(label.count("\n") for label in labels)) + bool(title)
    figure.set_figheight(figure.get_figheight() + 0.19 * max(0, lines - 2))
    below = -0.15 * 3.2 / (figure.get_figheight() - 1.2 - 0.19 * lines)  # inches to axes, near enough
    axes.legend(items, labels, loc="upper center", bbox_to_anchor=(0.5, below), ncol=columns, title=title or None,
                title_fontsize=points("legend.fontsize"))
    return 0.0


def level(name: str) -> str:
    """The name of a level, or of something else that has one in it: with true minus signs, and 0 without a sign."""
    return re.sub(r"(?<![^\s=(])[-+](?=0(?![\d/.]))", "", re.sub(r"(?<![^\s=(])-(?=[\d ])", "−", name))


def plain(text: str) -> str:
    """A text of the user, whose dollars are no formulas."""
    return text.replace("$", r"\$")


def logarithmic(axis: Axis) -> None:
    """With plain numbers, as far as these are short; over less than two decades also between their powers of ten."""
    def written(value: float, _: int) -> str:
        low, high = axis.get_view_interval()
        if PLAIN[0] <= low and high < PLAIN[1]:
            return f"{value:g}"
        power = floor(log10(value * (1 + 1e-9)))
        digit = f"{value / 10.0**power:.0f}×" if round(value / 10.0**power) > 1 else ""
        return f"{digit}10{str(power).translate(SUPERSCRIPT)}"

    def between(value: float, place: int) -> str:
        low, high = axis.get_view_interval()
        digit = round(value / 10.0**floor(log10(value * (1 + 1e-9))))
        return written(value, place) if high < 10 * low or high < 100 * low and digit in (2, 5) else ""

    axis.axes.set(**{f"{axis.axis_name}scale": "log"})
    axis.set_major_formatter(written)
    axis.set_minor_formatter(between)


def widest(labels: Sequence[str]) -> int:
    """Letters of the longest line of them all."""
    return max(len(line) for label in labels for line in label.splitlines() or [""])


def name_below(axes: Axes, text: str) -> None:
    """Of an axis along x, in lines that fit: of a slender picture they end where the axis ends, to have its whole width."""
    wide = axes.figure.get_figwidth() / axes.get_subplotspec().get_gridspec().ncols
    axes.set_xlabel(in_lines(text, wide - 0.15, points("axes.labelsize")), loc="right" if wide < SLENDER else "center")


def beside_ticks(figure: Figure, name: str) -> str:
    """A name of several words below an axis."""
    lines = name.replace(", ", "\n", 1)
    return lines.replace(", ", "\n").replace(" (", "\n(") if figure.get_figwidth() < NARROW else lines


def write_numbers(axes: Axes, words: Sequence[str], least: Sequence[str]) -> None:
    """Above a panel that is centred in the figure, several to a row, as many as fit; where that would take too much of a figure whose size
    was asked for, only the `least` of them."""
    figure, size = axes.figure, points("legend.fontsize")
    rows = in_rows(figure, words, size)
    high = (1 + rows.count("\n")) * LINE * size / 72
    if _asked and high > MOST_NUMBERS * figure.get_figheight():
        rows = in_rows(figure, least, size)
    axes.set_title(rows, fontsize=size, parse_math=False)


def write_deviations(axes: Axes, name: str, largest: float) -> None:
    """For a low panel of what is `name`d, in standard deviations, below another: limits, few numbers, and a short name where it is narrow."""
    figure = axes.figure
    most = max(2.5, (1.1 if figure.get_figwidth() > NARROW else 1.3) * largest)
    axes.get_gridspec().set_height_ratios((3, 1 if figure.get_figwidth() > NARROW else 1.5))
    axes.set_ylim(-most, most)
    power = 10 ** floor(log10(most))
    marked = max(digit for digit in (1, 2, 5) if digit * power <= most) * power
    axes.set_yticks([-marked, 0, marked] if figure.get_figwidth() > NARROW else [-marked, marked])
    axes.set_ylabel(f"{name if figure.get_figwidth() > NARROW else 'Δ'} / σ")
    figure.align_ylabels()


def in_rows(figure: Figure, words: Sequence[str], size: float) -> str:
    """Several to a line beside the numbers of an axis; one that is longer than that is wrapped."""
    room = figure.get_figwidth() - 0.1 * size
    probe = figure.text(0, 0, "", fontsize=size, parse_math=False)

    def wide(text: str) -> float:
        probe.set_text(text)
        return probe.get_window_extent().width / figure.dpi

    lines: list[str] = []
    for word in words:
        longer = f"{lines[-1]},   {word}" if lines else word
        if lines and wide(longer) < room:
            lines[-1] = longer
        else:
            lines += wrapped(word, max(12, int(len(word) * room / wide(word)) - 1)).split("\n") if wide(word) > room else [word]
    probe.remove()
    return "\n".join(lines)


def points(name: str) -> float:
    """The size of letters that is called `name` in matplotlib's settings."""
    return FontProperties(size=plt.rcParams[name]).get_size_in_points()


def letters(figure: Figure) -> int:
    """How many letters of a legend fit into its width."""
    return int(figure.get_figwidth() * (16.5 if figure.get_figwidth() < NARROW else 13.3))


def in_lines(text: str, inches: float, size: float) -> str:
    """Wrapped to a width, for letters of a size in points; shorter where they are wide ones."""
    most, font = max(12, int(inches * 72 / (LETTER * size))), FontProperties(size=size)
    while most > 12 and any(text_to_path.get_text_width_height_descent(line, font, False)[0] > 72 * inches
                            for line in wrapped(text, most).split("\n")):
        most -= 1
    return wrapped(text, most)


@contextmanager
def letters_by(factor: float) -> Iterator[None]:
    """What is drawn in this context has letters larger by a factor than they usually are, and so much more room about them."""
    usual = {key: value for key, value in RULES.items() if key.endswith("size") and not isinstance(value, str)}
    usual |= {key: rcParamsDefault[key] for key in ("axes.labelpad", "axes.titlepad", "xtick.major.pad", "ytick.major.pad",
                                                    "xtick.major.size", "ytick.major.size")}
    global _factor
    before, _factor = _factor, factor
    try:
        with plt.rc_context({key: value * factor for key, value in usual.items()}):
            yield
    finally:
        _factor = before


@contextmanager
def here(asked: tuple[float, float] | None = None) -> Iterator[None]:
    """What is drawn in this context looks so, and has the size [inches] that is asked for; a notebook's other pictures stay
    as they are."""
    global _asked
    before, _asked = _asked, asked or _asked
    small = {key: value * SMALLER for key, value in RULES.items() if key.endswith("size") and not isinstance(value, str)}
    try:
        with plt.rc_context({**RULES, **(small if _asked and _asked[0] < NARROW else {})}), warnings.catch_warnings():
            warnings.filterwarnings("ignore", GLYPH)  # told of once, where the picture is saved
            yield
    finally:
        _asked = before


ENDINGS = (".png", ".pdf", ".svg")
TITLE = 11.5  # points
GLYPH = r"Glyph (\d+) .* missing from"
PLAIN = 5e-5, 2e5  # a logarithmic axis between these has its numbers written out
LONGEST = 300  # letters of a title
LETTER, LINE = 0.58, 1.25  # width and height of a letter over its size
BELOW = 0.045  # inches per point of size: numbers and name of an axis below a panel
NARROW, SMALLER, SLENDER = 5.0, 0.8, 2.4  # inches of a figure whose letters are smaller, by how much, and inches of a slender one
MOST_NUMBERS = 0.25  # of a figure's height
LEAST, NEARLY = 0.6, 0.99  # times the usual size of letters; and times that, which is the same but for rounding
_asked: tuple[float, float] | None = None
_room: tuple[float, float] | None = None
_factor = 1.0  # of letters


@dataclass(frozen=True)
class Look:
    """How one curve or one file's tracks are drawn."""

    colour: str
    marker: str
    open: bool = False  # an open symbol and a dashed line


def looks(laws: Sequence[str]) -> list[Look]:
    """One look per law name: the law's own colour the first time, another one when it comes again."""
    taken: set[str] = set()
    spare = ((*pair, bool(turn)) for turn in range(len(laws)) for pair in OTHERS)  # dashed once all are taken
    result = []
    for law in laws:
        name = law.split(" ")[0]
        result.append(Look(*(LAWS[name] if name in LAWS and name not in taken else next(spare))))
        taken.add(name)
    return result


def require_name(path: Path | str) -> None:
    """Raises InputError where a picture cannot have this name, and StorageError where it cannot be written."""
    path = Path(asked.path("output", path))
    if path.suffix.lower() not in ENDINGS:
        raise InputError(f"{path}: a picture's name ends in .png, .pdf or .svg")
    require_place(path)


def is_crowded(figure: Figure) -> bool:
    """Whether a panel of a small picture is too low for two numbers beside it; one that is drawn to scale may be."""
    return min(figure.get_figwidth() / NARROW, figure.get_figheight() / SLENDER) < 1 and any(
        axes.get_window_extent().height < 2.2 * label.get_window_extent().height for axes in figure.axes if axes.get_aspect() == "auto"
        for label in axes.get_yticklabels()[:1] if label.get_text() and label.get_visible() and axes.yaxis.get_visible())


def save(figure: Figure, path: Path | str, dpi: float = 200) -> None:
    """Writes the figure, as what its ending says, and forgets it. Raises StorageError, ValueError where it has too many dots, and InputError
    for an ending that is no picture's or where its size leaves no room between the letters."""
    require_name(path)
    try:
        with whole(path) as new, here(), warnings.catch_warnings(record=True) as told:
            warnings.filterwarnings("error", "constrained_layout not applied")
            warnings.filterwarnings("always", GLYPH)
            figure.draw_without_rendering()  # a text beside a curve makes room for itself, and moves with what became narrower
            if is_crowded(figure):
                raise UserWarning
            figure.savefig(new, format=Path(path).suffix[1:].lower(), facecolor="white", dpi=dpi)
    except UserWarning:
        width, height = 25.4 * figure.get_size_inches()
        raise InputError(f"--size: {width:.0f}x{height:.0f} leaves no room for curves between the letters; make it larger") from None
    finally:
        plt.close(figure)
    missing = dict.fromkeys(chr(int(found[1])) for one in told if (found := re.match(GLYPH, str(one.message))))
    if missing:
        warnings.warn(f"{path}: the letters of pictures lack {' '.join(missing)}, of which boxes are left", PictureWarning, stacklevel=2)

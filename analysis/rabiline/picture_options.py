"""The options of the picture commands."""
from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError
from math import inf
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Callable, NoReturn, TypeVar

from . import asked
from .argument_types import heading
from .errors import InputError
from .units import parse_quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

T = TypeVar("T")


class KeywordParser(ArgumentParser):
    """Reads options that are keywords of a call: what is wrong with one is an InputError."""

    def error(self, message: str) -> NoReturn:
        """Raises it."""
        raise InputError(message.removeprefix("argument "))

    @staticmethod
    def require(name: str, read: Callable[[str], T], text: str) -> T:
        """One option by itself."""
        try:
            return read(text)
        except ArgumentTypeError as problem:
            raise InputError(f"--{name}: {problem}") from None


def words_of(key: str, value: object) -> list[str]:
    """A keyword as on the command line: a list is an option for each of its values, True one without a value, None and False none."""
    option = f"--{key.replace('_', '-')}"
    if value is None or isinstance(value, bool):
        return [option] if value else []
    if isinstance(value, list):
        return [word for one in value for word in words_of(key, one)]
    if not isinstance(value, (str, Path, Real)):
        value = ":".join(map(repr, pair_of(key, value)))
    return [f"{option}={value}"]


def pair_of(key: str, value: object) -> tuple[float, float]:
    """Two numbers. Raises TypeError."""
    try:
        first, second = map(float, value)
    except (TypeError, ValueError):
        raise TypeError(f"`{key}` is {value!r}: a text is meant, as on the command line, or a pair of numbers where that has two") from None
    return first, second


def asked_size(size: object) -> tuple[float, float] | None:
    """[inches] "86x60", or a pair, in mm; None where no size is asked for. Raises InputError, and TypeError for what is neither."""
    if size is None:
        return None
    text = size if isinstance(size, str) else "x".join(f"{each:.6g}" for each in pair_of("size", size))
    return KeywordParser.require("size", size_of, text)


def asked_dots(dpi: object) -> float:
    """Per inch. Raises TypeError for what is no number, and InputError for one that is none of a picture."""
    return KeywordParser.require("dpi", dots, str(asked.number("dpi", dpi)))


def drawn(draw: Callable[[], Figure], output: Path | str | None, size: object, dpi: object) -> Figure:
    """What `draw` makes, in the size and with the dots that a call asks for; written to `output` where that is given."""
    from . import style
    dpi = asked_dots(dpi)
    with style.here(asked_size(size)):
        figure = draw()
    if output is not None:
        style.save(figure, output, dpi)
    return figure


def add_options(verb: str, parser: ArgumentParser) -> None:
    """Those of one command, `plot-scan` for one."""
    several = verb in ("plot-scan", "plot-profiles", "plot-tracks")
    parser.add_argument("files" if several else "file", metavar="FILE", type=Path, nargs="+" if several else None)
    if verb == "plot-tally":
        parser.add_argument("name", metavar="NAME", help="PART_TALLY, as `summary` lists them")
    parser.add_argument("-o", "--output", type=Path, metavar="PNG",
                        help=f"PNG, PDF or SVG; FILE{verb.removeprefix('plot')}.png where it is missing")
    parser.add_argument("--title", type=heading, help="instead of the file's own")
    if verb in ("plot-levels", "plot-image", "plot-profiles", "plot-transit"):
        parser.add_argument("--detector", metavar="NAME", help="the first one by default")
    if verb in ("plot-scan", "plot-levels"):
        parser.add_argument("--mark", action="append", default=[], metavar="LABEL=VALUE",
                            help='points out a value: "Larmor frequency=291.647 kHz"')
    if verb in RANGED:
        for axis in "xy":
            parser.add_argument(f"--{axis}-range", metavar="FROM:TO", type=range_of, help="as the axis writes it, such as 280:300")
    if verb in OWN_OPTIONS:
        OWN_OPTIONS[verb](parser)


RANGED = {"plot", "plot-scan", "plot-levels", "plot-image", "plot-profiles", "plot-tally", "plot-transit", "plot-field"}


def size_of(text: str) -> tuple[float, float]:
    """[inches] "86x60", in mm."""
    try:
        width, height = (float(number) / 25.4 for number in text.lower().replace("mm", "").split("x"))
    except ValueError:
        raise ArgumentTypeError(f"`{text}` is no size: write width x height in mm, such as 86x60") from None
    if not (1 < width < 40 and 1 < height < 40):
        raise ArgumentTypeError(f"`{text}` is no size of a picture: both are in mm, from 26 to 1000")
    return width, height


def dots(text: str) -> float:
    """Per inch."""
    try:
        if 10 <= float(text) <= 2400:
            return float(text)
    except ValueError:
        pass
    raise ArgumentTypeError(f"`{text}` is no number of dots per inch from 10 to 2400")


def range_of(text: str) -> tuple[float, float]:
    """"280:300"."""
    try:
        low, high = map(float, text.split(":"))
    except ValueError:
        raise ArgumentTypeError(f"`{text}` is no range: write two numbers as the axis has them, such as 280:300") from None
    if not -inf < low < high < inf:
        raise ArgumentTypeError(f"`{text}` is no range: the first number is the smaller one")
    return low, high


def mark_of(text: str, units: str) -> tuple[str, float]:
    """A label and a value in SI, on an axis in these units. Raises InputError."""
    label, equals, value = text.rpartition("=")
    try:
        if not (equals and label):
            raise ValueError("no label")
        return label, parse_quantity(value, units or None)
    except ValueError as problem:
        of_unit = f": {problem}" if "unit" in str(problem) else ""
        raise InputError(f'--mark "{text}" is not LABEL=VALUE, such as "Larmor frequency=291.647 kHz"{of_unit}') from None


def points_of(text: str, points: int) -> list[int]:
    """"0,50", flat numbers of so many scan points. Raises InputError."""
    try:
        numbers = [int(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"--points {text} is not a list of numbers, such as 0,50") from None
    if not all(0 <= number < points for number in numbers):
        raise InputError(f"--points {text}: the scan points are 0 to {points - 1}")
    return numbers


def _of_scan(parser: ArgumentParser) -> None:
    parser.add_argument("--detector", metavar="NAME", help="all by default")
    parser.add_argument("--beside", action="store_true", help="a panel for each file, side by side")
    parser.add_argument("--data", type=Path, metavar="COUNTS.csv",
                        help="measured counts over the same parameter: as fractions where it has `emitted`, or `seconds` and "
                             "the source in the file its `rate`, else scaled to the first curve")
    parser.add_argument("--panel-title", action="append", default=[], metavar="TEXT",
                        help="above a panel of --beside instead of the file's title; repeated, one for each file")


def _of_levels(parser: ArgumentParser) -> None:
    parser.add_argument("--levels", metavar="A,B", help='"F=4 m=0,F=3 m=0"; all by default')


def _of_image(parser: ArgumentParser) -> None:
    parser.add_argument("--points", metavar="I,J", help="flat numbers of the scan points to show; else the scan's edge "
                                                        "and the middle of its deepest dip or peak")


def _of_profiles(parser: ArgumentParser) -> None:
    parser.add_argument("--along", choices=("x", "z"), default="z", help="axis of the detector; z by default")
    parser.add_argument("--points", metavar="I,J", help="flat numbers of the scan points to show; all by default, which are 8 at most")


def _of_tally(parser: ArgumentParser) -> None:
    parser.add_argument("--axes", metavar="A,B",
                        help="one or two of its axes; the first ones by default, the others are summed over")
    parser.add_argument("--points", metavar="I,J", help="flat numbers of the scan points to show, the first by default; or `all`: "
                                                        "one axis of the tally over the scan")


def _of_angles(parser: ArgumentParser) -> None:
    parser.add_argument("--monitor", metavar="NAME", help="the first one that has such tallies by default")
    parser.add_argument("--point", metavar="I", type=int, default=0, help="flat number of the scan point; 0 by default")
    parser.add_argument("--polar-rate", metavar="RATE", help='expected, drawn beside the fit: "-140 Hz" (turns per second)')
    parser.add_argument("--azimuth-rate", metavar="RATE", help='expected: "2.91646935 kHz"')


def _of_transit(parser: ArgumentParser) -> None:
    parser.add_argument("--species", metavar="I", type=int, default=1, help="which of the beam; 1 by default")


def _of_field(parser: ArgumentParser) -> None:
    parser.add_argument("--region", action="append", default=[], metavar="NAME=BEGIN:END",
                        help='shades a field: "B=0.30:0.55" (m)')


def _of_tracks(parser: ArgumentParser) -> None:
    _of_field(parser)
    parser.add_argument("--in-space", action="store_true", help="in three dimensions")


def _of_motion(parser: ArgumentParser) -> None:
    parser.add_argument("--point", metavar="I", type=int, help="of a scan: the motions at this point, not the findings")


OWN_OPTIONS = {"plot-scan": _of_scan, "plot-levels": _of_levels, "plot-image": _of_image, "plot-profiles": _of_profiles, "plot-tally": _of_tally,
               "plot-angles": _of_angles, "plot-transit": _of_transit, "plot-tracks": _of_tracks, "plot-field": _of_field,
               "plot-motion": _of_motion}

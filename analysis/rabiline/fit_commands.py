"""The commands fit, fit-line and forecast."""
from __future__ import annotations

import argparse
import re
import shlex
import sys
from argparse import ArgumentParser
from pathlib import Path
from typing import TYPE_CHECKING

from .argument_types import count, duration, heading, rate, rate_or_zero

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LONG = 5.0  # s

ABOUT_FIT = """\
Fits parameters of an experiment to measured counts, with the simulation itself as the line shape.

  rabiline fit clock.yaml --data counts.csv --free C.field,first.amplitude+second.amplitude -o fit.png

The table has the scanned parameter and the counts, with units in the header; `seconds` (time at each point), `emitted`
(particles) and `detector` if wanted:

  first.frequency [Hz],counts
  9192631271.5,812
  9192631281.5,790

A second scanned parameter has a column of its own: `C2.phase [deg],C1.frequency [kHz],counts`. Those that take each value
together share one, with `+` between: `C1.frequency+C2.frequency [kHz]`.

Start values are those of the file, or of --set. Names with `+` between have one value. `scale`, a factor of all that is
expected, is free unless the table has `emitted`, or `seconds` while the source in the file states its `rate`; `background`,
counts at each point, is free where it is named; else it is what the detector in the file has, over `seconds`, or over the time
that `emitted` or `scale` means at the source's `rate`.
"""

AFTER_FIT = """\
The fit minimises -2 ln of the Poisson likelihood, in which the simulation may be off by its covariance. Every flight has
the same random numbers. Derivatives are differences over about one standard deviation, or over more, with few particles or with
more, until four groups of the particles agree about them: so edges of slits and detectors do not stop the fit. `profile` is
where -2 ln L, least over all other parameters, is one higher; it is flown where edges or the top of the curve are near, and the error
is half of it then. Combinations of parameters that the counts do not know are named.
"""

ABOUT_FORECAST = """\
How well a measurement will know parameters: counts of the file's scan, --seconds at each point.

  rabiline forecast clock.yaml --free C.field,first.amplitude+second.amplitude --rate 1e6 --seconds 10
"""


def arguments(verb: str, parser: ArgumentParser) -> None:
    """The options of one of these commands."""
    if verb == "fit-line":
        from .line_commands import arguments as of_lines
        return of_lines(parser)
    is_fit = verb == "fit"
    parser.description, parser.epilog = (ABOUT_FIT, AFTER_FIT) if is_fit else (ABOUT_FORECAST, None)
    parser.set_defaults(command=fit if is_fit else forecast)
    parser.add_argument("file", metavar="FILE", type=Path, help="an experiment, YAML")
    if is_fit:
        parser.add_argument("--data", type=Path, required=True, metavar="COUNTS.csv")
        parser.add_argument("-o", "--output", type=Path, metavar="PNG", help="a picture with residuals")
        parser.add_argument("--title", type=heading, help="of the picture")
        parser.add_argument("--explore", type=count, default=0, metavar="N",
                            help="particles that show how the curve changes with the parameters; by default a quarter of all and 5000 "
                                 "at most, or as many more as this needs. The curve itself is that of all --particles")
    else:
        parser.add_argument("--rate", type=rate, metavar="R", help="particles that leave the source per second (1/s)")
        parser.add_argument("--seconds", type=duration, default=1.0, metavar="T", help="at each scan point, such as 600 or \"10 min\"; 1 by default")
        parser.add_argument("--background", type=rate_or_zero, metavar="B", help="counts per second without a beam; the detector's by default")
        parser.add_argument("--known-rate", action="store_true", help="the rate is known exactly: no free factor")
        parser.add_argument("--no-scan", action="store_true", help="omit the file's scan")
        parser.add_argument("--scan", action="append", default=[], metavar="NAME=FROM:TO:POINTS")
    parser.add_argument("--free", required=True, metavar="NAME[,NAME]", help="dotted names, as in --set")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="change a parameter for this time")
    parser.add_argument("--particles", type=count, metavar="N", help="simulated at each scan point")
    parser.add_argument("--detector", metavar="NAME")
    parser.add_argument("--threads", type=count, metavar="T", help="all that there are by default")


class _Time:
    """Says how long a fit or a forecast will take, where that is long."""

    def __init__(self, what: str, flights: int, fewer: str) -> None:
        self.what, self.usual, self.fewer = what, flights, fewer  # about so many that explore, and the option for smaller ones
        self.said: set[tuple[int, bool]] = set()

    def __call__(self, flights: int, particles: int, whole: bool, seconds: float) -> None:
        needed = 2 if whole else self.usual
        if (particles, whole) in self.said or seconds * needed < LONG or flights == 1:
            return
        self.said.add((particles, whole))
        print(f"a simulation of {particles} particles takes {seconds:.2g} s; {self.what} needs "
              + ("one or two of them" if whole else f"about {needed} of them, {seconds * needed:.0f} s; fewer {self.fewer} are faster"),
              file=sys.stderr, flush=True)


def _free(options: argparse.Namespace) -> list[str]:
    """The parameters of --free, whatever blanks stand between them."""
    return re.sub(r"\s*([,+])\s*", r"\1", options.free.strip()).split(",")


def fit(options: argparse.Namespace) -> Figure | None:
    """Parameters of an experiment from measured counts."""
    from .fitting import fit_counts
    names = _free(options)
    experiment = _experiment(options).scan()
    found = fit_counts(experiment, options.data, names, detector=options.detector, threads=options.threads, explore=options.explore,
                       told=_Time("a fit", 4 * (2 * len(names) + 1) + len(names)**2, "--explore"))
    print(found)
    if not options.output:
        return None
    from .fit_plots import draw_fit
    return draw_fit(found, options.title)


def forecast(options: argparse.Namespace) -> None:
    """How well a measurement will know parameters."""
    from .forecasting import forecast as expected
    experiment = _experiment(options)
    for text in options.scan:
        name, _, values = text.partition("=")
        experiment = experiment.scan(name, values)
    names = _free(options)
    print(expected(experiment, names, rate=options.rate, seconds=options.seconds,
                   background=options.background, known_rate=options.known_rate, detector=options.detector,
                   threads=options.threads, told=_Time("a forecast", 4 * (2 * len(names) + 1), "--particles")))


def _experiment(options: argparse.Namespace) -> object:
    from .errors import InputError
    from .experiment import load
    from .hdf5 import EXPERIMENTS, TABLE
    if options.file.suffix == TABLE:
        data = getattr(options, "data", None)
        experiment = shlex.quote(str(data)) if data and data.suffix in EXPERIMENTS else "EXPERIMENT.yaml"
        raise InputError(f"{options.file} is a table, and an experiment belongs here\n"
                         f"  help: `rabiline fit {experiment} --data {shlex.quote(str(options.file))}` fits an experiment to it")
    experiment = load(options.file)
    if experiment.is_model:
        raise InputError(f"{options.file} is a model: nothing is counted in it")
    if getattr(options, "no_scan", True):
        experiment = experiment.scan()
    changes = [text.partition("=") for text in options.set]
    for name, equals, _ in changes:
        if not equals:
            raise InputError(f"--set {name}: a value is set as NAME=VALUE")
    more = {"particles": options.particles} if options.particles else {}
    return experiment.set({**{name: value for name, _, value in changes}, **more})

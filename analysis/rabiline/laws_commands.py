"""The commands compare-laws and bound-kappa."""
from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import observed, results
from .argument_types import duration, heading, positive, rate
from .laws_report import Beam, all_pairs, report, unit_models
from .likelihood import same
from .templates import HISTOGRAMS, NoTemplates, Templates, templates

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ABOUT_LAWS = """\
How well laws of motion can be told apart, and what measured counts say about them. FILE is a result whose scan has
the law as an axis, alone or with one parameter more:

  rabiline run FILE.yaml --scan 'law=quantum,dorado' -o laws.h5
  rabiline compare-laws laws.h5 -o where.png
  rabiline compare-laws laws.h5 --rate 1e4 --background 2
  rabiline compare-laws laws.h5 --data counts.csv --emitted 5000

No law is preferred: what is said of A against B is said of B against A. `dorado` is a hypothesis.
"""

AFTER_LAWS = """\
Numbers. Counts are independent and Poisson, in cells of the histogram of at least 50 simulated particles under one
of the laws. -2 ln(L_other/L_true) is on average q = 2 Σ [a ln(a/b) - a + b], a and b the counts that both expect;
√q is the median significance (Cowan et al., Eur. Phys. J. C 71, 1554, 2011), here with the next order of a
saddlepoint, and by trials where few counts tell. Templates have Monte Carlo errors of their own, one factor for
each cell (Barlow and Beeston 1993; Dembinski and Abdelmotteleb, Eur. Phys. J. C 82, 1043, 2022).

Data. A table has a line of names, then one line for each bin: counts; x and z, or one of them (bin centres), or
x_from and x_to; the scanned parameter; detector; emitted. Names may carry a unit: `x [mm]`, `H0.frequency [kHz]`.
Without x and z, counts are those of the whole detector. Scan points that are not listed were not measured; bins
that are not listed hold no counts. A result of `rabiline run` under one law may stand in for data; let its scan
points be independent (--set scan.particles=independent) and its seed another one. It emits a fixed number of
particles, and a beam does not: where nearly all are caught, p comes out near 1.

  H0.frequency [kHz],counts
  288.1,4967
  291.6,4903

`neither fits` means p < 0.001 for both; a law is favoured where it fits and the likelihood ratio is one that the
other law makes in less than 0.00135 of measurements (three sigmas); else the data `cannot tell`.
"""

ABOUT_KAPPA = """\
Which strengths κ of the hypothesis `dorado` measured counts allow: the interval that is connected to κ = 0,
straight flight. FILE is a result whose scan has law.kappa as an axis, alone or with one parameter more:

  rabiline run FILE.yaml --set 'law={name: dorado, kappa: 0}' --scan 'law.kappa=0:0.004:17' -o kappa.h5
  rabiline bound-kappa kappa.h5 --data counts.csv --emitted 5000 -o profile.png
  rabiline bound-kappa kappa.h5 --emitted 5000            # what to expect if κ = 0

Data are those of compare-laws (see its --help). The scan points of FILE should share their particles, as they do by
default: then -2 ln L is smooth in κ. Simulate ten times as many particles at each point as there are counts.
"""

AFTER_KAPPA = """\
Accepted at 95 % are the κ with -2 ln L less than 3.84 above its least value over the scan (Wilks 1938; at the edge
κ = 0 this is on the safe side). -2 ln L is interpolated between scan points by a cubic that does not overshoot
(Fritsch and Carlson 1980). Where it is rough from point to point, as Monte Carlo errors make it, the 3.84 grow by
twice that. Cells are coarser than those of compare-laws, about 32 for each point, which makes it smoother. It need
not rise all the way: at κ = 2 the suggested experiment's beam is not turned sideways any more. Other accepted
intervals are listed, and not part of the bound.
"""


def arguments(verb: str, made: argparse.ArgumentParser) -> None:
    """The options of one of the commands."""
    function, made.description, made.epilog = (compare_laws, ABOUT_LAWS, AFTER_LAWS) if verb == "compare-laws" else \
        (bound_kappa, ABOUT_KAPPA, AFTER_KAPPA)
    made.set_defaults(command=function)
    made.add_argument("file", metavar="FILE", type=Path)
    if verb == "compare-laws":
        made.add_argument("--reference", metavar="LAW",
                          help="compare this law with each other; all pairs by default (the picture shows the first pair "
                               "that differs)")
    made.add_argument("--detector", metavar="NAME", help="all by default")
    made.add_argument("--histogram", choices=list(HISTOGRAMS),
                      help="what is compared: the image over x and z (default), a projection, or the number that "
                           "the detector caught; with a table as data, what it lists")
    made.add_argument("--data", type=Path, metavar="DATA",
                      help="measured counts: a table (CSV), or a result (HDF5) that stands in for data")
    made.add_argument("--emitted", type=positive, metavar="N",
                      help="particles emitted at each scan point while the data were taken (of an aimed source, "
                           "those towards its target); where nothing tells, the flux is fitted")
    made.add_argument("--rate", type=rate, metavar="R",
                      help="particles that leave the source per second (1/s)")
    made.add_argument("--background", type=rate, metavar="B",
                      help="counts per second without a beam (1/s), evenly over each detector; needs --rate, and "
                           "--seconds where there are data")
    made.add_argument("--seconds", type=duration, metavar="T",
                      help="time spent at each scan point of the data (s)")
    made.add_argument("--free-flux", action="store_true", help="the flux is not known: only shapes count")
    made.add_argument("-o", "--output", type=Path, metavar="PNG", help="a picture: PNG, PDF or SVG")
    made.add_argument("--title", type=heading, help="of the picture, instead of the file's own")


def compare_laws(options: argparse.Namespace) -> Figure | None:
    """How well laws of motion can be told apart."""
    made, data, beam = _read(options, "law", np.inf)
    names = {name for law in made.names for name in (law, law.split(" ")[0])}
    if options.reference is not None and options.reference not in names:
        raise NoTemplates(f"{made.path}: no law `{options.reference}` (there is {', '.join(made.names)})")
    pairs = all_pairs(made.names, options.reference)
    print("\n".join(report(made, beam, pairs, data)))
    if not options.output:
        return None
    from .laws_plots import draw_laws
    found = unit_models(made, beam)
    shown = next((pair for pair in pairs if not same(found[pair[0]], found[pair[1]])), pairs[0])
    return draw_laws(made, beam, shown, data, options.title)


def bound_kappa(options: argparse.Namespace) -> Figure | None:
    """Which strengths of the hypothesis counts allow."""
    from .kappa import MOST_CELLS, bound, bound_report
    made, data, beam = _read(options, "law.kappa", MOST_CELLS)
    found = bound(made, beam, data)
    print("\n".join(bound_report(made, found)))
    if not options.output:
        return None
    from .kappa_plots import draw_profile
    return draw_profile(made, found, options.title)


def _read(options: argparse.Namespace, parameter: str, most: float) -> tuple[Templates, observed.Observation | None, Beam]:
    file = results.read(options.file)
    listed = observed.histogram_in(options.data) if options.data else None
    if listed and options.histogram and listed != options.histogram:
        raise NoTemplates(f"{options.data}: its columns are those of --histogram {listed}, not {options.histogram}")
    if options.detector is not None and options.detector not in file.detectors:
        raise NoTemplates(f"{file.path}: no detector `{options.detector}` (there is {', '.join(file.detectors)})")
    made = templates(file, parameter, options.histogram or listed or "image", most).choose(options.detector)
    rate = options.rate or file.rate
    if options.background is not None and rate is None:
        raise NoTemplates("--background needs --rate, the particles that leave the source per second")
    backgrounds = tuple(screen.background if options.background is None else options.background
                        for screen in made.screens)
    if options.seconds and not options.data:
        raise NoTemplates("--seconds is the time at each scan point of --data: without them nothing is counted over a time")
    if any(backgrounds) and options.data and not options.seconds:
        raise NoTemplates("counts without a beam are stated, and not for how long: --seconds, the time at each scan "
                          "point of the data")
    beam = Beam(rate, backgrounds, options.free_flux, options.seconds, options.emitted)
    data = observed.read(options.data, made) if options.data else None
    warnings = list(data.warnings) if data else []
    counted = sum(own.sum() for own in data.counts) if data else 0
    if not made.independent and made.points > 1 and counted > made.emitted[0] / 10:
        warnings.append(f"the scan points of {made.path} share {made.emitted[0]:.6g} particles, and Monte Carlo errors "
                        "are counted as if each point had its own; with so many data, run it with more particles"
                        f"{'' if parameter == 'law.kappa' else ', or with --set scan.particles=independent'}")
    for warning in warnings:
        print(f"rabiline: warning: {warning}", file=sys.stderr)
    return made, data, beam

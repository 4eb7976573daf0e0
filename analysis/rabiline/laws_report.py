"""How laws compare, in words: what tells them apart, how many particles that takes, where it is, what data say."""
from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Iterable, Sequence

import numpy as np

from .covariance import ChiSquared
from .likelihood import SIGMAS, Model, Separation, agreement, same, separation
from .observed import Observation, in_cells
from .templates import HISTOGRAMS, Templates, models, spread_over_bins
from .units import format_value, law_name
from .verdict import Verdict, verdict

HALF = 0.5  # of q, that the bins named carry
DAY, YEAR = 86400.0, 31557600.0


@dataclass(frozen=True)
class Beam:
    """What is known of the experiment."""

    rate: float | None  # 1/s that leave the source
    backgrounds: tuple[float, ...]  # 1/s, one for each screen of the templates
    free: bool  # the flux is not known
    seconds: float | None = None  # at each scan point, of the data
    emitted: float | None = None  # particles at each scan point, of the data


def report(made: Templates, beam: Beam, pairs: Sequence[tuple[int, int]], data: Observation | None) -> Iterable[str]:
    """Lines for each screen, and for all together where there are several."""
    names = [law_name(name) for name in made.names]
    yield f"{made.title or made.path}"
    yield f"  laws         {'; '.join(names)}"
    over = f"; {made.points} points of {made.axis.parameter}" if made.axis else ""
    yield f"  compared     counts over {HISTOGRAMS[made.screens[0].histogram]}{over}"
    yield f"  flux         {'not known: only shapes count' if beam.free else 'known'}"
    for chosen in [[i] for i in range(len(made.screens))] + ([list(range(len(made.screens)))]
                                                            if len(made.screens) > 1 else []):
        part = Templates(**{**vars(made), "screens": tuple(made.screens[i] for i in chosen)})
        own = Beam(beam.rate, tuple(beam.backgrounds[i] for i in chosen), beam.free, beam.seconds, beam.emitted)
        yield f"detector {part.screens[0].name}" if len(chosen) == 1 else "all detectors together"
        for one, other in pairs:
            yield from (f"  {line}" for line in _pair(part, own, one, other))
        if data is not None:
            yield from (f"  {line}" for line in _data(part, own, data.of(chosen)))


def unit_models(made: Templates, beam: Beam) -> list[Model]:
    """Of one unit of exposure: one second at each scan point where the rate is known, else one particle emitted."""
    if beam.rate is None:
        return models(made, 1.0, None, beam.free)
    return models(made, beam.rate * made.aimed, list(beam.backgrounds), beam.free)


def against_data(made: Templates, beam: Beam, data: Observation) -> tuple[np.ndarray, list[Model], bool]:
    """Counts [cells], a model for each law, and whether the flux is free."""
    known = data.emitted if data.emitted is not None else None
    if known is None and beam.emitted is not None:
        known = np.full(made.points, beam.emitted)
    if known is None and beam.rate is not None and beam.seconds is not None:
        known = beam.rate * made.aimed * beam.seconds
    free = beam.free or known is None
    backgrounds = [each * beam.seconds for each in beam.backgrounds] if beam.seconds else None
    exposure = known if known is not None else np.ones(made.points)
    n, made_models = in_cells(made, data, backgrounds, free, exposure)
    return n, made_models, free


def verdict_of(made: Templates, beam: Beam, data: Observation) -> Verdict:
    """What data say about the laws."""
    n, found, _ = against_data(made, beam, data)
    return verdict([law_name(name) for name in made.names], found, n)


def _pair(made: Templates, beam: Beam, one: int, other: int) -> Iterable[str]:
    names = [law_name(made.names[i]) for i in (one, other)]
    found = unit_models(made, beam)
    a, b = found[one], found[other]
    yield f"{names[0]} against {names[1]}"
    if same(a, b):
        yield "  the same prediction in every bin, to the last bit: no number of particles tells them apart here"
        return
    value, freedom, p = agreement(a, b.at(a.expected))
    yield f"  templates     {ChiSquared(value, freedom, p)}, within their Monte Carlo errors"
    simulated = models(made, made.emitted)
    apart = [separation(simulated[i], simulated[j]) for i, j in ((one, other), (other, one))]
    yield f"  as many counts as simulated, {made.emitted[0]:.6g} particles at each point (mean, which is AIC's " \
          "difference too, ± Monte Carlo error)"
    for i, way in enumerate(apart):
        yield f"    {names[i]} true: -2 ln(L_other/L_true) = {format_value(way.q, '', way.error)}, " \
              f"{_sigmas(way.significance(1.0)) if way.told else 'not told apart'}"
    ways = [separation(a, b), separation(b, a)]
    yield f"  {SIGMAS:g} sigma in half of the measurements takes"
    for i, way in enumerate(ways):
        yield f"    {names[i]} true: {_exposure(way, made, beam)}"
    if any(way.told for way in ways):
        yield from _where(made, a, b, ways[0], names)


def _sigmas(value: float) -> str:
    return f"{value:.3g} sigma" if value < 100 else "more than 100 sigma"


def _exposure(way: Separation, made: Templates, beam: Beam) -> str:
    exposure = way.exposure()
    if not np.isfinite(exposure):
        return "no number that this simulation can tell: the templates differ by no more than their Monte Carlo errors"
    particles = exposure * (beam.rate * made.aimed if beam.rate is not None else np.ones(made.points))
    at = f"{particles.mean():.3g} at each of {made.points} points, " if made.points > 1 else ""
    relative = way.error / way.q
    kind = "particles" if np.all(made.aimed == 1) else "particles aimed at the target"
    text = f"{particles.sum():.3g} {kind} ({at}Monte Carlo error {relative:.1%})"
    return text if beam.rate is None else f"{text}; {_duration(exposure * made.points)} of beam"


def _duration(seconds: float) -> str:
    for unit, size in (("years", YEAR), ("days", DAY), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 2 * size:
            return f"{seconds / size:.3g} {unit}"
    return format_value(float(f"{seconds:.3g}"), "s")


def _where(made: Templates, a: Model, b: Model, way: Separation, names: list[str]) -> Iterable[str]:
    """The least set of scan points, and of rows of bins, that carries half of q."""
    begin = 0
    for screen in made.screens:
        cells = int(screen.cells.max()) + 1
        own = slice(begin, begin + cells)
        begin += cells
        share = way.contributions[own].sum() / way.contributions.sum()
        prefix = f"{screen.name}, {share:.0%} of it: " if len(made.screens) > 1 else ""
        if share == 0:
            continue
        bins = spread_over_bins(screen, way.contributions[own])
        places = []
        if made.axis is not None:
            values = made.axis.labels or made.axis.values
            chosen = _half(bins.sum(axis=(1, 2)))
            shown = [v if isinstance(v, str) else format_value(float(v), made.axis.units) for v in
                     (values[chosen[0]], values[chosen[-1]])]
            span = f"{made.axis.parameter} {' to '.join(dict.fromkeys(shown))} ({chosen.size} of {made.points} points)"
            places.append(span)
        for name, axis in (("x", (0, 2)), ("z", (0, 1))):
            along = bins.sum(axis=axis)
            edges = screen.edges["xz".index(name)]
            if along.size > 1:
                chosen = _half(along)
                places.append(f"{name} {format_value(edges[chosen[0]], 'm')} to "
                              f"{format_value(edges[chosen[-1] + 1], 'm')} ({chosen.size} of {along.size} bins)")
        yield f"  half of it is in {prefix}{places[0] if places else 'the one number of counts'}"
        yield from (f"    {place}" for place in places[1:])
        overlap = np.minimum(a.expected, b.expected)[own].sum() / (a.expected + b.expected)[own].sum() * 2
        yield f"    what both expect overlaps by {100 * overlap:.3g} %"


def _half(shares: np.ndarray) -> np.ndarray:
    """The numbers of the largest `shares` that together make half of the sum, sorted."""
    order = np.argsort(-shares, kind="stable")
    count = int(np.searchsorted(np.cumsum(shares[order]), HALF * shares.sum())) + 1
    return np.sort(order[:count])


def _data(made: Templates, beam: Beam, data: Observation) -> Iterable[str]:
    n, found, free = against_data(made, beam, data)
    result = verdict([law_name(name) for name in made.names], found, n)
    flux = "flux fitted" if free else "flux known"
    yield f"data: {data.path}, {n.sum():.6g} counts in {n.size} cells, {flux}; p from {result.trials} trials"
    best = min(fit.aic for fit in result.fits)
    width = max(map(len, result.names))
    for name, fit in zip(result.names, result.fits):
        yield f"  {name:<{width}}  -2 ln L {fit.deviance:.1f}, {_p(fit.p, result.trials)}; {fit.chi_squared}; AIC " \
              f"+{fit.aic - best:.1f}"
    for pair in result.pairs:
        one, other = result.names[pair.one], result.names[pair.other]
        if pair.same:
            yield f"  {one} and {other} predict the same"
            continue
        (mean, spread), (mean_other, spread_other) = pair.expected
        yield f"  -2 ln(L of {other} / L of {one}) = {pair.ratio:.1f}; expected {mean:.1f} ± {spread:.1f} if {one} " \
              f"holds, {mean_other:.1f} ± {spread_other:.1f} if {other} holds"
        yield f"    as much against {other}: {_tail(pair.p[1])}; as much against {one}: {_tail(pair.p[0])}"
    yield f"  so {result.words}"


def _p(p: float, trials: int) -> str:
    return f"p < {max(1.001 * p, 1e-12):.1g}" if p < 1.5 / (trials + 1) else f"p = {p:.2g}"


def _tail(p: float) -> str:
    return f"p = {min(p, 1.0):.2g}" if p > 1e-12 else "p < 1e-12"


def all_pairs(names: Sequence[str], reference: str | None) -> list[tuple[int, int]]:
    """Numbers of laws, each with each, or the reference with each other one."""
    if reference is None:
        return list(combinations(range(len(names)), 2))
    first = next(i for i, name in enumerate(names) if name == reference or name.split(" ")[0] == reference)
    return [(first, i) for i in range(len(names)) if i != first]

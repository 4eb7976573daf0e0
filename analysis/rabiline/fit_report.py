"""A fit of counts in words."""
from __future__ import annotations

from typing import TYPE_CHECKING, Iterable

import numpy as np
from scipy import stats

from .covariance import LEAST_P, freedom_in_words, p_in_words
from .held import PART, Held
from .units import format_value, unit_shown

if TYPE_CHECKING:
    from .fitting import CountsFit

MANY_COUNTS = 12  # all even by chance in one table of four thousand
LOST = 10  # times a parameter: an error that leaves nothing of it
BORNE_OUT = 3  # a factor between an error by the curvature and one by the profile that leaves them one
REJECTED = "the experiment does not describe these counts: errors mean little"
COARSE = "the simulation has too few particles to tell more: what is not known, and chi², are no verdict on the counts"
IMPOSSIBLE = 3  # errors beyond what a parameter may be
ALIKE = 0.95  # a correlation
LARGEST_SHARE = 0.5  # of a variance that may be the simulation's own, where it tells what is degenerate
ROUGH = 0.2  # relative error of a curve that is beyond what chi² can judge: some 25 particles at a point


def report(fit: CountsFit) -> Iterable[str]:
    """Lines: values with errors and profile intervals, correlations, chi², what is degenerate."""
    yield (f"{fit.title}: {fit.counts.counts.size} points of {fit.counts.path} over "
           f"{' and '.join([fit.counts.parameter, *([fit.counts.across.parameter] if fit.counts.across else [])])}, at {fit.detector}")
    width = max(map(len, fit.names))
    for i, (name, unit) in enumerate(zip(fit.names, fit.units)):
        if unknown := why_unknown(fit, i):
            yield f"  {name:<{width}}  {unknown}, held near {format_value(float(f'{fit.values[i]:.4g}'), unit, None, fit.written_unit(i))}"
            continue
        if is_undetermined(fit, i):
            yield f"  {name:<{width}}  not determined by these counts"
            continue
        low, high = fit.intervals[i]
        shown = unit_shown(fit.values[i], unit, fit.errors[i], fit.written_unit(i))
        yield f"  {name:<{width}}  {fit.told(i)}   (profile {_signed(low - fit.values[i], *shown)}, {_signed(high - fit.values[i], *shown)})"
    for name, value, error in ((name, value, error) for name, value, error in fit.combined if np.isfinite(value)):
        yield f"  {name}: {value:.6g} ± {error:.2g} in SI"
    for name, limit in fit.beyond:
        i = fit.names.index(name)
        yield (f"  `{name}` goes to {format_value(float(f'{limit:.4g}'), fit.units[i], None, fit.written_unit(i))} and no further: beyond, the simulated "
               "curve is taken to go on straight")
        if abs(fit.values[i] - limit) > IMPOSSIBLE * fit.errors[i]:
            correlation = fit.covariance[i] / fit.errors / fit.errors[i]
            alike = [f"`{other}`" for j, other in enumerate(fit.names) if j != i and abs(correlation[j]) > ALIKE]
            yield f"  help: a value that is {abs(fit.values[i] - limit) / fit.errors[i]:.0f} errors beyond cannot be: hold `{name}`{''.join(f', or {one}, which does nearly the same' for one in alike)}"
    yield from (f"  {direction}" for direction in dict.fromkeys(map(str, fit.degenerate)))
    if fit.wanted_particles > fit.particles:
        yield f"  help: {few_particles(fit.particles, fit.wanted_particles)}"
    if fit.is_flat:
        yield from (f"  help: {line}" for line in _about_unit(fit))
    correlation = fit.covariance / fit.errors[:, None] / fit.errors
    if not fit.degenerate:
        for i, name in enumerate(fit.names):
            for j in range(i):
                if abs(correlation[i, j]) > 0.3:
                    yield f"  correlation of {fit.names[j]} and {name}: {correlation[i, j]:+.2f}"
    yield f"  chi² {fit.chi_squared:.1f} for {freedom_in_words(fit.freedom)}, {p_in_words(fit.p)}" if fit.freedom > 0 else \
        "  as many parameters as points: nothing is left that could tell whether the experiment describes these counts"
    yield f"  condition number {fit.condition:.3g}; {fit.flights} flights"
    if fit.share_of_simulation > 0.2 and not fit.degenerate:
        wanted = 9 * fit.share_of_simulation / (1 - min(fit.share_of_simulation, 0.999)) * fit.particles
        name = fit.names[int(np.argmax(fit.shares_of_simulation))]
        yield (f"  {fit.share_of_simulation:.0%} of the variance of {name} comes from the simulation itself: {wanted:.2g} `particles` would make that "
               "a tenth")
    if fit.sparse and fit.searches > 1:
        yield f"  the points are farther apart than what the curve shows is wide, so that other values may fit as well: this is the best of {fit.searches} searches"
    for rival in fit.rivals:
        moved = (rival.values - fit.values) / fit.errors
        i = int(np.argmax(np.abs(moved)))
        there = format_value(float(f"{rival.values[i]:.4g}"), fit.units[i], None, fit.written_unit(i))
        yield (f"  nearly as good: {fit.names[i]} near {there}, {abs(moved[i]):.0f} of its errors from here, where −2 ln L is {max(rival.rise, 0.0):.1f} higher: measure more points")
    if fit.about_background:
        yield f"  {fit.about_background}"
    for one in fit.held:
        yield from _about_held(fit, one)
    if verdict := verdict_of(fit):
        yield f"  {verdict}"
    if fit.p < LEAST_P and (why := _as_rates(fit.counts.counts)):
        yield f"  {why}: are they rates? What was counted has its errors by itself; write that, and a column `seconds`"


def _as_rates(counts: np.ndarray) -> str:
    """What [n] counts have in common that were divided by a time, or multiplied; empty where they have nothing."""
    step = np.gcd.reduce(np.rint(counts).astype(np.int64))
    return f"all counts are multiples of {step}" if step > 1 and np.count_nonzero(counts) >= MANY_COUNTS else ""


def why_unknown(fit: CountsFit, number: int) -> str:
    """Of a parameter; empty where it is known."""
    lost = [direction for direction in fit.degenerate if number in direction.involved]
    return "lost in the simulation's noise" if lost and all(one.hidden for one in lost) else "not known by itself" if lost else ""


def told_shortly(fit: CountsFit, number: int) -> str:
    """A parameter with its value, where it has one."""
    name, unknown = fit.names[number], why_unknown(fit, number) or ("not determined" if is_undetermined(fit, number) else "")
    return f"{name} {unknown}" if unknown else f"{name} = {fit.told(number)}"


def few_particles(particles: int, wanted: float) -> str:
    """For a fit, or a forecast."""
    return f"{particles} particles at each point may be too few to tell: try --particles {float(f'{wanted:.1g}'):.0f}"


def verdict_of(fit: CountsFit) -> str:
    """What is wrong with the whole of it; empty where nothing is."""
    seen = fit.expected >= 1  # where the curve has nothing no simulation is rough
    is_rejected, is_rough = fit.p < LEAST_P, seen.any() and np.median((fit.template_errors / fit.expected)[seen]) > ROUGH
    if (fit.degenerate and fit.share_of_simulation > LARGEST_SHARE) or is_rough:
        return COARSE
    return f"{REJECTED}{f' (the best of {fit.searches} searches)' if fit.searches > 1 else ''}" if is_rejected else ""


def is_undetermined(fit: CountsFit, number: int) -> bool:
    """Whether the error of a parameter is many times as large as the parameter is, and as it was at the start, and no profile bears it out."""
    size = max(abs(fit.values[number]), *np.abs(fit.start[number:number + 1]), 0.0)
    low, high = fit.intervals[number]
    borne_out = 1 / BORNE_OUT < (high - low) / (2 * fit.errors[number]) < BORNE_OUT
    return bool(fit.errors[number] > LOST * size and not borne_out)


def _about_unit(fit: CountsFit) -> Iterable[str]:
    counts = fit.counts
    extent = f"{counts.places[int(np.argmin(counts.x))]} to {counts.places[int(np.argmax(counts.x))]}"
    yield f"the counts change from {extent}, and the simulated curve does not: is the unit of the column `{counts.parameter}` right, or does the fit start too far away?"


def _about_held(fit: CountsFit, one: Held) -> Iterable[str]:
    """What the counts say about a parameter that was not free, and what hangs on it."""
    i = int(np.argmax(np.abs(one.moved)))
    if one.searched:
        there = format_value(float(f"{fit.values[i] + one.moved[i] * fit.errors[i]:.3g}"), fit.units[i], None, fit.written_unit(i))
        yield (f"  `{one.name}` is not free, and the counts fit as well with {one.value:.3g} of it and {fit.names[i]} near {there}, {abs(one.moved[i]):.0f} "
               "of its errors from here: a search from where the fit started ends there")
        yield f"  help: fit with `{one.name}` in --free, or measure it"
    elif one.is_wanted and float(stats.chi2.sf(fit.chi_squared - one.fall, fit.freedom - 1)) < LEAST_P:
        yield (f"  a free `{one.name}` would take {one.fall:.0f} off chi², which leaves it too large: something else that is held, or the experiment "
               "itself, is not as in the measurement")
    elif one.is_wanted and not one.is_possible:
        yield (f"  the counts lean towards a {one.name} of {one.value:.3g} by {np.sqrt(one.fall):.1f} standard deviations, which cannot be: something else that "
               "is held, or the experiment itself, is not as in the measurement")
    elif one.is_wanted:
        yield (f"  `{one.name}` is not free, and the counts lean towards {one.value:.3g} by {np.sqrt(one.fall):.1f} standard "
               f"deviations, whatever chi² says: that moves {fit.names[i]} by {abs(one.moved[i]):.1f} of its errors, or more")
        yield f"  help: fit with `{one.name}` in --free"
    elif one.matters:
        i = int(np.argmax(np.abs(one.by_part)))
        yield (f"  `{one.name}` is taken as known: {PART:.0%} of the counts more by it would move {fit.names[i]} by {abs(one.by_part[i]):.1f} of its "
               "errors")


def _signed(by: float, unit: str, factor: float) -> str:
    size = abs(by) / factor
    if not np.isfinite(by) or size == 0:
        return f"+0 {unit}".strip() if size == 0 else "open"
    digits = max(0, 2 - int(np.floor(np.log10(size))))  # three, as the error beside it has two
    return f"{'+' if by > 0 else '−'}{float(f'{size:.3g}'):.{digits}f} {unit}".strip()

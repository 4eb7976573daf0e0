"""Which strengths κ of the hypothesis counts allow: the interval of the likelihood that is connected to κ = 0."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Iterable

import numpy as np
from scipy import interpolate, stats

from .errors import InputError
from .laws_report import Beam, against_data
from .likelihood import SEED, TRIALS, Model, p_value, trials
from .observed import Observation
from .templates import Templates, models

CONFIDENCE = 0.95
FINE = 200  # interpolated places between two scan points
LEAST_POINTS = 3  # of the scan within the interval, from 0 on, for the interpolation to be trusted
UNFIT = 0.001
MOST_CELLS = 32  # for each scan point and detector: fewer have smaller Monte Carlo errors, and a shift is seen by all
ROUGH = 0.1  # below this it is not worth a word
NEAR = 40.0  # above the least -2 ln L, where its roughness is looked at
MOST_NOISE = 1.0  # of -2 ln L by Monte Carlo errors, where each strength has its own


class NoBound(InputError):
    """Counts or a scan that give no bound, and why."""


@dataclass(frozen=True)
class Interval:
    """Accepted strengths; open where the scan ends before they do."""

    low: float
    high: float
    open_low: bool
    open_high: bool


@dataclass(frozen=True)
class Profile:
    """-2 ln L over κ, above its least value."""

    strengths: np.ndarray  # [n] rising
    values: np.ndarray  # [n] at the scan points
    fine: np.ndarray  # [m] strengths between them
    interpolated: np.ndarray  # [m]
    level: float  # accepted below this
    connected: Interval | None  # to κ = 0; None where κ = 0 itself is not accepted
    others: tuple[Interval, ...]
    rough: float = 0.0  # one standard deviation from point to point; twice this is part of the level

    @property
    def coarse(self) -> bool:
        """Whether too few scan points are accepted to say where between two of them the interval ends."""
        interval = self.connected
        if interval is None or (interval.open_low and interval.open_high):
            return False
        near = self.strengths[(self.strengths >= interval.low) & (self.strengths <= interval.high)]
        return near.size < LEAST_POINTS

    @property
    def quoted(self) -> Interval | None:
        """The interval connected to κ = 0; where the scan is coarse, out to the nearest scan points that are rejected,
        which is on the safe side."""
        if not self.coarse:
            return self.connected
        interval = self.connected
        below, above = self.strengths[self.strengths < interval.low], self.strengths[self.strengths > interval.high]
        return Interval(interval.low if interval.open_low else float(below[-1]),
                        interval.high if interval.open_high else float(above[0]), interval.open_low, interval.open_high)

    @property
    def best(self) -> float:
        """The strength at which -2 ln L is least."""
        return float(self.fine[np.argmin(self.interpolated)])


@dataclass(frozen=True)
class Bound:
    """A profile, and what it came from."""

    profile: Profile
    source: str  # of the counts: the file, which may hold measured ones or stand-ins, or what they are expected from
    counts: float
    free: bool
    p: float | None  # of the counts at the best scan point; None for counts that are expected and not measured
    trials: int


def profile(strengths: np.ndarray, values: np.ndarray, confidence: float = CONFIDENCE) -> Profile:
    """Of -2 ln L `values` [n] at `strengths` [n].

    Accepted are strengths with -2 ln L less than the quantile of χ² with one degree of freedom above the least value
    of all (Wilks 1938). Between scan points a monotone cubic is taken (Fritsch and Carlson 1980, PCHIP), which makes no
    minima of its own: the least value is that of a scan point. Raises NoBound."""
    order = np.argsort(strengths)
    strengths, values = np.asarray(strengths, float)[order], np.asarray(values, float)[order]
    if strengths.size < 2 or not strengths[0] <= 0 <= strengths[-1]:
        raise NoBound(f"the scan over law.kappa goes from {strengths[0]:g} to {strengths[-1]:g} and must hold κ = 0")
    if not np.isfinite(values).all():
        raise NoBound("the likelihood is not finite at every strength")
    gaps = [np.linspace(a, b, FINE, endpoint=False) for a, b in zip(strengths[:-1], strengths[1:])]
    fine = np.unique(np.concatenate([*gaps, [strengths[-1]], [0.0]]))
    curve = interpolate.PchipInterpolator(strengths, values)(fine)
    least = curve.min()
    rough = _roughness(values - least)
    level = float(stats.chi2.isf(1 - confidence, 1)) + 2 * rough
    inside = np.concatenate([[False], curve - least <= level, [False]])
    begins, ends = np.flatnonzero(~inside[:-1] & inside[1:]), np.flatnonzero(inside[:-1] & ~inside[1:])
    found = [_interval(fine, curve - least - level, begin, end - 1) for begin, end in zip(begins, ends)]
    connected = next((interval for interval in found if interval.low <= 0 <= interval.high), None)
    others = tuple(interval for interval in found if interval is not connected)
    return Profile(strengths, values - least, fine, curve - least, level, connected, others, rough)


def _roughness(values: np.ndarray) -> float:
    """The scatter of values about a smooth curve, from third differences of neighbours near the least value: those of a
    parabola are 0, those of independent errors have 20 times their variance."""
    thirds = [np.diff(values[i:i + 4], 3)[0] for i in range(values.size - 3) if values[i:i + 4].max() <= NEAR]
    return float(np.sqrt(np.mean(np.square(thirds)) / 20)) if len(thirds) >= 3 else 0.0


def bound(made: Templates, beam: Beam, data: Observation | None) -> Bound:
    """From data, or without them from the counts that κ = 0 expects of `beam.emitted` particles at each point."""
    if data is None:
        zero = np.flatnonzero(made.strengths == 0)
        if not zero.size:
            raise NoBound(f"{made.path}: no scan point at κ = 0, whose counts could stand in for --data")
        exposure = beam.emitted if beam.emitted is not None else \
            beam.rate * made.aimed * beam.seconds if beam.rate is not None and beam.seconds else None
        if exposure is None:
            raise NoBound("without --data: --emitted, the particles at each scan point for which to tell the bound")
        backgrounds = [each * beam.seconds for each in beam.backgrounds] if beam.seconds else None
        found = models(made, exposure, backgrounds, beam.free)
        n, free = found[zero[0]].expected, beam.free
        source = f"expected if κ = 0, {np.mean(exposure):.6g} particles emitted at each scan point"
    else:
        n, found, free = against_data(made, beam, data)
        source = str(data.path)
    values = np.array([float(model.deviance(n)) for model in found])
    noise = _noise(found[int(np.argmin(values))], n)
    if made.independent and noise > MOST_NOISE:
        raise NoBound(f"{made.path}: each κ was simulated with particles of its own, and by that alone -2 ln L "
                      f"scatters by {noise:.2g} from one κ to the next; run it without scan.particles=independent, or "
                      "with more particles")
    result = profile(made.strengths, values)
    best = found[int(np.argmin([model.deviance(n) for model in found]))]
    number = int(np.clip(2**22 // n.size, 300, TRIALS))
    return Bound(result, source, float(n.sum()), free, None if data is None else _p(best, n, number), number)


def _noise(model: Model, n: np.ndarray) -> float:
    """By how much -2 ln L of counts n [cells] scatters between templates with independent Monte Carlo errors: to first
    order a relative error e of a cell changes it by 2 e (mu - n)/(1 + mu/k), and e² is 1/k for both templates."""
    at = model.at(n)
    mu, k = at.expected, at.support
    return float(np.sqrt(2 * np.sum((2 * (mu - n) / (1 + mu / k)) ** 2 / k)))


def family(made: Templates) -> str:
    """The law whose strength is scanned: "dorado (hypothesis): torque"."""
    name, _, closure = made.names[0].split(", kappa")[0].rstrip(")").partition(" (")
    return f"{name} (hypothesis): {closure}" if closure else f"{name} (hypothesis)"


def bound_report(made: Templates, found: Bound) -> Iterable[str]:
    """Lines."""
    result = found.profile
    yield made.title or made.path
    over = f"; {made.points} points of {made.axis.parameter}" if made.axis else ""
    yield f"  law          {family(made)}; κ from {result.strengths[0]:g} to {result.strengths[-1]:g}, " \
          f"{result.strengths.size} points{over}"
    yield f"  detectors    {', '.join(screen.name for screen in made.screens)}"
    yield f"  counts       {found.source}; {found.counts:.6g} in all, flux {'fitted' if found.free else 'known'}"
    yield f"  best         κ = {result.best:.4g}; κ = 0 is {_above_zero(result):.2f} above it in -2 ln L"
    if found.p is not None:
        yield f"  fit          p = {found.p:.2g} at the best scan point, from {found.trials} trials"
        if found.p < UNFIT:
            yield "  so no κ of this scan fits the counts, and the interval below means nothing"
    interval = result.quoted
    if interval is None:
        yield f"  bound        none connected to κ = 0: the counts reject κ = 0 at {CONFIDENCE:.0%}, within this " \
              "family of laws (one measurement in twenty does so by chance)"
    else:
        yield f"  bound        {_in_words(interval)} at {CONFIDENCE:.0%}, connected to κ = 0"
        if interval.open_high and interval.high > 0:
            yield "               the scan ends before the likelihood falls; a longer range of law.kappa tells more"
        if result.coarse:
            yield "               out to the nearest scan points that are rejected: too few are accepted to " \
                  "interpolate; scan law.kappa in smaller steps"
    if result.rough > ROUGH:
        yield f"  rough        -2 ln L scatters by {result.rough:.2g} between scan points, as Monte Carlo errors " \
              f"make it: accepted below {result.level:.2f}; more particles tell more"
    for other in result.others:
        yield f"  also         {_in_words(other)} is accepted, not connected to κ = 0"


def _above_zero(result: Profile) -> float:
    return float(np.interp(0.0, result.fine, result.interpolated))


def _in_words(interval: Interval) -> str:
    low = f"{interval.low:.3g}{' (end of the scan)' if interval.open_low and interval.low else ''}"
    return f"{low} ≤ κ ≤ {interval.high:.3g}{' (end of the scan)' if interval.open_high else ''}"


def _interval(fine: np.ndarray, above: np.ndarray, begin: int, end: int) -> Interval:
    """From the first to the last accepted place, and on to where straight lines cross the level."""
    def crossing(inside: int, outside: int) -> float:
        part = above[inside] / (above[inside] - above[outside])
        return float(fine[inside] + part * (fine[outside] - fine[inside]))

    open_low, open_high = begin == 0, end == fine.size - 1
    return Interval(float(fine[begin]) if open_low else crossing(begin, begin - 1),
                    float(fine[end]) if open_high else crossing(end, end + 1), open_low, open_high)


def _p(model: Model, n: np.ndarray, number: int) -> float:
    fitted = model.at(n)
    drawn, _ = trials(fitted, [fitted], np.random.default_rng(SEED), number)
    return p_value(float(fitted.deviance(n)), drawn[0])

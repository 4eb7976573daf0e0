"""Closed forms of lines: f between 0 and 1, about a centre. Frequencies are in Hz; `time` is that in a field, or between Ramsey's two."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, Sequence

import numpy as np

DEVIATIONS = 6.0  # on both sides of the mean flight time, and between the phases that the sum over these times repeats itself
MOST_TIMES, SHORTEST = 400, 0.05  # of these times; of the mean one, which what is shorter takes
TIPS = 0.25, 0.12  # turns in each field
FLIPS = 0.4, 0.7, 0.85, 1.0, 1.2, 1.45, 1.7  # turns of Rabi's spins on resonance, half a turn for a flip, where a fit starts again
RATIOS = 0.4, 0.15, 0.05, 0.01  # of the time in a field to that between the two, where a fit starts


@dataclass(frozen=True)
class Form:
    """A closed form of one line or several."""

    name: str
    parameters: tuple[str, ...]  # of f, beside `centre`
    f: Callable[..., np.ndarray]  # f(x - centre, *parameters)
    starts: Callable[[Sequence[float]], Sequence[Sequence[float]]]  # from widths of the line, or periods of its fringes
    period: Callable[[Sequence[float]], float] | None = None  # of the fringes that the parameters make; None: it has none
    others: Callable[[Sequence[float]], Sequence[Sequence[float]]] | None = None  # starts in other valleys, from where a fit has ended


def lorentz(d: np.ndarray, width: float) -> np.ndarray:
    """[n] At distances d [n] from the centre; `width` is that at half height, in their unit."""
    return 1 / (1 + (2 * d / width)**2)


def gauss(d: np.ndarray, width: float) -> np.ndarray:
    """[n] At distances d [n] from the centre; `width` is that at half height, in their unit."""
    return np.exp2(-(2 * d / width)**2)


def sinc2(d: np.ndarray, time: float) -> np.ndarray:
    """[n] A weak field for a time in s, d [n] in Hz: (sin(pi d t)/(pi d t))²."""
    return np.sinc(d * time)**2


def rabi(d: np.ndarray, strength: float, time: float) -> np.ndarray:
    """[n] Rabi's flip (Phys. Rev. 51, 652, 1937): d [n] and `strength`, the Rabi frequency, in Hz, `time` in s."""
    total = np.hypot(d, strength)
    return (strength / total)**2 * np.sin(np.pi * total * time)**2


def ramsey(d: np.ndarray, strength: float, pulse: float, time: float, spread: float) -> np.ndarray:
    """[n] Ramsey's two fields (Phys. Rev. 78, 695, 1950), d [n] and `strength` in Hz, each for the time `pulse`, averaged over flight times that are normal
    with a relative deviation `spread`."""
    turned = 2 * np.pi * spread * (np.abs(d).max(initial=0.0) * (time + 2 * pulse) + 2 * strength * pulse)  # the phase of one deviation
    deviations = np.linspace(-DEVIATIONS, DEVIATIONS, int(min(DEVIATIONS * (turned + DEVIATIONS) / np.pi, MOST_TIMES)) + 2)
    weights, times = np.exp(-deviations**2 / 2), 1 + spread * deviations
    short = times < SHORTEST
    weights, times = np.append(weights[short].sum(), weights[~short]), np.append(SHORTEST, times[~short])
    return _two_fields(d, strength, pulse * times, time * times, weights / weights.sum())


def ramsey_over(slowness: np.ndarray, weights: np.ndarray) -> Form:
    """The same, averaged over the slowness [s/m] that a result has; the fields are described by their lengths."""
    weights = weights / weights.sum()

    def f(d: np.ndarray, strength: float, zone: float, distance: float) -> np.ndarray:
        return _two_fields(d, strength, zone * slowness, distance * slowness, weights)

    mean = float(slowness @ weights)
    return Form("ramsey", ("strength", "zone", "distance"), f,
                lambda periods: [(tip / tau, tau / mean, time / mean) for tau, time in _times(periods) for tip in TIPS],
                lambda shared: _period(shared[1], shared[2]) / mean)


def rabi_over(slowness: np.ndarray, weights: np.ndarray) -> Form:
    """Rabi's line, averaged over the slowness [s/m] that a result has; the field is described by its length."""
    weights = weights / weights.sum()

    def f(d: np.ndarray, strength: float, length: float) -> np.ndarray:
        total = np.hypot(d, strength)
        return (strength / total)**2 * (np.sin(np.pi * length * total[:, None] * slowness)**2 @ weights)

    mean = float(slowness @ weights)
    return Form("rabi", ("strength", "length"), f, lambda widths: [(strength, time / mean) for strength, time in FORMS["rabi"].starts(widths)],
                others=lambda shared: _flips(shared, mean))


def _flips(shared: Sequence[float], slowness: float) -> list[tuple[float, float]]:
    """Strength, and length of a field that is passed with this slowness."""
    return [(flip / (shared[1] * slowness), shared[1]) for flip in FLIPS]


def _times(periods: Sequence[float]) -> list[tuple[float, float]]:
    """In a field and between the two, for fringes of these periods."""
    return [(ratio * time, time) for period in periods for ratio in RATIOS for time in [_period(ratio, 1.0) / period]]


def _period(pulse: float, time: float) -> float:
    """Of the fringes near their centre: two pulses of a quarter turn add 4/pi of their time to that between."""
    return 1 / (time + 4 / np.pi * pulse)


def _two_fields(d: np.ndarray, strength: float, pulse: np.ndarray, time: np.ndarray, weights: np.ndarray) -> np.ndarray:
    total = np.maximum(np.hypot(d, strength), 1e-300)[:, None]
    pulses, phase, d = 2 * np.pi * total * pulse, np.pi * d[:, None] * time, d[:, None]
    part = d / total  # twice sin(pulse / 2) (cos(phase) cos(pulse / 2) - part sin(phase) sin(pulse / 2)), as a sum of sines
    amplitude = (1 + part) / 2 * np.sin(phase + pulses) - (1 - part) / 2 * np.sin(phase - pulses) - part * np.sin(phase)
    return np.einsum("ij,j->i", (strength / total * amplitude)**2, weights)  # in one thread, as a line is a small matter


FORMS = {form.name: form for form in (
    Form("lorentz", ("width",), lorentz, lambda widths: [(w,) for w in widths]),
    Form("gauss", ("width",), gauss, lambda widths: [(w,) for w in widths]),
    Form("sinc2", ("time",), sinc2, lambda widths: [(0.886 / w,) for w in widths]),
    Form("rabi", ("strength", "time"), rabi, lambda widths: [(strength * w, 0.8 / w) for strength in (0.6, 1.25) for w in widths],
         others=lambda shared: _flips(shared, 1.0)),
    Form("ramsey", ("strength", "pulse", "time", "spread"), ramsey,
         lambda periods: [(tip / tau, tau, time, spread) for tau, time in _times(periods) for tip in TIPS for spread in (0.02, 0.08, 0.2, 0.4)],
         lambda shared: _period(shared[1], shared[2])),
)}

"""Closed forms of lines, fitted to a curve with its covariance: the quick way, where the experiment itself is not needed.

Every curve is baseline + contrast f(x - centre), f one of the forms.
"""
from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Callable, Mapping, Sequence

import numpy as np
from scipy import optimize, special

from . import asked
from .errors import InputError
from .forms import FORMS, Form
from .line_starts import first_guesses, linear

HOPS = 5  # of a comb of fringes: how often those beside the best are tried
BESIDE = -1.0, -0.5, 0.5, 1.0  # fringes: bright ones and dark ones
AS_GOOD = 9.0  # of chi²: three standard deviations
UNKNOWN = 10  # times itself: an error that leaves nothing
FINE = 20  # places between two points, where a line is looked for that no point sees
SAME = 0.02  # of the extent of a scan: centres that are one
LEAST = 1e-6  # of the largest singular value: directions below it are not known
LONG, HOPELESS = 50, 20.0  # steps of a fit after which it is given up, where its chi² is still so many times that of another start
REST = 0.05  # of chi²: what is nearer to the least than that is there, within a quarter of the errors
ROUNDS, SETTLED = 12, 0.01  # of fits to counts, with the errors of the last one; errors by which a parameter moves in the last of them
FAINT = 100.0  # of chi², by which it is less than that of no line
PROBED = 1.0, 2.0, 4.0, 8.0  # errors beside the centre of a faint line, where it could be as well
STRETCH, DOUBLED = 3, np.log(2.0)  # of a parameter that is not known: so many times it is doubled, or halved, to see where that leaves the others
ENTANGLED = 4.0  # times an error where all others are known
LEAST_EXPECTED = 0.1  # counts


class NoLine(InputError):
    """Why a form cannot be fitted."""


@dataclass(frozen=True)
class Poisson:
    """Errors of counts, each divided by its exposure: those that the fitted curve has. Least squares with them are where Poisson's likelihood is
    largest (A. Charnes, E. Frome and P. Yu, J. Am. Stat. Assoc. 71, 169, 1976)."""

    exposure: np.ndarray | float = 1.0

    def covariance(self, y: np.ndarray, least: float = LEAST_EXPECTED) -> np.ndarray:
        """[n, n] Where y [n] is expected, of `least` counts at each point or more."""
        return np.diag(np.maximum(y * self.exposure, least) / np.square(self.exposure))

    def of_constant(self, y: np.ndarray) -> float:
        """Chi² of the likeliest constant, with the errors that this has."""
        mean = np.average(y, weights=self.exposure * np.ones(y.size))
        return float(np.sum((y - mean)**2 / np.diag(self.covariance(np.full(y.size, mean)))))

    def deviance(self, y: np.ndarray, expected: np.ndarray) -> float:
        """-2 ln of the likelihood of y [n] where so much is expected [n], against that of y itself; what cannot be is as likely as a millionth of a count."""
        n, mu = y * self.exposure, np.maximum(expected * self.exposure, 1e-6)
        return float(2 * np.sum(mu - n + special.xlogy(n, n / mu)))


@dataclass(frozen=True, repr=False, eq=False)
class LineFit:
    """What was fitted; the covariance is that of all parameters."""

    form: str
    names: tuple[str, ...]  # centre, or centre_1, ...; the form's own; contrast; baseline
    values: np.ndarray  # [parameters] in the units of x and y
    errors: np.ndarray  # [parameters] one standard deviation; infinite of what is not known, such as the strength of a weak field
    covariance: np.ndarray  # [parameters, parameters]
    chi_squared: float
    constant: float  # chi² of the best constant
    freedom: int
    expected: np.ndarray  # [n]
    curve: Callable[[np.ndarray], np.ndarray]  # the fitted y [m] at any x [m]
    others: tuple[tuple[tuple[float, ...], float], ...] = ()  # centres of other fringes, or sets of lines, that are as good within `AS_GOOD`, and chi² of these
    unit: str = ""  # of x, as `fit_line` was told
    deviance: float | None = None  # of counts, which have no correlations: of their likelihood

    @property
    def p(self) -> float:
        """Of chi²."""
        return float(special.chdtrc(self.freedom, self.chi_squared)) if self.freedom > 0 else np.nan

    @property
    def badness(self) -> float:
        """What is least where the fit is best."""
        return self.chi_squared if self.deviance is None else self.deviance

    def __getitem__(self, name: str) -> tuple[float, float]:
        """Value and error."""
        i = asked.place_of(name, self.names)
        return float(self.values[i]), float(self.errors[i])

    def __repr__(self) -> str:
        from .line_report import told
        return f"<fit of {self.form}: {', '.join(told(self))}>"

    def __str__(self) -> str:
        from .line_report import described
        return "\n".join(described(self, self.unit))


@np.errstate(all="ignore")  # of starts that lead nowhere
def fit_line(x: np.ndarray, y: np.ndarray, errors: np.ndarray | float | Poisson, form: str | Form | Callable[..., np.ndarray] = "rabi", *,
             lines: int = 1, start: Mapping[str, float] | None = None, unit: str = "") -> LineFit:
    """Fits a form to y [n]; `errors` are one standard deviation of each point [n], or of all, or a covariance [n, n], or those of counts. Several `lines` have a centre
    and a contrast each, by rising centre, and share the rest. A callable f(x, a, b, ...) is fitted as it stands, from `start`. Weights are those of
    independent points with these variances, and errors come from the whole covariance. `unit` is that of x, as results are told. Raises NoLine."""
    x, y, start = np.asarray(x, float), np.asarray(y, float), dict(start or {})
    covariance = errors.covariance(y, 1.0) if isinstance(errors, Poisson) else _covariance(x, y, errors)
    if not (np.isfinite(x).all() and np.isfinite(y).all() and np.isfinite(covariance).all()):
        raise NoLine("the curve has values that are infinite or no numbers")
    if callable(form) and not isinstance(form, Form):
        def of(first: np.ndarray, covariance: np.ndarray) -> LineFit:
            return _refined("callable", tuple(start), lambda values, at: form(at, *values), first, x, y, covariance)
        return replace(_likeliest(of(np.array(list(start.values())), covariance), y, errors, lambda fit, covariance: of(fit.values, covariance)), unit=unit)
    if not isinstance(form, Form) and form not in FORMS:
        raise NoLine(f"there is no form `{form}` (there is {', '.join(FORMS)})")
    asked.whole_number("lines", lines, 1)
    chosen = form if isinstance(form, Form) else FORMS[form]
    if x.size < len(chosen.parameters) + 2 * lines + 2:
        raise NoLine(f"{x.size} points are too few for {lines} line{'s' if lines > 1 else ''} of the form {chosen.name}")
    if np.ptp(y) == 0:
        raise NoLine("nothing was detected, at no point\n  help: `rabiline summary` of the result tells where particles ended" if not y.any() else
                     "the curve is flat, there is no line in it\n  help: a detector that catches all levels alike does not see what fields did; "
                     "put a magnet or a `spin_filter` in front of it, or look at `plot-levels`")
    order = np.argsort(x)
    extent, origin = float(np.ptp(x)), float(x[order[x.size // 2]])
    own, sigma = len(chosen.parameters), np.sqrt(np.diag(covariance))
    _check_start(chosen, lines, start, x)
    if _of_constant(y, sigma) < 1:
        raise NoLine("the curve is flat within its errors, there is no line in it")
    guesses = first_guesses(chosen, x[order], y[order], sigma[order], lines, start)
    numbered = [f"centre_{i + 1}" for i in range(lines)] if lines > 1 else ["centre"]
    contrasts = [f"contrast_{i + 1}" for i in range(lines)] if lines > 1 else ["contrast"]

    shape = _remembering(lambda at, centre, *shared: chosen.f(at - origin - centre * extent, *np.exp(shared)), lines * (own + 3))

    def model(values: np.ndarray, at: np.ndarray) -> np.ndarray:
        parts = [values[own + lines + i] * shape(at, values[i], *values[lines:lines + own]) for i in range(lines)]
        return values[-1] + np.sum(parts, axis=0)

    reached = [np.inf]  # chi² of other starts
    names = (*numbered, *chosen.parameters, *contrasts, "baseline")

    def refined_from(first: np.ndarray, covariance: np.ndarray, least: float = np.inf) -> LineFit:
        return _refined(chosen.name, names, model, first, x, y, covariance, least)

    def held(fit: LineFit, number: int, at: float) -> LineFit:
        def rest(values: np.ndarray, covariance: np.ndarray) -> LineFit:
            return _refined(chosen.name, names, lambda values, x: model(np.insert(values, number, at), x), values, x, y, covariance)

        return _likeliest(rest(np.delete(fit.values, number), errors.covariance(fit.expected) if isinstance(errors, Poisson) else covariance), y, errors, lambda fit, covariance: rest(fit.values, covariance))

    def least(fit: LineFit, covariance: np.ndarray = covariance) -> LineFit:
        return _likeliest(fit, y, errors, lambda fit, covariance: refined_from(fit.values, covariance))

    def refined(centres: Sequence[float], shared: Sequence[float]) -> LineFit:
        first = linear(chosen, x, y, sigma, centres, shared)[1]
        fitted = refined_from(np.concatenate([(np.array(centres) - origin) / extent, np.log(shared), first[1:], first[:1]]), covariance, min(reached))
        reached.append(fitted.chi_squared)
        return fitted

    def beside(fit: LineFit) -> list[tuple[float, list[float], Sequence[float]]]:
        shared = np.exp(fit.values[lines:lines + own])
        if chosen.others is not None and not set(start) & set(chosen.parameters):
            return [(fit.chi_squared, (origin + extent * fit.values[:lines]).tolist(), other) for other in chosen.others(shared)]
        if chosen.period is None or lines > 1 or "centre" in start:
            return []
        return [(fit.chi_squared, [origin + extent * fit.values[0] + by * chosen.period(shared)], shared) for by in BESIDE]

    is_doubtful = partial(_is_doubtful, x=x, lines=lines, has_fringes=chosen.period is not None)
    found = _best([least(fit) for fit in _minima(refined, guesses, beside, AS_GOOD * (1 + isinstance(errors, Poisson)))], x, is_doubtful)
    for _ in range(HOPS):
        faint = {i: PROBED if i < lines else PROBED[:2] for i in range(2 * lines + own) if found.constant - found.chi_squared < FAINT}
        probed = [_probed(found, i, lambda at: held(found, i, at), places) for i, places in {**faint, **({} if chosen.period else dict.fromkeys(_entangled(found), PROBED))}.items()]
        better = min((lower for _, _, lower in probed if lower is not None), key=lambda one: one[0], default=None)
        moved = found if better is None else replace(least(refined_from(better[1], covariance)), others=found.others)
        if better is None or is_doubtful(moved) > is_doubtful(found):
            for i, wider, _ in probed:
                found = _widened(found, i, wider)
            break
        found = moved
    for i in range(lines, lines + own):
        found = _over_a_valley(found, i, lambda at: held(found, i, at))
    if lines > 1 and (np.abs(found.values[:lines]) > 1).any():
        raise NoLine(f"the curve does not show {lines} lines: one goes away beyond the scan\n  help: fit fewer, or name where each starts, such as --start centre_1=VALUE")
    rising = np.argsort(found.values[:lines])
    sorting = np.concatenate([rising, np.arange(lines, lines + own), lines + own + rising, [found.values.size - 1]])
    values, scale = found.values[sorting], np.ones(found.values.size)
    values[:lines], scale[:lines] = origin + extent * values[:lines], extent
    values[lines:lines + own] = scale[lines:lines + own] = np.exp(values[lines:lines + own])
    spread = found.covariance[np.ix_(sorting, sorting)] * scale[:, None] * scale
    others = tuple((tuple(origin + extent * centre for centre in centres), chi_squared) for centres, chi_squared in found.others)
    return LineFit(found.form, found.names, values, np.sqrt(np.diag(spread).clip(0)), spread, found.chi_squared, found.constant,
                   found.freedom, found.expected, found.curve, others, unit, found.deviance)


def _likeliest(found: LineFit, y: np.ndarray, errors: object, again: Callable[[LineFit, np.ndarray], LineFit]) -> LineFit:
    """Of counts the fit with the errors that it has itself, from one with others."""
    for _ in range(ROUNDS if isinstance(errors, Poisson) else 0):
        last, found = found, again(found, errors.covariance(found.expected))
        found = replace(found, deviance=errors.deviance(y, found.expected), constant=errors.of_constant(y))
        known = np.isfinite(found.errors)
        if (np.abs(found.values - last.values)[known] <= SETTLED * found.errors[known]).all():
            break
    return found


def _entangled(fit: LineFit) -> np.ndarray:
    """The numbers of parameters whose error is many times what it is where the others are known: valleys that long bend."""
    known = np.flatnonzero(np.isfinite(fit.errors) & (fit.errors > 0))
    correlation = (fit.covariance / fit.errors[:, None] / fit.errors)[np.ix_(known, known)]
    return known[np.diag(np.linalg.pinv(correlation, hermitian=True)) > ENTANGLED**2]


def _probed(fit: LineFit, number: int, held: Callable[[float], LineFit], places: Sequence[float]) -> tuple[int, float, tuple[float, np.ndarray] | None]:
    """A faint line is where it is by a few points, from which its likelihood falls off slower than a parabola, and so does that of parameters which
    make up for each other: by how much the error of one parameter is larger for what the badness is where it is `held` elsewhere, so many errors
    away as `places` say, and where that is lower, it and all values there."""
    error, wider, lower = fit.errors[number], 1.0, None
    for away in places if np.isfinite(error) else ():
        for side in (-1, 1):
            at = fit.values[number] + side * away * error
            try:
                there = held(at)
            except NoLine:
                continue
            rise = there.badness - fit.badness
            if rise < -REST and (lower is None or there.badness < lower[0]):
                lower = there.badness, np.insert(there.values, number, at)
            wider = max(wider, away / np.sqrt(max(rise, REST)))
    return number, wider, lower


def _over_a_valley(fit: LineFit, number: int, held: Callable[[float], LineFit]) -> LineFit:
    """Where the logarithm of a parameter is not known: errors of all others that reach to where they are while it is `held` elsewhere, if that is as
    good."""
    reach = np.zeros(fit.errors.size)
    for by in (-DOUBLED, DOUBLED) if np.isinf(fit.errors[number]) else ():
        for times in range(1, STRETCH + 1):
            try:
                there = held(fit.values[number] + times * by)
            except NoLine:
                break
            if there.badness > fit.badness + 1:
                break
            reach = np.maximum(reach, np.abs(np.insert(there.values, number, fit.values[number]) - fit.values))
    wider = np.where(np.isfinite(fit.errors) & (fit.errors > 0), np.hypot(1, reach / np.maximum(fit.errors, 1e-300)), 1.0)
    return replace(fit, errors=fit.errors * wider, covariance=fit.covariance * wider * wider[:, None])


def _covariance(x: np.ndarray, y: np.ndarray, errors: np.ndarray | float) -> np.ndarray:
    """[n, n] Of y [n] at x [n]. Raises NoLine."""
    given = np.asarray(errors, float)
    if x.ndim != 1 or x.shape != y.shape or given.ndim > 2 or any(length != x.size for length in given.shape):
        raise NoLine(f"x, y and errors do not belong together: they have the shapes {x.shape}, {y.shape} and {given.shape}")
    variances = np.diag(given) if given.ndim == 2 else given**2
    if (variances <= 0).any():
        raise NoLine("all errors must be above 0" if given.ndim < 2 else "all variances, on the diagonal of the covariance, must be above 0")
    return given if given.ndim == 2 else np.diag(np.broadcast_to(variances, x.shape))


def _check_start(form: Form, lines: int, start: Mapping[str, float], x: np.ndarray) -> None:
    centres = ["centre"] if lines == 1 else [f"centre_{i + 1}" for i in range(lines)]
    for name, value in start.items():
        if name not in (*centres, *form.parameters):
            raise NoLine(f"the form {form.name} has no start for `{name}` (it has {', '.join((*centres, *form.parameters))})")
        if name in centres and not x.min() - np.ptp(x) <= value <= x.max() + np.ptp(x):
            raise NoLine(f"`{name}` starts at {value:g}, far outside the scan from {x.min():g} to {x.max():g}")
        if name not in centres and not 0 < value < np.inf:
            raise NoLine(f"`{name}` starts at {value:g}, and must be above 0")


def _minima(refined: Callable[[Sequence[float], Sequence[float]], LineFit], guesses: Sequence[tuple[float, list[float], Sequence[float]]],
            beside: Callable[[LineFit], list[tuple[float, list[float], Sequence[float]]]], within: float) -> list[LineFit]:
    """Fits of about the least chi², the best first, each with a centre of its own: one fringe of many is as good a start as its neighbour, and no such
    fit leads from one to the other. What is `beside` the best is tried with its other parameters, as long as that helps. Raises NoLine where all are
    worse than a start."""
    fits, problems = [], []

    def take(starts: Sequence[tuple[float, list[float], Sequence[float]]]) -> None:
        for _, centres, shared in starts:
            try:
                fits.append(refined(centres, shared))
            except NoLine as problem:
                problems.append(problem)
        fits.sort(key=lambda fit: fit.badness)

    take(guesses)
    if problems and (not fits or fits[0].badness > guesses[0][0]):
        raise problems[0]
    for _ in range(HOPS):
        best = fits[0]
        take(beside(best))
        if best.badness - fits[0].badness < REST:
            break
    return _apart(fits, within)


def _apart(fits: Sequence[LineFit], within: float) -> list[LineFit]:
    """Of fits by rising badness those as good as the first, each with a centre of its own."""
    kept = [fits[0]]
    for fit in fits[1:]:
        if fit.badness < fits[0].badness + within and all((np.abs(_centres(fit) - _centres(other)) > SAME).any() for other in kept):
            kept.append(fit)
    return kept


def _centres(fit: LineFit) -> np.ndarray:
    """[lines] By rising place."""
    return np.sort(fit.values[[i for i, name in enumerate(fit.names) if name.startswith("centre")]])


def _best(fits: Sequence[LineFit], x: np.ndarray, is_doubtful: Callable[[LineFit], bool]) -> LineFit:
    """The best of these, with the others, doubtful ones behind those as good as they; what one point makes is where this point is, within the step."""
    fits = _apart(sorted(fits, key=lambda fit: fit.badness), AS_GOOD)
    fits.sort(key=is_doubtful)  # the order is otherwise kept
    least = np.median(np.diff(np.unique(x))) / np.ptp(x) if _between_points(fits[0], x) else 0.0
    return replace(_widened(fits[0], 0, least / max(fits[0].errors[0], 1e-300)), others=tuple((tuple(_centres(fit).tolist()), fit.chi_squared) for fit in fits[1:]))


def _is_doubtful(fit: LineFit, x: np.ndarray, lines: int, has_fringes: bool) -> bool:
    """Whether one point makes it, the middle of fringes is beyond the scan, one of several `lines` far beyond, or a contrast is not known though
    there are no fringes to tell where it is."""
    contrasts = slice(-1 - lines, -1)
    return _between_points(fit, x) or bool((np.abs(fit.values[:lines]) > (0.5 if has_fringes else 1 if lines > 1 else np.inf)).any()) or \
        not has_fringes and bool((fit.errors[contrasts] > UNKNOWN * np.abs(fit.values[contrasts])).any())


def _between_points(fit: LineFit, x: np.ndarray) -> bool:
    """Whether most of the line is where no point sees it."""
    at = np.sort(x)
    fine = at[:-1, None] + np.diff(at)[:, None] * np.linspace(0, 1, FINE, endpoint=False)
    return np.ptp(fit.curve(fine.ravel())) > 2 * np.ptp(fit.expected)


def _widened(fit: LineFit, number: int, times: float) -> LineFit:
    """With the error of one parameter so many times as large, where that is more than 1."""
    scale = np.where(np.arange(fit.values.size) == number, max(times, 1.0), 1.0)
    return replace(fit, errors=fit.errors * scale, covariance=fit.covariance * scale * scale[:, None])


def _refined(name: str, names: tuple[str, ...], model: Callable[[np.ndarray, np.ndarray], np.ndarray], first: np.ndarray, x: np.ndarray,
             y: np.ndarray, covariance: np.ndarray, least: float = np.inf) -> LineFit:
    """From `first`; what is `HOPELESS` beside the `least` chi² of other starts is not followed to its end."""
    sigma = np.sqrt(np.diag(covariance))

    def found_within(steps: int | None) -> optimize.OptimizeResult:
        # The 1 behind the residuals ends fits of curves without noise, whose chi² would fall for ever: a weak field has no strength.
        return optimize.least_squares(lambda values: np.append((model(values, x) - y) / sigma, 1.0), first, x_scale="jac", ftol=1e-6, max_nfev=steps)

    try:
        found = found_within(LONG if np.isfinite(least) else None)
        if found.status == 0 and np.isfinite(least) and 2 * found.cost < HOPELESS * least:
            found = found_within(None)
    except ValueError:  # of parameters or slopes that are infinite or no numbers
        raise _lost(name) from None
    jacobian = found.jac[:-1]
    sizes = np.maximum(np.linalg.norm(jacobian, axis=0), 1e-300)
    if not (np.isfinite(found.x).all() and np.isfinite(jacobian).all()):
        raise _lost(name)
    u, singular, rows = np.linalg.svd(jacobian / sizes, full_matrices=False)
    kept = singular > LEAST * singular[0]
    if not found.success and np.sum((u[:, kept].T @ found.fun[:-1])**2) > REST:
        raise _lost(name)
    linear = (rows[kept].T / singular[kept]) @ u[:, kept].T / sizes[:, None] / sigma
    spread = linear @ covariance @ linear.T
    unknown = (np.abs(rows[~kept]) > 0.1).any(axis=0)
    spread[unknown, unknown] = np.inf
    left = (model(found.x, x) - y) / sigma
    freedom = y.size - first.size
    return LineFit(name, names, found.x, np.sqrt(np.diag(spread).clip(0)), spread, float(left @ left), _of_constant(y, sigma), freedom,
                   model(found.x, x), lambda at: model(found.x, at))


def _remembering(shape: Callable[..., np.ndarray], most: int) -> Callable[..., np.ndarray]:
    """The same, kept for its latest arguments, `most` of them: derivatives by baseline, contrasts and other centres ask for it again."""
    kept: dict[tuple[float, ...], tuple[np.ndarray, np.ndarray]] = {}  # places, by which they are the same, and the shape there

    def again(at: np.ndarray, *values: float) -> np.ndarray:
        if values not in kept or kept[values][0] is not at:
            if len(kept) >= most:
                del kept[next(iter(kept))]
            kept[values] = at, shape(at, *values)
        return kept[values][1]

    return again


def _of_constant(y: np.ndarray, sigma: np.ndarray) -> float:
    """chi² of the best constant."""
    return float(np.sum(((y - np.average(y, weights=sigma**-2)) / sigma)**2))


def _lost(name: str) -> NoLine:
    help_ = "\n  help: a weak field makes a line of the form sinc2, in which its strength and the contrast are one: --form sinc2" if name == "rabi" else \
        "\n  help: name where it starts, such as --start centre=VALUE, or another --form"
    return NoLine(f"the fit of the form {name} does not converge{help_}")

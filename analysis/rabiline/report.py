"""What a results file holds, in words."""
from __future__ import annotations

from dataclasses import asdict
from typing import Iterable, Sequence

import numpy as np

from .agreement import with_constant
from .covariance import COUNTED, LEAST_P
from .curves import Curve, Resonance, curves, labels_of
from .motion_report import axis_numbers
from .reading import LOBES, Comb, Reading, comb_of, readings_of
from .results import Axis, FieldCheck, Results
from .units import format_value, law_name


def summary(results: Results, detectors: Sequence[str]) -> str:
    """Lines about the run, its scan, the resonances that these detectors saw, monitors and tallies, the ledger and the
    provenance."""
    return "\n".join([*_run(results), *_warnings(results), *_resonances(results, detectors), *_monitors(results), *_tallies(results),
                      *_ledger(results), *_provenance(results)])


def summary_numbers(results: Results, detectors: Sequence[str]) -> dict[str, object]:
    """The same as numbers in SI, for other programs."""
    def line(resonance: Resonance) -> dict[str, object]:
        return {"kind": resonance.kind, **{name: {"value": value.value, "error": value.error} for name, value in (
            ("centre", resonance.centre), ("width", resonance.width), ("depth", resonance.depth))}}

    def lines(curve: Curve) -> dict[str, object]:
        pieces = readings_of(curve)
        told = [reading for _, reading in pieces if isinstance(reading, Reading)]
        comb = _comb(curve, pieces)
        return {"how": "; ".join(dict.fromkeys(reading.how for reading in told)), "found": [line(one) for reading in told for one in reading.resonances],
                "fringes": None if comb is None else {"maxima": comb.maxima, "distance": comb.distance}}

    every = [curve for name in detectors for curve in curves(results, name)] if results.scan.axes else []
    return {
        "title": results.title, "program": results.program, "law": list(dict.fromkeys(results.laws)),
        "species": list(dict.fromkeys(results.species)), "particles": float(results.particles[0]),
        "warnings": list(results.warnings),
        "field_check": None if results.field_check is None else asdict(results.field_check),
        "scan": [axis_numbers(axis) for axis in results.scan.axes],
        "detected": {name: {"value": results.scan.detected[i].tolist(), "error": results.scan.errors[i].tolist()}
                     for i, name in enumerate(results.scan.detectors) if name in detectors},
        "lines": [{"curve": curve.label, "detector": curve.detector, **lines(curve)} for curve in every],
        "fates": [{"fate": fate.fate, "where": fate.where, "particles": float(fate.particles.sum())}
                  for fate in results.fates],
    }


def _run(results: Results) -> Iterable[str]:
    yield results.title or results.path.name
    yield f"  written by   {results.program}"
    yield f"  law          {'; '.join(map(law_name, dict.fromkeys(results.laws)))}"
    yield f"  species      {'; '.join(dict.fromkeys(results.species))}"
    fewest, most = results.particles.min(), results.particles.max()
    yield f"  particles    {fewest:.0f}{f' to {most:.0f}' if most > fewest else ''} per point, {len(results.laws)} point{'s' if len(results.laws) > 1 else ''}"
    if results.solid_angle is not None:
        yield f"  solid angle  {results.solid_angle:.6g} sr"
    if results.aimed_fraction is not None:
        low, high = results.aimed_fraction.min(), results.aimed_fraction.max()
        yield f"  aimed        weight 1 stands for {low:.6g}" + (f" to {high:.6g}" if high > low else "") + \
            " of all that leave the source"
    if results.rate is not None:
        yield f"  rate         {results.rate:.6g} 1/s leave the source"
    if (check := results.field_check) is not None:
        yield f"  steps        {_checked(check)}"
    for axis in results.scan.axes:
        yield f"  scan         {axis.parameter}: {_extent(axis)}"


def _checked(check: FieldCheck) -> str:
    if check.particles == 0 and check.approximated:
        return "not checked: where levels are driven in the rotating-wave approximation, there is no whole field to integrate"
    if check.particles == 0:
        return "not checked: an independent integration takes longer than a second for one particle, or none gets through"
    particles = "one particle" if check.particles == 1 else f"{check.particles} particles"
    return f"within {check.deviation:.2g} of an independent integration of {particles}; {check.tolerance:.2g} asked for"


def _warnings(results: Results) -> Iterable[str]:
    for warning in results.warnings:
        first, *rest = warning.splitlines()
        yield f"  warning      {first}"
        yield from (f"               {line.strip()}" for line in rest)


def _extent(axis: Axis) -> str:
    if axis.labels:
        return "; ".join(map(law_name, axis.labels))
    return f"{axis.text(axis.values.min())}, 1 point" if axis.values.size == 1 else f"{axis.text(axis.values.min())} to {axis.text(axis.values.max())}, {axis.values.size} points"


def _range(low: float, high: float) -> str:
    return f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"


def _resonances(results: Results, detectors: Sequence[str]) -> Iterable[str]:
    scan = results.scan
    for detector in detectors:
        number = scan.detectors.index(detector)
        yield f"detector {detector}" + (f", {label}" if (label := labels_of(results)[detector]) != detector else "")
        if scan.detected_of_all is not None:
            low, high = scan.detected_of_all[number].min(), scan.detected_of_all[number].max()
            yield f"  detected     {_range(low, high)} of all that leave the source"
        if scan.count_rate is not None:
            low, high = scan.count_rate[number].min(), scan.count_rate[number].max()
            background = ", with the background" if results.detectors[detector].background else ""
            yield f"  counts       {_range(low, high)} 1/s{background}"
        if not scan.axes:
            fraction = format_value(scan.detected[number, 0], "", scan.errors[number, 0])
            yield f"  {law_name(results.laws[0])}: {fraction} of emitted"
            continue
        for curve in curves(results, detector):
            fractions = f"{curve.y.min():.6g} to {curve.y.max():.6g}" if curve.y.size > 1 else format_value(curve.y[0], "", curve.errors[0])
            yield f"  {f'{curve.label}: ' if curve.label else ''}{fractions} of emitted"
            yield from (f"    {line}" for line in [*_flat(curve), *_resonances_of(curve)])


def _flat(curve: Curve) -> Iterable[str]:
    """Whether the curve may be flat."""
    if np.ptp(curve.y) == 0 and not np.isinf(curve.spread.freedom):
        yield "flat          the same to the bit, as its points share their particles; that proves nothing statistically"
        return
    tested = with_constant(curve)
    yield f"{'not flat' if tested.p < LEAST_P else 'if flat':<13} {tested}"
    if 0 < tested.freedom < curve.y.size - 1 and np.isfinite(curve.spread.freedom):
        yield (f"              {tested.freedom} and not {curve.y.size - 1}: the points share their particles, and no more combinations of them differ by "
               f"{COUNTED} particles")


def _resonances_of(curve: Curve) -> Iterable[str]:
    """Of each stretch of a scan with gaps."""
    pieces = readings_of(curve)
    comb = _comb(curve, pieces)
    if comb is not None:
        yield f"fringes       {comb.maxima} maxima, {format_value(float(f'{comb.distance:.3g}'), curve.axis.units)} apart: `fit-line --form ramsey` fits them"
    for part, told in pieces:
        if len(pieces) > 1:
            yield _extent(part.axis)
        if isinstance(told, Reading):
            yield from _resonance(part, told)
        elif comb is None:
            yield f"no resonance: {told}"


def _comb(curve: Curve, pieces: Sequence[tuple[Curve, object]]) -> Comb | None:
    """Fringes where there is nothing else to tell."""
    return None if any(isinstance(told, Reading) for _, told in pieces) else comb_of(curve)


def _resonance(curve: Curve, told: Reading) -> Iterable[str]:
    for resonance in told.at_half_maximum:
        yield f"{'central' if told.is_fringe else 'half maximum':<13} {_measured(resonance, curve.axis.units)}"
    if told.may_be_lobes:
        yield f"              {LOBES}"
    if told.is_fringe:
        return
    if told.fit is None:
        yield f"no fit        {told.why_no_fit}"
        return
    for resonance, steepness in zip(told.fit.resonances, told.fit.steepnesses):
        yield f"fit           {_measured(resonance, curve.axis.units)}, steepness {format_value(steepness.value, '', steepness.error)}"
    yield f"              {told.fit.chi_squared}; weights from the covariance; misfit {told.fit.misfit:.2f}"


def _measured(resonance: Resonance, units: str) -> str:
    centre, width = (format_value(value.value, units, value.error) for value in (resonance.centre, resonance.width))
    depth = format_value(resonance.depth.value, "", resonance.depth.error)
    return f"{resonance.kind} at {centre}, FWHM {width}, {'depth' if resonance.kind == 'dip' else 'height'} {depth}"


def _monitors(results: Results) -> Iterable[str]:
    for monitor in results.monitors.values():
        yield f"monitor {monitor.name}"
        first = format_value(monitor.passed.flat[0], "", monitor.errors.flat[0])
        yield f"  {first} of emitted" if monitor.passed.size == 1 else \
            f"  {monitor.passed.min():.6g} to {monitor.passed.max():.6g} of emitted"


def _tallies(results: Results) -> Iterable[str]:
    """Each tally with its axes; means and standard deviations at the first scan point."""
    for tally in results.tallies.values():
        yield f"tally {tally.name}{' (expectation of the spin)' if tally.is_expectation else ''}"
        inside, outside = tally.counts[0].sum(), tally.outside[0].sum()
        planes = tally.outside.ndim > 1
        at = ", at the first scan point" if tally.counts.shape[0] > 1 else ""
        at += f", in {tally.outside.shape[1]} planes together" if planes else ""
        yield f"  {inside:.6g} particles, {outside:.6g} outside{at}"
        for axis in tally.axes:
            if axis.mean is None or axis.deviation is None:
                centres = f"{axis.edges.size - 1} planes, " \
                          f"{format_value((axis.edges[0] + axis.edges[1]) / 2, axis.units)} to " \
                          f"{format_value((axis.edges[-2] + axis.edges[-1]) / 2, axis.units)}"
                yield f"  {axis.name:<16} {', '.join(axis.labels) or centres}"
                continue
            if planes:
                ends = " to ".join(axis.text(axis.mean[0, k], axis.mean_errors[0, k]) for k in (0, -1))
                yield f"  {axis.name:<16} {axis.edges.size - 1} bins, mean {ends} from the first plane to the last"
                continue
            if not inside:
                yield f"  {axis.name:<16} {axis.edges.size - 1} bins, no mean of no particles"
                continue
            mean = axis.text(axis.mean[0], axis.mean_errors[0])
            deviation = axis.text(axis.deviation[0], axis.deviation_errors[0])
            yield f"  {axis.name:<16} {axis.edges.size - 1} bins, mean {mean}, standard deviation {deviation}"


def _ledger(results: Results) -> Iterable[str]:
    yield "fates, summed over the scan"
    emitted = results.emitted.sum()
    for line in results.fates:
        total = line.particles.sum()
        yield f"  {' '.join(filter(None, (line.fate, line.where))):<24} {total:>16.6g}  {total / emitted:8.3%}"
    counted = np.sum([line.particles for line in results.fates], axis=0)
    closes = np.allclose(counted, results.emitted, rtol=1e-12)
    yield f"  {'emitted':<24} {emitted:>16.6g}  {'the ledger closes' if closes else 'THE LEDGER DOES NOT CLOSE'}"


def _provenance(results: Results) -> Iterable[str]:
    yield "provenance"
    for name, value in results.simulation.items():
        yield f"  {name.replace('_', ' '):<16} {value}"

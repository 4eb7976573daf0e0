"""What a file of a model holds, in words."""
from __future__ import annotations

from typing import Iterable

import numpy as np

from .motions import ON_HYPOTHESIS, Finding, Motions
from .scan_axes import Axis
from .units import fitting_scale


def motion_summary(file: Motions) -> str:
    """Lines about the motions, and every finding with what is expected of it; over a scan, from where to where."""
    return "\n".join(_lines(file))


def motion_numbers(file: Motions) -> dict[str, object]:
    """The same as numbers in SI, for other programs; `null` where a point has none."""
    axis = file.axis
    return {
        "title": file.title, "program": file.program, "model": file.model,
        "scan": [] if axis is None else [axis_numbers(axis)],
        "motions": [{"name": motion.name, "meaning": motion.meaning, "hypothesis": motion.name in ON_HYPOTHESIS} for motion in file.points[0]],
        "findings": [{"name": finding.name, "meaning": finding.meaning, "unit": finding.units, "value": _known(finding.values),
                      "expected": _known(finding.expected), "expectation": finding.basis} for finding in file.findings],
    }


def axis_numbers(axis: Axis) -> dict[str, object]:
    """A scanned axis in SI, for other programs."""
    return {"parameter": axis.parameter, "unit": axis.units, "points": int(axis.values.size),
            "labels" if axis.labels else "values": list(axis.labels) or axis.values.tolist()}


def _known(values: np.ndarray) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


def _lines(file: Motions) -> Iterable[str]:
    yield file.title or file.path.name
    yield f"  model        {file.model}"
    if file.axis is not None:
        scale = fitting_scale(file.axis.values, file.axis.units)
        low, high = scale.apply(file.axis.values[0]), scale.apply(file.axis.values[-1])
        ends = f"{file.axis.labels[0]} to {file.axis.labels[-1]}" if file.axis.labels else f"{low:.6g} to {high:.6g}"
        yield f"  scan         {scale.label(file.axis.parameter)}: {ends}, {len(file.points)} points"
    for motion in file.points[0]:
        yield f"  motion       {motion.name}: {motion.meaning}"
    for finding in file.findings:
        unit = f" {finding.units}" if finding.units else ""
        whose = " (hypothesis)" if finding.name.split("_")[0] in ON_HYPOTHESIS else ""
        yield f"  finding      {finding.name}{whose}: {_range(finding.values)}{unit}, {_expected(finding)}"
        yield f"               {finding.meaning}"


def _expected(finding: Finding) -> str:
    """"closed form 3.2 m", "the paper supposes 0", "conserved"."""
    if finding.expectation == "conserved" and not np.nan_to_num(finding.expected).any():
        return finding.basis
    return f"{finding.basis} {_range(finding.expected)} {finding.units}".rstrip()


def _range(values: np.ndarray) -> str:
    known = values[np.isfinite(values)]
    if known.size == 0:
        return "none"
    return f"{known[0]:.9g}" if np.ptp(known) == 0 else f"{known[0]:.9g} to {known[-1]:.9g}"

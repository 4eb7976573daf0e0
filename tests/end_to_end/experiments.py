"""Where the program and the experiments are, and what their curves are asked."""

import os
import pathlib

import numpy as np

RABILINE = os.environ.get("RABILINE_PROGRAM", "rabiline")
EXPERIMENTS = pathlib.Path(__file__).resolve().parents[2] / "beamline"


def crossings(x, y, level):
    """Where the curve passes the level, by straight lines between points."""
    s = np.sign(y - level)
    i = np.nonzero(s[:-1] * s[1:] < 0)[0]
    return x[i] + (level - y[i]) / (y[i + 1] - y[i]) * (x[i + 1] - x[i])


def dip_centre(x, y, baseline=None):
    """Halfway between where a dip passes half of its depth."""
    level = (y.min() + (y.max() if baseline is None else baseline)) / 2
    found = crossings(x, y, level)
    return (found[0] + found[-1]) / 2

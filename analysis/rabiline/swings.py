"""Where a curve turns, by more than its noise."""
from __future__ import annotations

import numpy as np


def maxima(y: np.ndarray, least: float) -> np.ndarray:
    """[any] The numbers of those that stand `least` or more above the lowest points on both sides, as far as nothing higher lies between: whose
    prominence is that. An end of the curve is none. (scipy.signal has it too, and takes longer to load than a picture to draw.)"""
    found, low, top = [], float(y[0]), None
    for i, height in enumerate(y.tolist()):
        if top is None:
            low = min(low, height)
            top = i if height > low and height - low >= least else None
        elif height > y[top]:
            top = i
        elif height < y[top] and y[top] - height >= least:
            found.append(top)
            low, top = height, None
    return np.array(found, dtype=int)

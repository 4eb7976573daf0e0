"""Where a curve turns, by more than its noise."""
from __future__ import annotations

import numpy as np

FEW = 5  # extremes: a curve with more of them shows where its baseline is


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


def central(y: np.ndarray, least: float, noise: float) -> tuple[int, int, int, int] | None:
    """Of few fringes the central one: +1 for a maximum or -1, its number, and those of the opposite extremes on its left and right. It stands out of its
    likes by `noise` or more, and beyond both ends of the curve by `least`, as those beside it do the other way. None where there is none."""
    turns = {sign: maxima(sign * y, least) for sign in (+1, -1)}
    if turns[+1].size + turns[-1].size > FEW:
        return None
    found, stands_out = None, noise
    for sign, tops in turns.items():
        if tops.size == 0:
            continue
        height, lows = sign * y, turns[-sign]
        top = int(tops[np.argmax(height[tops])])
        left, right = lows[lows < top], lows[lows > top]
        out = height[top] - max(height[tops[tops != top]], default=-np.inf)
        ends = height[[0, -1]]
        if left.size and right.size and out >= stands_out and height[top] - ends.max() >= least \
                and ends.min() - height[[left[-1], right[0]]].max() >= least:
            found, stands_out = (sign, top, int(left[-1]), int(right[0])), out
    return found

"""Numbers on the command line."""
from __future__ import annotations

from argparse import ArgumentTypeError
from math import nan
from pathlib import Path

LARGEST = 1e30  # of what is counted, or passes


def positive(text: str) -> float:
    """A number above 0, up to LARGEST."""
    value = _number(text)
    if not value > 0:
        raise ArgumentTypeError(f"`{text}` is no number above 0, up to {LARGEST:g}")
    return value


def not_negative(text: str) -> float:
    """A number, 0 or above, up to LARGEST."""
    value = _number(text)
    if not value >= 0:
        raise ArgumentTypeError(f"`{text}` is no number, 0 or above, up to {LARGEST:g}")
    return value


def count(text: str, least: int = 1) -> int:
    """A whole number that is large enough; 1e5 is one, too."""
    value = _number(text)
    if not (value >= least and value == int(value)):
        raise ArgumentTypeError(f"`{text}` is no whole number, {least} or above")
    return int(value)


def file_name(text: str) -> Path:
    """A path; an empty one would be the folder."""
    if not text:
        raise ArgumentTypeError("the name of a file is empty")
    return Path(text)


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        return nan
    return value if abs(value) <= LARGEST else nan

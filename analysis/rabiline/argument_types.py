"""Numbers on the command line."""
from __future__ import annotations

import re
from argparse import ArgumentTypeError
from math import inf, nan
from pathlib import Path

from .asked import written_number

LARGEST = 1e30  # of what is counted, or passes
SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0, "d": 86400.0}


def positive(text: str) -> float:
    """A number above 0, up to LARGEST."""
    value = _number(text)
    if not value > 0:
        raise ArgumentTypeError(f"`{text}` is no number above 0, up to {LARGEST:g}")
    return value


def duration(text: str) -> float:
    """[s] Above 0: a number of seconds, or one with its unit, "10 min"."""
    value = _with_unit(text, "")
    if not value > 0:
        raise ArgumentTypeError(f"`{text}` is no time above 0: write seconds, such as 600, or `600 s`, `10 min`, `2 h`")
    return value


def rate(text: str) -> float:
    """[1/s] Above 0: a number per second, or one with its unit, "4e4 /s"."""
    value = _with_unit(text, "/")
    if not value > 0:
        raise ArgumentTypeError(f"`{text}` is no rate above 0: write a number per second, such as 4e4, or `4e4 /s`, `2.4e6 /min`")
    return value


def rate_or_zero(text: str) -> float:
    """[1/s] The same, or 0."""
    return 0.0 if _with_unit(text, "/") == 0 else rate(text)


def count(text: str, least: int = 1, most: float = inf) -> int:
    """A whole number that is large enough; 1e5 is one, too."""
    if not text:
        raise ArgumentTypeError("it is empty")
    value = _number(text)
    if not (least <= value <= most and value == int(value)):
        raise ArgumentTypeError(f"`{text}` is no whole number, {least} {'or above' if most == inf else f'to {most}'}")
    return int(value)


def heading(text: str) -> str:
    """Of a picture; an empty one is a blank, which stands for none, and not for the file's own."""
    return text or " "


def file_name(text: str) -> Path:
    """A path; an empty one would be the folder."""
    if not text:
        raise ArgumentTypeError("the name of a file is empty")
    return Path(text)


def _number(text: str) -> float:
    try:
        value = written_number(text)
    except ValueError:
        return nan
    return value if abs(value) <= LARGEST else nan


def _with_unit(text: str, per: str) -> float:
    """A number of seconds, or `per` second: "10 min", "4e4 /s", "4e4 1/s", "600"."""
    found = re.fullmatch(rf"\s*([-+.\deE]+?)\s*(?:(?:1?{per})\s*([a-z]+))?\s*", text)
    if found is None or (found[2] or "s") not in SECONDS:
        return nan
    time = SECONDS[found[2] or "s"]
    value = _number(found[1]) * (1 / time if per else time)
    return value if abs(value) <= LARGEST else nan

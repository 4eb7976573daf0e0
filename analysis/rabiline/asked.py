"""What callers of the package give, held to its kind: errors of one line that say what belongs there."""
from __future__ import annotations

import difflib
import operator
import os
from decimal import Decimal
from numbers import Real
from typing import TYPE_CHECKING, Iterable

from .errors import InputError

MOST_THREADS, MOST_TRACKS, LONGEST_PATH = 1024, 10000, 4096  # bytes

if TYPE_CHECKING:
    import numpy as np


def written_number(text: str) -> float:
    """In plain digits, as every other program reads them; raises ValueError for what Python alone takes, such as 1_000."""
    if "_" in text or not text.isascii():
        raise ValueError(f"`{text}` is no number")
    return float(text)


def text(name: str, value: object) -> str:
    """Raises TypeError, and InputError where no file can hold it."""
    if not isinstance(value, str):
        raise TypeError(f"{name} is a text, not {_kind(value)}")
    try:
        value.encode()
    except UnicodeEncodeError as error:
        raise InputError(f"{name} has half of a character in it, {ascii(value[error.start])}, which no file can hold") from None
    return value


def path(name: str, value: object) -> str | os.PathLike[str]:
    """Raises TypeError, and InputError where no file can have such a name."""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"`{name}` is the path of a file, not {_kind(value)}")
    if not os.fspath(value):
        raise InputError(f"`{name}` is the path of a file, and is empty")
    if "\0" in os.fspath(value):
        raise InputError(f"`{name}` is the path of a file, and has a zero byte in it")
    try:
        if len(os.fsencode(value)) < LONGEST_PATH:
            return value
    except UnicodeEncodeError:
        raise InputError(f"`{name}` is the path of a file, and has half of a character in it") from None
    raise InputError(f"`{name}` is the path of a file, and longer than any: {os.fspath(value)[:60]}...")


def plain(value: object) -> object:
    """Of numpy's numbers and arrays, pandas' series and decimal numbers, what Python has itself."""
    return value.tolist() if hasattr(value, "tolist") else float(value) if isinstance(value, Decimal) else value


def number(name: str, value: object) -> float:
    """Raises TypeError."""
    value = plain(value)
    if not isinstance(value, Real) or isinstance(value, bool):
        raise TypeError(f"`{name}` is a number, not {_kind(value)}")
    try:
        return float(value)
    except OverflowError:
        raise InputError(f"`{name}` is larger than any number of the machine") from None


def whole_number(name: str, value: object, least: int = 0, most: int | None = None) -> int:
    """Raises TypeError and ValueError."""
    try:
        number = operator.index(None if isinstance(value, bool) else value)
    except TypeError:
        raise TypeError(f"`{name}` is a whole number, not {_kind(value)}") from None
    if number < least or most is not None and number > most:
        raise ValueError(f"`{name}` is {least} {'or above' if most is None else f'to {most}'}, not {number}")
    return number


def threads(value: object) -> int:
    """Of None, which is as many as the process may use, 0. Raises TypeError and ValueError."""
    return 0 if value is None else whole_number("threads", value, 1, MOST_THREADS)


def name(of: str, value: object) -> str | None:
    """None, or a name. Raises TypeError, and InputError where it is empty."""
    if value is not None and not text(f"`{of}`", value):
        raise InputError(f"`{of}` is empty: leave it out, or give a name")
    return value


def places(value: object) -> list[tuple[float, ...]]:
    """[n, 3] Raises TypeError and ValueError."""
    return list(map(tuple, _numbers("places", value, (None, 3), "a list of places (x, y, z) in m").tolist()))


def times(value: object, count: int) -> list[float]:
    """[count] All 0 where there are none. Raises TypeError and ValueError."""
    return [0.0] * count if value is None else _numbers("times", value, (count,), f"a list of {count} times in s, one for each place").tolist()


def names(name: str, value: object) -> list[str]:
    """Each of them once, none empty. Raises TypeError and InputError."""
    if isinstance(value, str) or not isinstance(value, Iterable):
        such_as = f", such as [{value!r}]" if isinstance(value, str) else ""
        raise TypeError(f"`{name}` is a list of names{such_as}, not {_kind(value)}")
    found = [text(f"a name in `{name}`", one) for one in value]
    if not all(map(str.strip, found)):
        raise InputError(f"a name in `{name}` is empty")
    if twice := [one for one in found if found.count(one) > 1]:
        raise InputError(f"`{twice[0]}` is {name} twice")
    return found


def _numbers(name: str, value: object, shape: tuple[int | None, ...], wanted: str) -> np.ndarray:
    import numpy as np
    try:
        found = np.empty(()) if np.iscomplexobj(value) else np.asarray(value, dtype=float)
    except (OverflowError, TypeError, ValueError):
        found = np.empty(())
    if found.ndim != len(shape) or any(size not in (None, own) for size, own in zip(shape, found.shape)):
        raise TypeError(f"`{name}` is {wanted}")
    if not np.isfinite(found).all():
        raise ValueError(f"`{name}` has numbers that are infinite or none")
    return found


def _kind(value: object) -> str:
    return "a text" if isinstance(value, str) else type(value).__name__


def near(name: object, names: Iterable[str]) -> str:
    """The one of these names that is most like it; empty where none is."""
    return next(iter(difflib.get_close_matches(str(name), list(names), 1)), "")


def place_of(name: object, names: tuple[str, ...], given: tuple[str, ...] = ()) -> int:
    """The number of one of these names; of others what is asked for is `given` by the counts. Raises KeyError."""
    if name in given:
        raise KeyError(f"{name!r} starts where the counts have it, and is given no other start")
    if name not in names:
        meant = near(name, names)
        raise KeyError(f"there is no {name!r}{f', but {meant!r}' if meant else ''} (there is {', '.join(names)})")
    return names.index(name)

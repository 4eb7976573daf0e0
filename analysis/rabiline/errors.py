"""What is wrong with what was asked for or given, or with its files: the text is the message. Those of the program (`_core`) are of
these kinds too."""
from __future__ import annotations

import re
from contextlib import contextmanager
from typing import Iterator, Mapping, Sequence

TURNING = (0x200e, 0x200f, *range(0x2028, 0x202f), *range(0x2066, 0x206a))  # characters that turn the direction of writing, or end lines
CONTROL = {code: "?" for code in (*range(32), *range(127, 160), *range(0xd800, 0xe000), *TURNING) if chr(code) not in "\n\t"}
VALUES = {"beside": "True", "in_space": "True", "size": "(width, height)"}  # of options in Python; all others are texts


def printable(text: str) -> str:
    """A text without the control characters of names and tables, which would steer a terminal."""
    return text if text.isprintable() else text.translate(CONTROL)


class InputError(Exception):
    """Something wrong with what was asked for or given."""

    exit_code = 2
    diagnostics: Sequence[Mapping[str, object]] = ()  # each mistake in an experiment: its file, line, column, message and help

    def __str__(self) -> str:
        return printable(super().__str__())


class StorageError(OSError):
    """A file that cannot be written, or a result that cannot be read."""

    exit_code = 3

    def __str__(self) -> str:
        return printable(super().__str__())


@contextmanager
def as_keywords() -> Iterator[None]:
    """What is told of options in this context is told as Python has them: detector="..." for `--detector` that is recommended, and the name
    alone of what was given."""
    def keyword(found: re.Match) -> str:
        name = found[1].replace("-", "_")
        return f"{name}={VALUES.get(name, chr(34) + '...' + chr(34))}" if found[2] is None else f"`{name}`"

    try:
        yield
    except InputError as problem:
        problem.args = tuple(re.sub(r"(?<![\w-])--([a-z]+(?:-[a-z]+)*)(?=(:| ?[\"`\d]| [A-Za-z])?)", keyword, text) if isinstance(text, str) else text for text in problem.args)
        raise

"""What is wrong with what was asked for or given, or with its files: the text is the message. Those of the program (`_core`) are of
these kinds too."""
from __future__ import annotations

from typing import Mapping, Sequence


class InputError(Exception):
    """Something wrong with what was asked for or given."""

    exit_code = 2
    diagnostics: Sequence[Mapping[str, object]] = ()  # each mistake in an experiment: its file, line, column, message and help


class StorageError(OSError):
    """A file that cannot be written, or a result that cannot be read."""

    exit_code = 3

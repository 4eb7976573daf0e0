"""What is wrong with what was asked for or given: its text is the message."""


class BadInput(Exception):
    """The base of all such errors of this package."""

    exit_code = 2


class InputError(BadInput):
    """Something wrong with what was asked for."""

"""What is wrong with what was asked for or given: its text is the message, and the exit code is 2."""


class BadInput(Exception):
    """The base of all such errors of this package."""


class InputError(BadInput):
    """Something wrong with what was asked for."""

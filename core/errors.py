"""Errors that a person can mend."""


class InputError(ValueError):
    """Bad input. The message is one line: what is wrong, and what to do about it."""

"""Errors that a person can mend."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


class InputError(ValueError):
    """Bad input. The message is one line: what is wrong, and what to do about it."""


def reason_of(error: OSError) -> str:
    """Why the system could not do something, in a few words without a capital."""
    return (error.strerror or str(error)).lower()


def nearest(word: str, choices: Iterable[str]) -> str | None:
    """The choice that ``word`` was probably meant to be, or None."""
    return next(iter(get_close_matches(word.lower(), list(choices), n=1, cutoff=0.5)), None)


def did_you_mean(word: str, choices: Iterable[str]) -> str:
    """`` (did you mean X?)`` for the choice nearest to ``word``, or nothing."""
    near = nearest(word, choices)
    return f" (did you mean {near}?)" if near else ""

"""Errors that a person can mend."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

LIKE = 0.7  # so much of two words is the same where one is a slip of the other; of other words two thirds may be


class InputError(ValueError):
    """Bad input. The message is one line: what is wrong, and what to do about it."""


def reason_of(error: OSError) -> str:
    """Why the system could not do something, in a few words without a capital."""
    return (error.strerror or str(error)).lower()


def nearest(word: str, choices: Iterable[str]) -> str | None:
    """The choice that ``word`` was probably meant to be: with a slip in it, or a part of that name alone; or None."""
    word, choices = word.lower(), list(choices)
    close = get_close_matches(word, choices, n=1, cutoff=LIKE)
    parts = [choice for choice in choices if word and word in choice.split("_")]
    return close[0] if close else parts[0] if len(parts) == 1 else None


def did_you_mean(word: str, choices: Iterable[str]) -> str:
    """`` (did you mean X?)`` for the choice nearest to ``word``, or nothing."""
    near = nearest(word, choices)
    return f" (did you mean {near}?)" if near else ""

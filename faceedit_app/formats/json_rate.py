"""The frame rate that a JSON document gives in one of its fields, or mentions in a text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import islice
from typing import Any

from faceedit_app.formats.json_text import JsonText, as_object
from faceedit_app.formats.rates import exact_rate
from faceedit_app.formats.stated_rate import (
    names_rate,
    rate_in_lines,
    rate_of,
    rate_of_period,
)
from faceedit_app.formats.timing import DEFAULT_RATE, SLOWEST

# These may also be the rate of the sound, which is far above.
_OTHER_RATES = {"samplerate", "samplingrate", "rate", "hz", "frequency", "tickspersecond"}
_FASTEST_CAMERA = 245.0  # frames per second
_NUMERATORS, _DENOMINATORS = ("numerator", "num"), ("denominator", "den", "denom")
_DEEPEST, _MOST = 3, 100  # objects below one another, and beside one another
_SAMPLE = 20  # entries of a list that are compared
_NEAR = 1  # levels at which a rate of something is that of the frames


def frame_rate(text: JsonText, document: Any) -> float | None:
    """The frames per second that a field gives, in the document or in objects below.

    Of a list, such as that of the frames, the first entry counts, but no number that differs in
    others: a rate that was measured at each frame is no frame rate.
    """
    for depth, entry in _levels(text, _as_one(text, document)):
        for name, value in islice(entry.items(), _MOST):
            rate = _rate(text, name, value, depth)
            if rate is not None:
                return exact_rate(rate)
    return None


def likely_rate(text: JsonText, otherwise: float = DEFAULT_RATE) -> float:
    """The rate that a text in the document mentions, or the usual one."""
    texts = (
        value
        for _, entry in _levels(text, _as_one(text, text.document))
        for value in islice(entry.values(), _MOST)
        if isinstance(value, str)
    )
    stated = rate_in_lines(texts)
    return stated.rate if stated else otherwise


def _levels(text: JsonText, outer: Mapping[str, Any]) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """The objects of a document with their depths, level by level."""
    level: list[Mapping[str, Any]] = [outer]
    for depth in range(_DEEPEST + 1):
        yield from ((depth, entry) for entry in level)
        values = (value for entry in level for value in islice(entry.values(), _MOST))
        objects = (found for value in values if (found := _as_one(text, value)))
        level = list(islice(objects, _MOST))


def _as_one(text: JsonText, value: Any) -> Mapping[str, Any]:
    """An object; or of a list of objects, the fields of the first without varying numbers."""
    if not isinstance(value, list):
        return as_object(value)
    some = [as_object(entry) for entry in value[:: len(value) // _SAMPLE + 1]]
    if not some:
        return {}

    def is_same(name: str, one: Any) -> bool:
        number = text.number(one)
        return all(text.number(entry.get(name, one)) == number for entry in some)

    return {name: one for name, one in islice(some[0].items(), _MOST) if is_same(name, one)}


def _rate(text: JsonText, name: str, value: Any, depth: int) -> float | None:
    """The rate that a field is; None if it is something else."""
    word = "".join(letter for letter in name.lower() if letter.isalpha())
    number = text.number(value)
    if number is None and isinstance(value, str):
        number = rate_of(value)
    if number is None:
        number = _fraction(text, value)
    if number is None:
        return None
    if names_rate(word):
        return number
    if word in _OTHER_RATES and depth <= _NEAR and SLOWEST <= number <= _FASTEST_CAMERA:
        return number
    return rate_of_period(word, number)


def _fraction(text: JsonText, value: Any) -> float | None:
    """The number of `{"numerator": 30000, "denominator": 1001}`."""
    parts = {name.lower(): text.number(part) for name, part in as_object(value).items()}
    above = next((parts[name] for name in _NUMERATORS if name in parts), None)
    below = next((parts[name] for name in _DENOMINATORS if name in parts), None)
    return above / below if above and below else None

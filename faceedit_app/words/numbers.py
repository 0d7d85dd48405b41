"""Numbers in English words, as a first suggestion of what they sound like."""

from __future__ import annotations

import re

_NAMES = (
    "zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen "
    "fifteen sixteen seventeen eighteen nineteen "
    "twenty thirty forty fifty sixty seventy eighty ninety"
)
_ONES, _TENS = _NAMES.split()[:20], _NAMES.split()[20:]
_LARGE = ((1_000_000, "million"), (1_000, "thousand"), (100, "hundred"))
_ORDINALS = {"one": "first", "two": "second", "three": "third", "five": "fifth"} | {
    "eight": "eighth",
    "nine": "ninth",
    "twelve": "twelfth",
}
_MONEY = {"$": "dollars", "£": "pounds", "€": "euros"}
_NUMBER = re.compile(r"([$£€]?)(\d{1,3}(?:,\d{3})+|\d{1,9})(?:\.(\d{1,9}))?(%|st|nd|rd|th)?", re.I)
_CLOCK = re.compile(r"(\d\d?):(\d\d)")


def in_words(text: str) -> str:
    """How a number such as `1984`, `$5`, `50%`, `2nd` or `12:30` is usually read; "" for others."""
    if clock := _CLOCK.fullmatch(text):
        hour, minute = int(clock[1]), int(clock[2])
        return _whole(hour) if not minute else f"{_whole(hour)} {_pair(minute)}"
    number = _NUMBER.fullmatch(text)
    if number is None:
        return ""
    money, digits, decimals, tail = number[1], number[2], number[3] or "", (number[4] or "").lower()
    value = int(digits.replace(",", ""))
    is_bare = not (money or decimals or tail or "," in digits)
    if is_bare and len(digits) == 4 and (1100 <= value < 2000 or 2010 <= value < 2100):
        hundreds = f"{_whole(value // 100)} "
        return hundreds + (_pair(value % 100) if value % 100 else "hundred")
    words = _whole(value)
    if decimals:
        words += " point " + " ".join(_ONES[int(digit)] for digit in decimals)
    if tail == "%":
        words += " percent"
    elif tail:
        words = _ordinal(words)
    return f"{words} {_MONEY[money]}" if money else words


def _pair(value: int) -> str:
    """Two digits, as in a year: 5 is oh five."""
    return _whole(value) if value > 9 else f"oh {_ONES[value]}"


def _whole(value: int) -> str:
    for size, name in _LARGE:
        if value >= size:
            rest = value % size
            return f"{_whole(value // size)} {name}" + (f" {_whole(rest)}" if rest else "")
    if value < len(_ONES):
        return _ONES[value]
    tens = _TENS[value // 10 - 2]
    return f"{tens} {_ONES[value % 10]}" if value % 10 else tens


def _ordinal(words: str) -> str:
    start, _, last = words.rpartition(" ")
    if last not in _ORDINALS:
        last = f"{last[:-1]}ieth" if last.endswith("y") else f"{last}th"
    else:
        last = _ORDINALS[last]
    return f"{start} {last}".strip()

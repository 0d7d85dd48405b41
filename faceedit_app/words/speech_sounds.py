"""What phonemes ask of the lips, in ARPABET, SAMPA and the International Phonetic Alphabet."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection
from enum import StrEnum


class Lips(StrEnum):
    """What the lips do."""

    CLOSE = "close"  # m, b, p: they meet
    TEETH = "teeth"  # f, v: the lower lip touches the upper teeth
    PUCKER = "pucker"  # w, oo: they are rounded
    PROTRUDE = "protrude"  # sh, ch: they come forward


_STRESS = re.compile(r"(?<=\D)\d+$")  # or tone; a digit alone is a vowel in SAMPA
_ARPABET = {
    **dict.fromkeys(("P", "B", "M", "EM"), Lips.CLOSE),
    **dict.fromkeys(("F", "V"), Lips.TEETH),
    **dict.fromkeys(("W", "UW"), Lips.PUCKER),
    **dict.fromkeys(("SH", "ZH", "CH", "JH"), Lips.PROTRUDE),
}
_IPA = {
    **dict.fromkeys(("p", "b", "m", "pf"), Lips.CLOSE),
    **dict.fromkeys(("f", "v", "ɱ"), Lips.TEETH),
    **dict.fromkeys(("w", "u", "ʉ", "y", "ʍ"), Lips.PUCKER),
    **dict.fromkeys(("ʃ", "ʒ", "tʃ", "dʒ", "ʧ", "ʤ", "tS", "dZ"), Lips.PROTRUDE),
}
# Every English word has a vowel. OY is not among these, as it is one of German SAMPA as well.
_ARPABET_VOWELS = frozenset(
    (
        *("AA", "AE", "AH", "AO", "AW", "AX", "AXR", "AY", "EH"),
        *("ER", "EY", "IH", "IX", "IY", "OW", "UH", "UW", "UX"),
    )
)
_SAMPA = {"S": "ʃ", "Z": "ʒ"}


def sampa_as_ipa(symbols: Collection[str]) -> dict[str, str]:
    """What a file's symbols mean in IPA that SAMPA and ARPABET use for different sounds.

    ARPABET's `S` is s, and SAMPA's is sh. A file is in SAMPA if it has symbols in lower case, and
    no vowel of ARPABET.

    Args:
        symbols: all that the file has.
    """
    bare = {_STRESS.sub("", symbol.strip()) for symbol in symbols}
    is_sampa = any(one.islower() for one in bare) and not bare & _ARPABET_VOWELS
    return _SAMPA if is_sampa else {}


def lips_of(symbol: str) -> Lips | None:
    """What a phoneme asks of the lips; None if it leaves them to its neighbours."""
    bare = _STRESS.sub("", symbol.strip())
    if bare in _ARPABET:
        return _ARPABET[bare]
    letters = unicodedata.normalize(
        "NFD", bare.rstrip(":")
    )  # without length, aspiration and diacritics
    plain = "".join(c for c in letters if unicodedata.category(c) not in ("Mn", "Lm", "Sk"))
    return _IPA.get(plain)


def spelled(symbol: str) -> str:
    """A phoneme as a message names it: B is b."""
    return _STRESS.sub("", symbol).lower()

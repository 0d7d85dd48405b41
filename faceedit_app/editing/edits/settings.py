"""The settings that edits are answered by."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum


class Mode(StrEnum):
    """How the answer is combined with the take."""

    PRESERVE = "preserve"  # take + N(asked) - N(tracked): frames without an edit stay unchanged
    RESYNTHESIZE = "resynthesize"  # N(asked), as in the paper


@dataclass(frozen=True)
class Settings:
    """How edits are answered; out-of-range values raise `ValueError`.

    Attributes:
        mode: see `Mode`.
        naturalness: 0 = the regressor alone, which follows most exactly; 1 = regressor and
            autoencoder, which is most believable.
        reach: 0 = what the networks answer, 1 = all the way to what was asked for.
        closes: where an edit closes lips or lids on FaceEdit's own character, close them on the
            user's character as well, if one is open.
    """

    mode: Mode = Mode.PRESERVE
    naturalness: float = 1.0
    reach: float = 1.0
    closes: bool = True

    def __post_init__(self) -> None:
        if not 0 <= self.naturalness <= 1:
            raise ValueError(f"naturalness {self.naturalness:g}: must be from 0 to 1")

    @property
    def exactness(self) -> float:
        """Naturalness and reach as one number, 0..1: the slider from natural to exact.

        It follows one path: from 0 to 0.5 reach rises from 0 to 1 while naturalness is 1; from
        0.5, the default, to 1 naturalness falls to 0 while reach is 1. Settings off the path, which
        only files have, are shown by the half that they are nearer to.
        """
        if self.naturalness < self.reach:
            return 1.0 - 0.5 * self.naturalness
        return 0.5 * min(self.reach, 1.0)

    def with_exactness(self, exactness: float) -> Settings:
        """The settings at a place of the path, 0..1; see `exactness`."""
        reach, naturalness = min(2.0 * exactness, 1.0), min(2.0 - 2.0 * exactness, 1.0)
        return replace(self, naturalness=naturalness, reach=reach)

    def describe_change(self, to: Settings) -> str:
        """The name of a step from these settings to others, such as "Natural to exact"."""
        if to.mode != self.mode:
            return to.mode.value.capitalize()
        if to.closes != self.closes:
            return "Close on the character" if to.closes else "Do not close on the character"
        return "Natural to exact"

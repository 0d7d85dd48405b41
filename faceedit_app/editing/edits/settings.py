"""How edits are answered."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Mode(StrEnum):
    """How the networks' answer is combined with the take."""

    PRESERVE = "preserve"  # take + N(asked) - N(tracked): what no edit reaches stays as it was
    RESYNTHESIZE = "resynthesize"  # N(asked), as in the paper, over the whole take


@dataclass(frozen=True)
class Settings:
    """How edits are answered.

    Attributes:
        mode: see `Mode`.
        naturalness: 0 = regressor alone (obeys), 1 = full system (believable).
        reach: 0 = what the networks answer, 1 = all the way to what was asked.
    """

    mode: Mode = Mode.PRESERVE
    naturalness: float = 1.0
    reach: float = 1.0

    def __post_init__(self) -> None:
        if not 0 <= self.naturalness <= 1:
            raise ValueError(f"naturalness {self.naturalness:g}: must be from 0 to 1")

    def describe_change(self, to: Settings) -> str:
        """What a step from these settings to others is called, such as "Naturalness"."""
        if to.mode != self.mode:
            return to.mode.value.capitalize()
        return "Naturalness" if to.naturalness != self.naturalness else "Reach"

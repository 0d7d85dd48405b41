"""Which shapes of a character make which of ARKit's channels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from faceedit_app.core.arkit import ARKIT_CHANNELS


class Half(StrEnum):
    """The part of a shape that a channel takes; left and right are the character's."""

    WHOLE = ""
    LEFT = "left"
    RIGHT = "right"
    UPPER = "upper"
    LOWER = "lower"
    UPPER_LEFT = "upper left"
    UPPER_RIGHT = "upper right"
    LOWER_LEFT = "lower left"
    LOWER_RIGHT = "lower right"


@dataclass(frozen=True)
class Share:
    """The contribution of one shape to a channel.

    Attributes:
        name: the shape, as its file spells it.
        weight: the factor of its displacements.
        half: the part of it that is used.
    """

    name: str
    weight: float = 1.0
    half: Half = Half.WHOLE


@dataclass(frozen=True)
class ShapeMatch:
    """Which shapes make which channels.

    Attributes:
        shares: by channel, the shapes that make it.
        unknown: names that no channel uses.
        alike: other spellings of used names, which a character's meshes may have.
        lost: sentences about shapes that do not quite fit their channel.
    """

    shares: Mapping[str, tuple[Share, ...]]
    unknown: tuple[str, ...] = ()
    alike: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    lost: tuple[str, ...] = ()

    @property
    def matched(self) -> dict[str, tuple[str, ...]]:
        """The names of the shapes that make each channel, in ARKit's order."""
        return {
            c: tuple(s.name for s in self.shares[c]) for c in ARKIT_CHANNELS if self.shares.get(c)
        }

    @property
    def played(self) -> frozenset[str]:
        """The names of all shapes that channels move."""
        used = {share.name for shares in self.shares.values() for share in shares}
        return frozenset(
            used.union(*(others for name, others in self.alike.items() if name in used))
        )

    @property
    def missing(self) -> tuple[str, ...]:
        """Channels without a shape."""
        return tuple(c for c in ARKIT_CHANNELS if not self.shares.get(c))

    @property
    def several(self) -> dict[str, tuple[str, ...]]:
        """Channels made of more than one shape."""
        return {channel: names for channel, names in self.matched.items() if len(names) > 1}

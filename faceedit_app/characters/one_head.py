"""Of several heads in one file, open one.

Measured together, two heads would be one whose eyes are far apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.characters.character import Character, MeshPart
from faceedit_app.characters.matches import ShapeMatch
from faceedit_app.core.arrays import Doubles

_EYES = ("eyeBlinkLeft", "eyeBlinkRight")
_MOUTH = ("jawOpen", "mouthPucker", "mouthFunnel", "mouthSmileLeft", "mouthSmileRight")
_APART = 3.0  # times the distance from eyes to mouth, between the eyes of two heads


@dataclass(frozen=True)
class _Head:
    """A part with a whole face: its eyes (3,) and how far they are from its mouth."""

    part: MeshPart
    eyes: Doubles
    size: float


def with_one_head(character: Character, match: ShapeMatch) -> tuple[Character, str]:
    """The character with the head that has the most shapes, and a remark about others; "" if none.

    Parts without a whole face, such as eyes, hair and clothes, stay with the head that they are
    nearest to.
    """
    heads = [head for part in character.parts if (head := _head(part, match)) is not None]
    if not heads:
        return character, ""
    main = max(heads, key=lambda head: len(head.part.targets))
    others = [head for head in heads if _is_another(head, main)]
    if not others:
        return character, ""

    def is_ours(part: MeshPart) -> bool:
        middle = part.neutral.mean(axis=0, dtype=np.float64)
        far = [float(np.linalg.norm(middle - head.eyes)) for head in (main, *others)]
        return far[0] <= min(far[1:])

    of_others = {id(head.part) for head in others}
    kept = tuple(
        part
        for part in character.parts
        if part is main.part or (id(part) not in of_others and is_ours(part))
    )
    names = ", ".join(head.part.name[:40] for head in others[:3])
    names += " …" if len(others) > 3 else ""
    return (
        replace(character, parts=kept),
        f"another head was left out: {names}; export one head a file to open it",
    )


def _head(part: MeshPart, match: ShapeMatch) -> _Head | None:
    """What a part has of a face; None if its shapes do not move both eyes and a mouth."""
    left, right = (_moved(part, match, (channel,)) for channel in _EYES)
    mouth = _moved(part, match, _MOUTH)
    if left is None or right is None or mouth is None:
        return None
    eyes = (left + right) / 2
    return _Head(part, eyes, float(np.linalg.norm(eyes - mouth)))


def _moved(part: MeshPart, match: ShapeMatch, channels: Sequence[str]) -> Doubles | None:
    """(3,) the middle of what the shapes of channels move; None if they move nothing."""
    amount = np.zeros(len(part.neutral))
    for channel in channels:
        for share in match.shares.get(channel, ()):
            for name in (share.name, *match.alike.get(share.name, ())):
                if name in part.targets:
                    amount += np.linalg.norm(part.targets[name], axis=1)
    total = float(amount.sum())
    if not total:
        return None
    middle: Doubles = amount @ part.neutral.astype(np.float64) / total
    return middle


def _is_another(head: _Head, main: _Head) -> bool:
    return float(np.linalg.norm(head.eyes - main.eyes)) > _APART * max(head.size, main.size)

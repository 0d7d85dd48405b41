"""Leave out copies of a head: levels of detail, and meshes that a scene shows twice."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faceedit_app.characters.character import Character, Part

_LEVEL = re.compile(r"[\W_]?lod[\W_]?(\d+)(?=[\W_]|$)", re.IGNORECASE)


def without_copies(character: Character) -> Character:
    """The character with one of each mesh that has morph targets; a remark names the others.

    Two heads would be measured as one whose eyes are between both.
    """
    kept: list[Part] = []
    left_out: list[str] = []
    finest = min((_level(part) for part in character.parts if part.targets), default=0)
    for part in character.parts:
        is_coarse = _LEVEL.search(part.name) is not None and _level(part) > finest
        if is_coarse or any(_is_copy(part, other) for other in kept):
            left_out.append(part.name)
        else:
            kept.append(part)
    if not left_out:
        return character
    return replace(character, parts=tuple(kept), remarks=(*character.remarks, _remark(left_out)))


def _level(part: Part) -> int:
    """The level of detail that a name says; 0 is the finest."""
    found = _LEVEL.search(part.name)
    return int(found[1]) if found else 0


def _is_copy(part: Part, other: Part) -> bool:
    """Whether a part is the same mesh with the same targets, there or elsewhere."""
    return (
        bool(part.targets)
        and part.targets.keys() == other.targets.keys()
        and part.neutral.shape == other.neutral.shape
        and np.array_equal(part.faces, other.faces)
        and np.allclose(_form(part), _form(other), atol=1e-3)
    )


def _form(part: Part) -> np.ndarray:
    """(V,) distances from the middle, in units of the largest."""
    away = np.linalg.norm(part.neutral - part.neutral.mean(axis=0), axis=1)
    form: np.ndarray = away / max(float(away.max()), 1e-12)
    return form


def _remark(names: Sequence[str]) -> str:
    shown = ", ".join(name[:40] for name in names[:3]) + (" …" if len(names) > 3 else "")
    return f"copies of the head were left out: {shown}"

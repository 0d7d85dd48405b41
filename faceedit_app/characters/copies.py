"""Leave out copies of a head: levels of detail, and meshes that a scene shows twice."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faceedit_app.characters.character import Character, MeshPart

_LEVEL = re.compile(r"[\W_]?lod[\W_]?(\d+)(?=[\W_]|$)", re.IGNORECASE)


def without_copies(character: Character) -> Character:
    """The character with one of each mesh that has morph targets; a remark names the others.

    Two heads would be measured as one whose eyes are between both. Small meshes, such as eyes, are
    often made twice for one head: those are left out only where a head is left out, too.
    """
    morphing = [part for part in character.parts if part.targets]
    finest = min((_level(part) for part in morphing), default=0)
    kept: list[MeshPart] = []
    copies: list[tuple[MeshPart, MeshPart]] = []  # each with the first such mesh
    for part in morphing:
        first = next((other for other in kept if _is_copy(part, other)), None)
        if first is not None:
            copies.append((part, first))
        elif _LEVEL.search(part.name) is None or _level(part) == finest:
            kept.append(part)
    half = max((_size(part) for part in kept), default=0.0) / 2
    heads = [pair for pair in copies if _size(pair[1]) >= half]
    for part, first in copies:
        is_small = _size(first) < half and not _is_same_place(part, first)
        if is_small and all(_is_nearer(part, head, copy) for copy, head in heads):
            kept.append(part)
    stays = {id(part) for part in kept}
    parts = tuple(part for part in character.parts if not part.targets or id(part) in stays)
    left_out = [part.name for part in morphing if id(part) not in stays]
    if not left_out:
        return character
    return replace(character, parts=parts, remarks=(*character.remarks, _remark(left_out)))


def _size(part: MeshPart) -> float:
    """The diagonal of the box around a part."""
    return float(np.linalg.norm(np.ptp(part.neutral, axis=0))) if len(part.neutral) else 0.0


def _is_same_place(part: MeshPart, other: MeshPart) -> bool:
    return np.allclose(part.neutral, other.neutral, atol=1e-3 * _size(other))


def _is_nearer(part: MeshPart, head: MeshPart, copy: MeshPart) -> bool:
    """Whether a small part belongs to a head and not to its copy."""
    middle = part.neutral.mean(axis=0)
    to_head, to_copy = (
        float(np.linalg.norm(each.neutral.mean(axis=0) - middle)) / max(_size(each), 1e-12)
        for each in (head, copy)
    )
    return to_head < to_copy


def _level(part: MeshPart) -> int:
    """The level of detail that a name says; 0 is the finest."""
    found = _LEVEL.search(part.name)
    return int(found[1]) if found else 0


def _is_copy(part: MeshPart, other: MeshPart) -> bool:
    """Whether a part is the same mesh with the same targets, there or elsewhere."""
    return (
        bool(part.targets)
        and part.targets.keys() == other.targets.keys()
        and part.neutral.shape == other.neutral.shape
        and np.array_equal(part.faces, other.faces)
        and np.allclose(_form(part), _form(other), atol=1e-3)
    )


def _form(part: MeshPart) -> np.ndarray:
    """(V,) distances from the middle, in units of the largest."""
    away = np.linalg.norm(part.neutral - part.neutral.mean(axis=0), axis=1)
    form: np.ndarray = away / max(float(away.max()), 1e-12)
    return form


def _remark(names: Sequence[str]) -> str:
    shown = ", ".join(name[:40] for name in names[:3]) + (" …" if len(names) > 3 else "")
    return f"copies of the head were left out: {shown}"

"""The blendshapes of an animation clip of Unity, saved as text (`.anim`, YAML).

Each curve under `m_FloatCurves` has keys with a time and a value, and then its `attribute`, such as
`blendShape.jawOpen`, and the `path` of its mesh; `m_EditorCurves` has the same curves again, for
Unity's own editor. Keys are frames if all curves that move have them at the same times. Meshes with
the same weights, such as head and teeth, are one take. Slopes and all else are kept.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.errors import FileError
from faceedit_app.core.names import naming_of
from faceedit_app.formats.files import LONGEST_NAME, check_text, shown
from faceedit_app.formats.followers import WHOLE, following
from faceedit_app.formats.key_times import time_keys
from faceedit_app.formats.number_spans import SpanSource
from faceedit_app.formats.take import Recording, Take, finish_take
from faceedit_app.formats.timing import counted
from faceedit_app.formats.weights import PERCENT

FORMAT = "Unity animation clip"
_HEAD = 1 << 12
_MAGIC = b"tag:unity3d.com"
_SHAPE = "blendShape."
_LINE = re.compile(
    rb"^(?P<indent> *)(?:- )?(?P<key>time|value|attribute|path|m_\w+): *(?P<text>[^\r\n]*)",
    re.M,
)
_ATTRIBUTE = re.compile(rb"blendShape\.([^\r\n]+)")
_SECTIONS = (b"m_FloatCurves", b"m_EditorCurves")
# Turns, places and sizes of bones, each as three or four numbers a key.
_OF_BONES = re.compile(
    rb"^  (m_(?:Rotation|CompressedRotation|Euler|Position|Scale)Curves): *\r?\n(?= *-)", re.M
)
_SECTION_INDENT = 2
_STILL = 2  # keys of a curve that does not move
_BAKE = "export it with a key for every frame, or as CSV"
_SLOPES = (
    "the slopes of keys stay as they are: an edited key is exact, and between keys it may not be"
)


@dataclass
class _Curve:
    """The keys of a shape of a mesh: times, and where the values are in the file."""

    name: str = ""
    mesh: str = ""
    times: list[float] = field(default_factory=list)
    spans: list[tuple[int, int]] = field(default_factory=list)


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is an animation clip with ARKit's shapes."""
    if _MAGIC not in content[:_HEAD]:
        return 0.0
    names = [
        text.decode("utf-8", "replace") for text in re.findall(rb"blendShape\.([^\r\n]+)", content)
    ]
    return 0.9 if any(map(naming_of(names), names)) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open an animation clip.

    Raises:
        RateNeeded: its times are unusable, and `fps` is None.
        FileError: it is damaged, or curves have keys at different times.
    """
    check_text(path, content)
    curves = [curve for curve in _curves(path, content) if curve.name and curve.times]
    naming = naming_of(curve.name for curve in curves)
    named = [(channel, curve) for curve in curves if (channel := naming(curve.name))]
    if not named:
        raise FileError(path, "has no keys of ARKit's shapes", _BAKE)
    named, unread = _one_face(path, content, named)
    longest = max((curve for _, curve in named), key=lambda curve: len(curve.times))
    for _, curve in named:
        if curve.times != longest.times and len(curve.times) > _STILL:
            what = f"has keys at other times for {shown(curve.name)} than for {shown(longest.name)}"
            raise FileError(path, what, _BAKE, _line(content, curve.spans[0][0]))
    moving = [(channel, curve) for channel, curve in named if curve.times == longest.times]
    columns: dict[str, list[_Curve]] = {}
    for channel, curve in moving:
        columns.setdefault(channel, []).append(curve)
    first = [found[0] for found in columns.values()]
    values = np.array([_numbers(path, content, curve.spans) for curve in first]).T
    copies = _copies(path, content, columns)
    still = len({channel for channel, _ in named} - columns.keys())
    others = {curve.name for curve in curves if naming(curve.name) is None}
    bones = [found.decode() for found in _OF_BONES.findall(content)]
    recording = Recording(
        path=path,
        format=FORMAT,
        channels=tuple(columns),
        values=values,
        timing=time_keys(path, np.array(longest.times), "sort the keys by time"),
        lost=np.zeros(len(values), bool),
        own=tuple(curve.name for curve in first),
        carried=tuple(shown(name, LONGEST_NAME) for name in (*sorted(others), *bones)),
        notes=(*_still_notes(still), _SLOPES),
        unread=unread,
        scale=PERCENT if np.abs(values).max() > 1 else None,
    )
    spans = np.array([curve.spans for curve in first], np.int64).transpose(1, 0, 2)
    return finish_take(
        recording,
        fps,
        lambda scale: SpanSource(content, spans, scale, copies=copies),
        lambda frame, k: _line(content, int(spans[frame, k, 0])),
    )


def _curves(path: Path, content: bytes) -> list[_Curve]:
    """The curves of shapes, in the order of the file."""
    found: list[_Curve] = []
    curve, inside = _Curve(), False
    for match in _LINE.finditer(content):
        key, text = match["key"], match["text"].strip()
        if key.startswith(b"m_") and len(match["indent"]) == _SECTION_INDENT:
            curve, inside = _Curve(), key in _SECTIONS
        elif not inside:
            continue
        elif key == b"time":
            curve.times.append(_numbers(path, content, [match.span("text")])[0])
        elif key == b"value":
            curve.spans.append((match.start("text"), match.start("text") + len(text)))
        elif key == b"attribute":
            name = text.decode("utf-8", "replace").strip("\"'")
            if len(curve.times) != len(curve.spans):
                problem = f"the curve {shown(name)} has keys without a value"
                raise FileError(path, problem, "save it again", _line(content, match.start()))
            curve.name = name.removeprefix(_SHAPE) if name.startswith(_SHAPE) else ""
            found.append(curve)
            curve = _Curve()
        elif key == b"path" and found and not curve.times:
            found[-1].mesh = text.decode("utf-8", "replace").strip("\"'")
    return found


def _one_face(
    path: Path, content: bytes, named: list[tuple[str, _Curve]]
) -> tuple[list[tuple[str, _Curve]], tuple[str, ...]]:
    """The curves of the mesh with most channels and of those that follow it; a note on others."""
    meshes: dict[str, dict[str, _Curve]] = {}
    for channel, curve in named:
        meshes.setdefault(curve.mesh, {}).setdefault(channel, curve)
    face = max(meshes, key=lambda mesh: len(_moving(meshes[mesh])))
    apart = {mesh for mesh in meshes if not _goes_with(path, content, meshes[mesh], meshes[face])}
    kept = [one for one in named if one[1].mesh not in apart]
    kept.sort(key=lambda one: one[1].mesh != face)  # teeth that follow may be still where it moves
    if not apart:
        return kept, ()
    which = f': those of "{shown(face)}" are read' if face else ": those of the first are read"
    note = f"{1 + len(apart)} meshes have weights of their own{which}"
    return kept, (note,)


def _moving(mesh: dict[str, _Curve]) -> dict[str, _Curve]:
    return {channel: curve for channel, curve in mesh.items() if len(curve.times) > _STILL}


def _goes_with(
    path: Path, content: bytes, mesh: dict[str, _Curve], face: dict[str, _Curve]
) -> bool:
    """Whether a mesh has the weights of the face in the channels that both have."""
    if mesh is face:
        return True
    shared = _moving({channel: curve for channel, curve in mesh.items() if channel in face})
    if any(curve.times != face[channel].times for channel, curve in shared.items()):
        return False
    own = [_numbers(path, content, curve.spans) for curve in shared.values()]
    lead = [_numbers(path, content, face[channel].spans) for channel in shared]
    if len({len(row) for row in lead}) > 1:
        return True  # these are refused, as those of one face are
    found = following(np.array(lead).T, np.array(own).T) if shared else None
    return not shared or (found is not None and found.share == WHOLE)


def _copies(
    path: Path, content: bytes, columns: dict[str, list[_Curve]]
) -> tuple[NDArray[np.int64], ...]:
    """(T, K, 2) per further curve of channels with the same weights; -1 if there is none."""
    most = max(map(len, columns.values()))
    copies = []
    for place in range(1, most):
        spans = []
        for first, *others in columns.values():
            same = [c for c in others if _same(path, content, c, first)]
            there = same[place - 1].spans if place <= len(same) else [(-1, -1)] * len(first.spans)
            spans.append(there)
        copies.append(np.array(spans, np.int64).transpose(1, 0, 2))
    return tuple(copies)


def _same(path: Path, content: bytes, curve: _Curve, other: _Curve) -> bool:
    return _numbers(path, content, curve.spans) == _numbers(path, content, other.spans)


def _numbers(path: Path, content: bytes, spans: Sequence[tuple[int, int]]) -> list[float]:
    numbers = []
    for start, end in spans:
        text = content[start:end].strip()
        try:
            number = float(text)
        except ValueError:
            number = np.nan
        if not np.isfinite(number):
            problem = f'holds "{shown(text.decode("utf-8", "replace"))}", not a finite number'
            raise FileError(path, problem, "save it again", _line(content, start))
        numbers.append(number)
    return numbers


def _still_notes(still: int) -> tuple[str, ...]:
    if not still:
        return ()
    return (f"{counted(still, 'channel')} with one or two keys: carried",)


def _line(content: bytes, place: int) -> int:
    return content.count(b"\n", 0, place) + 1

"""Characters from VRM 0 and VRM 1 files: glTF, with expressions that move morph targets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.characters.bounded import MOST_TARGETS, Damaged, check_targets
from faceedit_app.characters.character import Character, MeshPart
from faceedit_app.characters.gltf import PlacedPrimitive, read_parts
from faceedit_app.characters.gltf_buffers import GltfFile, Json
from faceedit_app.core.arrays import Floats

# A bind of an expression: the node or mesh, the number of its target, and the weight.
_Bind = tuple[int, int, float]


def read_vrm(path: Path) -> Character:
    """Read a VRM file; its expressions are added to the morph targets of its meshes.

    Raises:
        FileError: it cannot be read, or holds no mesh.
        Damaged: it contradicts itself.
    """
    document = GltfFile(path)
    extensions = document.json.get("extensions") or {}
    is_first = "VRMC_vrm" not in extensions
    vrm: Json = extensions.get("VRM" if is_first else "VRMC_vrm") or {}
    expressions = _groups(vrm) if is_first else _expressions(vrm)
    if len(expressions) > MOST_TARGETS:
        raise Damaged(f"{len(expressions)} expressions are more than {MOST_TARGETS}")
    placed = read_parts(document)
    sizes = [len(part.neutral) for _, part, _ in placed]
    check_targets(sizes, [len(part.targets) + len(expressions) for _, part, _ in placed])
    parts = tuple(_with_expressions(p, part, expressions, is_first) for p, part, _ in placed)
    meta: Json = vrm.get("meta") or {}
    return Character(path, "VRM 0" if is_first else "VRM 1", parts, attribution=_attribution(meta))


def _groups(vrm: Json) -> dict[str, Sequence[_Bind]]:
    """The blendshape groups of VRM 0, whose weights are in percent."""
    found = {}
    for group in (vrm.get("blendShapeMaster") or {}).get("blendShapeGroups") or []:
        preset = str(group.get("presetName") or "unknown").lower()
        name = str(group.get("name") or "") if preset == "unknown" else preset
        binds = group.get("binds") or []
        found[name[:200]] = [
            (_number(b, "mesh"), _number(b, "index"), float(b.get("weight", 100)) / 100)
            for b in binds
        ]
    return {name: binds for name, binds in found.items() if name and binds}


def _expressions(vrm: Json) -> dict[str, Sequence[_Bind]]:
    """The expressions of VRM 1, preset and custom."""
    found = {}
    expressions = vrm.get("expressions") or {}
    for kind in ("preset", "custom"):
        for name, expression in (expressions.get(kind) or {}).items():
            binds = (expression or {}).get("morphTargetBinds") or []
            found[str(name)[:200]] = [
                (_number(b, "node"), _number(b, "index"), float(b.get("weight", 1))) for b in binds
            ]
    return {name: binds for name, binds in found.items() if name and binds}


def _number(bind: Json, key: str) -> int:
    value: Any = bind.get(key)
    if not isinstance(value, int):
        raise Damaged("an expression moves a morph target that does not exist")
    return value


def _with_expressions(
    placed: PlacedPrimitive, part: MeshPart, expressions: dict[str, Sequence[_Bind]], by_mesh: bool
) -> MeshPart:
    own = placed.mesh if by_mesh else placed.node
    targets: dict[str, Floats] = dict(part.targets)
    for name, binds in expressions.items():
        moves = [
            (part.targets[placed.names[index]], weight)
            for number, index, weight in binds
            if number == own
            and 0 <= index < len(placed.names)
            and placed.names[index] in part.targets
        ]
        if not moves or name in part.targets:
            continue
        if len(moves) == 1 and moves[0][1] == 1.0:
            targets[name] = moves[0][0]  # the same array under another name
        else:
            targets[name] = np.sum([weight * array for array, weight in moves], axis=0)
    return replace(part, targets=targets)


def _attribution(meta: Json) -> str:
    authors = meta.get("authors") or [meta.get("author")]
    license_ = meta.get("licenseUrl") or meta.get("licenseName")
    says = [meta.get("name") or meta.get("title"), *authors, license_]
    return ", ".join(str(text) for text in says if text)[:300]

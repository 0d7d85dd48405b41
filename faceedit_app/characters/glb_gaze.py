"""Turn the eyes in a GLB of another maker: their joints, or the nodes of their eyeballs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from faceedit_app.characters.fitted import FittedCharacter
from faceedit_app.characters.gaze import LOOKS, gaze_turns
from faceedit_app.characters.glb_turning import rotation_of, split_matrix
from faceedit_app.characters.gltf_nodes import node_places
from faceedit_app.characters.turning import quaternions
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.clip import Clip


@dataclass(frozen=True)
class EyeTurns:
    """How a node of a file turns.

    Attributes:
        node: its number.
        pivot: (3,) about which it turns, in the file's coordinates.
        matrices: (T, 3, 3) in the file's coordinates.
    """

    node: int
    pivot: Doubles
    matrices: Doubles = field(repr=False)


def eye_turns(fitted: FittedCharacter, clip: Clip) -> list[EyeTurns]:
    """How eyes without shapes turn in a take; empty if eyes have shapes, or are part of a mesh.

    Args:
        fitted: a character from a GLB.
    """
    if fitted.eyes is None:
        return []
    shown = fitted.rig.levels.applied(clip.arkit_weights())
    weights = dict(zip(ARKIT_CHANNELS, shown.T, strict=True))
    turns = gaze_turns({name: weights[name] for name in LOOKS})
    axes = fitted.frame.axes
    return [
        EyeTurns(node, eye.place, axes.T @ turn @ axes)
        for eye, turn in zip(fitted.eyes, turns, strict=True)
        for node in eye.nodes(fitted.character.parts, fitted.part_of)
    ]


def turned_node(
    document: Mapping[str, Any], turns: EyeTurns, all_turns: Sequence[EyeTurns]
) -> tuple[Floats, Floats] | None:
    """The rotations (T, 4), x, y, z, w, and the translations (T, 3) of a node.

    Args:
        document: of the GLB; a matrix of the node is replaced by its parts.
        all_turns: of all nodes; a node below another one that turns moves with it.

    Returns:
        None if the node turns with another, or if something else hangs on it.
    """
    nodes = document["nodes"]
    parents = {child: k for k, node in enumerate(nodes) for child in node.get("children") or []}
    together = {t.node for t in all_turns if np.array_equal(t.pivot, turns.pivot)}
    if _above(turns.node, parents) & together or _meshes_below(turns.node, nodes) - together:
        return None
    places = node_places(nodes)
    above = places[parents[turns.node]] if turns.node in parents else np.eye(4)
    split_matrix(nodes[turns.node])
    own = nodes[turns.node].get("rotation", (0.0, 0.0, 0.0, 1.0))
    turned, here = rotation_of(above), places[turns.node][:3, 3]
    rotations = turned.T @ turns.matrices @ turned @ Rotation.from_quat(own).as_matrix()
    moved = turns.pivot + turns.matrices @ (here - turns.pivot)
    inside = np.linalg.solve(above[:3, :3], (moved - above[:3, 3]).T).T
    return quaternions(rotations), inside.astype(np.float32)


def _above(node: int, parents: Mapping[int, int]) -> set[int]:
    found: set[int] = set()
    while node in parents and parents[node] not in found:
        node = parents[node]
        found.add(node)
    return found


def _meshes_below(node: int, nodes: list[dict[str, Any]]) -> set[int]:
    """The nodes with meshes below a node, which it would take along."""
    found: set[int] = set()
    waiting = list(nodes[node].get("children") or [])
    while waiting:
        child = waiting.pop()
        if "mesh" in nodes[child] and "skin" not in nodes[child]:
            found.add(child)
        waiting += nodes[child].get("children") or []
    return found

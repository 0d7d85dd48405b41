"""Where glTF files place their nodes."""

from __future__ import annotations

from typing import Any

import numpy as np

from faceedit_app.characters.bounded import Damaged, finite, whole
from faceedit_app.characters.gltf_buffers import Json
from faceedit_app.core.arrays import Doubles


def node_places(nodes: list[Any]) -> list[Doubles]:
    """(4, 4) local to world of every node."""
    parents: dict[int, int] = {}
    for number, node in enumerate(nodes):
        for child in node.get("children") or []:
            parents[whole(child, "the number of a node", len(nodes) - 1)] = number
    own = [own_place(node) for node in nodes]
    places: list[Doubles | None] = [None] * len(nodes)
    for number in range(len(nodes)):
        chain = []
        at: int | None = number
        while at is not None and places[at] is None:
            chain.append(at)
            if len(chain) > len(nodes):
                raise Damaged("its nodes form a cycle")
            at = parents.get(at)
        for at in reversed(chain):
            above = places[parents[at]] if at in parents else None
            places[at] = own[at] if above is None else above @ own[at]
    return [place for place in places if place is not None]


def own_place(node: Json) -> Doubles:
    """(4, 4) a node's own transform."""
    if node.get("matrix") is not None:
        return finite(np.array(node["matrix"], np.float64).reshape(4, 4).T, "a node's matrix")
    x, y, z, w = np.array(node.get("rotation", (0, 0, 0, 1)), np.float64)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    place = np.eye(4)
    place[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)), np.float64)
    place[:3, 3] = node.get("translation", (0, 0, 0))
    return finite(place, "a node's place")

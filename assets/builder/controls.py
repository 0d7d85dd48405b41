"""The control distances of the character: which vertices they join."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from assets.builder.source import Ints
from faceedit_app.core.controls import CONTROL_IDS, CONTROLS
from faceedit_app.core.rig import Rig

LEFT_CORNER, RIGHT_CORNER = 7185, 425
_UPPER_LIP, _LOWER_LIP = 466, 496
_BRIDGE, _CHIN = 134, 5162

# Vertices of the "hm08" base mesh, by `Control.id`.
PAIRS: dict[str, tuple[int, int]] = {
    "mouth_opening": (474, 523),
    "mouth_width": (LEFT_CORNER, RIGHT_CORNER),
    "left_corner": (_UPPER_LIP, LEFT_CORNER),
    "right_corner": (_UPPER_LIP, RIGHT_CORNER),
    "upper_lip": (_BRIDGE, _UPPER_LIP),
    "lower_lip": (_CHIN, _LOWER_LIP),
    "left_eyelid": (6785, 6828),
    "right_eyelid": (1, 44),
    # From the inner corner of the eye, which neither a blink nor a squint moves.
    "left_brow": (6851, 6979),
    "right_brow": (67, 204),
    "jaw_side": (_BRIDGE, _CHIN),
}


def control_pairs(base_index: Ints) -> Ints:
    """(C, 2) indices into the finished character; -1 for a control that `PAIRS` lacks.

    Args:
        base_index: (V,) the base-mesh vertex that each of its vertices comes from, or -1.
    """
    where = {int(base): i for i, base in enumerate(base_index) if base >= 0}
    return np.array(
        [[where[v] for v in PAIRS[name]] if name in PAIRS else (-1, -1) for name in CONTROL_IDS]
    )


def write_definitions(path: Path, rig: Rig) -> None:
    """Write the definitions for people and other tools to read."""
    lengths = rig.controls(np.zeros((1, len(rig.channels)), np.float32))[0]
    entries = [
        {
            "id": control.id,
            "label": control.label,
            "region": control.region,
            "vertices": [int(v) for v in pair],
            "base_mesh_vertices": list(PAIRS[control.id]),
            "neutral_length_mm": round(float(length), 2),
        }
        for control, pair, length in zip(CONTROLS, rig.control_pairs, lengths, strict=True)
        if control.id in PAIRS
    ]
    text = json.dumps({"controls": entries}, indent=2) + "\n"
    path.write_text(text, encoding="utf-8", newline="\n")

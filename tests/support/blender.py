"""Blender, where it is installed: opens what FaceEdit exports."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

# Opens a file in a scene of its frame rate; its head is `head`, the arguments are `arguments`.
_OPEN = """
import json, sys
import bpy

path, rate, *arguments = sys.argv[sys.argv.index("--") + 1 :]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = round(float(rate))
if path.endswith(".glb"):
    bpy.ops.import_scene.gltf(filepath=path)
elif path.endswith(".fbx"):
    bpy.ops.import_scene.fbx(filepath=path)
else:
    bpy.ops.wm.usd_import(filepath=path)
head = next(o for o in bpy.data.objects if o.type == "MESH" and o.data.shape_keys)
"""
# Prints its shape keys and their values on each frame of the scene.
_SCRIPT = """
frames = int(arguments[0])
keys = head.data.shape_keys.key_blocks[1:]
first = round(min(c.range()[0] for c in curves(head.data.shape_keys)))
rows = []
for frame in range(first, first + frames):
    scene.frame_set(frame)
    rows.append([key.value for key in keys])
materials = [m.name for m in head.data.materials]
facts = {"shapes": [key.name for key in keys], "weights": rows, "materials": materials}
facts["pictures"] = sorted({tuple(i.size) for i in bpy.data.images if i.size[0]})
facts["textured"] = [
    any(link.to_socket.name == "Base Color" for link in m.node_tree.links)
    for m in head.data.materials
]
print("FACTS " + json.dumps(facts | {"vertices": len(head.data.vertices), "fps": scene.render.fps}))
"""
_CURVES = """
def curves(keys):
    action = keys.animation_data.action
    if hasattr(action, "fcurves"):
        return action.fcurves
    return action.layers[0].strips[0].channelbags[0].fcurves
"""


def opened_in_blender(path: Path, rate: float, frames: int) -> dict[str, Any]:
    """What Blender finds in a GLB, FBX or USD; skips the test if Blender is not there."""
    return head_in_blender(_CURVES + _SCRIPT, path, rate, frames)


def head_in_blender(script: str, path: Path, rate: float, *arguments: object) -> dict[str, Any]:
    """The facts that a script prints of a GLB, FBX or USD, which it finds opened.

    The script has `head`, the object with shape keys; `scene`; and `arguments` as texts.
    """
    return run_in_blender(_OPEN + script, path.parent, path, rate, *arguments)


def run_in_blender(script: str, folder: Path, *arguments: object) -> dict[str, Any]:
    """The facts that a script prints as JSON after `FACTS`; skips if Blender is not there."""
    blender = shutil.which("blender")
    if blender is None:
        pytest.skip("blender is not installed")
    file = folder / "in_blender.py"
    file.write_text(script, encoding="utf-8")
    command = [blender, "--background", "--factory-startup", "--python", os.fspath(file), "--"]
    run = subprocess.run(
        [*command, *map(str, arguments)], capture_output=True, encoding="utf-8", timeout=100,
        check=False,
    )  # fmt: skip
    lines = [line for line in run.stdout.splitlines() if line.startswith("FACTS ")]
    assert lines, run.stdout + run.stderr
    facts: dict[str, Any] = json.loads(lines[-1].removeprefix("FACTS "))
    return facts

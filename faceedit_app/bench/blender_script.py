"""Runs in Blender, not in FaceEdit: `blender --background --python blender_script.py -- ...`.

Arguments: the head (GLB), repetitions, pixels, frames. Prints `FACEEDIT` and a line of JSON.
"""

import importlib
import json
import os
import statistics
import sys
import tempfile
import time

bpy = importlib.import_module("bpy")  # only Blender has it

_head, _times, _size, _frames = sys.argv[sys.argv.index("--") + 1 :]
times, size, frames = int(_times), int(_size), int(_frames)

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=_head)
mesh = next(o for o in bpy.data.objects if o.type == "MESH" and o.data.shape_keys)
key = mesh.data.shape_keys.key_blocks["jawOpen"]
for frame in range(1, frames + 1):
    key.value = 0.3
    key.keyframe_insert("value", frame=frame)
action = mesh.data.shape_keys.animation_data.action
curve = next(c for c in action.fcurves if "jawOpen" in c.data_path)

scene = bpy.context.scene
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location = (0.0, -0.85, 0.03)
camera.rotation_euler = (1.5708, 0.0, 0.0)
scene.collection.objects.link(camera)
scene.camera = camera
scene.render.engine = "BLENDER_WORKBENCH"
scene.render.resolution_x = scene.render.resolution_y = size
scene.render.filepath = os.path.join(tempfile.mkdtemp(), "frame.png")

taken = []
for step in range(times + 2):
    began = time.perf_counter()
    for point in curve.keyframe_points:
        point.co.y = 0.2 + 0.01 * (step % 20)
    curve.update()
    scene.frame_set(frames // 2)
    bpy.context.evaluated_depsgraph_get().update()
    bpy.ops.render.render(write_still=False)
    taken.append(1e3 * (time.perf_counter() - began))
print(
    "FACEEDIT",
    json.dumps({"median": statistics.median(taken[2:]), "version": bpy.app.version_string}),
)

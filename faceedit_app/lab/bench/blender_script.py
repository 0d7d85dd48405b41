"""The same work in Blender, which runs this in a window: `blender --python THIS_FILE -- JOB`.

JOB is a JSON file: `head` (a GLB), `weights` (by shape key, one number for each frame), `changed`
(the shape key whose curve is edited), `frame` (the one on screen), `size` (pixels), `times`,
`target` (metres, Y up), `distance` (metres) and `field_of_view` (radians). Prints `FACEEDIT` and
JSON, on one line: medians in ms, what was drawn, and by what; then again, with EEVEE's in it.

A step is the wait of a user who drags all keys of one curve in Blender: the keys move
(`curve`), the scene is evaluated (`evaluate`), the window is drawn and shown (`draw`). In it:

- all shape keys of the head, each with a key on each frame, so that none is skipped for being 0;
- the same triangles, vertex colours and view as ours, smooth normals, and one sample a pixel;
- a window that shows only the face: no grid, handles, outline or curve editor.

Not in it: networks (Blender has none, so the other curves stay), plots, the mouse, undo. One call
moves all keys of the curve; nothing is done key by key in Python.
"""

import importlib
import json
import math
import os
import statistics
import sys
import tempfile
import time
import traceback
from pathlib import Path
from typing import Any

bpy: Any = importlib.import_module("bpy")  # only Blender has these three
gpu: Any = importlib.import_module("gpu")
mathutils: Any = importlib.import_module("mathutils")
np: Any = importlib.import_module("numpy")  # Blender's, or the system's

WARM_UP = 5


def head_of(job: dict[str, Any]) -> Any:
    """The head in an empty scene, with a key for each weight of each frame."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    # Blender 3.4's reader asks numpy for a name that the numpy beside it has given up.
    if "bool" not in vars(np):
        np.bool = bool
    # Vertices on the seams between materials are welded, or normals would break there.
    bpy.ops.import_scene.gltf(filepath=job["head"], merge_vertices=True)
    head = next(o for o in bpy.data.objects if o.type == "MESH" and o.data.shape_keys)
    head.data.polygons.foreach_set("use_smooth", [True] * len(head.data.polygons))
    head.data.update()
    keys = head.data.shape_keys
    keys.animation_data_create().action = bpy.data.actions.new("take")
    for name, weights in job["weights"].items():
        path = f'key_blocks["{name}"].value'
        curve = keys.animation_data.action.fcurves.new(path)
        curve.keyframe_points.add(len(weights))
        points = np.column_stack([np.arange(1.0, len(weights) + 1.0), weights])
        curve.keyframe_points.foreach_set("co", points.ravel())
        curve.update()
    bpy.context.scene.frame_end = len(job["weights"][job["changed"]])
    bpy.context.scene.frame_set(job["frame"])
    return head


def face_alone(job: dict[str, Any]) -> dict[str, Any]:
    """Fill the window with one 3D view of the face; returns the context for operators."""
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == "VIEW_3D")
    with bpy.context.temp_override(window=window, area=area, region=area.regions[-1]):
        bpy.ops.screen.screen_full_area(use_hide_panels=True)
    area = window.screen.areas[0]
    region = next(r for r in area.regions if r.type == "WINDOW")
    if (region.width, region.height) != (job["size"], job["size"]):
        raise RuntimeError(f"the view has {region.width} x {region.height} pixels")
    space = area.spaces.active
    space.overlay.show_overlays = space.show_gizmo = False
    space.shading.color_type = "VERTEX"
    space.shading.show_object_outline = False
    # Half a view is 36 mm of a view's lens.
    space.lens = 36.0 / math.tan(job["field_of_view"] / 2.0)
    x, y, z = job["target"]
    view = space.region_3d
    view.view_perspective, view.view_distance = "PERSP", job["distance"]
    view.view_location = (x, -z, y)
    view.view_rotation = mathutils.Euler((math.pi / 2.0, 0.0, 0.0)).to_quaternion()
    bpy.context.preferences.system.viewport_aa = "OFF"  # as in FaceEdit while the face moves
    bpy.context.scene.eevee.taa_samples = 1
    return {"window": window, "screen": window.screen, "area": area, "region": region}


def steps(job: dict[str, Any], head: Any, view: dict[str, Any]) -> dict[str, Any]:
    """Edit, evaluate and draw repeatedly; medians in ms, in total and by part."""
    path = f'key_blocks["{job["changed"]}"].value'
    curve = head.data.shape_keys.animation_data.action.fcurves.find(path)
    before = np.empty(2 * len(curve.keyframe_points), np.float32)  # frame and value of each key
    curve.keyframe_points.foreach_get("co", before)
    points = before.copy()
    layer = bpy.context.view_layer
    taken: list[tuple[float, float, float]] = []
    with bpy.context.temp_override(**view):
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
        first = picture()
        for step in range(WARM_UP + job["times"]):
            began = time.perf_counter()
            points[1::2] = before[1::2] + 0.02 * (1 + step % 20)
            curve.keyframe_points.foreach_set("co", points)
            curve.update()
            moved = time.perf_counter()
            layer.update()
            evaluated = time.perf_counter()
            bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
            drawn = time.perf_counter()
            taken.append((moved - began, evaluated - moved, drawn - evaluated))
        last = picture()
    curve.keyframe_points.foreach_set("co", before)
    curve.update()
    if np.array_equal(first, last):
        raise RuntimeError("the picture did not follow the curve")
    parts = [1e3 * statistics.median(column) for column in zip(*taken[WARM_UP:], strict=True)]
    return {
        "median": 1e3 * statistics.median(sum(step) for step in taken[WARM_UP:]),
        "best": 1e3 * min(sum(step) for step in taken[WARM_UP:]),
        "stages": dict(zip(("curve", "evaluate", "draw"), parts, strict=True)),
    }


def compile_shaders(view: dict[str, Any]) -> None:
    """Draw once offscreen, where EEVEE waits for its shaders; else they are compiled later."""
    width = view["region"].width
    space = view["area"].spaces.active
    beside = gpu.types.GPUOffScreen(width, width)
    matrices = space.region_3d.view_matrix, space.region_3d.window_matrix
    beside.draw_view3d(bpy.context.scene, bpy.context.view_layer, space, view["region"], *matrices)
    beside.free()


def picture() -> Any:
    """The window's pixels, as an array."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder, "window.png"))
        bpy.ops.screen.screenshot(filepath=path)
        image = bpy.data.images.load(path)
        pixels = np.array(image.pixels[:], np.float32)
        bpy.data.images.remove(image)
    return pixels


def main() -> None:
    """Measure Workbench, in which users animate, then EEVEE, which fewer machines can run."""
    job = json.loads(Path(sys.argv[sys.argv.index("--") + 1]).read_text(encoding="utf-8"))
    head = head_of(job)
    view = face_alone(job)
    shading = view["area"].spaces.active.shading
    shading.type = "SOLID"
    found = steps(job, head, view) | {
        "version": bpy.app.version_string,
        "drawn_by": gpu.platform.renderer_get(),
        "vertices": len(head.data.vertices),
        "triangles": len(head.data.polygons),
        "shape_keys": len(head.data.shape_keys.key_blocks) - 1,  # the first is the neutral face
        "eevee": None,
    }
    print("FACEEDIT", json.dumps(found), flush=True)
    shading.type = "MATERIAL"
    compile_shaders(view)
    found["eevee"] = steps(job, head, view)
    print("FACEEDIT", json.dumps(found), flush=True)


# Left at once, whatever happens: a window that stays open would keep `faceedit bench` waiting.
try:
    main()
    left = 0
except BaseException:
    traceback.print_exc()
    left = 3
sys.stdout.flush()
sys.stderr.flush()
os._exit(left)

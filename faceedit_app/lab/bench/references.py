"""Reference measurements to compare with; None if one is not installed."""

from __future__ import annotations

import importlib
import importlib.util
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.core.regions import REGIONS
from faceedit_app.core.resources import CHARACTER, shipped
from faceedit_app.core.rig import Rig
from faceedit_app.lab.bench.clocks import Timings, repeat
from faceedit_app.lab.bench.desk import long_take
from faceedit_app.lab.training.settings import TrainingSettings
from faceedit_app.networks.engine import ENDING, Engine
from faceedit_app.render.camera import FAR, FIELD_OF_VIEW, NEAR, default_camera

FRAMES, SIZE = 202, 640
_BLENDER_SECONDS = 180  # without a GPU, both engines need about 25


def naive(engine: Engine, rig: Rig, times: int) -> Timings:
    """The plain way: networks on the whole take, then pyrender as its manual shows it."""
    import pyrender
    import trimesh

    clip = long_take(FRAMES).clip
    weights = clip.arkit_weights()
    camera = default_camera(rig)
    scene_camera = pyrender.PerspectiveCamera(yfov=FIELD_OF_VIEW)
    renderer = pyrender.OffscreenRenderer(SIZE, SIZE)
    colors = (255 * rig.colors).astype(np.uint8)

    def once() -> None:
        curves = rig.arkit_distances.measure(weights).astype(np.float64)
        for region in REGIONS:
            for version in (curves, curves + 1.0):
                engine.answer(region.id, version, 1.0)
        rig.arkit_distances.measure(weights)
        vertices = rig.vertices(rig.from_arkit(weights[100]))
        mesh = trimesh.Trimesh(vertices, rig.faces, vertex_colors=colors, process=False)
        scene = pyrender.Scene()
        scene.add(pyrender.Mesh.from_trimesh(mesh))
        scene.add(scene_camera, pose=camera.pose())
        scene.add(pyrender.DirectionalLight(intensity=4.0), pose=camera.pose())
        renderer.render(scene)

    try:
        return repeat(once, times, 3)
    finally:
        renderer.delete()


def _can_train() -> bool:
    return all(importlib.util.find_spec(name) is not None for name in ("onnx", "torch"))


def in_torch(architecture: str, times: int) -> Timings | None:
    """The three regions' networks of an architecture on 202 frames, in torch, on one thread."""
    if not _can_train():
        return None
    import torch

    from faceedit_app.lab.training.architectures import ARCHITECTURES

    kind, settings = ARCHITECTURES[architecture], TrainingSettings()
    nets = [kind.of(len(r.controls), len(r.channels), settings).eval() for r in REGIONS]
    inputs = [torch.randn(1, net.controls, _padded(FRAMES, net.scale)) for net in nets]
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        with torch.inference_mode():
            return repeat(
                lambda: [net.answers(curves) for net, curves in zip(nets, inputs, strict=True)],
                times,
            )
    finally:
        torch.set_num_threads(threads)


def _padded(frames: int, scale: int) -> int:
    return scale * -(-frames // scale)


def multiplications(path: Path, frames: int) -> int:
    """Multiplications in the convolutions of a region's networks, for a number of frames."""
    import onnx

    model = onnx.load(path)
    for value in (*model.graph.input, *model.graph.output):
        value.type.tensor_type.shape.dim[0].dim_value = frames
    graph = onnx.shape_inference.infer_shapes(model, data_prop=True).graph
    lengths = {
        value.name: value.type.tensor_type.shape.dim[-1].dim_value for value in graph.value_info
    }
    sizes = {tensor.name: math.prod(tensor.dims) for tensor in graph.initializer}
    return sum(
        sizes[node.input[1]] * lengths[node.output[0]]
        for node in graph.node
        if node.op_type == "Conv"
    )


def cpu_limit(folder: Path, times: int) -> Timings | None:
    """One matrix product with as many multiplications as the networks need for 202 frames."""
    if importlib.util.find_spec("onnx") is None:
        return None
    paths = [folder / f"{region.id}{ENDING}" for region in REGIONS]
    needed = sum(multiplications(path, _padded(FRAMES, 16)) for path in paths)
    side = 384
    rows = max(round(needed / side**2), 1)
    random = np.random.default_rng(0)
    a = random.normal(size=(rows, side)).astype(np.float32)
    b = random.normal(size=(side, side)).astype(np.float32)
    out = np.empty((rows, side), np.float32)
    return repeat(lambda: np.matmul(a, b, out=out), times)


def gl_limit(rig: Rig, times: int) -> Timings | None:
    """The same triangles in one colour, read back: the least that this OpenGL needs."""
    if importlib.util.find_spec("moderngl") is None:
        return None
    import pyrender

    moderngl = importlib.import_module("moderngl")  # no dependency: an option for this measure
    context = moderngl.create_standalone_context(backend="egl")
    try:
        program = context.program(
            vertex_shader="""#version 330
                in vec3 position; uniform mat4 clip;
                void main() { gl_Position = clip * vec4(position, 1.0); }""",
            fragment_shader="""#version 330
                out vec4 pixel; void main() { pixel = vec4(0.8, 0.6, 0.5, 1.0); }""",
        )
        lens = pyrender.PerspectiveCamera(FIELD_OF_VIEW, NEAR, FAR)
        clip = lens.get_projection_matrix(SIZE, SIZE) @ np.linalg.inv(default_camera(rig).pose())
        program["clip"].write(clip.T.astype(np.float32).tobytes())
        vertices = np.ascontiguousarray(rig.neutral, np.float32)
        buffer = context.buffer(vertices.tobytes())
        indices = context.buffer(np.ascontiguousarray(rig.faces, np.int32).tobytes())
        mesh = context.vertex_array(program, [(buffer, "3f", "position")], indices)
        target = context.simple_framebuffer((SIZE, SIZE))
        target.use()
        context.enable(moderngl.DEPTH_TEST)
        out = bytearray(4 * SIZE * SIZE)

        def once() -> None:
            buffer.write(vertices)
            target.clear()
            mesh.render()
            target.read_into(out, components=4)

        return repeat(once, times)
    finally:
        context.release()


def blender(
    rig: Rig, times: int, say: Callable[[str], None] = lambda _: None
) -> dict[str, Any] | None:
    """The same head and take in Blender: change a shape key's curve, evaluate, draw.

    Blender draws only in a window; without a display it gets one from `xvfb-run`.

    Args:
        rig: ours, for the take's weights and the view.
        times: repetitions.
        say: called with the reason if there is no result.

    Returns:
        What `blender_script.py` prints; None if there is no `blender`, or it cannot draw.
    """
    program = shutil.which("blender")
    if program is None:
        return None
    command = [program, "--factory-startup", "--window-geometry", "0", "0", str(SIZE), str(SIZE)]
    shown = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if sys.platform == "linux" and not shown:
        display = shutil.which("xvfb-run")
        if display is None:
            say("blender: needs a display, or xvfb-run")
            return None
        command = [display, "-a", "-s", "-screen 0 1280x1024x24", *command]
    with tempfile.TemporaryDirectory() as folder:
        job = Path(folder, "job.json")
        job.write_text(json.dumps(_job(rig, times)), encoding="utf-8")
        script = Path(__file__).with_name("blender_script.py")
        printed = _output([*command, "--python", str(script), "--", str(job)], folder)
    lines = [line for line in printed.splitlines() if line.startswith("FACEEDIT ")]
    if not lines:
        say("blender: " + (printed.strip().splitlines() or ["no answer"])[-1])
        return None
    found: dict[str, Any] = json.loads(lines[-1].removeprefix("FACEEDIT "))
    return found


def _job(rig: Rig, times: int) -> dict[str, Any]:
    """Blender's input: the head, the take, and the camera."""
    weights = rig.from_arkit(long_take(FRAMES).clip.arkit_weights())
    camera = default_camera(rig)
    return {
        "head": str(shipped(CHARACTER)),
        "weights": dict(zip(rig.channels, weights.T.tolist(), strict=True)),
        "changed": "jawOpen",
        "frame": FRAMES // 2,
        "size": SIZE,
        "times": times,
        "target": camera.target,
        "distance": camera.distance,
        "field_of_view": FIELD_OF_VIEW,
    }


def _output(command: list[str], folder: str) -> str:
    """What a program prints, including errors, within `_BLENDER_SECONDS`.

    Its child processes are stopped too: `xvfb-run` would leave Blender and the display behind.
    """
    try:
        process = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,  # as `xvfb-run` does anyway
            encoding="utf-8",
            errors="replace",
            env=os.environ | {"TMPDIR": folder},
            start_new_session=True,
        )
    except OSError as error:
        return str(error)
    with process:
        try:
            return process.communicate(timeout=_BLENDER_SECONDS)[0]
        except subprocess.TimeoutExpired:
            if sys.platform == "win32":
                process.kill()
            else:
                os.killpg(process.pid, signal.SIGKILL)
            return f"{process.communicate()[0]}\nnot done after {_BLENDER_SECONDS} seconds"


def of_all(engine: Engine, rig: Rig, times: int) -> dict[str, Timings | None]:
    """The references that run in this process."""
    models = shipped("models")
    references: dict[str, Timings | None] = {
        "naive": naive(engine, rig, max(times // 5, 3)),
        "torch": in_torch("unet", times),
        "holden": in_torch("holden", times),
        "cpu_limit": cpu_limit(models, times),
    }
    try:
        references["gl_limit"] = gl_limit(rig, times)
    except Exception:  # drivers raise all kinds
        references["gl_limit"] = None
    return references

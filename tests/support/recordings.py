"""Small synthetic takes in formats other than CSV."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arkit import ARKIT_CHANNELS

Weights = NDArray[np.float64]

# The order in which Face Cap names its shapes.
FACECAP_NAMES = tuple(
    name + side
    for name, sides in (
        ("browInnerUp", ""),
        *((n, "LR") for n in ("browDown", "browOuterUp", "eyeLookUp", "eyeLookDown", "eyeLookIn")),
        *((n, "LR") for n in ("eyeLookOut", "eyeBlink", "eyeSquint", "eyeWide")),
        ("cheekPuff", ""),
        *((n, "LR") for n in ("cheekSquint", "noseSneer")),
        *((n, "") for n in ("jawOpen", "jawForward", "jawLeft", "jawRight", "mouthFunnel")),
        *((n, "") for n in ("mouthPucker", "mouthLeft", "mouthRight", "mouthRollUpper")),
        *((n, "") for n in ("mouthRollLower", "mouthShrugUpper", "mouthShrugLower", "mouthClose")),
        *((n, "LR") for n in ("mouthSmile", "mouthFrown", "mouthDimple", "mouthUpperUp")),
        *((n, "LR") for n in ("mouthLowerDown", "mouthPress", "mouthStretch")),
        ("tongueOut", ""),
    )
    for side in ([f"_{s}" for s in sides] or [""])
)


def face(frames: int = 40, channels: int = 52) -> Weights:
    """(frames, channels) weights that all differ, with four decimals."""
    places = np.arange(frames)[:, None] * 7 + np.arange(channels) * 3
    return np.round(0.5 + 0.4 * np.sin(places / 11.0), 4)


def audio2face(weights: Weights, fps: float | None = 60, indent: int | None = 4) -> str:
    """An Audio2Face export."""
    document: dict[str, Any] = {
        "exportFps": fps,
        "trackPath": 'C:\\take 12.5 "ä".wav',
        "numPoses": weights.shape[1],
        "numFrames": len(weights),
        "facsNames": list(ARKIT_CHANNELS),
        "weightMat": weights.tolist(),
        "joints": ["jaw"],
        "rotations": [[[0.0, 1e-3, -0.25, 1]]] * len(weights),
    }
    if fps is None:
        del document["exportFps"]
    return json.dumps(document, indent=indent, ensure_ascii=False)


def named_frames(weights: Weights, fps: float = 30, variant: str = "LAM") -> str:
    """JSON with names and frames, as LAM, BEAT and others write it."""
    document: dict[str, Any] = {"names": list(ARKIT_CHANNELS)}
    rows = weights.tolist()
    timed = [{"weights": row, "time": n / fps, "rotation": []} for n, row in enumerate(rows)]
    match variant:
        case "LAM":
            document["metadata"] = {"fps": fps, "frame_count": len(rows), "blendshape_count": 52}
            document["frames"] = timed
        case "BEAT":
            document["frames"] = timed
        case "plain lists":
            document |= {"frame_rate": fps, "frames": rows}
        case "values":
            document["values"] = rows
    return json.dumps(document)


def mediapipe(weights: Weights, fps: float = 60, variant: str = "categories") -> str:
    """JSON of a webcam recorder."""
    begin = 1_735_689_602_977
    times = [begin + round(1000 * n / fps) for n in range(len(weights))]
    entries: list[Any] = []
    for time, row in zip(times, weights.tolist(), strict=True):
        scores = {"_neutral": 0.0001} | dict(zip(ARKIT_CHANNELS, row, strict=True))
        categories = [{"name": name, "score": score} for name, score in scores.items()]
        if variant == "categories":
            entries.append({"timestamp": time, "blendshapes": categories})
        else:
            stamp = f"2025-01-01T00:00:{time % 60_000 / 1000:06.3f}Z"
            entries.append(
                {"key": f"x:{time}", "value": {"timestamp": stamp, "blendShapes": scores}}
            )
    return json.dumps(entries if variant == "categories" else {"data": entries})


def facecap(weights: Weights, fps: float = 30, newline: str = "\n") -> str:
    """A Face Cap recording."""
    lines = ["info,facecap,1", "bs," + ",".join(FACECAP_NAMES)]
    for n, row in enumerate(weights):
        pose = "0.01,0.02,-0.31,1.5,-2.0,0.3,0.1,0.2,0.1,0.2"
        cells = ",".join(f"{value:.4f}" for value in row)
        lines.append(f"k,{48 + round(1000 * n / fps)},{pose},{cells}")
    return newline.join(lines) + newline


def glb(
    path: Path,
    weights: Weights,
    fps: float = 30,
    *,
    kind: str = "float",
    meshes: int = 1,
    names: tuple[str, ...] = ARKIT_CHANNELS,
) -> Path:
    """Write a GLB of a triangle whose shapes are animated.

    Args:
        kind: `float`, `bytes`, `shorts` (stored in whole numbers) or `cubic` (with tangents).
        meshes: how many meshes have the same shapes and the same animation.
    """
    binary = bytearray()
    accessors: list[dict[str, Any]] = []
    views: list[dict[str, Any]] = []

    def add(array: NDArray[Any], component: int, type_: str, **more: Any) -> int:
        binary.extend(b"\0" * (-len(binary) % 4))
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": array.nbytes})
        binary.extend(array.tobytes())
        accessors.append(
            {
                "bufferView": len(views) - 1,
                "componentType": component,
                "count": array.size if type_ == "SCALAR" else len(array),
                "type": type_,
                **more,
            }
        )
        return len(accessors) - 1

    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4")
    corners = add(triangle, 5126, "VEC3", min=[0, 0, 0], max=[1, 1, 0])
    shapes = [{"POSITION": add(triangle * 0.1, 5126, "VEC3", min=[0, 0, 0], max=[0.1, 0.1, 0])}]
    times = ((np.arange(len(weights)) + 2) / fps).astype("<f4")
    clock = add(times, 5126, "SCALAR", min=[float(times[0])], max=[float(times[-1])])
    match kind:
        case "bytes":
            output = add(np.round(weights * 255).astype("u1"), 5121, "SCALAR", normalized=True)
        case "shorts":
            output = add(np.round(weights * 65535).astype("<u2"), 5123, "SCALAR", normalized=True)
        case "cubic":
            with_tangents = np.stack([0 * weights, weights, 0 * weights], axis=1)
            output = add(with_tangents.astype("<f4"), 5126, "SCALAR")
        case _:
            output = add(weights.astype("<f4"), 5126, "SCALAR")
    mesh = {
        "primitives": [{"attributes": {"POSITION": corners}, "targets": shapes * len(names)}],
        "extras": {"targetNames": list(names)},
    }
    sampler: dict[str, int | str] = {"input": clock, "output": output}
    if kind == "cubic":
        sampler["interpolation"] = "CUBICSPLINE"
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(meshes))}],
        "nodes": [{"mesh": n, "name": f"mesh {n}"} for n in range(meshes)],
        "meshes": [mesh] * meshes,
        "animations": [
            {
                "samplers": [sampler],
                "channels": [
                    {"sampler": 0, "target": {"node": n, "path": "weights"}} for n in range(meshes)
                ],
            }
        ],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary.extend(b"\0" * (-len(binary) % 4))
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(binary), b"BIN\0") + bytes(binary)
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    return path

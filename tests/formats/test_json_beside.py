"""What JSON has beside the weights is read if names say what it is, and told if not."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faceedit_app.formats.opening import open_take, write_take

TURNS = (0.1 * np.sin(np.arange(30)[:, None] / 5 + np.arange(3))).round(4)


def frames(beside: Any) -> list[dict[str, Any]]:
    """Frames with what `beside` makes of yaw, pitch and roll, beside the weights."""
    return [
        {"time": n / 30, "blendShapes": {"jawOpen": 0.01 * n, "mouthClose": 0.02}, **beside(*row)}
        for n, row in enumerate(TURNS.tolist())
    ]


@pytest.mark.parametrize(
    ("beside", "unit"),
    [
        (lambda y, p, r: {"headYaw": y, "headPitch": p, "headRoll": r}, 1.0),
        (lambda y, p, r: {"head": {"yaw": y, "pitch": p, "roll": r}}, 1.0),
        (lambda y, p, r: {"headPose": {"roll": r, "yaw": y, "pitch": p}}, 1.0),
        (lambda y, p, r: {"head": {"yaw": y, "pitch": p, "roll": r, "unit": "deg"}}, np.degrees(1)),
    ],
)
def test_rotations_beside_the_weights_are_read_and_written(
    tmp_path: Path, beside: Any, unit: float
) -> None:
    path, out = tmp_path / "take.json", tmp_path / "out.json"
    path.write_text(json.dumps(frames(beside)))
    take = open_take(path)
    rotations = take.clip.rotations
    assert rotations is not None
    np.testing.assert_allclose(rotations[:, :3], TURNS / unit, atol=1e-6)
    assert take.source.encode(take.clip.weights, take.clip.weights) == path.read_bytes()
    turned = rotations.copy()
    turned[3, 0] = 0.5 / unit
    write_take(out, take, take.clip.weights, turned)
    again = open_take(out).clip.rotations
    assert again is not None
    np.testing.assert_allclose(again, turned, atol=1e-6)


@pytest.mark.parametrize("about", ["units", "rotation_unit"])
def test_a_field_says_degrees(tmp_path: Path, about: str) -> None:
    rows = frames(lambda y, p, r: {"headYaw": y, "headPitch": p, "headRoll": r})
    path = tmp_path / "take.json"
    path.write_text(json.dumps({about: "degrees", "frames": rows}))
    rotations = open_take(path).clip.rotations
    assert rotations is not None
    np.testing.assert_allclose(rotations[:, :3], np.radians(TURNS), atol=1e-6)


def test_the_rest_is_told_by_its_keys(tmp_path: Path) -> None:
    rows = frames(lambda y, p, r: {"headRotation": [y, p, r], "transform": [[1, 0], [0, 1]]})
    path = tmp_path / "take.json"
    path.write_text(json.dumps(rows))
    assert open_take(path).carried == ("headRotation", "transform")


def test_lists_beside_those_of_channels_are_read_or_told(tmp_path: Path) -> None:
    lists: dict[str, list[object]] = {
        "time": [n / 30 for n in range(30)],
        "jawOpen": [0.01 * n for n in range(30)],
    }
    lists |= {"headYaw": TURNS[:, 0].tolist(), "transform": [[1, 0]] * 30}
    path = tmp_path / "take.json"
    path.write_text(json.dumps(lists))
    take = open_take(path)
    assert take.clip.rotations is not None
    np.testing.assert_allclose(take.clip.rotations[:, 0], TURNS[:, 0], atol=1e-6)
    assert take.carried == ("headYaw", "transform")


def test_the_joints_of_audio2face_and_the_turns_of_lam_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a2f.json"
    weights = [[0.01 * n] for n in range(30)]
    document = {"exportFps": 30, "facsNames": ["jawOpen"], "weightMat": weights, "joints": ["jaw"]}
    path.write_text(json.dumps(document | {"rotations": [[[0, 0, 0, 1]]] * 30}))
    assert open_take(path).carried == ("joints", "rotations")
    rows = [
        {"weights": row, "time": n / 30, "rotation": [0, 0, 0]} for n, row in enumerate(weights)
    ]
    path.write_text(json.dumps({"names": ["jawOpen"], "frames": rows}))
    assert open_take(path).carried == ("rotation",)

"""Landmarks of a scan: from a file, or found on a picture."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from support.faces import shipped_rig
from support.tracker import needs_tracker

from faceedit_app.characters.making import Template
from faceedit_app.characters.points import POINTS
from faceedit_app.characters.scans import Scan
from faceedit_app.cli import main
from faceedit_app.core.arrays import Doubles, Pixels
from faceedit_app.core.errors import FileError
from faceedit_app.scans import landmarks
from faceedit_app.scans.landmarks import find_landmarks, read_points, scan_landmarks
from faceedit_app.tracking.landmarker import FaceLandmarker


def test_points_are_read(tmp_path: Path) -> None:
    path = tmp_path / "points.json"
    path.write_text(json.dumps({name: [i, 0, 1] for i, name in enumerate(POINTS)}))
    assert read_points(path)["left_mouth_corner"].tolist() == [2, 0, 1]


@pytest.mark.parametrize(
    "content",
    [
        *("", "[]", "3", "[" * 99999, '{"chin": [0, 0, 0]}'),
        json.dumps({name: [0, 0] for name in POINTS}),
        json.dumps({name: [10**400, 0, 0] for name in POINTS}),
        json.dumps(dict.fromkeys(POINTS, "here")),
    ],
)
def test_points_that_are_none_are_one_line(tmp_path: Path, content: str) -> None:
    (tmp_path / "points.json").write_text(content)
    with pytest.raises(FileError) as caught:
        read_points(tmp_path / "points.json")
    assert "\n" not in str(caught.value)


@needs_tracker
def test_networks_that_are_none_are_one_line(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    import trimesh

    trimesh.creation.icosphere(3).export(tmp_path / "ball.ply")
    command = ["character", "make", str(tmp_path / "ball.ply"), "-o", str(tmp_path / "a.glb")]
    (tmp_path / "none.task").write_bytes(b"no zip")
    assert main([*command, "--landmarker", str(tmp_path / "none.task")]) == 2
    assert "download it again" in capfd.readouterr().err
    assert not (tmp_path / "a.glb").exists()


@needs_tracker
def test_a_face_is_found_however_its_file_is_turned(tmp_path: Path) -> None:
    rig, template = shipped_rig(), Template.of(shipped_rig())
    turned = rig.neutral.astype(np.float64)[:, [0, 2, 1]] * (40.0, -40.0, 40.0)  # Z up
    scan = Scan(turned, rig.faces, rig.colors)
    marks = find_landmarks(template, scan, tmp_path / "scan.ply", None)
    assert len(marks.positions) > 350
    ours = marks.on(template.vertices, template.faces)
    theirs = marks.positions[:, [0, 2, 1]] * (25.0, 25.0, -25.0)
    assert np.median(np.linalg.norm(ours - theirs, axis=1)) < 2.0


class Imagining(FaceLandmarker):
    """Sees a face in every picture: where the networks see none, points all over the middle."""

    def find(self, picture: Pixels) -> Doubles | None:
        found = super().find(picture)
        return np.random.default_rng(1).uniform(160, 350, (478, 2)) if found is None else found


@needs_tracker
def test_what_only_looks_like_a_face_is_passed_over() -> None:
    rig, template = shipped_rig(), Template.of(shipped_rig())
    turned = rig.neutral.astype(np.float64) * (-40.0, 40.0, -40.0)  # its back is tried first
    marks = scan_landmarks(template, Scan(turned, rig.faces, rig.colors), Imagining())
    assert marks is not None
    assert marks.misfit(template.vertices, template.faces) < 1.0


@needs_tracker
def test_a_head_without_a_face_has_no_landmarks(monkeypatch: pytest.MonkeyPatch) -> None:
    few = list(landmarks._axes())[:2]  # each is drawn; a ball looks the same from all sides
    monkeypatch.setattr(landmarks, "_axes", lambda: iter(few))
    template = Template.of(shipped_rig())
    ball = trimesh.creation.icosphere(3)
    scan = Scan(np.asarray(ball.vertices), np.asarray(ball.faces, np.int32), None)
    assert scan_landmarks(template, scan, Imagining()) is None

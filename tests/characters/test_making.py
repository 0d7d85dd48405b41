"""Blendshapes for a head that has none: a scan of a known head gets them back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from support.faces import shipped_rig

from faceedit_app.characters import registration
from faceedit_app.characters.closure import Openings
from faceedit_app.characters.fitted import open_character
from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.characters.leaving_out import without_parts
from faceedit_app.characters.making import Made, Template, make
from faceedit_app.characters.registration import Landmarks
from faceedit_app.characters.scans import Scan, read_scan
from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.errors import FileError


def other(vertices: Doubles) -> Doubles:
    """A smooth change of a head, mm: longer, with a broader jaw and a larger nose."""
    x, y, z = vertices.T
    return np.stack(
        (
            x * (1.06 - 0.0012 * np.clip(y, -60, 60)),
            1.08 * y,
            z + 4.0 * np.exp(-(x**2) / 300 - (y + 5) ** 2 / 500),
        ),
        axis=1,
    )


def scanner(points: Doubles) -> Doubles:
    """From millimetres to the scan's own unit and axes."""
    return points[:, [2, 0, 1]] * 0.004 + 7.0


@pytest.fixture(scope="module")
def template() -> Template:
    return Template.of(shipped_rig())


@pytest.fixture(scope="module")
def scan(template: Template) -> Scan:
    """The skin alone, in another unit and with finer triangles of its own."""
    mesh = trimesh.Trimesh(other(template.vertices), template.faces, process=False)
    vertices, faces = trimesh.remesh.subdivide(mesh.vertices, mesh.faces)
    colors = np.tile(np.array([0.2, 0.4, 0.1, 1.0], np.float32), (len(vertices), 1))
    return Scan(scanner(vertices), np.asarray(faces, np.int32), colors)


@pytest.fixture(scope="module")
def made(template: Template, scan: Scan) -> Made:
    points = {
        name: scanner(other(template.vertices[[vertex]]))[0]
        for name, vertex in template.points.items()
    }
    return make(template, scan, template.landmarks(points), "Scanned")


def test_the_skin_lies_on_the_scan(made: Made, scan: Scan) -> None:
    middle, most = made.distance_to(scan)
    assert middle < 0.3
    assert most < 1.5


def test_each_vertex_is_where_it_should_be(made: Made, template: Template) -> None:
    """Not only on the surface: lips on lips, lids on lids."""
    there = trimesh.transform_points(made.skin, made.to_scan)
    known = scanner(other(template.vertices))
    far = np.linalg.norm(there - known, axis=1)[made.face] / 0.004
    assert np.median(far) < 2.0
    points = list(template.points.values())
    assert (np.linalg.norm(there - known, axis=1)[points] / 0.004).max() < 2.5


def test_lips_and_lids_close(made: Made) -> None:
    weights = np.zeros((2, 52), np.float32)
    weights[0, [ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]]] = 1.0
    weights[1, [ARKIT_INDEX["eyeBlinkLeft"], ARKIT_INDEX["eyeBlinkRight"]]] = 1.0
    gaps = Openings.of(made.rig).measure(weights)
    assert gaps[0, 0] < 0.3
    assert gaps[1, 1:].max() < 0.3


def test_a_scan_with_open_lips_gets_a_closed_mouth(
    template: Template, monkeypatch: pytest.MonkeyPatch
) -> None:
    fewer = tuple((*step, -(-rounds // 3)) for *step, rounds in registration._STEPS)
    monkeypatch.setattr(registration, "_STEPS", fewer)  # the scan is like our head
    jaw = 0.3 * template.moves[template.rig.channel_index["jawOpen"]]

    def open_lips(rows: slice | list[int]) -> Doubles:
        return scanner(other((template.vertices + jaw)[rows]))

    scan = Scan(open_lips(slice(None)), np.asarray(template.faces, np.int32), None)
    points = {name: open_lips([vertex])[0] for name, vertex in template.points.items()}
    made = make(template, scan, template.landmarks(points), "Open")
    assert made.parted > 5
    assert made.distance_to(scan)[0] < 0.3  # the fit itself keeps them open
    weights = np.zeros((2, 52), np.float32)
    weights[1, [ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]]] = 1.0
    lips = made.rig.arkit_distances.measure(weights)[:, 0]
    assert lips[0] == pytest.approx(shipped_rig().arkit_distances.measure(weights)[0, 0], abs=0.8)
    assert lips[1] == pytest.approx(lips[0], abs=0.8)


def test_eyes_stay_round_and_in_the_head(made: Made) -> None:
    for side in (1, -1):
        radii = []
        for rig in (shipped_rig(), made.rig):
            faces = next(rig.faces[m.start : m.stop] for m in rig.materials if m.name == "sclera")
            known = shipped_rig().neutral[:, 0] * side > 0
            eye = rig.neutral[[v for v in np.unique(faces) if known[v]]].astype(float)
            centre = trimesh.nsphere.fit_nsphere(eye)[0]
            radii.append(np.linalg.norm(eye - centre, axis=1))
        shapes = [r / r.mean() for r in radii]
        np.testing.assert_allclose(shapes[1], shapes[0], atol=0.02)


def test_it_takes_the_colours_of_the_scan(made: Made, template: Template) -> None:
    skin = np.flatnonzero(template.vertex_of >= 0)
    face = skin[made.face[template.vertex_of[skin]]]
    np.testing.assert_allclose(
        np.median(made.rig.colors[face, :3], axis=0), [0.2, 0.4, 0.1], atol=0.01
    )


def test_it_is_a_character_that_opens(made: Made, tmp_path: Path) -> None:
    write_rig(tmp_path / "made.glb", made.rig)
    fitted = open_character(tmp_path / "made.glb")
    assert len(fitted.checklist.matched) == 52
    assert fitted.checklist.doubts == ()
    assert fitted.rig.missing_controls == ()


def test_landmarks_that_fell_into_a_hole_are_left_out(template: Template) -> None:
    random = np.random.default_rng(1)
    triangles = random.choice(len(template.faces), 200, replace=False).astype(np.intp)
    weights = np.full((200, 3), 1 / 3)
    marks = Landmarks(triangles, weights, np.zeros((200, 3)))
    places = other(marks.on(template.vertices, template.faces))
    places[:20, 2] -= 60.0
    kept = replace(marks, positions=places).plausible(template.vertices, template.faces)
    assert len(kept.positions) > 130
    assert not np.isin(triangles[:20], kept.triangles).any()


# --- files ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["ply", "stl", "obj", "glb"])
def test_scans_of_every_kind_are_read(tmp_path: Path, kind: str) -> None:
    sphere = trimesh.creation.icosphere(3)
    path = tmp_path / f"scan.{kind}"
    sphere.export(path)
    scan = read_scan(path)
    assert len(scan.faces) == len(sphere.faces)
    np.testing.assert_allclose(np.ptp(scan.vertices, axis=0), 2, atol=0.02)


def test_colours_of_a_scan_are_read_as_light(tmp_path: Path) -> None:
    sphere = trimesh.creation.icosphere(3)
    sphere.visual.vertex_colors = np.tile([188, 0, 255, 255], (len(sphere.vertices), 1))
    sphere.export(tmp_path / "scan.ply")
    colors = read_scan(tmp_path / "scan.ply").colors
    assert colors is not None
    np.testing.assert_allclose(colors[0], [0.503, 0, 1, 1], atol=0.01)


def test_a_scan_of_many_triangles_is_made_smaller(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from faceedit_app.characters import scans

    monkeypatch.setattr(scans, "_ENOUGH", 1000)
    trimesh.creation.icosphere(4).export(tmp_path / "scan.ply")
    scan = read_scan(tmp_path / "scan.ply")
    assert len(scan.faces) < 1100
    assert "decimated" in scan.remarks[0]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 99999999\nend_header\n"),
        ("a.ply", b""),
        ("a.stl", b"solid"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("a.txt", b"hello"),
    ],
)
def test_what_is_no_scan_is_one_line(tmp_path: Path, name: str, content: bytes) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(FileError) as caught:
        read_scan(tmp_path / name)
    assert "\n" not in str(caught.value)


def test_hair_and_brows_can_be_left_out_of_a_head_that_has_its_own() -> None:
    rig = shipped_rig()
    bald = without_parts(rig, ("hair", "brows"))
    assert [m.name for m in rig.materials if m.name not in ("hair", "brows")] == [
        m.name for m in bald.materials
    ]
    assert len(bald.neutral) < len(rig.neutral)
    for old, new in zip(rig.control_pairs.ravel(), bald.control_pairs.ravel(), strict=True):
        assert (bald.neutral[new] == rig.neutral[old]).all()
        assert (bald.deltas[:, new] == rig.deltas[:, old]).all()
    before, after = (
        {m.name: r.neutral[r.faces[m.start : m.stop]] for m in r.materials} for r in (rig, bald)
    )
    for name, places in after.items():
        np.testing.assert_array_equal(places, before[name])

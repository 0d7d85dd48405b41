"""The colours of scans: read from every kind of file, and carried to the head that is made."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from support.faces import shipped_rig

from faceedit_app.characters import making
from faceedit_app.characters import paint as paint_of_scans
from faceedit_app.characters.fitted import open_character
from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.characters.making import Made, Template, make
from faceedit_app.characters.paint import Atlas, Paint
from faceedit_app.characters.registration import FittedTemplate
from faceedit_app.characters.scans import Scan, read_scan
from faceedit_app.core.arrays import Doubles, Floats

UPPER, LOWER = (255, 0, 0), (0, 0, 255)  # of the picture


def _ball() -> tuple[Doubles, np.ndarray, Floats]:
    """Vertices, triangles, and uv with v upwards."""
    ball = trimesh.creation.icosphere(3)
    return ball.vertices, ball.faces, (0.1 + 0.4 * (ball.vertices[:, :2] + 1)).astype(np.float32)


def _write_picture(path: Path) -> None:
    pixels = np.zeros((64, 64, 3), np.uint8)
    pixels[:32], pixels[32:] = UPPER, LOWER
    Image.fromarray(pixels).save(path)


def _write_ply(path: Path, names: str, picture: str) -> None:
    vertices, faces, uv = _ball()
    first, second = names.split()
    header = [
        *("ply", "format ascii 1.0", f"comment TextureFile {picture}"),
        *(f"element vertex {len(vertices)}", "property float x", "property float y"),
        *("property float z", f"property float {first}", f"property float {second}"),
        *(f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"),
    ]
    rows = [" ".join(map(str, row)) for row in np.column_stack((vertices, uv))]
    path.write_text("\n".join([*header, *rows, *(f"3 {a} {b} {c}" for a, b, c in faces), ""]))


def _write_obj(path: Path, materials: str = "scan.mtl") -> None:
    vertices, faces, uv = _ball()
    lines = [f"mtllib {materials}", *(f"v {x} {y} {z}" for x, y, z in vertices)]
    lines += [*(f"vt {u} {v}" for u, v in uv), "usemtl Skin"]
    lines += [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in faces + 1]
    path.write_text("\n".join(lines))


def _top_is_red(scan: Scan) -> bool:
    assert scan.colors is not None
    high = scan.vertices[:, 1] > 0.3
    red, blue = scan.colors[high].mean(axis=0), scan.colors[~high].mean(axis=0)
    return bool(red[0] > 0.95 > 0.3 > red[2] and blue[2] > 0.5)


@pytest.mark.parametrize("names", ["s t", "u v", "texture_u texture_v"])
def test_a_ply_with_a_texture_is_read_in_its_colours(tmp_path: Path, names: str) -> None:
    _write_picture(tmp_path / "skin.png")
    _write_ply(tmp_path / "scan.ply", names, "C:\\scans\\skin.png")
    scan = read_scan(tmp_path / "scan.ply")
    assert scan.remarks == ()
    assert scan.paint is not None
    assert _top_is_red(scan)


def test_a_missing_picture_is_said(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    _write_ply(tmp_path / "scan.ply", "s t", "skin.png")
    scan = read_scan(tmp_path / "scan.ply")
    assert scan.remarks == ("the texture skin.png is missing",)
    assert scan.colors is scan.paint is None
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    "line",
    [
        "map_Kd skin.jpg",
        "map_Kd -s 1 1 1 -o 0 0 skin.jpg",
        "map_Kd -clamp on SKIN.JPG",
        "\tmap_Kd C:\\Users\\me\\scan\\skin.jpg",
        'map_Kd "skin.jpg"',
        "map_kd textures/skin.jpg",
    ],
)
def test_an_obj_finds_its_picture_as_its_materials_spell_it(tmp_path: Path, line: str) -> None:
    _write_picture(tmp_path / "skin.jpg")
    _write_obj(tmp_path / "scan.obj")
    (tmp_path / "scan.mtl").write_text(f"newmtl Skin\nKd 0.1 0.1 0.1\n{line}\nKd 0.2 0.2 0.2\n")
    scan = read_scan(tmp_path / "scan.obj")
    assert scan.remarks == ()
    assert _top_is_red(scan)


def test_an_obj_without_its_materials_says_so(tmp_path: Path) -> None:
    _write_obj(tmp_path / "scan.obj")
    scan = read_scan(tmp_path / "scan.obj")
    assert scan.colors is None
    assert "scan.mtl" in scan.remarks[0]


def test_an_obj_may_have_a_colour_for_each_vertex(tmp_path: Path) -> None:
    vertices, faces, _ = _ball()
    rows = [f"v {x} {y} {z} 0.5 0 {int(y > 0)}" for x, y, z in vertices]
    rows += [f"f {a} {b} {c}" for a, b, c in faces + 1]
    (tmp_path / "scan.obj").write_text("\r\n".join(rows))
    colors = read_scan(tmp_path / "scan.obj").colors
    assert colors is not None
    upper = colors[vertices[:, 1] > 0]
    np.testing.assert_allclose(upper, np.tile([0.214, 0, 1, 1], (len(upper), 1)), atol=0.001)


def test_a_scan_does_not_read_other_scans_beside_it(tmp_path: Path) -> None:
    _write_obj(tmp_path / "scan.obj")
    (tmp_path / "broken.obj").write_text("v here\n")
    read_scan(tmp_path / "scan.obj")


def test_the_colours_of_many_vertices_are_kept_when_triangles_are_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from faceedit_app.characters import scans

    monkeypatch.setattr(scans, "_ENOUGH", 1000)
    monkeypatch.setattr(scans, "_FINE", 2000)
    ball = trimesh.creation.icosphere(4)
    ball.visual.vertex_colors = np.where(ball.vertices[:, :1] > 0, 255, 0) * np.ones((1, 4))
    ball.export(tmp_path / "scan.ply")
    scan = read_scan(tmp_path / "scan.ply")
    assert len(scan.faces) < 1100
    assert scan.paint is not None
    assert len(scan.paint.faces) == len(ball.faces)


# --- on the head ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def template() -> Template:
    return Template.of(shipped_rig())


def _stripes(places: Doubles) -> Doubles:
    """(N,) 0 or 1: the picture of the scan has stripes of 4 mm across the face."""
    return np.floor(places[:, 1] / 4.0) % 2


@pytest.fixture(scope="module")
def atlas(template: Template) -> Atlas:
    return Atlas.of(template.vertices, template.faces)


@pytest.fixture(scope="module")
def made(template: Template, atlas: Atlas) -> Made:
    """Of a scan that is our own head, with stripes finer than its vertices."""
    v = template.vertices
    low, size = v.min(axis=0), np.ptp(v, axis=0)
    uv = np.stack(((v[:, 0] - low[0]) / size[0], 1 - (v[:, 1] - low[1]) / size[1]), axis=1)
    heights = low[1] + size[1] * (1 - (np.arange(2048) + 0.5) / 2048)
    rows = _stripes(np.stack((heights, heights), axis=1))
    picture = np.full((2048, 4, 4), 255, np.uint8)
    picture[..., :3] = (255 * rows)[:, None, None]
    faces = np.asarray(template.faces, np.int32)
    white = np.ones((len(v), 4), np.float32)
    numbers = np.zeros(len(faces), np.intp)
    paint = Paint(v, faces, white, uv.astype(np.float32), numbers, (picture,))
    scan = Scan(v, faces, paint.of_vertices, (), paint)
    points = {name: v[vertex] for name, vertex in template.points.items()}
    with pytest.MonkeyPatch.context() as patch:  # it fits, and to find that out takes seconds
        patch.setattr(making, "register", lambda *_: FittedTemplate(v, np.eye(4)))
        patch.setattr(Atlas, "of", lambda *_: atlas)
        patch.setattr(paint_of_scans, "SIZE", 512)
        return make(template, scan, template.landmarks(points), "Striped")


def test_the_picture_shows_what_the_vertices_cannot(made: Made, template: Template) -> None:
    rig = made.rig
    assert rig.uv is not None
    (picture,) = rig.textures
    skin = next(m for m in rig.materials if m.name == "skin")
    corners = rig.faces[skin.start : skin.stop]
    face = (rig.neutral[corners][..., 2] > 0.02).all(axis=1)
    weights = np.array([0.5, 0.3, 0.2])
    places = 1000.0 * np.einsum("k,fkx->fx", weights, rig.neutral[corners[face]])
    uv = np.einsum("k,fkx->fx", weights, rig.uv[corners[face]])
    column, row = (uv * picture.shape[0]).astype(int).T
    seen = picture[row, column, 0] / 255.0
    inside = np.abs(places[:, 1] / 4.0 % 1 - 0.5) < 0.3  # not at the edge of a stripe
    assert np.abs(seen - _stripes(places))[inside].mean() < 0.04


def test_cuts_in_the_picture_change_no_shape(made: Made, template: Template) -> None:
    rig, plain = made.rig, template.rig
    assert rig.channels == plain.channels
    assert len(rig.faces) == len(plain.faces)
    np.testing.assert_array_equal(rig.control_pairs, plain.control_pairs)
    assert rig.shading_groups is not None
    first = rig.shading_groups
    np.testing.assert_array_equal(rig.neutral, rig.neutral[first])
    np.testing.assert_array_equal(rig.deltas, rig.deltas[:, first])
    np.testing.assert_array_equal(first[rig.faces], plain.faces)


def test_it_is_saved_with_its_picture(made: Made, tmp_path: Path) -> None:
    write_rig(tmp_path / "made.glb", made.rig)
    opened = open_character(tmp_path / "made.glb")
    assert opened.checklist.doubts == opened.checklist.remarks == ()
    np.testing.assert_array_equal(opened.rig.textures[0], made.rig.textures[0])
    skin = [m for m in opened.rig.materials if m.texture is not None]
    assert [m.name for m in skin] == ["skin", "lips"]


def test_no_two_triangles_share_a_pixel(atlas: Atlas) -> None:
    pixels, _, weights = atlas.texels(512)
    inside = pixels[(weights > 1e-3).all(axis=1)]
    assert len(np.unique(inside)) > 0.97 * len(inside)
    assert len(np.unique(pixels)) > 0.4 * 512**2

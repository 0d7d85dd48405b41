"""The control points of brows and jaw, on characters of every kind that have shapes for them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.character_files import FLOAT, UNSIGNED, small_glb, write_glb
from support.heads import BROW, EYE, small_head

from faceedit_app.characters.fitted import FittedCharacter, open_character
from faceedit_app.core.controls import CONTROL_INDEX


def _shown(fitted: FittedCharacter, control: str, **frame: float) -> float:
    """A control, mm, with some weights."""
    weights = np.array([[frame.get(c, 0.0) for c in fitted.rig.channels]], np.float32)
    return float(fitted.rig.controls(weights)[0, CONTROL_INDEX[control]])


def test_a_brow_rises_and_frowns_on_its_own_side(tmp_path: Path) -> None:
    fitted = open_character(write_glb(tmp_path / "head.glb"))
    rest = _shown(fitted, "left_brow")
    assert _shown(fitted, "left_brow", browOuterUpLeft=1.0) > rest + 1.5
    assert _shown(fitted, "left_brow", browInnerUp=1.0) > rest + 1.5
    assert _shown(fitted, "left_brow", browDownLeft=1.0) < rest - 3.0
    for channel in ("browDownRight", "browOuterUpRight", "eyeBlinkLeft", "jawOpen"):
        assert _shown(fitted, "left_brow", **{channel: 1.0}) == pytest.approx(rest, abs=0.3)


def test_the_jaw_goes_to_its_own_left_and_right(tmp_path: Path) -> None:
    fitted = open_character(write_glb(tmp_path / "head.glb"))
    rest = _shown(fitted, "jaw_side")
    assert _shown(fitted, "jaw_side", jawLeft=1.0) > rest + 3.0
    assert _shown(fitted, "jaw_side", jawRight=1.0) < rest - 3.0
    assert _shown(fitted, "jaw_side", jawOpen=1.0) == pytest.approx(rest, abs=0.1)


def test_brows_may_be_a_mesh_of_their_own(tmp_path: Path) -> None:
    """Drawn brows, in front of a forehead that does not move."""
    out = small_glb(lambda name: None if name.startswith("brow") else name)
    x = np.concatenate((np.linspace(-44, -18, 9), np.linspace(18, 44, 9)))
    lower = np.stack((x, np.full(18, BROW), np.full(18, 2.0)), axis=1)
    places = np.concatenate((lower, lower + np.array([0, 4, 0]))) / 1000
    triangles = [[i, i + 1, i + 19, i, i + 19, i + 18] for i in range(17) if i != 8]
    up = np.tile([0.0, 0.004, 0.0], (36, 1))
    moves = {"browInnerUp": up}
    for side, mine in (("Left", places[:, 0] > 0), ("Right", places[:, 0] < 0)):
        moves |= {f"browOuterUp{side}": up * mine[:, None], f"browDown{side}": -up * mine[:, None]}
    primitive = {
        "attributes": {"POSITION": out.accessor(places, FLOAT)},
        "indices": out.accessor(np.array(triangles).ravel(), UNSIGNED),
        "targets": [{"POSITION": out.accessor(moved, FLOAT)} for moved in moves.values()],
    }
    out.mesh([primitive], list(moves), name="Brows")
    (tmp_path / "head.glb").write_bytes(out.content())
    fitted = open_character(tmp_path / "head.glb")
    for side, sign in (("left", 1.0), ("right", -1.0)):
        assert fitted.places[f"{side}_brow"].part == "Brows"
        assert fitted.places[f"{side}_eye_corner"].part == "Head"
        brow = 1000 * fitted.rig.neutral[fitted.points[f"{side}_brow"]]
        assert brow[0] == pytest.approx(sign * EYE, abs=5)
        assert _shown(fitted, f"{side}_brow", browInnerUp=1.0) > _shown(fitted, f"{side}_brow") + 3


def test_one_shape_that_moves_the_brows_is_enough(tmp_path: Path) -> None:
    def only_frowns(name: str) -> str | None:
        return None if name.startswith("brow") and "Down" not in name else name

    fitted = open_character(write_glb(tmp_path / "head.glb", only_frowns))
    brow = 1000 * fitted.rig.neutral[fitted.points["right_brow"]]
    eye = small_head().points["right_upper_lid"]
    assert brow[0] == pytest.approx(eye[0], abs=4)
    assert _shown(fitted, "right_brow", browDownRight=1.0) < _shown(fitted, "right_brow") - 3


@pytest.mark.parametrize(
    ("without", "missing"),
    [(("brow",), ("left_brow", "right_brow")), (("jawLeft", "jawRight"), ("jaw_side",))],
)
def test_curves_that_no_shape_moves_are_left_out(
    tmp_path: Path, without: tuple[str, ...], missing: tuple[str, ...]
) -> None:
    path = write_glb(tmp_path / "head.glb", lambda name: None if name.startswith(without) else name)
    fitted = open_character(path)
    assert fitted.rig.missing_controls == missing
    assert fitted.checklist.doubts == ()

"""What a user says of a character: in a file beside it, in words a person can write."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from support.character_files import write_glb
from support.heads import small_head

from faceedit_app.characters.character import PartVertex
from faceedit_app.characters.fitted import open_character
from faceedit_app.characters.map_file import CharacterMap, map_path, read_map, write_map
from faceedit_app.characters.matches import Half, Share
from faceedit_app.core.errors import FileError


def said(character: Path, **content: Any) -> Path:
    path = map_path(character)
    path.write_text(json.dumps({"faceedit_character_map": 1, **content}), encoding="utf-8")
    return path


def test_a_map_comes_back_as_it_was(tmp_path: Path) -> None:
    mapping = CharacterMap(
        {
            "jawOpen": (Share("Mund auf", 0.8),),
            "eyeBlinkLeft": (Share("zu", half=Half.LEFT), Share("Lid")),
            "cheekPuff": (),
        },
        {"chin": PartVertex("Kopf", 12)},
        {"jawOpen": (1.2, 0.05, 0.9)},
    )
    write_map(tmp_path / "a.map.json", mapping)
    assert read_map(tmp_path / "a.map.json") == mapping


def test_names_in_another_language_are_mapped_by_hand(tmp_path: Path) -> None:
    ours = {
        "jawOpen": "Kiefer",
        "eyeBlinkLeft": "LidL",
        "eyeBlinkRight": "LidR",
        "mouthFunnel": "O",
    }
    path = write_glb(tmp_path / "kopf.glb", ours.get)
    with pytest.raises(FileError, match=r"Lid.*kopf\.glb\.map\.json"):
        open_character(path)
    said(path, channels=ours)
    fitted = open_character(path)
    assert fitted.checklist.matched == {channel: (name,) for channel, name in ours.items()}
    assert "left_upper_lid" in fitted.points


def test_a_channel_can_be_taken_away_or_made_weaker(tmp_path: Path) -> None:
    path = write_glb(tmp_path / "a.glb")
    before = open_character(path).rig
    said(path, channels={"cheekPuff": [], "jawOpen": {"shape": "jawOpen", "weight": 0.5}})
    fitted = open_character(path)
    assert fitted.checklist.missing == ("cheekPuff",)
    assert "cheekPuff" in fitted.checklist.unknown
    jaw = [rig.deltas[rig.channels.index("jawOpen")].min() for rig in (before, fitted.rig)]
    assert jaw[1] == pytest.approx(jaw[0] / 2, rel=1e-3)


def test_a_point_can_be_put_elsewhere(tmp_path: Path) -> None:
    path = write_glb(tmp_path / "a.glb")
    vertex = int(abs(small_head().vertices - (0, -90, 0)).sum(axis=1).argmin())
    found = open_character(path)
    said(path, points={"chin": {"part": found.places["chin"].part, "vertex": vertex}})
    moved = open_character(path)
    assert moved.places["chin"].vertex == vertex != found.places["chin"].vertex
    assert moved.rig.control_pairs[5, 0] == moved.points["chin"]


def test_the_whole_map_says_what_is_used_already(tmp_path: Path) -> None:
    path = write_glb(tmp_path / "a.glb")
    found = open_character(path)
    write_map(map_path(path), found.whole_map)
    again = open_character(path)
    assert again.points == found.points
    assert again.checklist == found.checklist


@pytest.mark.parametrize(
    "content",
    [
        "",
        "[]",
        "nonsense",
        '{"channels": {}}',
        '{"faceedit_character_map": 2}',
        '{"faceedit_character_map": 1, "channels": {"jawOpne": "a"}}',
        '{"faceedit_character_map": 1, "channels": {"jawOpen": [{"weight": 1}]}}',
        '{"faceedit_character_map": 1, "channels": {"jawOpen": [{"shape": "a", "weight": NaN}]}}',
        '{"faceedit_character_map": 1, "channels": {"jawOpen": [{"shape": "a", "half": "top"}]}}',
        '{"faceedit_character_map": 1, "channels": 3}',
        '{"faceedit_character_map": 1, "points": {"nose": {"part": "a", "vertex": 1}}}',
        '{"faceedit_character_map": 1, "points": {"chin": {"part": "a", "vertex": "x"}}}',
        '{"faceedit_character_map": 1, "points": {"chin": {"part": "Head", "vertex": 99999}}}',
        '{"faceedit_character_map": 1, "points": {"chin": {"part": "Nobody", "vertex": 1}}}',
        "[" * 100_000,
        '{"faceedit_character_map": 1, "channels": {"jawOpen": {"shape": "a", "weight": 1'
        + "0" * 400
        + "}}}",
    ],
)
def test_a_map_that_is_wrong_is_one_line(tmp_path: Path, content: str) -> None:
    path = write_glb(tmp_path / "a.glb")
    map_path(path).write_text(content, encoding="utf-8")
    with pytest.raises(FileError) as caught:
        open_character(path)
    assert str(caught.value).startswith(str(map_path(path)))
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500


def test_a_strength_may_name_only_what_differs(tmp_path: Path) -> None:
    path = write_glb(tmp_path / "a.glb")
    said(path, strength={"jawOpen": {"multiplier": 0.5}, "eyeBlinkLeft": {}})
    assert open_character(path).rig.levels.by_channel == {"jawOpen": (0.5, 0.0, 1.0)}


@pytest.mark.parametrize(
    ("strength", "says"),
    [
        ({"jawOpen": {"multiplier": 11}}, "strength of jawOpen .* multiplier of 0 to 10"),
        ({"jawOpen": {"limit": 0}}, "strength of jawOpen"),
        ({"jawOpen": {"offset": float("nan")}}, "strength of jawOpen"),
        ({"jawOpn": {}}, "jawOpn, which ARKit lacks"),
        ({"jawOpen": 2}, "is not a character map"),
        (["jawOpen"], "is not a character map"),
    ],
)
def test_a_strength_that_is_wrong_is_named(tmp_path: Path, strength: Any, says: str) -> None:
    path = write_glb(tmp_path / "a.glb")
    said(path, strength=strength)
    with pytest.raises(FileError, match=says):
        open_character(path)


def test_a_shape_that_the_file_lacks_is_named(tmp_path: Path) -> None:
    path = write_glb(tmp_path / "a.glb")
    said(path, channels={"cheekPuff": "Backen"})
    doubts = open_character(path).checklist.doubts
    assert "the map makes cheekPuff of Backen, which the file does not have" in doubts

"""What is exported for other programs, opened by readers that are not ours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.blender import run_in_blender
from support.character_files import VISEMES, picture_of, write_glb, write_vrm
from support.exports import CLIP, ENDINGS, export, quiet_take, take_of
from support.faces import shipped_rig
from support.fbx_files import write_fbx
from support.gltf import NO_VALIDATOR, accessor_errors, has_validator, parts, validator_errors
from support.places import ROOT, SHARED
from support.takes import make_livelink_csv

from faceedit_app.characters.fitted import open_character
from faceedit_app.characters.registry import read_character
from faceedit_app.cli import main
from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.exporting import (
    Options,
    choose,
    export_session,
    export_take,
    out_formats,
)
from faceedit_app.editing.opening import open_session
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take


def test_every_out_format_has_its_own_key_and_says_what_to_do_with_it() -> None:
    formats = out_formats()
    assert len({form.key for form in formats}) == len(formats)
    for form in formats:
        hints = form.hints(59.94)
        assert hints
        assert not any("{" in hint for hint in hints)
    assert any("29.97 fps" in hint for hint in choose(Path("x.glb")).hints(30000 / 1001))


@pytest.mark.parametrize("compact", [False, True])
def test_a_glb_plays_the_take(compact: bool, tmp_path: Path) -> None:
    path = tmp_path / "talk.glb"
    export(path, compact=compact)
    assert accessor_errors(path.read_bytes()) == []
    back = open_take(path).clip
    np.testing.assert_allclose(
        back.arkit_weights(), CLIP.weights, atol=0.5 / 65535 + 1e-7 if compact else 0
    )
    assert back.rate == 30
    document, _ = parts(path.read_bytes())
    assert [animation["name"] for animation in document["animations"]] == ["talk"]


def test_zeros_are_left_out_of_a_compact_glb(tmp_path: Path) -> None:
    take = quiet_take()
    sizes = []
    for compact in (False, True):
        path = tmp_path / f"{compact}.glb"
        export(path, take, compact=compact)
        sizes.append(path.stat().st_size)
        np.testing.assert_allclose(
            open_take(path).clip.arkit_weights(), take.clip.weights, atol=1e-5
        )
    document, _ = parts(path.read_bytes())
    output = document["accessors"][document["animations"][0]["samplers"][0]["output"]]
    assert "sparse" in output
    assert sizes[0] - sizes[1] > 40 * 52 * 4 * 0.7


def test_an_edit_of_a_compact_glb_is_exported(tmp_path: Path) -> None:
    path = tmp_path / "talk.glb"
    export(path, quiet_take(), compact=True)
    session = open_session(path, shipped_rig())
    session.add(Edit(("left_eyelid", "right_eyelid"), Op.OFFSET, 0.5, 0.8, 0.1, -3.0))
    assert session.changed_frames()
    session.export(tmp_path / "edited.glb")
    again = open_take(tmp_path / "edited.glb").clip.arkit_weights()
    np.testing.assert_allclose(again, session.weights, atol=1e-6)


def test_weights_beyond_1_stay_floats_in_a_compact_glb(tmp_path: Path) -> None:
    clip = replace(CLIP, weights=CLIP.weights * np.float32(2))
    path = tmp_path / "talk.glb"
    export(path, replace(take_of(), clip=clip), compact=True)
    np.testing.assert_array_equal(open_take(path).clip.arkit_weights(), clip.weights)


@pytest.mark.parametrize("compact", [False, True])
@pytest.mark.parametrize("take", [take_of, quiet_take])
def test_khronos_validator_finds_no_error(
    take: Callable[[], Take], compact: bool, tmp_path: Path
) -> None:
    if not has_validator():
        pytest.skip(NO_VALIDATOR)
    export(tmp_path / "talk.glb", take(), compact=compact)
    assert validator_errors(tmp_path / "talk.glb") == []


def test_a_character_of_another_maker_only_gets_the_animation(tmp_path: Path) -> None:
    head = write_glb(tmp_path / "head.glb", lambda name: f"Face_{name}")
    path = tmp_path / "talk.glb"
    export(path, character=head)
    before, after = parts(head.read_bytes()), parts(path.read_bytes())
    added = after[0].pop("animations")
    assert len(added) == 1
    assert after[1].startswith(before[1].rstrip(b"\0"))
    for key, value in before[0].items():
        if key != "buffers":
            size = len(value) if isinstance(value, list) else None
            assert after[0][key] == value if size is None else after[0][key][:size] == value
    known = read_character(head).targets
    back = open_take(path).clip
    columns = [ARKIT_INDEX[channel] for channel in back.channels]
    assert len(back.channels) == len([n for n in known if n.removeprefix("Face_") in ARKIT_INDEX])
    np.testing.assert_array_equal(back.weights, CLIP.weights[:, columns])
    if has_validator():  # the test's head lacks bounds: nothing is added to its own errors
        assert validator_errors(path) == validator_errors(head)


def test_a_vrm_is_written_as_it_is_shown(tmp_path: Path) -> None:
    """Its visemes stand for channels, and so they are called: a take of `a` would be lost."""
    one_eyed = {f"blink_{side[0]}": {f"eyeBlink{side}": 1.0} for side in ("Left", "Right")}
    visemes = {name: made for name, made in VISEMES.items() if name != "blink"}
    vrm = write_vrm(tmp_path / "head.vrm", presets=visemes | one_eyed)
    export(tmp_path / "talk.glb", character=vrm)
    rig = open_character(vrm).rig
    assert {"jawOpen", "eyeBlinkLeft", "eyeBlinkRight"} < set(rig.channels)
    back = open_take(tmp_path / "talk.glb").clip
    assert set(back.channels) == set(rig.channels)
    columns = [ARKIT_INDEX[channel] for channel in back.channels]
    np.testing.assert_array_equal(back.weights, CLIP.weights[:, columns])


def test_textures_go_into_a_glb(tmp_path: Path) -> None:
    """A character whose file is no GLB is written as FaceEdit shows it."""
    fbx = write_fbx(tmp_path / "head.fbx", texture=picture_of((200, 30, 30)))
    export(tmp_path / "talk.glb", character=fbx)
    document, _ = parts((tmp_path / "talk.glb").read_bytes())
    assert document["textures"] == [{"source": 0}]
    assert read_character(tmp_path / "talk.glb").parts[0].surface.texture is not None
    if has_validator():
        assert validator_errors(tmp_path / "talk.glb") == []


@pytest.mark.parametrize("ending", [".fbx", ".usda"])
def test_a_character_of_another_maker_keeps_its_names(ending: str, tmp_path: Path) -> None:
    head = write_glb(tmp_path / "head.glb", lambda name: f"Face_{name}")
    path = tmp_path / f"talk{ending}"
    export(path, character=head)
    assert b"Face_jawOpen" in path.read_bytes()


def test_a_take_shorter_than_the_animation_of_the_character_opens_again(tmp_path: Path) -> None:
    head, path = tmp_path / "head.glb", tmp_path / "talk.glb"
    export(head)
    clip = replace(CLIP, times=CLIP.times[:5], weights=CLIP.weights[:5])
    export(path, replace(take_of(), clip=clip), character=head)
    back = open_take(path)
    np.testing.assert_array_equal(back.clip.weights, clip.weights)
    assert "one of 2 animations is read" in back.notes


@pytest.mark.skipif(not (SHARED / "heads" / "facecap.glb").exists(), reason="shared is absent")
def test_a_real_character_is_animated(tmp_path: Path) -> None:
    path = tmp_path / "talk.glb"
    head = SHARED / "heads" / "facecap.glb"
    export(path, character=head, compact=True)
    # Its compressed views lie in a buffer that is not in the file.
    assert set(accessor_errors(path.read_bytes())) <= set(accessor_errors(head.read_bytes()))
    back = open_take(path).clip
    np.testing.assert_allclose(back.arkit_weights(), CLIP.weights, atol=1e-5)


# --- sessions, rates, and what is refused -------------------------------------------------------


def test_what_is_on_screen_is_what_a_character_plays(tmp_path: Path) -> None:
    session = open_session(make_livelink_csv(tmp_path / "take.csv"), shipped_rig())
    session.add(Edit(("mouth_opening",), Op.OFFSET, 0.5, 1.0, 0.1, 6.0))
    written = export_session(session, tmp_path / "talk.glb", choose(Path("talk.glb")))
    assert np.any(session.weights != session.take.clip.arkit_weights())
    again = open_take(tmp_path / "talk.glb").clip
    np.testing.assert_array_equal(again.arkit_weights(), session.weights)
    np.testing.assert_allclose(again.times, session.take.clip.times, atol=1e-6)
    assert "LeftEyeYaw" in written.remarks[0]
    assert written.said("this")[1] == "the head is straight; this turns it as recorded"
    assert written.said()[1] == "the head is straight"


@pytest.mark.parametrize("ending", ENDINGS)
def test_another_rate_is_written(ending: str, tmp_path: Path) -> None:
    written = export(tmp_path / f"talk{ending}", rate=60.0)
    assert written.clip.rate == 60
    assert len(written.clip) == 80
    if ending == ".glb":
        assert open_take(written.path).clip.rate == 60


def test_the_recording_is_not_replaced_by_a_conversion(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    take = make_livelink_csv(tmp_path / "take.csv")
    before = take.read_bytes()
    assert main(["convert", str(take), str(take), "--fps", "30"]) == 2
    assert "is the recording itself" in capfd.readouterr().err
    assert take.read_bytes() == before
    assert main(["convert", str(take), str(take), "--fps", "30", "--overwrite"]) == 0
    assert (tmp_path / "take.csv.bak").read_bytes() == before


def test_a_layout_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    export(tmp_path / "talk.glb")
    take = open_take(tmp_path / "talk.glb")
    own = choose(Path("x.glb"), take=take)
    assert not own.has_character
    with pytest.raises(FaceEditError, match="can only be written as it was recorded"):
        export_take(take, take.clip, tmp_path / "b.glb", own, Options(rate=24.0))
    assert choose(Path("x.glb")).has_character
    assert not (tmp_path / "b.glb").exists()


@pytest.mark.parametrize(("name", "key"), [("x.csv", "glb"), ("x.glb", "csv"), ("x.FBX", "usd")])
def test_a_file_that_ends_like_one_of_another_format_is_refused(name: str, key: str) -> None:
    with pytest.raises(FileError, match="does not end like a file of the format"):
        choose(Path(name), key)


@pytest.mark.parametrize(("name", "key"), [("x.csv", "livelink"), ("x.csv", "csv"), ("x", "glb")])
def test_a_format_takes_its_own_ending_and_none(name: str, key: str) -> None:
    assert choose(Path(name), key).key == key


def test_a_character_that_is_none_is_refused(tmp_path: Path) -> None:
    for number, content in enumerate([b"", b"glTF\2\0\0\0", b"no character"]):
        path = tmp_path / f"{number}.glb"
        path.write_bytes(content)
        with pytest.raises(FileError, match=path.name):
            export(tmp_path / "talk.glb", character=path)
    assert not (tmp_path / "talk.glb").exists()


def test_the_command_says_how_to_go_on(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    take = make_livelink_csv(tmp_path / "take.csv")
    for ending in ENDINGS:
        out = tmp_path / f"talk{ending}"
        assert main(["convert", str(take), str(out), "--fps", "25"]) == 0
        said = capfd.readouterr().out
        assert "with character, 50 frames at 25 fps" in said
        assert "Blender:" in said


def test_the_script_of_the_guide_puts_a_take_on_a_head_in_blender(tmp_path: Path) -> None:
    export(tmp_path / "head.glb")
    export_take(take_of(), CLIP, tmp_path / "take.csv", choose(Path("x"), "csv"))
    guide = (ROOT / "docs" / "formats.md").read_text(encoding="utf-8")
    script = guide.partition("<!-- script: blender -->\n```python\n")[2].partition("```")[0]
    assert "keyframe_insert" in script
    facts = run_in_blender(
        f"""
import bpy, json, sys
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=sys.argv[-1])
bpy.context.scene.render.fps = 30
head = next(o for o in bpy.data.objects if o.type == "MESH")
head.data.shape_keys.animation_data_clear()
bpy.context.view_layer.objects.active = head
{script.replace('"take.csv"', repr(str(tmp_path / "take.csv")))}
bpy.context.scene.frame_set(bpy.context.scene.frame_start + 17)
print("FACTS " + json.dumps({{key.name: key.value for key in blocks[1:]}}))
""",
        tmp_path,
        tmp_path / "head.glb",
    )
    found = np.array([facts[name] for name in ARKIT_CHANNELS])
    np.testing.assert_allclose(found, CLIP.weights[17], atol=2e-6)

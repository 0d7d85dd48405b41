"""The command line: what it prints and writes, and one line for everything that is wrong."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.faces import shipped_rig
from support.networks import write_models
from support.renderers import need_opengl
from support.takes import make_livelink_csv

from faceedit_app.cli import main
from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.edit import from_json as edit_from_json
from faceedit_app.editing.help.retime import moved, stretched
from faceedit_app.editing.opening import load_engine, open_session
from faceedit_app.formats.opening import open_take
from faceedit_app.render import snapshot
from faceedit_app.ui.start import display

EDIT: dict[str, Any] = {
    "control": "mouth_opening",
    "op": "offset",
    "start": 0.8,
    "end": 1.2,
    "falloff": 0.2,
    "value": 6.0,
}


def edits_file(folder: Path, *entries: dict[str, Any]) -> Path:
    path = folder / "edits.json"
    path.write_text(json.dumps({"version": 1, "edits": entries}), encoding="utf-8")
    return path


# --- what works --------------------------------------------------------------------------------


def test_info_names_what_matters(take: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["info", str(take)]) == 0
    text = capfd.readouterr().out
    for part in (str(take), "118", "60", "Live Link Face CSV", "52 of ARKit's 52", "2 frames"):
        assert part in text


def test_info_as_json(take: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["info", str(take), "--json"]) == 0
    facts = json.loads(capfd.readouterr().out)
    assert (facts["frames"], facts["rate"], facts["format"]) == (118, 60.0, "Live Link Face CSV")
    assert facts["duration_s"] == pytest.approx(2.0)
    assert len(facts["channels"]) == 52
    assert [gap["missing"] for gap in facts["gaps"]] == [2]


@pytest.mark.parametrize(
    "change",
    [
        {"op": "offset", "value": 5.0},
        {"op": "set", "value": 12.0},
        {"op": "scale", "value": 2.5},
        {"op": "smooth", "value": 0.2},
    ],
    ids=lambda change: change["op"],
)
@pytest.mark.parametrize("mode", ["preserve", "resynthesize"])
@pytest.mark.parametrize("naturalness", ["0", "1"])
def test_apply_changes_the_edited_channels(
    take: Path, models: str, change: dict[str, Any], mode: str, naturalness: str
) -> None:
    edits, out = edits_file(take.parent, EDIT | change), take.parent / "out.csv"
    given = ["apply", str(take), str(edits), "-o", str(out), "--models", models]
    assert main([*given, "--mode", mode, "--naturalness", naturalness]) == 0
    before, after = open_take(take).clip, open_take(out).clip
    changed = before.weights != after.weights
    assert changed.any()
    assert after.weights.min() >= 0
    assert after.weights.max() <= 1
    assert not changed[:, before.channels.index("eyeBlinkLeft")].any()
    assert changed.any(axis=1).all() == (mode == "resynthesize")
    if mode == "preserve":
        assert not changed[before.times < 0.3].any()
        assert not changed[before.times > 1.7].any()


def test_apply_fills_a_range_with_other_motion_of_the_take(take: Path, models: str) -> None:
    fill = {"controls": list(CONTROL_IDS), "op": "fill", "start": 0.8, "end": 1.2, "seed": 1}
    edits, outs = edits_file(take.parent, fill), [take.parent / f"{i}.csv" for i in range(2)]
    for out in outs:
        assert main(["apply", str(take), str(edits), "-o", str(out), "--models", models]) == 0
    assert outs[0].read_bytes() == outs[1].read_bytes()
    before, after = open_take(take).clip, open_take(outs[0]).clip
    changed = (before.weights != after.weights).any(axis=1)
    inside = (before.times > 0.79) & (before.times < 1.21)
    assert changed[inside].mean() > 0.8
    assert not changed[~inside].any()


def test_apply_retimes_as_the_window_does(take: Path, models: str) -> None:
    rig = shipped_rig()
    session = open_session(take, rig, load_engine(rig, Path(models)))
    session.add(edit_from_json(EDIT))
    session.preview(moved(session.take.clip, (0.7, 1.0), 0.1))
    session.preview(stretched(session.take.clip, (0.7, 1.0), 1.2))
    session.commit()
    shown, edits, out = (take.parent / name for name in ("shown.csv", "edits.json", "out.csv"))
    session.export(shown)
    session.save_edits(edits)
    assert main(["apply", str(take), str(edits), "-o", str(out), "--models", models]) == 0
    assert out.read_bytes() == shown.read_bytes() != take.read_bytes()


def test_apply_of_a_reset_alone_changes_nothing(take: Path, models: str) -> None:
    edits = edits_file(take.parent, EDIT | {"op": "reset"})
    out = take.parent / "out.csv"
    assert main(["apply", str(take), str(edits), "-o", str(out), "--models", models]) == 0
    assert out.read_bytes() == take.read_bytes()


def test_apply_without_edits_gives_the_same_bytes(take: Path, models: str) -> None:
    edits, out = edits_file(take.parent), take.parent / "out.csv"
    assert main(["apply", str(take), str(edits), "-o", str(out), "--models", models]) == 0
    assert out.read_bytes() == take.read_bytes()


def test_render_draws_the_frame_at_a_time(take: Path, capfd: pytest.CaptureFixture[str]) -> None:
    need_opengl()
    out = take.parent / "face.png"
    out.write_text("my only recording")
    code = main(["render", str(take), "-o", str(out), "--time", "1.0", "--size", "160x120"])
    from PIL import Image

    said = capfd.readouterr().err
    assert code == 0, said
    assert f"{out}: the file that was there is now {out}.bak" in said
    with Image.open(out) as picture:
        assert picture.size == (160, 120)
        assert np.asarray(picture).std() > 5


def test_render_draws_a_frame_that_fills_a_gap(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    drawn: list[Floats] = []
    monkeypatch.setattr(snapshot, "snapshot", lambda _rig, weights, *_, **__: drawn.append(weights))
    monkeypatch.setattr(snapshot, "write_png", lambda _path, _picture: None)
    take = make_livelink_csv(tmp_path / "take.csv", 2.0, untracked=range(60, 66))
    session = open_session(open_take(take), shipped_rig())
    session.add(Edit(CONTROL_IDS, Op.FILL, 0.9, 1.2, 0.0))
    session.save_edits(tmp_path / "edits.json")
    files = [str(take), "-o", str(tmp_path / "face.png"), "--edits", str(tmp_path / "edits.json")]
    assert main(["render", *files, "--time", "1.05"]) == 0
    assert "face.png: the filled frame at 1.050 s of " in capfd.readouterr().out
    np.testing.assert_allclose(drawn[0], session.all_frames().weights[63], atol=1e-4)


def test_version_and_help_end_well(capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert "FaceEdit" in capfd.readouterr().out
    for command in ("info", "apply", "render", "train"):
        assert main([command, "--help"]) == 0
        assert "Usage" in capfd.readouterr().out


# --- what is wrong -----------------------------------------------------------------------------

HEADER = b"Timecode,BlendshapeCount,JawOpen,EyeBlinkLeft\n"
ROW = b"01:02:03:04.000,2,0.1,0.2\n"
BAD_TAKES: dict[str, bytes] = {
    "empty": b"",
    "header only": HEADER,
    "truncated last row": HEADER + ROW + b"01:02:03:05.000,2,0.1\n",
    "a cell that is no number": HEADER + ROW + b"01:02:03:05.000,2,0.1,abc\n",
    "a picture": b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR" + bytes(range(256)),
    "no known channel": b"Timecode,BlendshapeCount,a,b\n" + ROW,
    "not a number": HEADER + ROW + b"01:02:03:05.000,2,0.1,nan\n",
}


@pytest.mark.parametrize("name", BAD_TAKES)
def test_bad_take_is_reported_in_one_line_and_nothing_is_written(
    name: str, tmp_path: Path, models: str, complaint: Callable[..., str]
) -> None:
    bad, out = tmp_path / "bad.csv", tmp_path / "out"
    bad.write_bytes(BAD_TAKES[name])
    edits = edits_file(tmp_path, EDIT)
    for command in (
        ("info", bad),
        ("apply", bad, edits, "-o", out, "--models", models),
        ("render", bad, "-o", out, "--time", 0),
    ):
        text = complaint(*command)
        assert str(bad) in text
        assert "; " in text, "no remedy"
    assert not out.exists()


def test_folder_or_missing_file_as_take_is_reported(
    tmp_path: Path, complaint: Callable[..., str]
) -> None:
    assert str(tmp_path) in complaint("info", tmp_path)
    assert "none.csv" in complaint("info", tmp_path / "none.csv")


def test_bad_edit_is_reported_with_file_and_number(
    take: Path, models: str, complaint: Callable[..., str]
) -> None:
    edits, out = edits_file(take.parent, EDIT, EDIT | {"op": "shake"}), take.parent / "out.csv"
    text = complaint("apply", take, edits, "-o", out, "--models", models)
    assert f"{edits}: edit 2" in text
    assert not out.exists()


def test_missing_models_are_reported(take: Path, complaint: Callable[..., str]) -> None:
    out = take.parent / "out.csv"
    edits = edits_file(take.parent, EDIT)
    text = complaint("apply", take, edits, "-o", out, "--models", take.parent)
    assert "lower.onnx" in text
    assert not out.exists()


def test_models_for_another_character_are_refused(
    take: Path, complaint: Callable[..., str]
) -> None:
    rig, out = shipped_rig(), take.parent / "out.csv"
    smaller = replace(rig, neutral=rig.neutral * 0.7, deltas=rig.deltas * 0.7, name="Small Mira")
    folder = write_models(take.parent / "models", smaller)
    edits = edits_file(take.parent, EDIT)
    text = complaint("apply", take, edits, "-o", out, "--models", folder)
    assert "lower.onnx: was made for another character, 'Small Mira'" in text
    assert not out.exists()


@pytest.mark.parametrize(
    "option",
    [
        ("--mode", "guess"),
        ("--naturalness", "1.5"),
        ("--naturalness", "-0.1"),
        ("--naturalness", "nan"),
        ("--naturalness", "much"),
        ("--strength", "2"),
    ],
    ids=" ".join,
)
def test_bad_option_of_apply_is_reported(
    take: Path, models: str, option: tuple[str, str], complaint: Callable[..., str]
) -> None:
    out = take.parent / "out.csv"
    edits = edits_file(take.parent, EDIT)
    assert option[0] in complaint("apply", take, edits, "-o", out, "--models", models, *option)
    assert not out.exists()


@pytest.mark.parametrize(
    "option",
    [
        ("--time", "99"),
        ("--time", "-1"),
        ("--time", "nan"),
        ("--size", "big"),
        ("--size", "8x8"),
        ("--size", "99999x100"),
    ],
    ids=" ".join,
)
def test_bad_option_of_render_is_reported(
    take: Path, option: tuple[str, str], complaint: Callable[..., str]
) -> None:
    out = take.parent / "face.png"
    assert option[0] in complaint("render", take, "-o", out, *option)
    assert not out.exists()


def test_render_names_the_endings_for_pictures_and_films(
    take: Path, complaint: Callable[..., str]
) -> None:
    text = complaint("render", take, "-o", take.parent / "face.jpg")
    assert ".png for a picture" in text
    assert ".mp4" in text


@pytest.mark.parametrize(
    "given",
    [("fly",), ("--fast",), ("info",), ("info", "a", "b"), ("apply", "a"), ("train",)],
    ids=" ".join,
)
def test_wrong_usage_is_reported_in_one_line(
    given: tuple[str, ...], complaint: Callable[..., str]
) -> None:
    complaint(*given)


def test_window_without_a_display_is_reported(
    take: Path, monkeypatch: pytest.MonkeyPatch, complaint: Callable[..., str]
) -> None:
    monkeypatch.setattr(display, "has_display", lambda: False)
    for given in ((), (take,), (take.parent / "none.csv",)):
        assert "no display" in complaint(*given)


def test_display_is_what_the_desktop_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("QT_QPA_PLATFORM", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    assert not display.has_display()
    for name in ("nonsense", ":99999", "localhost:x", ":"):
        monkeypatch.setenv("DISPLAY", name)
        assert not display.has_display()
    # Qt asked to use a desktop that is not there would end the process.
    monkeypatch.setenv("QT_QPA_PLATFORM", "xcb")
    assert not display.has_display()
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    assert display.has_display()
    monkeypatch.delenv("QT_QPA_PLATFORM")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setenv("WAYLAND_DISPLAY", "wayland-7")
    assert not display.has_display()
    (tmp_path / "wayland-7").touch()
    assert display.has_display()


def test_applied_edit_opens_the_mouth(take: Path, models: str) -> None:
    edits, out = edits_file(take.parent, EDIT), take.parent / "out.csv"
    assert main(["apply", str(take), str(edits), "-o", str(out), "--models", models]) == 0
    before, after = (open_take(path).clip.arkit_weights() for path in (take, out))
    held = slice(50, 70)
    jaw = ARKIT_INDEX["jawOpen"]
    assert after[held, jaw].mean() > before[held, jaw].mean() + 0.05


def test_apply_never_replaces_the_recording_by_mistake(
    take: Path, tmp_path: Path, models: str, complaint: Callable[..., str]
) -> None:
    before, edits = take.read_bytes(), edits_file(tmp_path, EDIT)
    other = take.parent / "other.csv"
    assert main(["apply", str(take), str(edits), "-o", str(other), "--models", models]) == 0
    line = complaint("apply", take, edits, "-o", take, "--models", models)
    assert "is the recording itself" in line
    assert "--overwrite" in line
    assert take.read_bytes() == before
    command = ["apply", str(take), str(edits), "-o", str(take), "--models", models, "--overwrite"]
    assert main(command) == 0
    assert take.read_bytes() == other.read_bytes()
    assert take.with_name("take.csv.bak").read_bytes() == before


def test_apply_writes_the_format_of_the_ending(take: Path, tmp_path: Path, models: str) -> None:
    edits = edits_file(tmp_path, EDIT)
    for name in ("out.csv", "out.glb", "out.json", "out.take"):
        out = tmp_path / name
        assert main(["apply", str(take), str(edits), "-o", str(out), "--models", models]) == 0
    own, glb, json_ = (open_take(tmp_path / f"out.{end}") for end in ("csv", "glb", "json"))
    assert (tmp_path / "out.take").read_bytes() == (tmp_path / "out.csv").read_bytes()
    assert (glb.format, json_.format) == ("GLB animation", "Audio2Face JSON")
    np.testing.assert_allclose(glb.clip.arkit_weights(), own.clip.arkit_weights(), atol=1e-7)


def test_a_stop_is_said_in_one_line(
    take: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def stop(*_given: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("faceedit_app.formats.opening.open_take", stop)
    assert main(["info", str(take)]) == 130
    assert capfd.readouterr().err == "faceedit: stopped\n"

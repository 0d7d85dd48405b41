"""Takes of any dialect, written for programs that know one: read as these programs read them."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.dialects import drop_frame, whole_frames
from support.places import ROOT
from support.takes import livelink_names, make_livelink_csv, make_plain_csv, speech_like

from faceedit_app.cli import main
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Doubles
from faceedit_app.formats.opening import open_take

FRAMES = 90


def livelink(rate: int = 30, **options: Any) -> Callable[[Path], Path]:
    return lambda path: make_livelink_csv(path, FRAMES / rate, rate, **options)


def changed(change: Callable[[str], str], **options: Any) -> Callable[[Path], Path]:
    """A Live Link take whose text was changed."""

    def make(path: Path) -> Path:
        text = make_livelink_csv(path, FRAMES / 30, 30, **options).read_text()
        path.write_text(change(text))
        return path

    return make


def stamped(stamp: Callable[[int], str], scale: float = 1.0) -> Callable[[Path], Path]:
    """A Live Link take with timecodes of its own."""

    def make(path: Path) -> Path:
        weights = scale * speech_like(FRAMES, 30, livelink_names())
        rows = [
            ",".join([stamp(n), "52", *(f"{value:.4f}" for value in row)])
            for n, row in enumerate(weights)
        ]
        header = ",".join(["Timecode", "BlendshapeCount", *livelink_names()])
        path.write_text("\n".join([header, *rows]) + "\n")
        return path

    return make


def count_first(path: Path) -> Path:
    """A Live Link take with its first two columns in the other order."""
    rows = [line.split(",") for line in livelink()(path).read_text().splitlines()]
    path.write_text("".join(",".join([row[1], row[0], *row[2:]]) + "\n" for row in rows))
    return path


DIALECTS: dict[str, Callable[[Path], Path]] = {
    "the application's own": livelink(60),
    "base 30": stamped(lambda n: whole_frames(n, 30)),
    "base 25": livelink(25, base=25),
    "drop-frame": stamped(drop_frame),
    "percent": stamped(lambda n: f"10:00:{n // 30:02d}:{n % 30 * 2:02d}.000", 100.0),
    "semicolons and decimal commas": changed(lambda t: t.replace(",", ";").replace(".", ",")),
    "quotes": changed(lambda t: t.replace("Timecode", '"Timecode"', 1)),
    "other spellings": changed(lambda t: t.replace("JawOpen", "jaw_open")),
    "columns in another order": count_first,
    "lost faces": livelink(60, untracked=(20, 21)),
    "an empty column": livelink(60, extra={"Note": ""}),
    "a comment": changed(lambda t: f"# made by hand\n{t}"),
}


def read_as_unreal(path: Path) -> tuple[Doubles, Doubles]:
    """Times (T,) in seconds and weights (T, 52) as Unreal's Live Link Face Importer reads them.

    It skips empty cells, and stops at a row that then has another length.
    """
    lines = [line for line in path.read_text("utf-8-sig").splitlines() if line]
    names = [cell.lower() for cell in lines[0].split(",") if cell]
    assert names[:2] == ["timecode", "blendshapecount"]
    places = [names.index(name.lower()) for name in ARKIT_CHANNELS]
    times, weights = [], []
    for line in lines[1:]:
        cells = [cell for cell in line.split(",") if cell]
        if len(cells) != len(names):
            break
        hours, minutes, seconds, frames = map(float, cells[0].split(":"))
        times.append(hours * 3600 + minutes * 60 + seconds + frames / 60)
        weights.append([float(cells[place]) for place in places])
    return np.array(times), np.array(weights)


@pytest.mark.parametrize("make", DIALECTS.values(), ids=DIALECTS)
def test_unreal_reads_any_take_that_is_written_as_live_link_face(
    tmp_path: Path, make: Callable[[Path], Path]
) -> None:
    take, out = make(tmp_path / "take.csv"), tmp_path / "out.csv"
    assert main(["convert", str(take), str(out), "--format", "livelink"]) == 0
    clip = open_take(take).clip
    times, weights = read_as_unreal(out)
    np.testing.assert_allclose(weights, clip.arkit_weights(), atol=1e-5)
    np.testing.assert_allclose(times - times[0], clip.times, atol=1e-4)
    # Without a format, each keeps its own.
    assert main(["convert", str(take), str(out)]) == 0
    assert out.read_bytes() == take.read_bytes()


def test_a_take_that_unreal_reads_is_copied(tmp_path: Path) -> None:
    take, out = (
        make_livelink_csv(tmp_path / "take.csv", extra={"Angry": "0.5"}),
        tmp_path / "out.csv",
    )
    assert main(["convert", str(take), str(out), "--format", "livelink"]) == 0
    assert out.read_bytes() == take.read_bytes()


def scripts() -> dict[str, str]:
    """The two scripts of the guide."""
    guide = (ROOT / "docs" / "formats.md").read_text(encoding="utf-8")
    parts = [part.partition("```")[0] for part in guide.split("```python\n")[1:]]
    return {"blender": parts[0], "maya": parts[1]}


def run_script(tool: str, take: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, list[float]]:
    """Each channel's time in seconds and weight of its keys, as a script sets them at 30 fps."""
    keys: dict[str, list[float]] = {}
    if tool == "blender":

        class Block:
            value = 0.0

            def __init__(self, name: str) -> None:
                self.name = name

            def keyframe_insert(self, path: str, frame: float) -> None:
                keys.setdefault(self.name, []).extend([(frame - 1) / 30, self.value])

        bpy: Any = ModuleType("bpy")
        blocks = {name: Block(name) for name in ARKIT_CHANNELS}
        shapes = SimpleNamespace(
            data=SimpleNamespace(shape_keys=SimpleNamespace(key_blocks=blocks))
        )
        render = SimpleNamespace(fps=30, fps_base=1.0)
        scene = SimpleNamespace(frame_start=1, render=render)
        bpy.context = SimpleNamespace(scene=scene, object=shapes)
        monkeypatch.setitem(sys.modules, "bpy", bpy)
    else:
        maya: Any = ModuleType("maya")

        def set_key(node: str, attribute: str, time: str, value: float) -> None:
            keys.setdefault(attribute, []).extend([float(time.removesuffix("sec")), value])

        maya.cmds = SimpleNamespace(
            attributeQuery=lambda name, node, exists: name in ARKIT_CHANNELS, setKeyframe=set_key
        )
        monkeypatch.setitem(sys.modules, "maya", maya)
    script = scripts()[tool].replace('"take.csv"', repr(str(take)))
    exec(script, {})
    return keys


def plain(change: Callable[[str], str]) -> Callable[[Path], Path]:
    def make(path: Path) -> Path:
        path.write_bytes(change(make_plain_csv(path).read_text()).encode())
        return path

    return make


def in_percent(text: str) -> str:
    header, *rows = text.splitlines()
    cells = [row.split(",") for row in rows]
    lines = [",".join([c[0], *(f"{100 * float(v):.3f}" for v in c[1:])]) for c in cells]
    return "\n".join([header, *lines])


TABLES: dict[str, Callable[[Path], Path]] = {
    "plain already": plain(str),
    "Live Link Face": livelink(60),
    "percent": plain(in_percent),
    "semicolons": plain(lambda t: t.replace(",", ";").replace(".", ",")),
    "other names": plain(lambda t: t.replace("Left", "_L").replace("jawOpen", "Jaw_Open")),
    "another name of the times": plain(lambda t: t.replace("time_s", "timestamp", 1)),
    "a byte order mark": plain(lambda t: "\ufeff" + t),
    "a comment": plain(lambda t: f"# by hand\n{t}"),
    "lost faces": plain(lambda t: t.replace("\n0.5000,", "\n0.5000" + 52 * "," + "\n0.5100,")),
}


@pytest.mark.parametrize("tool", ["blender", "maya"])
@pytest.mark.parametrize("make", TABLES.values(), ids=TABLES)
def test_the_scripts_of_the_guide_read_any_take_that_is_written_as_plain_csv(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, make: Callable[[Path], Path], tool: str
) -> None:
    take, out = make(tmp_path / "take.csv"), tmp_path / "out.csv"
    assert main(["convert", str(take), str(out), "--format", "csv"]) == 0
    clip = open_take(take).clip
    keys = run_script(tool, out, monkeypatch)
    assert set(keys) == set(clip.channels)
    for channel, weights in zip(clip.channels, clip.weights.T, strict=True):
        found = np.array(keys[channel]).reshape(-1, 2)
        np.testing.assert_allclose(found[:, 0], clip.times, atol=2e-4)
        np.testing.assert_allclose(found[:, 1], weights, atol=1e-5)


def test_a_plain_csv_is_copied(tmp_path: Path) -> None:
    take, out = make_plain_csv(tmp_path / "take.csv"), tmp_path / "out.csv"
    assert main(["convert", str(take), str(out), "--format", "csv"]) == 0
    assert out.read_bytes() == take.read_bytes()

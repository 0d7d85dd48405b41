"""One table of formats, from which the rest of FaceEdit knows what it can open."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from support import recordings
from support.places import ROOT
from support.takes import make_livelink_csv, make_plain_csv

from faceedit_app.core.arrays import Floats
from faceedit_app.core.errors import FileError
from faceedit_app.core.glb import join_glb
from faceedit_app.formats import registry
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.registry import Format
from faceedit_app.formats.take import Recording, Take, finish_take
from faceedit_app.formats.timing import Timing
from faceedit_app.lab.training.data import take_paths

# --- what a new format needs: a module such as this, and a row ------------------------------------


class ToySource:
    """A toy file is "TOY" and a byte a frame, in percent."""

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        return b"TOY" + bytes(np.round(edited[:, 0] * 100).astype(np.uint8))


def sniff(content: bytes) -> float:
    return 1.0 if content.startswith(b"TOY") else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    values = np.frombuffer(content[3:], np.uint8).astype(np.float64)[:, None]
    timing = Timing(np.arange(len(values)) / 10, 10.0)
    nothing = np.zeros(len(values), bool)
    recording = Recording(path, "Toy", ("jawOpen",), values, timing, nothing)
    return finish_take(recording, fps, lambda scale: ToySource())


TOY = Format("toy", "Toy", (".toy", ".xyz"), "application/x-toy", "toy makers", sniff, read)


@pytest.fixture
def with_toy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(registry, "FORMATS", (*registry.FORMATS, TOY))


@pytest.fixture
def tables() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_tables", ROOT / "docs" / "make_tables.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.usefixtures("with_toy")
def test_a_new_format_is_one_module_and_one_row(tmp_path: Path) -> None:
    path = tmp_path / "take.bin"
    path.write_bytes(b"TOY" + bytes(range(0, 100, 5)))
    take = open_take(path)
    assert (take.format, take.clip.rate, len(take.clip)) == ("Toy", 10, 20)
    weights = take.clip.weights.copy()
    weights[2, 0] = 0.77
    write_take(tmp_path / "out.toy", take, weights)
    assert (tmp_path / "out.toy").read_bytes()[:6] == b"TOY\x00\x05M"


@pytest.mark.usefixtures("with_toy")
def test_all_that_depends_on_formats_knows_the_new_one(tmp_path: Path, tables: ModuleType) -> None:
    assert registry.endings()[-2:] == (".toy", ".xyz")
    assert registry.mime_types()[-1] == "application/x-toy"
    assert registry.offered_endings()[-1] == ".xyz"
    assert "| Toy | `.toy`, `.xyz` | toy makers |" in registry.markdown_table()
    assert "toy makers" in tables.with_tables((ROOT / "README.md").read_text(encoding="utf-8"))
    (tmp_path / "a.toy").write_bytes(b"TOY" + bytes(9))
    (tmp_path / "b.toy").write_bytes(b"something else")
    assert [path.name for path in take_paths(tmp_path)] == ["a.toy"]


# --- the formats there are ------------------------------------------------------------------------


@pytest.mark.parametrize("page", ["README.md", "docs/formats.md"])
def test_the_documentation_lists_the_formats(page: str, tables: ModuleType) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    assert registry.markdown_table() in text
    assert tables.with_tables(text) == text, "run python docs/make_tables.py"


def test_every_format_is_recognised_by_its_content_alone(tmp_path: Path) -> None:
    face = recordings.face()
    texts = {
        "Audio2Face JSON": recordings.audio2face(face),
        "Face Cap TXT": recordings.facecap(face),
        "JSON with names and frames": recordings.named_frames(face),
        "MediaPipe JSON": recordings.mediapipe(face),
    }
    for number, text in enumerate(texts.values()):
        (tmp_path / f"{number}.take").write_text(text, encoding="utf-8")
    make_livelink_csv(tmp_path / "4.take")
    make_plain_csv(tmp_path / "5.take")
    recordings.glb(tmp_path / "6.take", face)
    found = {open_take(path).format for path in tmp_path.iterdir()}
    assert found == {
        *texts,
        "Live Link Face CSV",
        "CSV with times in seconds",
        "GLB animation",
    }


def test_training_finds_takes_of_every_format_and_no_other_files(tmp_path: Path) -> None:
    face = recordings.face()
    make_plain_csv(tmp_path / "a.csv")
    (tmp_path / "b.CSV").write_text("damaged")
    (tmp_path / "c.json").write_text(recordings.audio2face(face), encoding="utf-8")
    (tmp_path / "edits.json").write_text('{"version": 1, "edits": []}')
    (tmp_path / "notes.txt").write_text("open the jaw")
    recordings.glb(tmp_path / "d.glb", face)
    names = [path.name for path in registry.takes_below(tmp_path)]
    assert names == ["a.csv", "b.CSV", "c.json", "d.glb"]


@pytest.mark.parametrize(
    ("content", "says", "remedy"),
    [
        (b'{"emotionNames": ["joy"], "emotionKeys": [[0.1]]}', "emotions", "facsNames"),
        (b'{"version": 1, "take": {}, "settings": {}, "edits": []}', "a project", ".faceedit"),
        (b'{"version":1,"fingerprint":{}}\n{"step":1,"edits":[]}\n', "the journal", "recover"),
        (b'{"version": 1, "edits": []}', "a list of edits", "open the take first"),
        (b'{"format": "openfacefx.track", "fps": 30}', "sparse keys", "ARKit CSV"),
        (b"mouthSmile_R-0|eyeLookOut_L-12|=head#1,2", "which has no times", "its frame rate"),
        (b"[[0.1, 0.2], [0.3, 0.4]]", "without the names", "ARKit names"),
        (b"\x93NUMPY\x01\x00", "without the names", "CSV"),
        (b"PK\x03\x04 weights.npy", "without the names", "CSV"),
        (b"PK\x03\x04 xl/workbook.xml", "workbook", "CSV"),
        ((b"0.1," * 51 + b"0.2\n") * 9, "without the names", "line at the top"),
        (
            b"".join(b"0,%s,0.1\n" % n.encode() for n in 2 * recordings.FACECAP_NAMES),
            "no line with the names of its columns",
            "time,channel,value",
        ),
        (b"frame, AU01_r, AU02_r, AU45_c\n1, 0.1, 0.2, 1\n", "action units", "film"),
        (b"jawOpen jawLeft\n0.1 0.2\n", "by spaces", "commas"),
        (b"animVersion 1.1;\nanim jawOpen blendShape1 0 1 0;\n", "Maya", "CSV"),
        (b"PXR-USDC" + bytes(80), "USD", ".usda"),
        (b'#usda 1.0\ndef Xform "jawOpen, jawLeft"\n{\n}\n', "USD text without", "GLB"),
        (b"%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n", "Unity", ".anim"),
        (b"Ogawa\xff" + bytes(80), "Alembic", "GLB"),
        (b"BLENDER-v300" + bytes(80), "Blender", "GLB"),
        (b"\x1f\x8b\x08" + bytes(80), "compressed", "unpack"),
        (b"PK\x03\x04 take.csv", "compressed", "unpack"),
        (b"\x80\x04\x95}\x94\x8c\x07jawOpen\x94K\x01s.", "pickle", "CSV"),
        (b"SQLite format 3\0" + bytes(80), "SQLite", "CSV"),
        (b"<!DOCTYPE html>\n<html><title>jawOpen, jawLeft</title>", "web page", "download"),
        (b"version https://git-lfs.github.com/spec/v1\noid 1\n", "Git LFS", "git lfs pull"),
        (b'{"asset": {"version": "2.0"}, "bufferViews": []}', "glTF", "GLB"),
        (join_glb({"asset": {}}, b"")[:-1], "cut off: it has 39 of 40 bytes", "again"),
        (join_glb({"asset": {}}, b""), "without an animation", "shape keys"),
        (b"glTF\x02\x00\x00\x00", "a GLB that is cut off", "again"),
        (b"glTF" + bytes(20), "a GLB that is damaged", "again"),
        (
            b'#usda 1.0\ndef Xform "}" {\n}  # }\n  def SkelAnimation "',
            "USD text that is cut off",
            "again",
        ),
        (b'{"a":', "cut off", "again"),
        (b'{"jawOpen": [0.1, 0.2], "jawLef', "cut off", "again"),
        (b"[[0.1, 0.2], [0.3", "cut off", "again"),
        (b'{"a" 1}', "is damaged: expecting", "again"),
        (b"[take]\nname = a\n", "no ARKit channel", "choose a take"),
        (b"Kaydara FBX Binary  \x00", "FBX", "GLB"),
        (b"HIERARCHY\nROOT Hips", "BVH", "CSV or GLB"),
        (b"{}", "no ARKit channel", "choose a take"),
    ],
)
def test_what_cannot_be_opened_is_named_with_a_way_out(
    tmp_path: Path, content: bytes, says: str, remedy: str
) -> None:
    path = tmp_path / "file"
    path.write_bytes(content)
    with pytest.raises(FileError) as caught:
        open_take(path)
    assert says in caught.value.problem
    assert remedy in caught.value.remedy
    assert str(caught.value).isprintable()

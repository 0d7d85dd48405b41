"""Every reader of the application, with a valid file that it reads."""

from __future__ import annotations

import io
import json
import wave
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

import av
import numpy as np

from faceedit_app.characters.glb import read_rig
from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.characters.map_file import read_map
from faceedit_app.characters.registry import read_character
from faceedit_app.characters.scans import read_scan
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS, CONTROLS, LIP_OPENING, MOUTH_CORNERS
from faceedit_app.core.resources import DEMO_TAKE, shipped
from faceedit_app.core.rig import Material, Rig
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.files.edits_file import write_edits
from faceedit_app.editing.files.fingerprint import fingerprint
from faceedit_app.editing.files.journal import Journal
from faceedit_app.editing.files.pending import pending_journals
from faceedit_app.editing.files.project import Project, read_project, write_project
from faceedit_app.editing.opening import open_session, shipped_rig
from faceedit_app.editing.steps import EditState
from faceedit_app.formats import csv_take, metahuman
from faceedit_app.formats.opening import encoded_take, open_take
from faceedit_app.formats.registry import endings, writable
from faceedit_app.media.film import Film
from faceedit_app.media.sound import read_sound
from faceedit_app.networks.completion import FOLDER, read_completion
from faceedit_app.networks.region import read_region
from faceedit_app.words.files import WRITE_ENDINGS, read_words, write_words
from faceedit_app.words.transcript import Phoneme, Transcript, Word

_ROWS = 40  # of the takes: enough to tell their times, small enough to read thousands
_VERTICES = 60  # of the characters
_EDITS = (
    Edit((LIP_OPENING,), Op.OFFSET, 0.1, 0.3, 0.1, 4.0, name="wider"),
    Edit(MOUTH_CORNERS, Op.SCALE, 0.0, 0.2, 0.1, 1.5, strength=0.5),
    Edit((LIP_OPENING,), Op.DRAW, 0.1, 0.4, 0.1, points=((0.1, 3.0), (0.3, 9.0))),
    Edit(CONTROL_IDS, Op.RETIME, 0.0, 0.4, 0.0, pins=((0.1, 0.2), (0.2, 0.2), (0.2, 0.3))),
)


class Wrong(Exception):
    """A damaged file was read as something that it cannot be."""


@dataclass(frozen=True)
class Reader:
    """A reader, and a valid file for it.

    Attributes:
        name: what it reads, such as `edits`.
        ending: of its files.
        content: of a valid file.
        read: reads a file; raises FaceEditError if it is damaged.
    """

    name: str
    ending: str
    content: bytes
    read: Callable[[Path], object]


def all_readers(folder: Path) -> list[Reader]:
    """Every reader.

    Args:
        folder: where the valid files are made.
    """
    demo = open_take(shipped(DEMO_TAKE))
    lines = shipped(DEMO_TAKE).read_bytes().splitlines(keepends=True)
    take = folder / "take.csv"
    take.write_bytes(b"".join(lines[: _ROWS + 1]))
    clip = Clip(demo.clip.weights[:_ROWS], demo.clip.channels, demo.clip.times[:_ROWS], 60.0)
    readers = [Reader("takes", ".csv", take.read_bytes(), _read_take)]
    for form in writable():
        if form.write is not None:
            readers.append(Reader("takes", form.endings[0], form.write(clip), _read_take))
    readers += [Reader("takes", ending, content, _read_take) for ending, content in _dialects(clip)]
    write_edits(folder / "edits.json", _EDITS)
    readers.append(_reader("edits", folder / "edits.json", partial(_apply_edits, take)))
    state = EditState(_EDITS)
    write_project(folder / "project.faceedit", Project(take, fingerprint(take), state))
    readers.append(_reader("projects", folder / "project.faceedit", read_project))
    readers.append(Reader("journals", ".jsonl", _journal(take, folder), _read_journal))
    readers.append(Reader("sounds", ".wav", _sound(), read_sound))
    readers.append(_reader("films", _film(folder / "film.mkv"), _read_film))
    model = next(shipped("models").glob("*.onnx"))
    readers.append(_reader("models", model, read_region))
    model = next((shipped("models") / FOLDER).glob("*.onnx"))
    readers.append(_reader("models", model, read_completion))
    rig = _small_rig()
    write_rig(folder / "head.glb", rig)
    readers.append(_reader("characters", folder / "head.glb", read_character))
    readers.append(_reader("rigs", folder / "head.glb", read_rig))
    readers.append(Reader("characters", ".obj", _obj(rig), read_character))
    readers.append(Reader("maps", ".json", _MAP, read_map))
    readers += [Reader("words", ending, content, _read_words) for ending, content in _words(folder)]
    return readers


def _words(folder: Path) -> Iterator[tuple[str, bytes]]:
    """Files of words: those that FaceEdit writes, captions, and what speech recognisers write."""
    said = Transcript(
        (
            Word("blue", 0.2, 0.5, (Phoneme("B", 0.2, 0.3), Phoneme("UW", 0.3, 0.5))),
            Word("map", 1.2, 1.5, (Phoneme("M", 1.2, 1.5),)),
        )
    )
    for ending in WRITE_ENDINGS:
        write_words(folder / f"words{ending}", said, 2.0)
        yield ending, (folder / f"words{ending}").read_bytes()
    yield ".vtt", b"WEBVTT\n\nNOTE x\n\n00:00.200 --> 00:00.500\n<v Bob>blue<00:00.300> &amp;\n"
    segment = {"id": 0, "start": 0.2, "end": 1.5, "text": " blue map", "words": []}
    yield ".json", json.dumps({"text": "blue map", "segments": [segment]}).encode()


def _read_words(path: Path) -> object:
    found = read_words(path)
    for line in found.lines:
        if line.start is not None and not 0.0 <= abs(line.start) < 1e7:
            raise Wrong(f"a line begins at {line.start} s")
    words = found.transcript.words if found.transcript is not None else ()
    if any(not word.start <= word.end for word in words):
        raise Wrong("a word ends before it begins")
    return found


def _dialects(clip: Clip) -> Iterator[tuple[str, bytes]]:
    """The clip in formats and dialects that FaceEdit reads and does not write."""
    plain = csv_take.write(clip)
    yield ".csv", ("\ufeff" + plain.decode()).encode("utf-16-le")
    yield ".csv", b"# units: s\n" + plain.replace(b",", b";").replace(b".", b",")
    rows = [dict(zip(clip.channels, row, strict=True)) for row in clip.weights.tolist()]
    yield ".json", json.dumps([{"time": n / 60, **row} for n, row in enumerate(rows)]).encode()
    series = dict(zip(clip.channels, clip.weights.T.tolist(), strict=True))
    yield ".json", json.dumps({"fps": 60, "curves": series}).encode()
    controls = ["time_s", *(f"CTRL_expressions_{metahuman.CONTROLS[c][0]}" for c in clip.channels)]
    yield ".csv", ",".join(controls).encode() + plain[plain.index(b"\n") :]
    entries = [(n / 60, name, weight) for n, row in enumerate(rows) for name, weight in row.items()]
    yield ".json", json.dumps([dict(zip("tkv", entry, strict=True)) for entry in entries]).encode()
    texts = [{"fps": "60", "weights": {k: str(v) for k, v in row.items()}} for row in rows]
    yield ".jsonl", "\n".join(map(json.dumps, texts)).encode()
    lines = (f"{t:.4f},{name},{weight}" for t, name, weight in entries)
    yield ".csv", "\n".join(["time,name,value", *lines]).encode()
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    lists = ([name, *map(str, values)] for name, values in columns.items())
    turned = [["time_s", *(f"{n / 60:.4f}" for n in range(len(rows)))], *lists]
    yield ".csv", "\n".join(map(",".join, turned)).encode()
    keys = {name: [[n / 60, v] for n, v in enumerate(values)] for name, values in columns.items()}
    yield ".json", json.dumps(keys).encode()
    nested = [{"jaw": {"open": row["jawOpen"]}, "eye": {"blink": {"left": 0.5}}} for row in rows]
    yield ".json", json.dumps({"video": {"r_frame_rate": "60/1"}, "frames": nested}).encode()
    frames = ("|".join(f"{k}-{100 * v:.0f}" for k, v in row.items()) for row in rows)
    yield ".txt", "\n".join(f"{n / 60:.4f}|{text}|" for n, text in enumerate(frames)).encode()


def readers_of(sample: Path) -> list[Reader]:
    """The readers of a user's own valid file, by its ending."""
    kinds = {name: (endings, read) for name, endings, read in _BY_ENDING}
    return [
        _reader(name, sample, read)
        for name, (endings, read) in kinds.items()
        if sample.suffix.lower() in endings
    ]


def _reader(name: str, path: Path, read: Callable[[Path], object]) -> Reader:
    return Reader(name, path.suffix, path.read_bytes(), read)


_MAP = b"""{"faceedit_character_map": 1,
 "channels": {"jawOpen": ["Jaw_Open"], "mouthClose": [{"shape": "close", "weight": 0.5}]},
 "points": {"left_mouth_corner": {"part": "head", "vertex": 7}}}"""


def _read_take(path: Path) -> None:
    """Open a take; unchanged, it must be written as the same bytes."""
    take = open_take(path, fps=None)
    weights, times = take.clip.weights, take.clip.times
    if not (np.isfinite(weights).all() and np.isfinite(times).all()):
        raise Wrong("a weight or a time is not finite")
    if len(times) > 1 and not (np.diff(times) > 0).all():
        raise Wrong("the times do not run forward")
    if encoded_take(path, take, weights) != path.read_bytes():
        raise Wrong("the unchanged take is not written as the same bytes")
    encoded_take(path, take, np.where(weights > 0.5, weights - 0.25, weights + 0.25))


def _read_journal(path: Path) -> None:
    pending_journals(path.parent)


def _journal(take: Path, folder: Path) -> bytes:
    journal = Journal(take, folder=folder / "journals")
    for count in (1, 2, 3):
        journal.record(EditState(_EDITS[:count]))
    content = journal.path.read_bytes()
    journal.close()
    return content


def _sound() -> bytes:
    content = io.BytesIO()
    with wave.open(content, "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(8000)
        file.writeframes(bytes(1600))
    return content.getvalue()


def _film(path: Path) -> Path:
    """A film of a few small pictures."""
    with av.open(str(path), "w") as out:
        stream = out.add_stream("mpeg4", rate=25)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        for shade in range(0, 200, 20):
            frame = av.VideoFrame.from_ndarray(np.full((48, 64, 3), shade, np.uint8), "rgb24")
            out.mux(stream.encode(frame))
        out.mux(stream.encode(None))
    return path


def _read_film(path: Path) -> None:
    """Index a film, and decode its first and last picture."""
    film = Film(path)
    try:
        for index in {0, len(film) - 1}:
            film.picture(index)
    finally:
        film.close()


def _apply_edits(take: Path, path: Path) -> None:
    """Apply edits to a take; what is shown must be finite."""
    session = open_session(take, _shipped_rig())
    session.load_edits(path)
    session.live.work()
    for name in ("asked", "achieved", "weights"):
        if not np.isfinite(getattr(session, name)).all():
            raise Wrong(f"{name} is not finite")


@cache
def _shipped_rig() -> Rig:
    return shipped_rig()


def _small_rig() -> Rig:
    """A corner of the shipped character, small enough to be read thousands of times."""
    rig = _shipped_rig()
    faces = rig.faces[(rig.faces < _VERTICES).all(axis=1)]
    return Rig(
        neutral=rig.neutral[:_VERTICES],
        faces=faces,
        channels=rig.channels,
        deltas=rig.deltas[:, :_VERTICES],
        colors=rig.colors[:_VERTICES],
        materials=(Material("skin", 0, len(faces)),),
        control_pairs=np.arange(2 * len(CONTROLS), dtype=np.int32).reshape(-1, 2),
    )


def _obj(rig: Rig) -> bytes:
    points = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in rig.neutral]
    faces = [f"f {a} {b} {c}" for a, b, c in rig.faces + 1]
    return "\n".join(["o head", *points, *faces, ""]).encode()


_BY_ENDING: tuple[tuple[str, tuple[str, ...], Callable[[Path], object]], ...] = (
    ("takes", endings(), _read_take),
    ("projects", (".faceedit",), read_project),
    ("journals", (".jsonl",), _read_journal),
    ("characters", (".glb", ".gltf", ".vrm", ".fbx", ".obj"), read_character),
    ("scans", (".glb", ".obj", ".ply", ".stl"), read_scan),
    ("sounds", (".wav", ".mp3", ".m4a", ".mov", ".mp4", ".mkv", ".avi"), read_sound),
    ("films", (".mov", ".mp4", ".mkv", ".avi", ".mpg", ".webm"), Film),
    ("models", (".onnx",), read_region),
)

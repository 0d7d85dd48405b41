"""The table of take formats, which everything that depends on formats reads.

File dialogs, drag and drop, training, the file types of the installed application and the table in
the README all use it. To add a format, add a module with `sniff` and `read`, and a row here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Indices
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FileError
from faceedit_app.core.names import similar_channel, versions_of
from faceedit_app.formats import (
    audio2face,
    azure_speech,
    csv_style,
    csv_take,
    facecap,
    glb_animation,
    ifacialmocap,
    livelink,
    long_table,
    mediapipe,
    metahuman,
    named_frames,
    named_weights,
    transposed,
    unity_clip,
    usd_text,
)
from faceedit_app.formats.csv_table import first_rows
from faceedit_app.formats.cut_off import check_whole
from faceedit_app.formats.encodings import as_utf8
from faceedit_app.formats.faceless import Faceless
from faceedit_app.formats.files import BOM, CHOOSE_TAKE, check_text, read_bytes, shown
from faceedit_app.formats.foreign import recognise_foreign
from faceedit_app.formats.other_readers import is_plain_csv, is_plain_livelink
from faceedit_app.formats.take import Source, Take

_START = 1 << 20  # bytes in which a whole take of usual length fits
_START_OF_TEXT = 1024  # bytes in which binary data has a zero


@dataclass(frozen=True)
class Format:
    """A format of takes.

    Attributes:
        key: the name on the command line.
        name: shown to the user.
        endings: of its files, in lower case with the dot.
        mime: the media type for which the desktop offers FaceEdit; "" if most files of that type
            are something else.
        tools: the tools that write it.
        sniff: how likely, 0..1, a file's content is of this format.
        read: opens a file: path, content, and the frame rate if the user gave one.
        write: encodes any clip in this format; None if only takes that were read from it can be
            written.
        write_like: as `write`, in the style of a source, given the frame of it that each frame
            comes from, and its rows without a face; gives None for one that has no style.
        is_plain: whether other programs read a file of this format, given its content and clip, as
            they read what `write` writes.
        tells_times: whether its frames have times, not only a rate.
        keeps_rotations: whether `write` keeps the rotations of head and eyes.
        keeps_confidence: whether it keeps how sure the tracker was.
        hints: for a format that can be written, by program, what to do there; `{rate}` stands for
            the frame rate.
    """

    key: str
    name: str
    endings: tuple[str, ...]
    mime: str
    tools: str
    sniff: Callable[[bytes], float]
    read: Callable[[Path, bytes, float | None], Take]
    write: Callable[[Clip], bytes] | None = None
    write_like: Callable[[Source, Clip, Indices, Faceless | None], csv_style.Styled | None] = (
        lambda source, clip, frames, faceless: None
    )
    is_plain: Callable[[bytes, Clip], bool] = lambda content, clip: True
    tells_times: bool = True
    keeps_rotations: bool = False
    keeps_confidence: bool = False
    hints: tuple[tuple[str, str], ...] = ()


# fmt: off
FORMATS: tuple[Format, ...] = (
    Format("livelink", livelink.FORMAT, (".csv",), "text/csv",
           "Live Link Face on an iPhone; Face_Landmark_Link and others that write its layout",
           livelink.sniff, livelink.read, livelink.write, csv_style.write_like,
           is_plain=is_plain_livelink,
           keeps_rotations=True, keeps_confidence=True, hints=(
               ("Unreal", "switch on the plug-in Live Link Face Importer, and drag the file into "
                "the Content Browser: it becomes a Level Sequence"),
               ("Blender", "the add-on Faceit imports it (Mocap > Import Live Link Face)"),
               ("Maya", "write FBX instead, or run the script in docs/formats.md on a plain CSV"),
           )),
    Format("csv", "CSV with ARKit names", (".csv", ".tsv"), "text/csv",
           "NVIDIA Audio2Face, MediaPipe recorders, SAiD, spreadsheets",
           csv_take.sniff, csv_take.read, csv_take.write, csv_style.write_like,
           is_plain=is_plain_csv, keeps_rotations=True, keeps_confidence=True, hints=(
               ("Blender, Maya", "the scripts in docs/formats.md put it on a mesh with its shapes"),
               ("Spreadsheets", "one row a frame: seconds, then a column for each channel"),
           )),
    Format("audio2face", audio2face.FORMAT, (".json",), "application/json",
           "NVIDIA Audio2Face",
           audio2face.sniff, audio2face.read, audio2face.write,
           is_plain=audio2face.is_plain, tells_times=False,
           keeps_confidence=True, hints=(
               ("Blender", "set the scene to {rate} first; the add-on Faceit then imports the file "
                "(Mocap > Import Audio2Face)"),
               ("Maya, Omniverse", "Audio2Face's own importers of blendshape weights read it"),
           )),
    Format("azure", azure_speech.FORMAT, (".json", ".jsonl"), "application/json",
           "programs that save the blend shapes of Azure's text to speech",
           azure_speech.sniff, azure_speech.read),
    Format("facecap", facecap.FORMAT, (".txt",), "",
           "Face Cap on an iPhone", facecap.sniff, facecap.read),
    Format("ifacialmocap", ifacialmocap.FORMAT, (".txt",), "",
           "scripts that save what iFacialMocap sends", ifacialmocap.sniff, ifacialmocap.read),
    Format("long", long_table.FORMAT, (".csv", ".tsv"), "text/csv",
           "data frames and databases (pandas, R, SQL)", long_table.sniff, long_table.read),
    Format("transposed", transposed.FORMAT, (".csv", ".tsv"), "text/csv",
           "Speech2BS, spreadsheets", transposed.sniff, transposed.read),
    Format("names", named_frames.FORMAT, (".json",), "application/json",
           "the BEAT dataset, LAM_Audio2Expression", named_frames.sniff, named_frames.read),
    Format("mediapipe", mediapipe.FORMAT, (".json",), "application/json",
           "webcam recorders on MediaPipe", mediapipe.sniff, mediapipe.read),
    Format("json", named_weights.FORMAT, (".json", ".jsonl", ".ndjson"), "application/json",
           "scripts, game engines, web recorders", named_weights.sniff, named_weights.read),
    Format("metahuman", metahuman.FORMAT, (".csv", ".json"), "",
           "Unreal scripts that list a MetaHuman's curves", metahuman.sniff, metahuman.read),
    Format("glb", glb_animation.FORMAT, (".glb",), "model/gltf-binary",
           "Face Cap, Blender, XR Animator", glb_animation.sniff, glb_animation.read),
    Format("unity", unity_clip.FORMAT, (".anim",), "",
           "Unity, and recorders that are made with it", unity_clip.sniff, unity_clip.read),
    Format("usda", usd_text.FORMAT, (".usda",), "",
           "Audio2Face, Omniverse, FaceEdit itself", usd_text.sniff, usd_text.read),
)
# fmt: on


class NotTake(FileError):
    """A file that can be read, and is something other than a take."""


def recognise(path: Path, content: bytes) -> Format:
    """Recognise the format of a file by its content.

    Raises:
        NotTake: it is not a take; the text says what it is instead, if known.
        FileError: it is damaged, or names channels almost as a take does.
    """
    found = find_format(content)
    if found is not None:
        return found
    check_whole(path, content)
    foreign = recognise_foreign(content)
    if foreign is not None:
        raise NotTake(path, foreign.problem, foreign.remedy, command_remedy=foreign.command_remedy)
    check_text(path, content)
    line = 1 + next(
        k for k, text in enumerate(content.removeprefix(BOM).splitlines()) if text.strip()
    )
    names = first_rows(content)[0]
    if several := _names_of_one(names):
        listed = " and ".join(f'"{shown(name)}"' for name in several[:2])
        problem = f"holds no ARKit channel, but {len(several)} columns for each: {listed}"
        raise FileError(path, problem, "keep the columns of one person, or of one kind", line)
    for name in names:
        if meant := similar_channel(name, ARKIT_CHANNELS):
            problem = f'holds no ARKit channel, but "{shown(name)}"'
            raise FileError(path, problem, f"if {meant} is meant, correct the name", line)
    raise NotTake(path, "holds no ARKit channel such as jawOpen", CHOOSE_TAKE, line)


def _names_of_one(names: Sequence[str]) -> list[str]:
    """The names of a channel that has several, such as one for each person; none if none has."""
    owners: dict[str, list[str]] = {}
    for by in versions_of(names).values():
        for name, channel in by.items():
            owners.setdefault(channel, []).append(name)
    return next((found for found in owners.values() if len(found) > 1), [])


def check_start(path: Path) -> None:
    """Refuse a file whose beginning shows that it is not a take; quick enough to wait for.

    Raises:
        NotTake: it is not a take.
        FileError: it cannot be read, or is damaged.
    """
    start = read_bytes(path, _START)
    binary = 0 <= start.find(b"\0") < _START_OF_TEXT and not as_utf8(start[:_START_OF_TEXT])[1]
    # What makes a long text or GLB a take may follow later.
    if len(start) < _START or (binary and not start.startswith(b"glTF")):
        recognise(path, as_utf8(start)[0])


def find_format(content: bytes) -> Format | None:
    """The format of a file's content, or None."""
    sure = [(form.sniff(content), form) for form in FORMATS]
    best = max(sure, key=lambda one: one[0], default=(0.0, None))
    return best[1] if best[0] > 0 else None


def is_take(path: Path) -> bool:
    """Whether a file's content is of a known format; False if it cannot be read."""
    try:
        return find_format(as_utf8(read_bytes(path))[0]) is not None
    except FileError:
        return False


def takes_below(folder: Path) -> list[Path]:
    """The takes in a folder and its subfolders, by name.

    Any CSV counts, so that a damaged one is not skipped silently; other endings are shared with
    other kinds of files, whose content is checked.
    """
    files = files_below(folder)
    return [path for path in files if path.suffix.lower() == ".csv" or is_take(path)]


def files_below(folder: Path) -> list[Path]:
    """The files in a folder and its subfolders that end like takes, by name; none is read."""
    known = endings()
    return sorted(path for path in folder.rglob("*") if path.suffix.lower() in known)


def why_no_take(path: Path) -> str:
    """What a file is that ends like a take and is none, and what to do; "" for a take.

    It is "" for a damaged CSV as well, which may have been a take.
    """
    try:
        recognise(path, as_utf8(read_bytes(path))[0])
    except FileError as error:
        if isinstance(error, NotTake) or path.suffix.lower() != ".csv":
            return f"{error.problem}; {error.remedy}"
    return ""


def writable() -> tuple[Format, ...]:
    """The formats that can be written from any source."""
    return tuple(form for form in FORMATS if form.write is not None)


def endings() -> tuple[str, ...]:
    """The endings of all takes, each once, in the order of the table."""
    return tuple(dict.fromkeys(ending for form in FORMATS for ending in form.endings))


def mime_types() -> tuple[str, ...]:
    """The media types under which the desktop offers FaceEdit, each once."""
    return tuple(dict.fromkeys(form.mime for form in FORMATS if form.mime))


def offered_endings() -> tuple[str, ...]:
    """The endings of files for which the desktop offers FaceEdit, each once."""
    offered = (ending for form in FORMATS if form.mime for ending in form.endings)
    return tuple(dict.fromkeys(offered))


def markdown_table() -> str:
    """The table of formats in the documentation."""
    head = "| format | file | written by |\n|---|---|---|\n"
    rows = (f"| {f.name} | {', '.join(f'`{e}`' for e in f.endings)} | {f.tools} |" for f in FORMATS)
    return head + "\n".join(rows) + "\n"

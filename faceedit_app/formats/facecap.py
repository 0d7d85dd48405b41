"""Face Cap TXT, recorded by the iPhone application of that name.

Lines of cells between commas: `info,...`; `bs,` and the names; then a line a frame, `k,T,` with T
in milliseconds since the start, ten numbers for head and eyes (angles in degrees), and the weights.
"""

from __future__ import annotations

from pathlib import Path

from faceedit_app.core.errors import FileError
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.csv_table import Table, plain_text
from faceedit_app.formats.csv_take import csv_take
from faceedit_app.formats.files import BOM, check_text
from faceedit_app.formats.take import Take

FORMAT = "Face Cap TXT"
_HEAD = 1 << 16
_NAMES, _FRAME = b"bs,", b"k,"
# Names that the file does not have. Face Cap always writes degrees, however far the head turns.
_POSE = (
    *("headX", "headY", "headZ", "headPitch_deg", "headYaw_deg", "headRoll_deg"),
    *("leftEyeX", "leftEyeY", "rightEyeX", "rightEyeY"),
)


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a Face Cap recording."""
    lines = content[:_HEAD].removeprefix(BOM).splitlines()
    names = next((line for line in lines if line.startswith(_NAMES)), b"")
    return 0.95 if any(canonical_channel(plain_text(cell)) for cell in names.split(b",")) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open a Face Cap recording.

    Raises:
        RateNeeded: its times are unusable, and `fps` is None.
        FileError: it is damaged.
    """
    check_text(path, content)
    lines = tuple(content.splitlines(keepends=True))
    header = next(i for i, line in enumerate(lines) if line.removeprefix(BOM).startswith(_NAMES))
    names = [plain_text(cell) for cell in lines[header].rstrip().rstrip(b",").split(b",")[1:]]
    first = next((line for line in lines[header:] if line.startswith(_FRAME)), None)
    if first is None:
        raise FileError(path, "holds no frames", "record the take again", header + 1)
    others = len(first.rstrip().rstrip(b",").split(b",")) - 2 - len(names)
    pose = _POSE if others == len(_POSE) else [f"pose{k + 1}" for k in range(others)]
    columns = ("k", "time_ms", *pose, *names)
    return csv_take(Table(path, lines, header, columns, b",", _FRAME[:1]), fps, FORMAT)

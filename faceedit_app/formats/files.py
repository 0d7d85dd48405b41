"""Read a take's file, and show texts from it in messages."""

from __future__ import annotations

from pathlib import Path

from faceedit_app.core.errors import FileError, reason_of

_LARGEST_FILE = 1 << 30  # an hour at 60 fps is 160 MB
_LONGEST_SHOWN = 40
LONGEST_NAME = 120  # of a column, in a list of them
BOM = b"\xef\xbb\xbf"
CHOOSE_TAKE = "choose a take, such as a Live Link Face CSV"
REPAIR = "correct it or delete the line"


def read_bytes(path: Path, most: int = -1) -> bytes:
    """The content of a file.

    Args:
        most: bytes to read from its beginning; -1 for all.

    Raises:
        FileError: it is missing, a folder, unreadable or too large.
    """
    try:
        if path.is_dir():
            raise FileError(path, "is a folder", "choose a take inside it")
        if not path.exists():
            raise FileError(path, "does not exist", "check the name and the folder")
        if not path.is_file():
            raise FileError(path, "is not a regular file", CHOOSE_TAKE)
        if path.stat().st_size > _LARGEST_FILE:
            raise FileError(path, "is larger than 1 GB", "split the take into shorter ones")
        if most < 0:
            return path.read_bytes()
        with path.open("rb") as file:
            return file.read(most)
    except OSError as error:
        reason = reason_of(error)
        raise FileError(
            path, f"cannot be read ({reason})", "check the file's permissions and its name"
        ) from error


def shown(text: str, longest: int = _LONGEST_SHOWN) -> str:
    """A text from a file, made fit for a message: short and on one line."""
    text = "".join(c if c.isprintable() else "?" for c in text[:longest])
    return text if len(text) < longest else text[:-1] + "…"


def check_text(path: Path, content: bytes) -> None:
    """Check that a file is UTF-8 or ASCII text.

    Raises:
        FileError: it is not.
    """
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise FileError(path, "is UTF-16 text", "save it as UTF-8")
    nul = content.find(b"\0")
    if content[:4] == b"\x89PNG" or 0 <= nul < 1024:
        raise FileError(path, "is not a text file but binary data", CHOOSE_TAKE)
    if nul >= 0:
        line = content.count(b"\n", 0, nul) + 1
        raise FileError(path, "is damaged (zero bytes)", "copy it from the device again", line)
    if not content.removeprefix(BOM).strip():
        raise FileError(path, "is empty", CHOOSE_TAKE)

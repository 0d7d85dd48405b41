"""Files that were cut off, as a copy that broke off leaves them, before it is asked what they are.

What makes them a take may be in the part that is missing.
"""

from __future__ import annotations

import re
import struct
from pathlib import Path

from faceedit_app.core.errors import FileError
from faceedit_app.core.glb import MAGIC, split_glb
from faceedit_app.formats.files import BOM
from faceedit_app.formats.json_text import read_json

_USD = b"#usda"
# Text that is JSON if it is anything: other files also begin with a bracket.
_JSON = re.compile(rb"\s*(?:\{\s*(?:\"|\Z)|\[\s*(?:[\[{\"]|\Z))")
_QUIET = re.compile(rb'"""[\s\S]*?"""|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)*\'|#[^\n]*')
_BRACKETS = (b"{", b"[", b"("), (b"}", b"]", b")")
_AGAIN = "copy or export it again"
_LENGTH = 12  # bytes of a GLB before its chunks


def check_whole(path: Path, content: bytes) -> None:
    """Check that a file in GLB, USD text or JSON is whole.

    Raises:
        FileError: it is cut off, or damaged.
    """
    if content.startswith(MAGIC):
        _check_glb(path, content)
    elif content.startswith(_USD):
        text = _QUIET.sub(b"", content)
        opened, closed = (sum(map(text.count, some)) for some in _BRACKETS)
        if opened > closed or b'"' in text.rpartition(b"\n")[2]:
            line = content.count(b"\n") + 1
            raise FileError(path, "is USD text that is cut off", _AGAIN, line)
    elif _JSON.match(content.removeprefix(BOM)):
        read_json(path, content)


def _check_glb(path: Path, content: bytes) -> None:
    stated = struct.unpack_from("<I", content, 8)[0] if len(content) >= _LENGTH else 0
    if len(content) < max(stated, _LENGTH):
        of = f" of {stated:,}" if stated else ""
        has = f"it has {len(content):,}{of} bytes"
        raise FileError(path, f"is a GLB that is cut off: {has}", _AGAIN)
    try:
        split_glb(content)
    except (ValueError, struct.error):
        raise FileError(path, "is a GLB that is damaged", _AGAIN) from None

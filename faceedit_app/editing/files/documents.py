"""Reading FaceEdit's own JSON files, and saying in one line what is wrong with one."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from faceedit_app.core.errors import FileError


def read_document(path: Path, kind: str, version: int) -> dict[str, Any]:
    """Read a JSON file with a version.

    Args:
        path: the file.
        kind: what it should be, such as "edits file".
        version: the only one that this FaceEdit knows.

    Raises:
        FileError: it cannot be read, is something else, or comes from a later FaceEdit.
    """
    try:
        document = json.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise FileError(
            path, f"cannot be read ({(error.strerror or '').lower()})", "check the path"
        ) from error
    except json.JSONDecodeError as error:
        raise FileError(
            path, f"is not JSON ({error.msg})", f"choose another {kind}", error.lineno
        ) from error
    except (ValueError, RecursionError) as error:  # no UTF-8, or numbers or lists without end
        raise FileError(path, f"is no {kind}", "choose one that FaceEdit saved") from error
    if not isinstance(document, dict):
        raise FileError(path, f"is no {kind}", "choose one that FaceEdit saved")
    if document.get("version") != version:
        raise FileError(
            path,
            f"has version {document.get('version')!r}, this FaceEdit reads version {version}",
            "update FaceEdit",
        )
    return document

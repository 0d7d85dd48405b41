"""Edits files: a list of edits as JSON, for another take or for `faceedit apply`."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.editing.edits.edit import Edit, from_json, to_json
from faceedit_app.editing.files.documents import read_document

VERSION = 1


def write_edits(path: Path | str, edits: Iterable[Edit]) -> None:
    """Save edits as a readable JSON file, one edit a line."""
    lines = ",\n    ".join(json.dumps(to_json(edit)) for edit in edits)
    text = f'{{\n  "version": {VERSION},\n  "edits": [\n    {lines}\n  ]\n}}\n'
    write_atomically(path, text.encode())


def read_edits(path: Path | str) -> tuple[Edit, ...]:
    """Read an edits file.

    Raises:
        FileError: it cannot be read, is no edits file, or an edit in it is not usable.
    """
    path = Path(path)
    document = read_document(path, "edits file", VERSION)
    if not isinstance(document.get("edits"), list):
        raise FileError(path, 'has no list of "edits"', "choose an edits file saved by FaceEdit")
    edits = []
    for number, entry in enumerate(document["edits"], start=1):
        try:
            if not isinstance(entry, dict):
                raise ValueError("it is not an object")
            edits.append(from_json(entry))
        except ValueError as error:
            raise FileError(path, f"edit {number}: {error}", "correct that edit") from error
    return tuple(edits)

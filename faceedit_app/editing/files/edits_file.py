"""Edits files: a list of edits as JSON, for another take or for `faceedit apply`."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from faceedit_app.core.atomic import write_keeping
from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import FieldError, is_document, read_document, to_text
from faceedit_app.editing.edits.edit import Edit, edits_from, to_json

VERSION = 1


def is_edits_file(path: Path) -> bool:
    """Whether a file is a list of edits, of any version, and nothing else, such as a project."""
    return is_document(path, "version", "edits", only=True)


def write_edits(path: Path | str, edits: Iterable[Edit]) -> Path | None:
    """Save edits as a readable JSON file, one edit a line.

    Returns:
        The copy that was kept of a file that was no list of edits; None if there was none.

    Raises:
        FileError: it cannot be written; an existing file is then untouched.
    """
    lines = ",\n    ".join(to_text(to_json(edit)) for edit in edits)
    text = f'{{\n  "version": {VERSION},\n  "edits": [\n    {lines}\n  ]\n}}\n'
    return write_keeping(path, text.encode(), is_edits_file)


def read_edits(path: Path | str) -> tuple[Edit, ...]:
    """Read an edits file.

    Raises:
        FileError: it cannot be read, is not an edits file, or one of its edits is wrong.
    """
    path = Path(path)
    fields = read_document(path, "edits file", VERSION)
    try:
        return edits_from(fields)
    except FieldError as error:
        raise FileError(path, str(error), "correct it, or choose an edits file") from error

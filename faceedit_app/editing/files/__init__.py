"""Project files, edits files, the journal, and fingerprints of takes."""

import re
from pathlib import Path

PROJECT_SUFFIX = ".faceedit"
_KEPT = re.compile(r"\.faceedit\.bak\d*", re.ASCII | re.IGNORECASE)


def is_kept_project(path: Path) -> bool:
    """Whether a file is named as the copy of a project that was replaced: `NAME.faceedit.bak`."""
    return _KEPT.fullmatch("".join(path.suffixes[-2:])) is not None


def is_named_as_project(path: Path) -> bool:
    """Whether a file is named as a project, or as the copy of one that was replaced."""
    return path.suffix.lower() == PROJECT_SUFFIX or is_kept_project(path)

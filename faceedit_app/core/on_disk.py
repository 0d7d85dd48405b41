"""Whether there is a file or folder, for paths that may be anything.

`Path.is_file` and its like raise an error if a name is too long, or if the user may not look into a
folder. Paths come from projects, settings and the command line: here, there is nothing at such one.
"""

from __future__ import annotations

import os
from pathlib import Path


def exists(path: Path) -> bool:
    """Whether there is something at a path."""
    return os.path.exists(path)


def is_file(path: Path) -> bool:
    """Whether there is a regular file at a path."""
    return os.path.isfile(path)


def is_folder(path: Path) -> bool:
    """Whether there is a folder at a path."""
    return os.path.isdir(path)

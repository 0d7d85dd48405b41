"""The libraries that FaceEdit uses, and their licences, from the metadata of their packages.

The installed application carries the metadata of the packages in it, and of no others.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from faceedit_app.core import on_disk

APPLICATION = "faceedit"
TEXTS = "THIRD_PARTY_LICENSES.txt"  # next to the program of the installed application
_SHORT = 60  # characters; anything longer is the licence's text, not its name


@dataclass(frozen=True)
class Library:
    """A package: its name, its version, and the name of its licence."""

    name: str
    version: str
    licence: str


def libraries() -> list[Library]:
    """FaceEdit's dependencies, and theirs, by name; those that are not installed are left out."""
    found: dict[str, Library | None] = {}
    wanted = _needs(APPLICATION)
    while wanted:
        name = wanted.pop()
        if _key(name) in found:
            continue
        try:
            about = metadata.metadata(name)
        except metadata.PackageNotFoundError:  # needed on another system only, or not in the bundle
            found[_key(name)] = None
            continue
        found[_key(name)] = Library(about["Name"], about["Version"], licence_name(about))
        wanted |= _needs(name)
    return sorted(filter(None, found.values()), key=lambda library: library.name.lower())


def licence_name(about: metadata.PackageMetadata) -> str:
    """The name of a package's licence, from its metadata."""
    if expressions := about.get_all("License-Expression"):
        return str(expressions[0])
    lines = "".join(about.get_all("License") or []).strip().splitlines()
    if len(lines) == 1 and len(lines[0]) <= _SHORT:
        return lines[0]
    classifiers = about.get_all("Classifier") or []
    names = [c.rpartition(" :: ")[2] for c in classifiers if c.startswith("License ::")]
    return ", ".join(names) or "see its licence file"


def texts_file() -> Path | None:
    """The full texts of all licences, or None (installed application only)."""
    path = Path(sys.executable).with_name(TEXTS)
    return path if getattr(sys, "frozen", False) and on_disk.is_file(path) else None


def _needs(name: str) -> set[str]:
    """The names of a package's requirements, without those of its extras."""
    try:
        requirements = metadata.requires(name) or []
    except metadata.PackageNotFoundError:  # a checkout that was never installed
        return set()
    return {
        match[0]
        for requirement in requirements
        if "extra ==" not in requirement
        and (match := re.match(r"[A-Za-z0-9][A-Za-z0-9._-]*", requirement))
    }


def _key(name: str) -> str:
    """A package's name without its case and separators, for comparison."""
    return re.sub(r"[-_.]+", "-", name).lower()

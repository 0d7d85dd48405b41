"""The libraries that this installation stands on, and their licences, as their packages say.

The installed application carries the metadata of what is in it, and only of that.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

APPLICATION = "faceedit"
TEXTS = "THIRD_PARTY_LICENSES.txt"  # beside the installed application's program
_SHORT = 60  # characters: a longer licence is its text, not its name


@dataclass(frozen=True)
class Library:
    """One package: its name, its version, and the name of its licence."""

    name: str
    version: str
    licence: str


def libraries() -> list[Library]:
    """What FaceEdit needs, and what that needs in turn, by name; what is absent is left out."""
    found: dict[str, Library | None] = {}
    wanted = _needs(APPLICATION)
    while wanted:
        name = wanted.pop()
        if _key(name) in found:
            continue
        try:
            about = metadata.metadata(name)
        except metadata.PackageNotFoundError:  # for another system, or not in the bundle
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
    """The file with the full texts of all licences; only the installed application has one."""
    path = Path(sys.executable).with_name(TEXTS)
    return path if getattr(sys, "frozen", False) and path.is_file() else None


def _needs(name: str) -> set[str]:
    """What a package requires, without what it requires for extras."""
    try:
        requirements = metadata.requires(name) or []
    except metadata.PackageNotFoundError:  # a source tree that was never installed
        return set()
    return {
        match[0]
        for requirement in requirements
        if "extra ==" not in requirement
        and (match := re.match(r"[A-Za-z0-9][A-Za-z0-9._-]*", requirement))
    }


def _key(name: str) -> str:
    """Names are the same whatever their case and separators."""
    return re.sub(r"[-_.]+", "-", name).lower()

"""The licences of everything in the bundle, in one text.

Each file that goes in is traced to its origin: a distribution from the package index,
Python itself, or a package of the Linux distribution. A file without a licence stops the build.
"""

from __future__ import annotations

import functools
import importlib.metadata as metadata
import re
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Iterable
from email.message import Message
from pathlib import Path
from typing import cast

_LINE = "=" * 78
_LICENCE_FILE = re.compile(
    r"(^|[-_.])(licen[cs]es?|copying|notice|copyright|authors|thirdpartynotices)\b", re.I
)
_COMMON = Path("/usr/share/common-licenses")
# Licence texts that wheels name but do not include.
_SPOKEN_OF = {"LGPL": "LGPL-3", "GPL": "GPL-3"}
OURS = "faceedit"
# What a wheel includes without saying so.
_INSIDE = {
    "av": (
        "The wheel brings FFmpeg (LGPL-2.1-or-later, here built as GPL-2.0-or-later because of\n"
        "x264 and x265, GPL-2.0-or-later), dav1d, libvpx, libwebp, Opus and SVT-AV1 (BSD), LAME\n"
        "(LGPL-2.0-or-later), opencore-amr (Apache-2.0), GnuTLS, Nettle, GMP and libunistring\n"
        "(LGPL). Their sources are named in the releases of PyAV's FFmpeg builds.",
        ("GPL-2", "GPL-3", "LGPL-2.1", "LGPL-3"),
    ),
}


class Unlicensed(Exception):
    """A file of unknown origin, or one that came without a licence."""


def collect(sources: Iterable[Path]) -> str:
    """The text of THIRD_PARTY_LICENSES.

    Args:
        sources: the files that go into the bundle, where they are now.

    Raises:
        Unlicensed: the licence of a file is unknown.
    """
    parts: dict[str, str] = {"PyInstaller (its starter)": _of_distribution("pyinstaller")}
    for source in sorted(set(sources)):
        title, text = _origin(source)
        if title and title not in parts:
            parts[title] = text()
    listing = "\n".join(f"  {title}" for title in sorted(parts, key=str.lower))
    head = f"FaceEdit is under the MIT licence. With it come, each under its own:\n\n{listing}\n"
    bodies = [
        f"\n{_LINE}\n{title}\n{_LINE}\n\n{parts[title].strip()}\n"
        for title in sorted(parts, key=str.lower)
    ]
    return head + "".join(bodies)


def metadata_of(sources: Iterable[Path]) -> list[tuple[str, str, str]]:
    """PyInstaller's entries for the metadata of each distribution in the bundle.

    About lists their licences (`core/licences.py`), without what is left out of the bundle.
    """
    places = {place for source in sources for place in (source.absolute(), source.resolve())}
    names = {name for place, name in _owners().items() if place in places}
    entries = []
    for name in sorted(names):
        for file in metadata.distribution(name).files or []:
            if file.name == "METADATA" and file.parent.suffix == ".dist-info":
                entries.append((file.as_posix(), str(file.locate()), "DATA"))
    return entries


def _origin(source: Path) -> tuple[str, Callable[[], str]]:
    """What a file came with, and how to get the text of its licence; "" for our own files."""
    owner = _owners().get(source.absolute()) or _owners().get(source.resolve())
    if owner is not None:
        if owner == OURS:
            return "", str
        version = metadata.version(owner)
        return f"{owner} {version}", lambda: _of_distribution(owner)
    if (
        source.name == "base_library.zip"
        or source.name.startswith("libpython")
        or any(source.resolve().is_relative_to(folder) for folder in _standard_library())
    ):
        return f"Python {sys.version.split()[0]}", _of_python
    if "stripped" in source.parts:  # a copy made by the build, without its symbols
        place = source.parts[source.parts.index("stripped") + 1]
        if place == "av":
            return f"av {metadata.version('av')}", lambda: _of_distribution("av")
        return f"Python {sys.version.split()[0]}", _of_python
    if sys.platform.startswith("linux"):
        package = _debian_package(source)
        return f"{package} (Debian)", lambda: _of_debian(package)
    raise Unlicensed(f"{source}: of unknown origin")


@functools.cache
def _owners() -> dict[Path, str]:
    """Installed files and the distribution that each came with."""
    found: dict[Path, str] = {}
    for distribution in metadata.distributions():
        name = distribution.metadata["Name"]
        for file in distribution.files or []:
            path = Path(str(distribution.locate_file(file))).absolute()
            found[path] = name
            # As `path.resolve()`, which would ask for each folder on the way to each file again.
            found[path.resolve() if path.is_symlink() else _real(path.parent) / path.name] = name
    return found


@functools.cache
def _real(folder: Path) -> Path:
    return folder.resolve()


@functools.cache
def _standard_library() -> list[Path]:
    return [Path(sysconfig.get_path(key)).resolve() for key in ("stdlib", "platstdlib")]


def _of_distribution(name: str) -> str:
    distribution = metadata.distribution(name)
    about = cast("Message[str, str]", distribution.metadata)  # its protocol lacks `get`
    declared = about.get("License-Expression") or about.get("License") or ""
    classifiers = [c for c in about.get_all("Classifier") or [] if c.startswith("License")]
    head = [declared.strip()] if declared and "\n" not in declared.strip() else classifiers
    texts = [declared] if "\n" in declared.strip() else []
    for file in distribution.files or []:
        if _LICENCE_FILE.search(file.name) and file.suffix not in (".py", ".pyc", ".so"):
            texts.append(Path(str(distribution.locate_file(file))).read_text("utf-8", "replace"))
    if not texts:
        texts = [
            (_COMMON / common).read_text("utf-8")
            for word, common in _SPOKEN_OF.items()
            if (_COMMON / common).exists() and any(word in line for line in head)
        ]
    inside, common = _INSIDE.get(name, ("", ()))
    texts += [(_COMMON / c).read_text("utf-8") for c in common if (_COMMON / c).is_file()]
    if not (head or texts):
        raise Unlicensed(f"{name}: names no licence")
    urls = [f"Source: {u}" for u in about.get_all("Project-URL") or [] if "ource" in u][:1]
    author = about.get("Author") or about.get("Author-email") or ""
    by = [f"By {author}"] if author and not texts else []
    return "\n".join([*head, *by, *urls, inside, "", *dict.fromkeys(texts)])


def _of_python() -> str:
    for folder in (*_standard_library(), Path(sys.base_prefix)):
        for name in ("LICENSE.txt", "LICENSE"):
            if (folder / name).is_file():
                return (folder / name).read_text("utf-8")
    debian = Path(f"/usr/share/doc/python{sys.version_info[0]}.{sys.version_info[1]}/copyright")
    if debian.is_file():
        return debian.read_text("utf-8")
    raise Unlicensed("Python: its licence is not where it usually is")


@functools.cache
def _debian_package(source: Path) -> str:
    """The Debian package of a shared library."""
    for path in dict.fromkeys((str(source), str(source.resolve()), f"/usr{source}")):
        for some in (path, path.removeprefix("/usr")):
            done = subprocess.run(["dpkg-query", "-S", some], capture_output=True, text=True)
            if done.returncode == 0:
                return done.stdout.split(":")[0]
    raise Unlicensed(f"{source}: of unknown origin")


def _of_debian(package: str) -> str:
    path = Path("/usr/share/doc") / package / "copyright"
    if not path.is_file():
        raise Unlicensed(f"{package}: has no copyright file")
    text = path.read_text("utf-8", "replace")
    named = sorted(set(re.findall(r"/usr/share/common-licenses/([\w.+-]+\w)", text)))
    return text + "".join(
        f"\n--- {name}\n\n{(_COMMON / name).read_text('utf-8')}"
        for name in named
        if name.startswith(("LGPL", "MPL")) and (_COMMON / name).is_file()
    )

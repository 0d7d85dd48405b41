"""Build what is downloaded: python packaging/build.py [STEP]...

Steps, all if none is named: `bundle` (the application as a folder, PyInstaller), `archive` (the
folder packed: tar.xz, on Windows and macOS zip), `deb` (Debian and Ubuntu). Run it in an
environment where FaceEdit is installed from its wheel; `make package` sets one up.
"""

from __future__ import annotations

import os
import platform
import re
import shutil
import subprocess
import sys
import tarfile
import time
from pathlib import Path

import icons

import faceedit_app
from faceedit_app import __version__
from faceedit_app.formats.registry import mime_types, offered_endings

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
MADE, DIST = ROOT / "build" / "packaging", ROOT / "dist"
BUNDLE = DIST / "faceedit"
ICON_SIZES = (16, 24, 32, 48, 64, 128, 256, 512)
LINUX = sys.platform.startswith("linux")
# In the registry of Windows, for each ending.
OPEN_WITH = (
    r'Root: HKA; Subkey: "Software\Classes\{}\OpenWithProgids"; ValueType: string; '
    'ValueName: "FaceEdit.Project"; ValueData: ""; Flags: uninsdeletevalue'
)

# Packages with the libraries that the bundle leaves to the system, see contents.OF_THE_SYSTEM.
DEPENDS = (
    "libc6 (>= {glibc})",
    "libstdc++6",
    "libgcc-s1",
    "zlib1g",
    "libzstd1",
    "libexpat1",
    "libx11-6",
    "libx11-xcb1",
    "libxcb1",
    "libxext6",
    "libxrender1",  # pyglet, which pyrender imports, opens it by name
    "libfontconfig1",
    "libfreetype6",
    "libdbus-1-3",
    "libglib2.0-0 | libglib2.0-0t64",
    "libwayland-client0",
    "libwayland-cursor0",
    "libwayland-egl1",
    "libegl1",
    "libgl1",
    "libgl1-mesa-dri",
    "fonts-dejavu-core | fonts-liberation | ttf-bitstream-vera",
)


def bundle() -> None:
    """The application as a folder in dist/faceedit (dist/FaceEdit.app on macOS)."""
    import PyInstaller.__main__

    if Path(faceedit_app.__file__).is_relative_to(ROOT / "faceedit_app"):
        raise SystemExit("install FaceEdit's wheel first; this one is the source tree")
    icons.write_icons(MADE / "icons")
    options = ["--noconfirm", "--log-level=WARN"]
    folders = [f"--distpath={DIST}", f"--workpath={MADE / 'work'}"]
    PyInstaller.__main__.run([*options, *folders, str(HERE / "faceedit.spec")])
    shutil.copy(ROOT / "LICENSE", BUNDLE / "LICENSE")
    shutil.copy(MADE / "THIRD_PARTY_LICENSES.txt", BUNDLE)
    if sys.platform == "win32":
        (MADE / "faceedit.iss").write_text(_described("windows/faceedit.iss.in"), "utf-8")
    _say(BUNDLE)


def archive() -> None:
    """The folder as an archive, to be unpacked and started anywhere."""
    name = f"FaceEdit-{__version__}-{_system()}-{platform.machine().lower()}"
    if not LINUX:
        packed = DIST / ("FaceEdit.app" if sys.platform == "darwin" else "faceedit")
        _say(Path(shutil.make_archive(str(DIST / name), "zip", DIST, packed.name)))
        return
    folder = _fresh(MADE / name)
    _install(folder)
    shutil.copy(HERE / "linux" / "AppRun", folder)
    (folder / "faceedit.desktop").write_text(_described("linux/faceedit.desktop.in"), "utf-8")
    shutil.copy(MADE / "icons" / "faceedit-256.png", folder / "faceedit.png")
    (folder / ".DirIcon").symlink_to("faceedit.png")
    packages = " ".join(d.split()[0] for d in DEPENDS)
    readme = (HERE / "linux" / "README.txt").read_text("utf-8").replace("@PACKAGES@", packages)
    (folder / "README.txt").write_text(readme, "utf-8")
    target = DIST / f"{name}.tar.xz"
    with tarfile.open(target, "w:xz", preset=6) as tar:
        tar.add(folder, name, filter=_as_root)
    _say(target)


def deb() -> None:
    """The package for Debian and Ubuntu."""
    arch = subprocess.run(
        ["dpkg", "--print-architecture"], capture_output=True, text=True, check=True
    ).stdout.strip()
    folder = _fresh(MADE / "deb")
    _install(folder)
    (folder / "usr/bin").mkdir(parents=True)
    (folder / "usr/bin/faceedit").symlink_to("/opt/faceedit/faceedit")
    notes = folder / "usr/share/doc/faceedit"
    notes.mkdir(parents=True)
    for source in (BUNDLE / "LICENSE", BUNDLE / "THIRD_PARTY_LICENSES.txt"):
        with (notes / "copyright").open("ab") as file:
            file.write(source.read_bytes() + b"\n")
    size = sum(p.lstat().st_size for p in folder.rglob("*") if not p.is_symlink()) // 1024
    control = {
        "Package": "faceedit",
        "Version": __version__,
        "Architecture": arch,
        "Maintainer": "The FaceEdit founders <faceedit@localhost>",
        "Installed-Size": str(size),
        "Section": "graphics",
        "Priority": "optional",
        "Depends": ", ".join(DEPENDS).format(glibc=_glibc()),
        "Recommends": "libegl-mesa0, libportaudio2, xdg-desktop-portal",
        "Suggests": "libosmesa6",
        "Description": "edit tracked facial animation by dragging plain curves\n"
        " Opens the take that Live Link Face on a phone writes, and shows a few curves\n"
        " instead of 52 blendshapes. Drag one, and the face moves as a real face would.\n"
        " Everything that no edit touches is exported byte for byte as it came.",
    }
    (folder / "DEBIAN").mkdir()
    text = "".join(f"{key}: {value}\n" for key, value in control.items())
    (folder / "DEBIAN" / "control").write_text(text, "utf-8")
    for path in [folder, *folder.rglob("*")]:
        if not path.is_symlink():
            path.chmod(0o755 if path.is_dir() or os.access(path, os.X_OK) else 0o644)
    target = DIST / f"faceedit_{__version__}_{arch}.deb"
    build = ["dpkg-deb", "--root-owner-group", "-Zxz", "--build", str(folder), str(target)]
    subprocess.run(build, check=True, stdout=subprocess.DEVNULL)
    _say(target)


def _install(folder: Path) -> None:
    """The bundle and its desktop files, under a root folder."""
    shutil.copytree(BUNDLE, folder / "opt/faceedit", symlinks=True)
    share = folder / "usr/share"
    _copy(HERE / "linux" / "faceedit.mime.xml", share / "mime/packages/faceedit.xml")
    for source, place in (
        ("linux/faceedit.desktop.in", "applications/faceedit.desktop"),
        ("linux/faceedit.metainfo.xml.in", "metainfo/org.faceedit.FaceEdit.metainfo.xml"),
    ):
        (share / place).parent.mkdir(parents=True)
        (share / place).write_text(_described(source), "utf-8")
    for size in ICON_SIZES:
        icon = share / f"icons/hicolor/{size}x{size}/apps/faceedit.png"
        _copy(MADE / "icons" / f"faceedit-{size}.png", icon)
    _copy(MADE / "icons" / "faceedit.svg", share / "icons/hicolor/scalable/apps/faceedit.svg")


def describe(text: str) -> str:
    """What a desktop or an installer reads about FaceEdit, completed.

    Version and date come from the newest release in the changelog, media types and endings from
    the formats that FaceEdit reads.
    """
    changes = (ROOT / "CHANGELOG.md").read_text("utf-8")
    dates = dict(re.findall(r"^## \[?([\w.]+)\]? - (\d{4}-\d\d-\d\d)$", changes, re.M))
    date = dates.get(__version__, time.strftime("%Y-%m-%d"))
    types = mime_types()
    for token, value in {
        "@VERSION@": __version__,
        "@DATE@": date,
        "@MIME_TYPES@": ";".join(types),
        "@MEDIA_TYPES@": "\n    ".join(f"<mediatype>{name}</mediatype>" for name in types),
        "@OPEN_WITH@": "\n".join(OPEN_WITH.format(ending) for ending in offered_endings()),
    }.items():
        text = text.replace(token, value)
    return text


def _described(name: str) -> str:
    return describe((HERE / name).read_text("utf-8"))


def _glibc() -> str:
    """The newest version of the C library that a file of the bundle needs."""
    wanted = {(2, 28)}
    for path in BUNDLE.rglob("*"):
        if path.is_file() and (".so" in path.name or path.name == "faceedit"):
            found = re.findall(rb"GLIBC_(\d+)\.(\d+)", path.read_bytes())
            wanted |= {(int(major), int(minor)) for major, minor in found}
    return ".".join(map(str, max(wanted)))


def _system() -> str:
    return {"win32": "windows", "darwin": "macos"}.get(sys.platform, "linux")


def _fresh(folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(source, target)


def _as_root(entry: tarfile.TarInfo) -> tarfile.TarInfo:
    entry.uid = entry.gid = 0
    entry.uname = entry.gname = "root"
    return entry


def _say(path: Path) -> None:
    files = [path] if path.is_file() else [p for p in path.rglob("*") if not p.is_symlink()]
    size = sum(p.stat().st_size for p in files if p.is_file())
    print(f"{path.relative_to(ROOT)}: {size / 1e6:.1f} MB", flush=True)


STEPS = {"bundle": bundle, "archive": archive} | ({"deb": deb} if LINUX else {})

if __name__ == "__main__":
    asked = sys.argv[1:] or list(STEPS)
    if unknown := set(asked) - set(STEPS):
        raise SystemExit(f"{', '.join(sorted(unknown))}: must be {', '.join(STEPS)}")
    for step in asked:
        STEPS[step]()

"""What goes into the bundled application, and what stays out of it."""

from __future__ import annotations

import fnmatch
import pkgutil
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pygments.lexers

from faceedit_app.formats.registry import offered_endings

Entry = tuple[str, str, str]  # PyInstaller's: name in the bundle, file or link's target, kind

# Chosen by name at run time, or imported as modules of `render/pyrender_parts`, where PyInstaller
# cannot see it.
HIDDEN = [
    "OpenGL.platform.egl",
    "OpenGL.platform.osmesa",
    "OpenGL.platform.glx",
    "OpenGL.osmesa",
    "pyrender",
]

# All but what trimesh and the registration of scans need, and what that needs itself.
UNUSED_SCIPY = [
    "cluster",
    "datasets",
    "differentiate",
    "fftpack",
    "integrate",
    "io",
    "odr",
    "signal",
    "stats",
]

# rich, which prints the help, could colour the code of any language.
UNUSED_LEXERS = [
    lexer.name
    for lexer in pkgutil.iter_modules(pygments.lexers.__path__)
    if lexer.name not in ("_mapping", "python", "special")
]

EXCLUDED = [
    # The laboratory stays with pip: torch alone is twice the rest of the application.
    "torch",
    "onnx",
    "faceedit_app.lab",
    # ONNX Runtime includes tools for making models; the application only runs them.
    "onnxruntime.backend",
    "onnxruntime.datasets",
    "onnxruntime.quantization",
    "onnxruntime.tools",
    "onnxruntime.transformers",
    # FaceEdit and the parts of trimesh that it uses work without these.
    *(f"scipy.{part}" for part in UNUSED_SCIPY),
    *(f"pygments.lexers.{name}" for name in UNUSED_LEXERS),
    # pyrender, trimesh, networkx and pyqtgraph use these if they are there; FaceEdit does not.
    "matplotlib",
    "IPython",
    "setuptools",
    "tkinter",
    "PySide6.QtNetwork",
    "PySide6.QtTest",
    "PySide6.QtDBus",
    "PIL._avif",
    "PIL._imagingcms",
    "PIL._imagingft",
    "PIL._imagingtk",
    "PIL.ImageTk",
    # Nothing is fetched; Python's own hashes are enough.
    "ssl",
    "_ssl",
    "_hashlib",
    # GPL, and only for typing at a prompt.
    "readline",
]

# Plug-ins of Qt for kiosks, networks, picture formats and languages that FaceEdit does not use.
UNWANTED = [
    "*/plugins/egldeviceintegrations/*",
    "*/plugins/generic/*",
    "*/plugins/networkinformation/*",
    "*/plugins/tls/*",
    "*/plugins/platforms/*q[elmv]*",  # eglfs, linuxfb, minimal, vnc, vkkhrdisplay
    "*/plugins/platformthemes/libqgtk3*",  # file dialogs come through the desktop portal
    "*/plugins/imageformats/*q[!s]*",  # all but SVG; PNG is built in
    "*/translations/*",
    # pyrender's letters and demonstration shapes.
    "pyrender/fonts/*",
    "pyrender/models/*",
    # For dictation; words that are typed need none.
    "pocketsphinx/model/*.lm.bin",
]

# The graphics driver of the user's machine is loaded into the application, and needs these in the
# machine's own version, which is newer than ours. Each desktop has them.
OF_THE_SYSTEM = [
    "libstdc++.so.*",
    "libgcc_s.so.*",
    "libz.so.*",
    "libzstd.so.*",
    "libexpat.so.*",
    "libX11.so.*",
    "libX11-xcb.so.*",
    "libxcb.so.*",
    "libXau.so.*",
    "libXdmcp.so.*",
    "libXext.so.*",
    "libbsd.so.*",
    "libmd.so.*",
    "libdrm.so.*",
    "libwayland-*.so.*",
    "libfontconfig.so.*",
    "libfreetype.so.*",
    "libuuid.so.*",
    "libdbus-1.so.*",
    "libglib-2.0.so.*",
    "libgthread-2.0.so.*",
    "libgobject-2.0.so.*",
    "libgio-2.0.so.*",
    "libgmodule-2.0.so.*",
    "libsystemd.so.*",
    "libudev.so.*",
    # Those that only these load.
    "libgcrypt.so.*",
    "libgpg-error.so.*",
    "libpcre2-8.so.*",
    "liblz4.so.*",
    "libcap.so.*",
]


# Wheels whose libraries come with debugging symbols: 23 MB in PyAV, 15 MB in the others.
_UNSTRIPPED = (
    "libpython",
    "av/",
    "DracoPy",
    "ai_edge_litert/",
    "PIL/",
    "PySide6/",
    "scipy/optimize/",
)


def is_wanted(name: str) -> bool:
    """Whether a file belongs in the bundle, by its name there."""
    name = name.replace("\\", "/")
    if "/" not in name and any(fnmatch.fnmatch(name, pattern) for pattern in OF_THE_SYSTEM):
        return False
    return not any(fnmatch.fnmatch(name, pattern) for pattern in UNWANTED)


def _is_library(name: str) -> bool:
    """A library that only others load: neither a Python module nor a plug-in."""
    base = name.rpartition("/")[2]
    named = re.match(r"lib.*\.so(\.|$)", base) and not base.startswith("libpython")
    return bool(named) and "/plugins/" not in name


def without_orphans(binaries: list[Entry]) -> list[Entry]:
    """Leave out the libraries that nothing in the bundle loads any more (Linux)."""
    from PyInstaller.depend.bindepend import get_imports

    files = {name: source for name, source, kind in binaries if kind != "SYMLINK"}
    by_base: dict[str, list[str]] = {}
    for name in files:
        by_base.setdefault(name.rpartition("/")[2], []).append(name)
    kept = {name for name in files if not _is_library(name)}
    fresh = list(kept)
    while fresh:
        for wanted, _ in get_imports(files[fresh.pop()]):
            found = set(by_base.get(Path(wanted).name, [])) - kept
            kept |= found
            fresh += found
    # These are opened by name: by ctypes, and by ONNX Runtime, which warns where it is missing.
    by_name = ("freetype/", "/libonnxruntime_providers_shared")
    kept |= {name for name in files if any(part in name for part in by_name)}
    whole = [e for e in binaries if e[2] != "SYMLINK" and e[0] in kept]
    return whole + without_dangling([e for e in binaries if e[2] == "SYMLINK"], whole)


def without_dangling(entries: list[Entry], binaries: list[Entry]) -> list[Entry]:
    """Leave out links to libraries that are not in the bundle."""
    there = {name for name, _, kind in binaries if kind != "SYMLINK"}
    return [
        (name, target, kind)
        for name, target, kind in entries
        if kind != "SYMLINK" or str(Path(name).parent / target) in there
    ]


def stripped(entry: Entry, folder: Path) -> Entry:
    """Python's own libraries, and those of a few wheels, without their debugging symbols.

    Only those: the libraries in other wheels are stripped already, and some that were patched for
    the wheel do not survive it.
    """
    name, source, kind = entry
    ours = name.startswith(_UNSTRIPPED) or "/lib-dynload/" in name
    if not ours or kind == "SYMLINK" or not shutil.which("strip"):
        return entry
    copy = folder / name
    copy.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, copy)
    copy.chmod(0o755)
    subprocess.run(["strip", "--strip-unneeded", str(copy)], check=True)
    return name, str(copy), kind


def windows_version(version: str, name: str) -> Any:
    """What Windows shows under Properties > Details."""
    from PyInstaller.utils.win32 import versioninfo as win

    numbers = tuple(int(part) for part in re.findall(r"\d+", version)[:3])
    numbers = (*numbers, *(0,) * (4 - len(numbers)))
    texts = {
        "FileDescription": "FaceEdit",
        "ProductName": "FaceEdit",
        "ProductVersion": version,
        "FileVersion": version,
        "OriginalFilename": f"{name}.exe",
        "LegalCopyright": "MIT licence, the FaceEdit founders",
    }
    strings = [win.StringStruct(key, text) for key, text in texts.items()]
    return win.VSVersionInfo(
        ffi=win.FixedFileInfo(filevers=numbers, prodvers=numbers),
        kids=[
            win.StringFileInfo([win.StringTable("040904B0", strings)]),
            win.VarFileInfo([win.VarStruct("Translation", [1033, 1200])]),
        ],
    )


def macos_properties(version: str) -> dict[str, Any]:
    """The application's Info.plist: what it is, and which documents it opens."""
    return {
        "CFBundleDisplayName": "FaceEdit",
        "CFBundleShortVersionString": version,
        "NSHighResolutionCapable": True,
        "NSHumanReadableCopyright": "MIT licence, the FaceEdit founders",
        "LSMinimumSystemVersion": "12.0",
        "UTExportedTypeDeclarations": [
            {
                "UTTypeIdentifier": "org.faceedit.project",
                "UTTypeDescription": "FaceEdit project",
                "UTTypeConformsTo": ["public.data"],
                "UTTypeTagSpecification": {"public.filename-extension": ["faceedit"]},
            }
        ],
        "CFBundleDocumentTypes": [
            {
                "CFBundleTypeName": "FaceEdit project",
                "CFBundleTypeRole": "Editor",
                "LSHandlerRank": "Owner",
                "LSItemContentTypes": ["org.faceedit.project"],
            },
            {
                "CFBundleTypeName": "Facial animation",
                "CFBundleTypeRole": "Editor",
                "LSHandlerRank": "Alternate",
                "CFBundleTypeExtensions": [ending.lstrip(".") for ending in offered_endings()],
            },
        ],
    }

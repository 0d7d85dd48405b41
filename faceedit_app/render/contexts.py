"""Choose an OpenGL backend, or say why there is none."""

from __future__ import annotations

import ctypes
import os
import sys
from typing import Any

from faceedit_app.core.errors import Unavailable

_VARIABLE = "PYOPENGL_PLATFORM"
_LINUX_REMEDY = (
    'on Debian or Ubuntu: "apt install libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri libxrender1"'
)
_OTHER_REMEDY = "update the driver of the graphics card"


def unavailable(reason: str) -> Unavailable:
    """The error for a computer without OpenGL, in one line."""
    remedy = _LINUX_REMEDY if sys.platform.startswith("linux") else _OTHER_REMEDY
    short = " ".join(reason.split())[:200] or "no reason given"
    return Unavailable(f"The face cannot be drawn: {short}; {remedy}")


def choose_backend() -> str:
    """Choose a backend, and set PyOpenGL's environment before it is imported.

    An explicit PYOPENGL_PLATFORM wins. On Linux: EGL where it finds a device, else OSMesa. On
    Windows and macOS: "" for pyrender's own choice, a hidden pyglet window, which needs a desktop
    session.

    Raises:
        Unavailable: Linux without EGL devices and without OSMesa.
    """
    chosen = os.environ.get(_VARIABLE, "")
    if chosen or not sys.platform.startswith("linux"):
        return chosen
    if egl_devices() > 0:
        chosen = "egl"
    elif _load("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so") is not None:
        chosen = "osmesa"
    else:
        raise unavailable("no OpenGL was found on this computer")
    os.environ[_VARIABLE] = chosen
    return chosen


def platform_class(backend: str) -> Any:
    """The pyrender `Platform` class for a backend from `choose_backend`.

    Raises:
        Exception: any error of PyOpenGL, if the backend is missing.
    """
    # Imported only when needed: on other systems the import itself fails.
    if backend == "egl":
        from faceedit_app.render.egl import SharedDisplayEgl

        return SharedDisplayEgl
    if backend == "osmesa":
        from faceedit_app.render.osmesa import OSMesaWithFramebuffers

        return OSMesaWithFramebuffers
    from faceedit_app.render.pyrender_parts.platforms.pyglet_platform import PygletPlatform

    return PygletPlatform


def open_platform(backend: str, width: int, height: int) -> Any:
    """A platform with a live context, made current.

    Raises:
        Exception: any error of the driver or PyOpenGL; `open_renderer` turns it into one line.
    """
    platform = platform_class(backend)(width, height)
    platform.init_context()
    platform.make_current()
    return platform


def drawn_by() -> str:
    """What draws, as OpenGL calls it: a graphics card, or a program (llvmpipe).

    Raises:
        Unavailable: this computer offers no OpenGL.
        Exception: any error of the driver or PyOpenGL.
    """
    platform = open_platform(choose_backend(), 8, 8)
    from OpenGL import GL  # for the backend that has been chosen

    try:
        return str(GL.glGetString(GL.GL_RENDERER).decode(errors="replace"))
    finally:
        platform.delete_context()


def may_change_threads(backend: str) -> bool:
    """Whether a context can be made in one thread and used in another; a window's cannot."""
    return backend == "egl"


def egl_devices() -> int:
    """The number of EGL devices, without importing PyOpenGL."""
    library = _load("libEGL.so.1")
    if library is None:
        return 0
    library.eglGetProcAddress.restype = ctypes.c_void_p
    address = library.eglGetProcAddress(b"eglQueryDevicesEXT")
    if not address:
        return 0
    query = ctypes.CFUNCTYPE(
        ctypes.c_uint, ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_int)
    )(address)
    count = ctypes.c_int(0)
    return count.value if query(0, None, ctypes.byref(count)) else 0


def _load(*names: str) -> ctypes.CDLL | None:
    for name in names:
        try:
            return ctypes.CDLL(name)
        except OSError:
            continue
    return None

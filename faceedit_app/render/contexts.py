"""Where OpenGL comes from: choosing a backend, and saying why there is none."""

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
    """The one line for a machine without OpenGL."""
    remedy = _LINUX_REMEDY if sys.platform.startswith("linux") else _OTHER_REMEDY
    short = " ".join(reason.split())[:200] or "no reason given"
    return Unavailable(f"The face cannot be drawn: {short}; {remedy}")


def choose_backend() -> str:
    """Name the backend, and tell PyOpenGL before it is imported.

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
    """The class of pyrender's `Platform` for what `choose_backend` has named.

    Raises:
        Exception: whatever PyOpenGL raises where the backend is not there.
    """
    # Each is imported only where it is wanted: on other systems the import alone fails.
    if backend == "egl":
        from faceedit_app.render.egl import SharedDisplayEgl

        return SharedDisplayEgl
    if backend == "osmesa":
        from faceedit_app.render.osmesa import OSMesaWithFramebuffers

        return OSMesaWithFramebuffers
    from pyrender.platforms.pyglet_platform import PygletPlatform

    return PygletPlatform


def open_platform(backend: str, width: int, height: int) -> Any:
    """A platform with a live context, made current.

    Raises:
        Exception: whatever the driver or PyOpenGL raises; `open_renderer` turns it into a line.
    """
    platform = platform_class(backend)(width, height)
    platform.init_context()
    platform.make_current()
    return platform


def egl_devices() -> int:
    """How many devices EGL offers, asked without importing PyOpenGL."""
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

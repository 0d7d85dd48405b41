"""An EGL context that shares its display with others in the process.

Imports PyOpenGL: `contexts.choose_backend` comes first.
"""

from __future__ import annotations

import ctypes
from typing import Any

from OpenGL import EGL

from faceedit_app.render.pyrender_parts.platforms.egl import EGLPlatform


class SharedDisplayEgl(EGLPlatform):  # type: ignore[misc]  # pyrender has no types
    """pyrender's EGL platform, except that closing one context leaves the others alive.

    pyrender ends with `eglTerminate`, which ends every context on the device's display.
    """

    _display: Any = None
    _context: Any = None
    _address: int | None = None

    def init_context(self) -> None:
        """Create the context and make it current."""
        super().init_context()
        self._display, self._context = EGL.eglGetCurrentDisplay(), EGL.eglGetCurrentContext()
        self._address = _current()

    def make_current(self) -> None:
        """Make the context current unless it is; pyrender calls this several times per picture."""
        if self._address is None or _current() != self._address:
            super().make_current()

    def release(self) -> None:
        """Let another thread make the context current; pyrender's `make_uncurrent` does nothing."""
        nothing = EGL.EGL_NO_SURFACE
        EGL.eglMakeCurrent(self._display, nothing, nothing, EGL.EGL_NO_CONTEXT)

    def delete_context(self) -> None:
        """Free this context; the display stays open for the others."""
        if self._context is not None:
            EGL.eglDestroyContext(self._display, self._context)
            self._context = None


def _current() -> int | None:
    return ctypes.cast(EGL.eglGetCurrentContext(), ctypes.c_void_p).value

"""An EGL context that shares its display with others in the process.

Imported only after `contexts.choose_backend`, because it imports PyOpenGL.
"""

from __future__ import annotations

from typing import Any

from OpenGL import EGL
from pyrender.platforms.egl import EGLPlatform


class SharedDisplayEgl(EGLPlatform):  # type: ignore[misc]  # pyrender has no types
    """pyrender's EGL platform, except that closing one context leaves the others alive.

    pyrender ends with `eglTerminate`, which ends every context on the device's display.
    """

    _egl_display: Any
    _egl_context: Any

    def delete_context(self) -> None:
        """Free this context, once another is current; the display stays open."""
        if self._egl_context is not None:
            EGL.eglDestroyContext(self._egl_display, self._egl_context)
            self._egl_context = None

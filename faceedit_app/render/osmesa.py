"""OpenGL in software without EGL. Imports PyOpenGL: `contexts.choose_backend` comes first."""

from __future__ import annotations

from faceedit_app.render.pyrender_parts.platforms.osmesa import OSMesaPlatform


class OSMesaWithFramebuffers(OSMesaPlatform):  # type: ignore[misc]  # pyrender has no types
    """pyrender's OSMesa platform, with framebuffers.

    pyrender assumes that OSMesa has none, but it has had them for years; without them every change
    of size would need a new context.
    """

    def supports_framebuffers(self) -> bool:
        """Yes."""
        return True

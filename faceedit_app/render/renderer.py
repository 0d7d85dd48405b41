"""Draw the face as an image: open a renderer, draw, close."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from faceedit_app.core.arrays import Floats, Pixels
from faceedit_app.core.errors import Unavailable
from faceedit_app.core.rig import Rig
from faceedit_app.render import contexts
from faceedit_app.render.camera import Camera, default_camera

_SMALL = 64  # pixels
_SAMPLES = 4  # for each pixel of a smooth image
SLATE = (0x25 / 255, 0x28 / 255, 0x2F / 255)


class FaceRenderer:
    """Draws one character offscreen.

    Create, use and close it in one thread, unless it comes from `open_ahead`. A process may have
    several: each makes its own OpenGL context current when it works, and closing one leaves the
    others intact.

    Args:
        rig: the character; its faces, colours and materials are uploaded once.
        width, height: pixels.
        background: the colour in the middle of the backdrop, sRGB, 0..1.

    Attributes:
        rig: the character.
        fine: whether small smooth images get more samples, which takes longer.
        doubled: whether images that are not smooth are drawn at twice their width and height, which
            makes edges smoother.

    Raises:
        Unavailable: this computer offers no OpenGL.
    """

    def __init__(
        self,
        rig: Rig,
        width: int,
        height: int,
        background: tuple[float, float, float] = SLATE,
    ) -> None:
        self.rig = rig
        self.fine, self.doubled = True, False
        self._studio: Any = None
        self._image: Pixels = _image(width, height)
        backend = contexts.choose_backend()
        try:
            from faceedit_app.render.studio import Studio

            self._studio = Studio(rig, background, backend, width, height)
        except Exception as error:  # drivers and PyOpenGL raise all kinds
            self.close()
            raise contexts.unavailable(str(error) or type(error).__name__) from error

    def resize(self, width: int, height: int) -> None:
        """Change the size of the images, in pixels."""
        if self._image.shape[:2] != (height, width):
            self._image = _image(width, height)

    def draw(
        self, vertices: Floats, camera: Camera, smooth: bool = True, tint: Floats | None = None
    ) -> Pixels:
        """Draw an image of the face: `begin`, then `finish`."""
        self.begin(vertices, camera, smooth, tint)
        return self.finish()

    def begin(
        self, vertices: Floats, camera: Camera, smooth: bool = True, tint: Floats | None = None
    ) -> None:
        """Start drawing an image, and return at once so that other work can be done meanwhile.

        Args:
            vertices: (V, 3) float32, metres: `rig.vertices(weights)`, perhaps turned as a whole.
            camera: the camera.
            smooth: antialias edges; turn off while dragging or playing.
            tint: (V,) float32 in 0..1, such as `difference.tint_of(…)`; None = no tint.

        Raises:
            Unavailable: the renderer is closed.
        """
        if self._studio is None:
            raise _closed()
        height, width = self._image.shape[:2]
        samples = _SAMPLES if smooth else 0
        self._studio.begin(vertices, camera, width, height, samples, tint, self.fine, self.doubled)

    def finish(self) -> Pixels:
        """Wait for the image that was begun last, at its size.

        Returns:
            (H, W, 4) uint8, contiguous, BGRA with the top row first (QImage.Format_RGB32 takes it
            as it is). The buffer is reused: the next image overwrites it, so copy it to keep
            it. After `resize` there is a new buffer, and the old one stays unchanged.
        """
        if self._studio is None:
            raise _closed()
        self._studio.finish(self._image)
        return self._image

    def prepare(self) -> None:
        """Prepare the next picture, for the same camera.

        Call it after `finish`. It is optional: without it, the next picture takes a little longer.
        """
        if self._studio is not None:
            self._studio.prepare(self.doubled)

    def release(self) -> None:
        """Let another thread use it, if `contexts.may_change_threads`."""
        if self._studio is not None:
            self._studio.release()

    @property
    def shade(self) -> Floats:
        """(V,) float32 in 0..1, the share of the light from above that reaches each vertex.

        Raises:
            Unavailable: the renderer is closed.
        """
        if self._studio is None:
            raise _closed()
        shade: Floats = self._studio.shade
        return shade

    def close(self) -> None:
        """Free the graphics memory; calling it again does nothing."""
        if self._studio is not None:
            self._studio.delete()
            self._studio = None


def shade_of(rig: Rig) -> Floats:
    """Compute the shade of a character again, for `Rig.shade`: (V,) float32 in 0..1.

    Raises:
        Unavailable: this computer offers no OpenGL.
    """
    renderer = FaceRenderer(replace(rig, shade=None), 1, 1)
    try:
        return renderer.shade
    finally:
        renderer.close()


def open_renderer(rig: Rig, width: int, height: int) -> FaceRenderer:
    """Open a renderer on the OpenGL of this computer.

    On Linux that is EGL, else OSMesa; both work without a display. On Windows and macOS it is
    pyrender's default, a hidden pyglet window, which needs a desktop session. PYOPENGL_PLATFORM
    overrides the choice, if it is set before the first renderer is opened.

    Raises:
        Unavailable: there is none; the text gives the reason and the remedy in one line.
    """
    return FaceRenderer(rig, width, height)


def open_ahead(rig: Rig) -> FaceRenderer | None:
    """Open a renderer in one thread for another one to use, and let it draw a first picture.

    That compiles the shaders, which takes software OpenGL a quarter of a second, in which other
    threads can work.

    Returns:
        The renderer, or None if it has to be opened in the thread that uses it.

    Raises:
        Unavailable: this computer offers no OpenGL.
    """
    if not contexts.may_change_threads(contexts.choose_backend()):
        return None
    renderer = FaceRenderer(rig, _SMALL, _SMALL)
    try:
        camera = default_camera(rig, 1.0)
        for _ in range(2):  # the second is drawn on still parts that were kept
            renderer.draw(rig.neutral, camera, smooth=False)
        renderer.release()
    except Exception as error:  # drivers and PyOpenGL raise all kinds
        renderer.close()
        raise contexts.unavailable(str(error) or type(error).__name__) from error
    return renderer


def _image(width: int, height: int) -> Pixels:
    return np.zeros((max(height, 1), max(width, 1), 4), np.uint8)


def _closed() -> Unavailable:
    return Unavailable("The face cannot be drawn: its viewport is closed; open it again")

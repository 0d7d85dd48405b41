"""Framebuffers to draw into. Imports PyOpenGL: `contexts.choose_backend` comes first."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from OpenGL import GL

from faceedit_app.core.arrays import Floats, Pixels
from faceedit_app.render.camera import Camera

_BYTES = 8  # of a sample: its colour and its depth


class View(NamedTuple):
    """The camera of a picture, and its width and height in pixels."""

    camera: Camera
    size: tuple[int, int]


class Target:
    """A framebuffer of one size, with one or several samples per pixel.

    pyrender's renderer has two of them, one of which always takes four samples.
    """

    def __init__(self, width: int, height: int, samples: int) -> None:
        self.size, self.samples = (width, height), samples
        self._buffers = [int(b) for b in GL.glGenRenderbuffers(2)]
        for buffer, kind in zip(self._buffers, (GL.GL_RGBA8, GL.GL_DEPTH_COMPONENT24), strict=True):
            GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, buffer)
            GL.glRenderbufferStorageMultisample(GL.GL_RENDERBUFFER, samples, kind, width, height)
        self._name = int(GL.glGenFramebuffers(1))
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._name)
        for buffer, place in zip(
            self._buffers, (GL.GL_COLOR_ATTACHMENT0, GL.GL_DEPTH_ATTACHMENT), strict=True
        ):
            GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, place, GL.GL_RENDERBUFFER, buffer)
        status = GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER)
        if status != GL.GL_FRAMEBUFFER_COMPLETE:
            raise RuntimeError(f"the driver refuses a {width} x {height} image")

    @property
    def bytes(self) -> int:
        """What its colours and depths take."""
        width, height = self.size
        return width * height * max(self.samples, 1) * _BYTES

    def bind(self) -> None:
        """Draw into this target from now on."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._name)
        GL.glViewport(0, 0, *self.size)

    def copy_to(self, other: Target, depths: bool = False) -> None:
        """Copy the colours, with samples resolved, and optionally the depths.

        A target without samples may be copied to one of half its size, without the depths: a pixel
        is then the mean of four.
        """
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, self._name)
        GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, other._name)
        what = GL.GL_COLOR_BUFFER_BIT | (GL.GL_DEPTH_BUFFER_BIT if depths else 0)
        how = GL.GL_NEAREST if other.size == self.size else GL.GL_LINEAR
        GL.glBlitFramebuffer(0, 0, *self.size, 0, 0, *other.size, what, how)

    def read_colors(self, out: Pixels) -> None:
        """Wait for the picture, one sample per pixel, and write it to `out` (height, width, 4)."""
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, self._name)
        GL.glReadPixels(0, 0, *self.size, GL.GL_RGBA, GL.GL_UNSIGNED_BYTE, out)

    def read_depths(self, out: Floats) -> None:
        """Wait for the depths in 0..1, one per pixel, and write them to `out` (height, width)."""
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, self._name)
        GL.glReadPixels(0, 0, *self.size, GL.GL_DEPTH_COMPONENT, GL.GL_FLOAT, out)

    def delete(self) -> None:
        """Free it."""
        GL.glDeleteFramebuffers(1, [self._name])
        GL.glDeleteRenderbuffers(2, self._buffers)
        self.size = 0, 0


class Targets:
    """One target for each number of samples; replaced if the size changes."""

    def __init__(self) -> None:
        self._targets: dict[int, Target] = {}

    def of(self, size: tuple[int, int], samples: int) -> Target:
        """The target with `samples` samples, for a picture of `size` (width, height) pixels."""
        target = self._targets.get(samples)
        if target is None or target.size != size:
            if target is not None:
                target.delete()
            target = self._targets[samples] = Target(*size, samples)
        return target

    def delete(self) -> None:
        """Free all of them."""
        for target in self._targets.values():
            target.delete()
        self._targets = {}


class StillParts:
    """Pictures and depths of the still parts, on which the moving parts are drawn.

    Backdrop, most of the hair, neck and skull are a third of the work; copying them is fast.

    Args:
        draw: draws the still parts into a target.
    """

    def __init__(self, draw: Callable[[Target, View], None]) -> None:
        self._draw = draw
        self._targets = Targets()
        self._views: dict[int, View] = {}  # by samples

    def has(self, view: View, samples: int) -> bool:
        """Whether the still parts have been drawn for this view."""
        return self._views.get(samples) == view

    def copy_to(self, target: Target, view: View) -> None:
        """Copy the still parts to a target."""
        kept = self._targets.of(view.size, target.samples)
        if not self.has(view, target.samples):
            self._draw(kept, view)
            self._views[target.samples] = view
        kept.copy_to(target, depths=True)

    def forget(self) -> None:
        """Draw the still parts again before they are copied: they have moved."""
        self._views = {}

    def delete(self) -> None:
        """Free all of them."""
        self._targets.delete()
        self._views = {}

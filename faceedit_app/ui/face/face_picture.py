"""The picture of the face: what is drawn, from where, by which renderer. Uses no widget."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QColor, QImage, QPainter

from faceedit_app import render
from faceedit_app.core.arrays import Doubles, Floats, Pixels
from faceedit_app.core.head import Head
from faceedit_app.core.rig import Rig
from faceedit_app.render.difference import tint_of
from faceedit_app.ui.look.palette import BACKGROUND, BORDER, TEXT

_NEARER, _LOWER = 0.55, 0.012  # of the distance, and metres: small pictures show eyes and mouth
Size = tuple[int, int]  # pixels


class FacePicture:
    """Draws one face, or two side by side.

    Attributes:
        camera: where the face is seen from.
        image: the last picture drawn.
    """

    def __init__(self) -> None:
        self.camera = render.Camera()
        self.image: QImage | None = None
        self._pixels: Pixels | None = None  # memory that the image shares
        self._rig: Rig | None = None
        self._renderer: render.FaceRenderer | None = None
        self._weights: Floats | None = None
        self._beside: Floats | None = None
        self._against: Floats | None = None
        self._head: Head | None = None
        self._rotation: Floats | None = None
        self._rotation_beside: Floats | None = None
        self._begun = False

    def open(self, rig: Rig, size: Size, ready: render.FaceRenderer | None = None) -> None:
        """Start drawing a character.

        Args:
            ready: a renderer from `render.open_ahead`, used if it draws this character.

        Raises:
            FaceEditError: it cannot be drawn on this machine.
        """
        self.close()
        if self._rig is not None and self._rig is not rig:
            # Weights of another character do not apply.
            self._weights = self._beside = self._against = None
        self._rig, self._head = rig, None
        if ready is not None and ready.rig is not rig:
            with contextlib.suppress(Exception):  # a lost context cannot be freed
                ready.close()
            ready = None
        self._renderer = render.open_renderer(rig, *size) if ready is None else ready

    def close(self) -> None:
        """Free the graphics memory."""
        renderer, self._renderer = self._renderer, None
        self.image = self._pixels = None
        self._begun = False
        if renderer is not None:
            with contextlib.suppress(Exception):  # a lost context cannot be freed
                renderer.close()

    @property
    def can_draw(self) -> bool:
        """Whether a face can be drawn."""
        return self._renderer is not None

    @property
    def is_pair(self) -> bool:
        """Whether two faces are shown side by side."""
        return self._beside is not None

    @property
    def is_tinted(self) -> bool:
        """Whether the face is tinted by its distance from another one."""
        return self._against is not None

    def show(self, weights: Floats | None, beside: Floats | None, against: Floats | None) -> None:
        """Set the weights to draw; see `Viewport.show_weights`."""
        self._weights, self._beside, self._against = weights, beside, against

    def turn(self, rotation: Floats | None, beside: Floats | None) -> None:
        """Set how the heads are turned; see `Viewport.turn_heads`."""
        self._rotation, self._rotation_beside = rotation, beside

    def _turned(self, rig: Rig, vertices: Floats, rotation: Floats | None) -> Floats:
        if rotation is None:
            return vertices
        if self._head is None:
            self._head = Head(rig)
        return self._head.turned(vertices, rotation)

    def aim(self, aim: render.Aim, aspect: float) -> None:
        """Point the camera, for a picture of width / height `aspect`."""
        self.camera = self.aimed(aim, aspect / (2 if self.is_pair else 1))

    def aimed(self, aim: render.Aim, aspect: float) -> render.Camera:
        """The camera pointed at one face, for a picture of width / height `aspect`."""
        return self.camera if self._rig is None else render.aimed_camera(self._rig, aim, aspect)

    def project(
        self, vertices: Sequence[int] | None, width: float, height: float
    ) -> Doubles | None:
        """Where vertices are in a picture of this size; see `Viewport.project`."""
        if self._rig is None or self.is_pair:
            return None
        places, _ = self._first(self._rig)
        chosen = places if vertices is None else places[list(vertices)]
        return self.camera.project(chosen, width, height)

    def begin(self, size: Size, doubled: bool = False) -> None:
        """Start a rough picture of one face while other work goes on; `draw` finishes it."""
        if self._renderer is None or self._rig is None or self.is_pair:
            return
        with _errors_left_to_draw():
            self._renderer.resize(*size)
            self._renderer.doubled = doubled
            vertices, tint = self._first(self._rig)
            self._renderer.begin(vertices, self.camera, smooth=False, tint=tint)
            self._begun = True

    def forget_begun(self) -> None:
        """Discard a picture that was begun, because it is out of date."""
        self._begun = False

    def draw(self, size: Size, smooth: bool, fine: bool = True, doubled: bool = False) -> None:
        """Draw `image`. Drivers and PyOpenGL raise all kinds of errors.

        Args:
            size: width and height.
            smooth: with smooth edges, which is slower.
            fine: with more samples in a small picture, which is slower still.
            doubled: if it is rough, with edges that are nearly smooth.
        """
        if self._renderer is None or self._rig is None:
            return
        self._renderer.fine, self._renderer.doubled = fine, doubled
        self._pixels = self._faces(self._renderer, self._rig, size, smooth)
        self.image = _image_of(self._pixels)

    def thumbnail(self, weights: Floats, size: Size, aim: render.Aim) -> QImage | None:
        """A small picture of the face, or of a part of it, with (K,) weights, from the front.

        None if it cannot be drawn.
        """
        if self._renderer is None or self._rig is None:
            return None
        self._begun = False
        camera = render.aimed_camera(self._rig, aim, size[0] / size[1])
        if aim is render.Aim.FRONT:
            camera = camera.zoom(_NEARER).pan(0.0, -_LOWER)
        with _errors_left_to_draw():
            self._renderer.resize(*size)
            pixels = self._renderer.draw(self._rig.vertices(weights), camera, smooth=True)
            return _image_of(pixels).copy()
        return None

    def prepare(self) -> None:
        """Prepare the next picture, unless one has been begun."""
        if self._renderer is not None and not self._begun:
            with _errors_left_to_draw():
                self._renderer.prepare()

    def _first(self, rig: Rig) -> tuple[Floats, Floats | None]:
        """The vertices (V, 3) of the face and, if it is tinted, the strength of the tint (V,)."""
        vertices = rig.neutral if self._weights is None else rig.vertices(self._weights)
        turned = self._turned(rig, vertices, self._rotation)
        if self._against is None:
            return turned, None
        return turned, tint_of(vertices, rig.vertices(self._against))

    def _faces(self, renderer: render.FaceRenderer, rig: Rig, size: Size, smooth: bool) -> Pixels:
        """(H, W, 4) the picture: one face, or two side by side."""
        if self._begun and not smooth:
            self._begun = False
            return renderer.finish()
        self._begun = False
        width, height = size
        shown = [self._first(rig)]
        if self._beside is not None:
            vertices = self._turned(rig, rig.vertices(self._beside), self._rotation_beside)
            shown.insert(0, (vertices, None))
        renderer.resize(max(width // len(shown), 1), height)
        pictures = []
        for vertices, tint in shown:
            pixels = renderer.draw(vertices, self.camera, smooth=smooth, tint=tint)
            if len(shown) == 1:
                return pixels
            pictures.append(pixels.copy())  # the renderer may draw the next one into it
        return np.ascontiguousarray(np.concatenate(pictures, axis=1))


def _errors_left_to_draw() -> contextlib.suppress:
    """Ignore what drivers raise: `draw` raises it again, and the viewport reports it."""
    return contextlib.suppress(Exception)


def _image_of(pixels: Pixels) -> QImage:
    """An image that shares the memory of a picture (H, W, 4)."""
    height, width = pixels.shape[:2]
    return QImage(pixels.data, width, height, pixels.strides[0], QImage.Format.Format_RGB32)


def paint_names(painter: QPainter, room: QRect) -> None:
    """Label two faces."""
    half, height = room.width() // 2, room.height()
    painter.save()  # what is painted next is not to be filled like the labels
    painter.fillRect(half, 0, 1, height, QColor(BORDER))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for x, name in ((0, "Tracked"), (half, "Edited")):
        place = QRect(x, height - 34, half, 24)
        width = painter.fontMetrics().horizontalAdvance(name) + 20
        tag = QRect(0, 0, width, place.height())
        tag.moveCenter(place.center())
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(BACKGROUND))  # there may be skin behind it
        painter.drawRoundedRect(tag, 5, 5)
        painter.setPen(QColor(TEXT))
        painter.drawText(place, Qt.AlignmentFlag.AlignCenter, name)
    painter.restore()

"""pyrender's offscreen renderer for one character.

Imports PyOpenGL: `contexts.choose_backend` comes first. All calls must come from one thread.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats, Pixels
from faceedit_app.core.rig import Rig
from faceedit_app.render import contexts
from faceedit_app.render.camera import FAR, FIELD_OF_VIEW, NEAR, Camera, field_of_view
from faceedit_app.render.model import DEPTH, LiveMesh, Mesh, Model
from faceedit_app.render.painter import Order, Painter, Stage
from faceedit_app.render.pyrender_parts import (
    Material,
    OffscreenRenderer,
    OrthographicCamera,
    PerspectiveCamera,
    RenderFlags,
)
from faceedit_app.render.shade import bake_shade
from faceedit_app.render.surface import NormalSolver, vertex_looks
from faceedit_app.render.targets import StillParts, Target, Targets, View

_FINE = 1_200_000  # pixels, up to which fine pictures are drawn at twice their width and height,
_DOUBLED = 4_000_000  # and doubled ones
_DEPTH_SIZE = 320  # pixels of the depth images for the baked shade
_UPSIDE_DOWN = np.diag([1.0, -1.0, 1.0, 1.0])  # so that the top row is read first


class PortraitCamera(PerspectiveCamera):  # type: ignore[misc]  # pyrender has no types
    """A camera with the field of view of `camera.field_of_view`, upside down."""

    def __init__(self) -> None:
        super().__init__(FIELD_OF_VIEW, NEAR, FAR)

    def get_projection_matrix(self, width: int | None = None, height: int | None = None) -> Doubles:
        """(4, 4) for a picture of this size, pixels."""
        if width and height:
            self.yfov = field_of_view(width / height)
        matrix: Doubles = _UPSIDE_DOWN @ super().get_projection_matrix(width, height)
        return matrix


class Studio(OffscreenRenderer):  # type: ignore[misc]  # pyrender has no types
    """Draws one character.

    Args:
        rig: the character.
        background: the colour in the middle of the backdrop, sRGB, 0..1.
        backend: the result of `contexts.choose_backend`.
        width, height: the initial size, pixels.

    Attributes:
        shade: (V,) in 0..1, the share of the light from above that reaches each vertex.

    Raises:
        Exception: any error of the driver or PyOpenGL.
    """

    _platform: Any
    _renderer: Painter

    def __init__(
        self,
        rig: Rig,
        background: tuple[float, float, float],
        backend: str,
        width: int,
        height: int,
    ) -> None:
        self._background, self._backend = background, backend
        super().__init__(width, height)
        self.shade = self._bake(rig) if rig.shade is None else rig.shade
        self._model = Model(rig, vertex_looks(rig, self.shade))
        model = self._model
        self._stage = Stage(PortraitCamera(), model.still, model.moving, model.backdrop)
        self._targets, self._fine = Targets(), Targets()
        self._kept = StillParts(self._draw_still)
        self._drawn: Target
        self._looked: View | None = None  # the last picture's, if it was not tinted
        self._prepared: View | None = None  # the view for which still parts were copied

    def begin(
        self,
        vertices: Floats,
        camera: Camera,
        width: int,
        height: int,
        samples: int,
        tint: Floats | None = None,
        fine: bool = False,
        doubled: bool = False,
    ) -> None:
        """Start drawing `vertices`; returns before the graphics card is done.

        Args:
            vertices: (V, 3), metres.
            camera: the camera.
            width, height: pixels.
            samples: samples per pixel; 0 means one, with a faster light.
            tint: (V,) in 0..1; None = no tint.
            fine: draw it at twice its width and height, if it has samples and is small.
            doubled: the same for one without samples, if it is not huge.
        """
        self._platform.make_current()
        model = self._model
        if model.move(vertices):  # the head has turned
            self._kept.forget()
            self._looked = self._prepared = None
        self._renderer.hollows = model.hollows
        model.tint(tint)
        view = shown = View(camera, (width, height))
        # In a small picture, lashes and brows are narrower than its samples are apart.
        if samples and fine and 4 * width * height <= _FINE:
            shown = View(camera, (2 * width, 2 * height))
        target = self._targets.of(shown.size, samples)
        if not samples:
            target, shown = self._quick(view, doubled)
        # While the camera turns, keeping the still parts would cost more than it saves.
        if tint is None and (samples or view == self._looked):
            if samples or shown != self._prepared:
                self._kept.copy_to(target, shown)
            self._draw(target, shown, model.moving, upon=True)
        else:
            self._draw(target, shown, model.still, model.moving, model.backdrop)
        self._looked, self._prepared = view if tint is None else None, None
        self._drawn = target

    def _quick(self, view: View, doubled: bool) -> tuple[Target, View]:
        """What a picture without samples is drawn into, and how large."""
        width, height = view.size
        if not doubled or 4 * width * height > _DOUBLED:
            return self._targets.of(view.size, 0), view
        larger = View(view.camera, (2 * width, 2 * height))
        return self._fine.of(larger.size, 0), larger

    def finish(self, out: Pixels) -> None:
        """Wait for the picture, and write it to `out` (height, width, 4), BGRA, top row first."""
        self._platform.make_current()
        target, size = self._drawn, (out.shape[1], out.shape[0])
        if target.size != size and target.samples:
            target = self._fine.of(target.size, 0)
            self._drawn.copy_to(target)
        if target.size != size or target.samples:
            drawn, target = target, self._targets.of(size, 0)
            drawn.copy_to(target)
        target.read_colors(out)  # the shaders write blue first

    def prepare(self, doubled: bool = False) -> None:
        """Prepare the next quick picture, between pictures."""
        if self._looked is None or self._prepared:
            return
        self._platform.make_current()
        target, shown = self._quick(self._looked, doubled)
        # A quick picture from a new place may be one of many while the camera turns.
        if self._drawn.samples or self._kept.has(shown, 0):
            self._kept.copy_to(target, shown)
            self._prepared = shown

    def release(self) -> None:
        """Let another thread use it, if `contexts.may_change_threads`."""
        self._platform.release()

    def delete(self) -> None:
        """Free everything on the graphics card, and the context.

        As pyrender's, which then collects all of Python's garbage. That takes long, and deletes
        widgets that are garbage, which must not happen in another thread than the window's.
        """
        self._platform.make_current()
        self._targets.delete()
        self._fine.delete()
        self._kept.delete()
        self._model.delete()
        self._renderer.delete()
        self._platform.delete_context()
        del self._renderer, self._platform

    def __del__(self) -> None:
        """Do nothing; see `Painter.__del__`."""

    def _create(self) -> None:
        size = self.viewport_width, self.viewport_height
        self._platform = contexts.open_platform(self._backend, *size)
        self._renderer = Painter(self._background)

    def _draw_still(self, target: Target, view: View) -> None:
        self._draw(target, view, self._model.still, self._model.backdrop)

    def _draw(self, target: Target, view: View, *meshes: Mesh, upon: bool = False) -> None:
        self._stage.pose = view.camera.pose()
        self._render(self._stage, Order(target, view, meshes, upon))

    def _render(self, stage: Stage, order: Order) -> None:
        self.viewport_width, self.viewport_height = order.target.size
        self._renderer.order = order
        self.render(stage, RenderFlags.FLAT)
        self._platform.make_current()  # pyrender releases it

    def _bake(self, rig: Rig) -> Floats:
        """The shade of each vertex, (V,) float32 in 0..1, from depth images along parallel rays."""
        target = Target(_DEPTH_SIZE, _DEPTH_SIZE, 0)
        depths = np.empty((_DEPTH_SIZE, _DEPTH_SIZE), np.float32)
        material = Material(DEPTH, doubleSided=True)
        mesh = LiveMesh(rig, np.zeros((len(rig.neutral), 4), np.float32), [(material, rig.faces)])
        lamp = OrthographicCamera(1.0, 1.0)
        stage = Stage(lamp, mesh)

        def depths_of(
            vertices: Floats, poses: Sequence[Doubles], radius: float
        ) -> Iterator[Floats]:
            mesh.move(vertices)
            lamp.xmag = lamp.ymag = lamp.znear = radius
            lamp.zfar = 3.0 * radius
            for pose in poses:
                stage.pose = pose
                self._render(stage, Order(target, object(), (mesh,)))
                target.read_depths(depths)
                yield depths

        try:
            normals_of = NormalSolver(rig.faces, len(rig.neutral), groups=rig.shading_groups)
            return bake_shade(rig, normals_of, depths_of)
        finally:
            mesh.delete()
            target.delete()

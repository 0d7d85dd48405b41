"""pyrender's renderer with our shaders. Imports PyOpenGL: `contexts.choose_backend` first."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from OpenGL import GL
from pyrender import Material, Mesh, Renderer, Scene

from faceedit_app.render.programs import Program
from faceedit_app.render.surface import Shading
from faceedit_app.render.targets import Target

_SHADINGS = {shading.value for shading in Shading}


class Order(NamedTuple):
    """What is to be drawn, and where.

    Attributes:
        target: what is drawn into.
        view: stands for where the scene's camera is: another one where that has changed.
        meshes: those of the scene that are drawn, in this order.
        upon: whether they are drawn upon what is in the target already.
    """

    target: Target
    view: object
    meshes: tuple[Mesh, ...]
    upon: bool = False


class Painter(Renderer):  # type: ignore[misc]  # pyrender has no types
    """pyrender's renderer, with a forward pass that draws what it was ordered to.

    pyrender's own takes four samples of each pixel, begins with an empty picture, reads colours
    and depths back before it returns, and knows no shaders but its own. Scenes, cameras, meshes
    and how a primitive is drawn stay pyrender's.

    Args:
        background: the colour in the middle of the backdrop, sRGB, 0..1.

    Attributes:
        order: for the next call of `render`.
    """

    order: Order

    def __init__(self, background: tuple[float, float, float]) -> None:
        super().__init__(1, 1)
        self.dpscale = 1  # pyrender doubles every size on macOS, meaning a screen
        self._background = np.array(background)
        self._programs: dict[tuple[str, ...], Program] = {}
        self._view: object = None
        self._clip_from_world = self._camera_from_world = np.eye(4)

    def delete(self) -> None:
        """Free everything on the graphics card."""
        for program in self._programs.values():
            program.delete()
        self._programs = {}
        super().delete()

    def __del__(self) -> None:
        """Nothing: a forgotten renderer goes with its context.

        pyrender would delete by number here, in whichever context happens to be current.
        """

    def _program(self, material: Material, quick: bool) -> Program:
        """The shaders that draw a material, made when they are first needed."""
        key: tuple[str, ...] = (material.name,)
        if material.name in _SHADINGS:
            key = ("face", material.name)
            key += ("TEXTURED",) if material.tex_flags else ()
            key += ("QUICK",) if quick and material.name == Shading.FLESH.value else ()
        program = self._programs.get(key)
        if program is None:
            program = self._programs[key] = Program(*key)
            program._bind()
            program.set_uniform("background", self._background)
        return program

    def _forward_pass(self, scene: Scene, flags: int, seg_node_map: Any = None) -> None:
        target, view, meshes, upon = self.order
        target.bind()
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LEQUAL)  # the backdrop is as far away as nothing at all
        GL.glFrontFace(GL.GL_CW)  # pictures are drawn upside down, which turns triangles around
        if not upon:
            GL.glClear(GL.GL_DEPTH_BUFFER_BIT)  # the backdrop fills what the rest leaves free
        if view != self._view:
            self._view = view
            self._camera_from_world, projection = self._get_camera_matrices(scene)
            self._clip_from_world = projection @ self._camera_from_world
        for primitive in (p for mesh in meshes for p in mesh.primitives):
            program = self._program(primitive.material, quick=not target.samples)
            program._bind()
            if program.view != view:  # programs keep what they know
                program.view = view
                program.set_uniform("clip_from_world", self._clip_from_world)
                program.set_uniform("camera_from_world", self._camera_from_world)
            program.set_uniform("cutoff", primitive.material.alphaCutoff)
            self._bind_and_draw_primitive(primitive, None, program, flags)
            self._reset_active_textures()
        GL.glFlush()

"""pyrender's renderer with our shaders. Imports PyOpenGL: `contexts.choose_backend` first."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from OpenGL import GL

from faceedit_app.core.arrays import Doubles
from faceedit_app.render.hollows import Hollows
from faceedit_app.render.model import Mesh
from faceedit_app.render.programs import Program
from faceedit_app.render.pyrender_parts import Camera, Material, Renderer
from faceedit_app.render.surface import Shading
from faceedit_app.render.targets import Target

_SHADINGS = {shading.value for shading in Shading}


class Order(NamedTuple):
    """What to draw, and where.

    Attributes:
        target: the target to draw into.
        view: identifies the place of the camera; differs if the camera has moved.
        meshes: the meshes of the stage to draw, in this order.
        upon: whether to keep what the target already shows.
    """

    target: Target
    view: object
    meshes: tuple[Mesh, ...]
    upon: bool = False


class Stage:
    """What pyrender's renderer asks of a scene: meshes that stand where they are, and a camera.

    pyrender's own scene is a tree of nodes, whose library takes long to import.

    Args:
        camera: the camera.
        meshes: what can be drawn.

    Attributes:
        camera: the camera.
        pose: (4, 4) float64, camera to world, metres.
        meshes: what can be drawn.
    """

    lights = light_nodes = frozenset[Any]()  # our shaders have their own

    def __init__(self, camera: Camera, *meshes: Mesh) -> None:
        self.camera, self.pose, self.meshes = camera, np.eye(4), set(meshes)

    @property
    def main_camera_node(self) -> Stage:
        """pyrender's name for what has the camera."""
        return self

    def get_pose(self, _: Stage) -> Doubles:
        """pyrender's name for the `pose`."""
        return self.pose


class Painter(Renderer):  # type: ignore[misc]  # pyrender has no types
    """pyrender's renderer with a forward pass that follows an order.

    pyrender's own takes four samples of each pixel, begins with an empty picture, reads colours
    and depths back before it returns, and uses only its own shaders. Cameras, meshes and the
    drawing of primitives stay pyrender's.

    Args:
        background: the colour in the middle of the backdrop, sRGB, 0..1.

    Attributes:
        order: the order for the next call of `render`.
        hollows: how far lids and lips are open, for the shaders that ask for it.
    """

    order: Order
    hollows: Hollows | None = None

    def __init__(self, background: tuple[float, float, float]) -> None:
        super().__init__(1, 1)
        self.dpscale = 1  # pyrender doubles every size on macOS, as for a screen
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
        """Do nothing: the context frees everything.

        pyrender would delete objects by number here, in whatever context is current.
        """

    def _program(self, material: Material, quick: bool) -> Program:
        """The shaders of a material, compiled when they are first needed."""
        key: tuple[str, ...] = (material.name,)
        if material.name in _SHADINGS:
            key = ("face", material.name)
            key += ("TEXTURED",) if material.tex_flags else ()
            key += ("SHEER",) if material.alphaMode == "BLEND" else ()
            can_be_quick = material.name == Shading.FLESH.value or "SHEER" in key
            key += ("QUICK",) if quick and can_be_quick else ()
        program = self._programs.get(key)
        if program is None:
            program = self._programs[key] = Program(*key)
            program._bind()
            program.set_uniform("background", self._background)
        return program

    def _forward_pass(self, scene: Stage, flags: int, seg_node_map: Any = None) -> None:
        target, view, meshes, upon = self.order
        target.bind()
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LEQUAL)  # the backdrop is at the far plane
        GL.glFrontFace(GL.GL_CW)  # pictures are drawn upside down, which reverses triangles
        if not upon:
            GL.glClear(GL.GL_DEPTH_BUFFER_BIT)  # the backdrop covers the rest
        if view != self._view:
            self._view = view
            self._camera_from_world, projection = self._get_camera_matrices(scene)
            self._clip_from_world = projection @ self._camera_from_world
        for primitive in (p for mesh in meshes for p in mesh.primitives):
            program = self._program(primitive.material, quick=not target.samples)
            program._bind()
            if program.view != view:  # programs keep their uniforms
                program.view = view
                program.set_uniform("clip_from_world", self._clip_from_world)
                program.set_uniform("camera_from_world", self._camera_from_world)
            program.set_uniform("cutoff", primitive.material.alphaCutoff)
            program.set_hollows(self.hollows)
            # Lashes and brows are drawn last and lie in several layers of one colour: none of them
            # may hide another where one can see through it.
            is_thin = primitive.material.name == Shading.THIN.value
            GL.glDepthMask(not (is_thin and primitive.material.alphaMode == "BLEND"))
            self._bind_and_draw_primitive(primitive, None, program, flags)
            GL.glDepthMask(True)
            self._reset_active_textures()
        GL.glFlush()

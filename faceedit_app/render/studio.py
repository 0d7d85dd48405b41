"""The studio the face stands in: a pyrender renderer with our own light and a lean frame.

Imported only after `contexts.choose_backend`, because it imports PyOpenGL. All calls must come
from one thread, with the context current.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL
from pyrender.primitive import Primitive
from pyrender.renderer import Renderer
from pyrender.shader_program import ShaderProgram

from faceedit_app.core.arrays import Floats, Pixels
from faceedit_app.core.rig import Rig
from faceedit_app.render.camera import Camera, projection
from faceedit_app.render.difference import Tinter
from faceedit_app.render.shade import bake_shade
from faceedit_app.render.surface import NormalSolver, Shading, by_shading, vertex_looks

SAMPLES = 4
_DEPTH_SIZE = 320  # pixels, of the depth images for the baked shade
_SHADERS = Path(__file__).parent / "shaders"
_INCLUDE = re.compile(r'^#include "(.+)"$', re.MULTILINE)
_POSITION, _NORMAL, _COLOUR = 0, 1, 3  # where the shader has what may change with each frame
_TEXTURE_PLACE = 8  # and where a vertex lies in its texture; pyrender has 4 to 7
_FLIP = np.diag([1.0, -1.0, 1.0, 1.0])  # read back with the top row first


class View(NamedTuple):
    """Where a picture is taken from, and its width and height in pixels."""

    camera: Camera
    size: tuple[int, int]


class Target:
    """A framebuffer of one size, with or without several samples per pixel."""

    def __init__(self, width: int, height: int, samples: int) -> None:
        self.size, self.samples = (width, height), samples
        self._buffers = [int(b) for b in GL.glGenRenderbuffers(2)]
        for buffer, kind in zip(self._buffers, (GL.GL_RGBA8, GL.GL_DEPTH_COMPONENT24), strict=True):
            GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, buffer)
            GL.glRenderbufferStorageMultisample(GL.GL_RENDERBUFFER, samples, kind, width, height)
        self.name = int(GL.glGenFramebuffers(1))
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.name)
        for buffer, place in zip(
            self._buffers, (GL.GL_COLOR_ATTACHMENT0, GL.GL_DEPTH_ATTACHMENT), strict=True
        ):
            GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, place, GL.GL_RENDERBUFFER, buffer)
        status = GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER)
        if status != GL.GL_FRAMEBUFFER_COMPLETE:
            raise RuntimeError(f"the driver refuses a {width} x {height} image")

    def delete(self) -> None:
        """Free it."""
        GL.glDeleteFramebuffers(1, [self.name])
        GL.glDeleteRenderbuffers(2, self._buffers)


class Program(ShaderProgram):  # type: ignore[misc]  # pyrender has no types
    """A pair of shaders in some variant.

    pyrender replaces the names of variants wherever they stand; here they are the shader
    language's own, and a file can include another one.

    Args:
        vertex, fragment: the files.
        variant: what is defined in them.
    """

    def __init__(self, vertex: Path, fragment: Path, variant: Sequence[str]) -> None:
        super().__init__(str(vertex), str(fragment), defines=dict.fromkeys(variant, 1))

    def _load(self, shader_filename: str) -> str:
        path = Path(shader_filename)
        version, _, text = path.read_text(encoding="utf-8").partition("\n")
        for name in _INCLUDE.findall(text):
            shared = path.with_name(name).read_text(encoding="utf-8")
            text = text.replace(f'#include "{name}"', shared)
        return "\n".join([version, *(f"#define {name}" for name in self.defines), text])


@dataclass(frozen=True)
class Run:
    """Faces that are drawn alike, finely or quickly: indices from `first` to before `stop`.

    Those before `moving` look alike whatever the face does.
    """

    fine: Program
    quick: Program
    shading: Shading
    first: int
    moving: int
    stop: int
    texture: int | None = None  # OpenGL's number
    cutoff: float = 0.0


class Part(Enum):
    """Which faces of the character to draw."""

    ALL = auto()
    STILL = auto()
    MOVING = auto()

    def of(self, run: Run) -> tuple[int, int]:
        """First index in a run, and the one after the last."""
        first = run.moving if self is Part.MOVING else run.first
        return first, run.moving if self is Part.STILL else run.stop


class Studio(Renderer):  # type: ignore[misc]  # pyrender has no types
    """Draws one character in one call.

    From pyrender come the shader programs and the vertex arrays; the frame is our own, because
    pyrender's reads the depth back, always takes four samples and uploads the mesh anew.

    Args:
        rig: the character.
        background: sRGB, 0..1.
    """

    def __init__(self, rig: Rig, background: tuple[float, float, float]) -> None:
        super().__init__(1, 1)
        self.dpscale = 1  # pyrender doubles every size on macOS, meaning a screen
        self._programs: list[Program] = []
        self._background = np.asarray(background, np.float32)
        self._normals = NormalSolver(rig.faces, len(rig.neutral), rig.shading_groups)
        normals = self._normals(rig.neutral)
        looks = vertex_looks(rig, np.ones(len(rig.neutral), np.float32))
        groups = by_shading(rig)
        self._primitive = Primitive(
            positions=rig.neutral,
            normals=normals,
            tangents=looks,  # pyrender's name for the third, four-wide attribute
            color_0=rig.colors,
            indices=np.concatenate([part for g in groups for part in (g.still, g.moving)]),
            mode=GL.GL_TRIANGLES,
        )
        self._primitive._add_to_context()
        self._colors, self._tinter, self._is_plain = rig.colors, Tinter(rig.colors), True
        own = {_POSITION: rig.neutral, _NORMAL: normals, _COLOUR: rig.colors}
        if rig.uv is not None:
            own[_TEXTURE_PLACE] = rig.uv
        self._moving = self._own_buffers(own)
        self._textures = [_texture(pixels) for pixels in rig.textures]
        self._runs: list[Run] = []
        first = 0
        for group in groups:
            variant = [group.shading.value] + ["TEXTURED"] * (group.texture is not None)
            fine = quick = self._program("face", *variant)
            if group.shading is Shading.FLESH:
                quick = self._program("face", *variant, "QUICK")
            moving = first + group.still.size
            stop = moving + group.moving.size
            texture = None if group.texture is None else self._textures[group.texture]
            run = Run(fine, quick, group.shading, first, moving, stop, texture, group.cutoff)
            self._runs.append(run)
            first = stop
        self._backdrop = self._program("backdrop")
        self._depth = self._program("depth")
        self._locations: dict[tuple[int, str], int] = {}
        self._views: dict[int, View] = {}  # by program
        self._targets: dict[tuple[int, bool], Target] = {}  # by samples, and for what is still
        self._drawn: Target
        self._looked: View | None = None  # the last picture's, where nothing was tinted
        self._still: dict[int, View] = {}  # of what is still, by samples
        self._ready = False  # whether it is where the next quick picture will be drawn
        looks = vertex_looks(rig, self._bake(rig))
        whole = np.hstack((rig.neutral, normals, looks, rig.colors)).astype(np.float32)
        _fill(self._primitive._buffers[0], whole)

    def begin(
        self,
        vertices: Floats,
        camera: Camera,
        width: int,
        height: int,
        samples: int,
        tint: Floats | None = None,
    ) -> None:
        """Have `vertices` drawn; whoever draws works on while this returns.

        Args:
            vertices: (V, 3), metres: the rig's, with some weights.
            samples: of each pixel; 0 is one, and a quicker light.
            tint: (V,) in 0..1, how much of the tint each has; None is none at all.
        """
        self._upload(vertices)
        self._colour(tint)
        view = View(camera, (width, height))
        target = self._target(view.size, samples)
        # While the camera turns, to keep what is still would cost more than it saves.
        if tint is None and (samples or view == self._looked):
            self._put_still(target, view)
            self._draw_face(target, view, Part.MOVING)
        else:
            self._draw_with_backdrop(target, view, Part.ALL)
        self._looked, self._ready = view if tint is None else None, False
        GL.glFlush()
        self._drawn = target

    def finish(self, out: Pixels) -> None:
        """Wait for it, and put it into `out` (height, width, 4), BGRA, top row first."""
        self._read(self._drawn, out)

    def prepare(self) -> None:
        """Do what the next quick picture will need, while nobody waits for it."""
        view = self._looked
        if view is None or self._ready:
            return
        # A quick picture from a new place may be one of many while the camera turns.
        if self._drawn.samples or self._still.get(0) == view:
            self._put_still(self._target(view.size, 0), view)
            self._ready = True

    def delete(self) -> None:
        """Free everything on the graphics card."""
        for target in self._targets.values():
            target.delete()
        self._targets = {}
        for program in self._programs:
            program.delete()
        GL.glDeleteBuffers(len(self._moving), list(self._moving.values()))
        if self._textures:
            GL.glDeleteTextures(len(self._textures), self._textures)
        self._primitive.delete()
        super().delete()

    def __del__(self) -> None:
        """Nothing: a forgotten studio goes with its context.

        pyrender would delete by number here, in whichever context happens to be current.
        """

    def _begin(self, target: Target) -> None:
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, target.name)
        GL.glViewport(0, 0, *target.size)
        GL.glEnable(GL.GL_DEPTH_TEST)
        GL.glDepthFunc(GL.GL_LEQUAL)
        GL.glFrontFace(GL.GL_CW)  # the flip turns every triangle around

    def _own_buffers(self, attributes: dict[int, Floats]) -> dict[int, int]:
        """Buffers in place of pyrender's for some attributes, (V, 3) or (V, 4) each.

        These change with the frames; the looks, which pyrender keeps between them, stay.
        """
        GL.glBindVertexArray(self._primitive._vaid)
        names = [int(name) for name in GL.glGenBuffers(len(attributes))]
        for name, (place, values) in zip(names, attributes.items(), strict=True):
            values = np.ascontiguousarray(values, np.float32)
            GL.glBindBuffer(GL.GL_ARRAY_BUFFER, name)
            GL.glBufferData(GL.GL_ARRAY_BUFFER, values.nbytes, values, GL.GL_STREAM_DRAW)
            GL.glVertexAttribPointer(place, values.shape[1], GL.GL_FLOAT, GL.GL_FALSE, 0, None)
            GL.glEnableVertexAttribArray(place)
        GL.glBindVertexArray(0)
        return dict(zip(attributes, names, strict=True))

    def _upload(self, vertices: Floats) -> None:
        _fill(self._moving[_POSITION], vertices)
        _fill(self._moving[_NORMAL], self._normals(vertices))

    def _colour(self, tint: Floats | None) -> None:
        """Colours stay where they are until there is a tint, and once after it."""
        if tint is not None:
            _fill(self._moving[_COLOUR], self._tinter(tint))
        elif not self._is_plain:
            _fill(self._moving[_COLOUR], self._colors)
        self._is_plain = tint is None

    def _bake(self, rig: Rig) -> Floats:
        """The shade of each vertex, (V,) float32, from depth images of `_depth`."""
        target = Target(_DEPTH_SIZE, _DEPTH_SIZE, 0)
        depth = np.empty((_DEPTH_SIZE, _DEPTH_SIZE), np.float32)

        def depth_of(vertices: Floats, clip_from_world: NDArray[np.float64]) -> Floats:
            self._begin(target)
            GL.glClear(GL.GL_DEPTH_BUFFER_BIT)
            self._depth._bind()
            self._set_matrix(self._depth, "clip_from_world", clip_from_world)
            _fill(self._moving[_POSITION], vertices)
            GL.glBindVertexArray(self._primitive._vaid)
            count = self._primitive.indices.size
            GL.glDrawElements(GL.GL_TRIANGLES, count, GL.GL_UNSIGNED_INT, None)
            GL.glReadPixels(0, 0, *target.size, GL.GL_DEPTH_COMPONENT, GL.GL_FLOAT, depth)
            return depth

        try:
            return bake_shade(rig, self._normals, depth_of)
        finally:
            target.delete()

    def _draw_with_backdrop(self, target: Target, view: View, part: Part) -> None:
        """Some or all of the face, and the backdrop behind it."""
        self._begin(target)
        GL.glClear(GL.GL_DEPTH_BUFFER_BIT)
        self._draw_face(target, view, part)
        self._draw_backdrop()

    def _draw_face(self, target: Target, view: View, part: Part) -> None:
        GL.glBindVertexArray(self._primitive._vaid)
        GL.glCullFace(GL.GL_BACK)
        for run in self._runs:
            first, stop = part.of(run)
            if first == stop:
                continue
            program = run.fine if target.samples else run.quick
            program._bind()
            self._look(program, view)
            if run.texture is not None:
                GL.glActiveTexture(GL.GL_TEXTURE0)
                GL.glBindTexture(GL.GL_TEXTURE_2D, run.texture)
                GL.glUniform1i(self._location(program, "picture"), 0)
                GL.glUniform1f(self._location(program, "cutoff"), run.cutoff)
            # Nothing but the skin is known to be closed; lashes and brows are thin.
            toggle = GL.glEnable if run.shading is Shading.FLESH else GL.glDisable
            toggle(GL.GL_CULL_FACE)
            start = GL.GLvoidp(4 * first)
            GL.glDrawElements(GL.GL_TRIANGLES, stop - first, GL.GL_UNSIGNED_INT, start)
        GL.glDisable(GL.GL_CULL_FACE)

    def _put_still(self, target: Target, view: View) -> None:
        """Put all that does not move into a target, for the rest to be drawn upon.

        Backdrop, most of the hair, neck and skull are a third of the work; to copy them is quick.
        """
        if target.samples or not self._ready:
            still = self._target(target.size, target.samples, still=True)
            if view != self._still.get(target.samples):
                self._draw_with_backdrop(still, view, Part.STILL)
                self._still[target.samples] = view
            _blit(still, target, GL.GL_COLOR_BUFFER_BIT | GL.GL_DEPTH_BUFFER_BIT)
        self._begin(target)

    def _draw_backdrop(self) -> None:
        """Behind the face, so that only what the face leaves free is filled."""
        GL.glBindVertexArray(self._primitive._vaid)
        self._backdrop._bind()
        GL.glUniform3f(self._location(self._backdrop, "background"), *self._background)
        GL.glDrawArrays(GL.GL_TRIANGLES, 0, 3)
        GL.glBindVertexArray(0)

    def _read(self, target: Target, out: Pixels) -> None:
        if target.samples:
            plain = self._target(target.size, 0)
            _blit(target, plain)
            target = plain
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, target.name)
        # The shaders have written blue first.
        GL.glReadPixels(0, 0, *target.size, GL.GL_RGBA, GL.GL_UNSIGNED_BYTE, out)

    def _target(self, size: tuple[int, int], samples: int, still: bool = False) -> Target:
        """The one for pictures with so many samples, or for what is still in them."""
        target = self._targets.get((samples, still))
        if target is None or target.size != size:
            if target is not None:
                target.delete()
            target = self._targets[samples, still] = Target(*size, samples)
        return target

    def _program(self, name: str, *variant: str) -> Program:
        program = Program(_SHADERS / f"{name}.vert", _SHADERS / f"{name}.frag", variant)
        program._add_to_context()
        self._programs.append(program)
        return program

    def _location(self, program: Any, name: str) -> int:
        key = (int(program._program_id), name)
        if key not in self._locations:
            self._locations[key] = int(GL.glGetUniformLocation(program._program_id, name))
        return self._locations[key]

    def _look(self, program: Any, view: View) -> None:
        """Programs remember where from; the camera stands still most of the time."""
        if self._views.get(program._program_id) != view:
            self._views[program._program_id] = view
            width, height = view.size
            place = view.camera.view()
            clip = _FLIP @ projection(width / height) @ place
            self._set_matrix(program, "clip_from_world", clip)
            self._set_matrix(program, "camera_from_world", place)

    def _set_matrix(self, program: Any, name: str, matrix: NDArray[np.float64]) -> None:
        location = self._location(program, name)
        GL.glUniformMatrix4fv(location, 1, GL.GL_TRUE, matrix.astype(np.float32))


def _blit(source: Target, to: Target, what: int = GL.GL_COLOR_BUFFER_BIT) -> None:
    """Copy the colours, or what the samples of each pixel come to."""
    GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, source.name)
    GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, to.name)
    rectangle = (0, 0, *source.size)
    GL.glBlitFramebuffer(*rectangle, *rectangle, what, GL.GL_NEAREST)


def _texture(pixels: Pixels) -> int:
    """A texture of (H, W, 4) sRGB and alpha, with smaller ones of itself for a distance."""
    name = int(GL.glGenTextures(1))
    height, width = pixels.shape[:2]
    GL.glBindTexture(GL.GL_TEXTURE_2D, name)
    GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
    kind = GL.GL_RGBA, GL.GL_UNSIGNED_BYTE, np.ascontiguousarray(pixels)
    GL.glTexImage2D(GL.GL_TEXTURE_2D, 0, GL.GL_SRGB8_ALPHA8, width, height, 0, *kind)
    GL.glGenerateMipmap(GL.GL_TEXTURE_2D)
    for setting, value in (
        (GL.GL_TEXTURE_MIN_FILTER, GL.GL_LINEAR_MIPMAP_LINEAR),
        (GL.GL_TEXTURE_MAG_FILTER, GL.GL_LINEAR),
        (GL.GL_TEXTURE_WRAP_S, GL.GL_REPEAT),
        (GL.GL_TEXTURE_WRAP_T, GL.GL_REPEAT),
    ):
        GL.glTexParameteri(GL.GL_TEXTURE_2D, setting, value)
    return name


def _fill(buffer: int, values: Floats) -> None:
    """Put other values into a buffer of the same size."""
    GL.glBindBuffer(GL.GL_ARRAY_BUFFER, buffer)
    GL.glBufferSubData(GL.GL_ARRAY_BUFFER, 0, values.nbytes, np.ascontiguousarray(values))

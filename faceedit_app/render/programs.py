"""Our shaders as pyrender's programs. Imports PyOpenGL: `contexts.choose_backend` comes first."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from OpenGL import GL

from faceedit_app.render.hollows import Hollows
from faceedit_app.render.pyrender_parts import ShaderProgram

_SHADERS = Path(__file__).parent / "shaders"
_INCLUDE = re.compile(r'^#include "(.+)"$', re.MULTILINE)


class Program(ShaderProgram):  # type: ignore[misc]  # pyrender has no types
    """A variant of a pair of shaders, ready to draw.

    pyrender replaces the names of variants anywhere in the text; here they are definitions of the
    shader language, and a file can include another.

    Args:
        name: of the files, without their endings.
        variant: the names to define.

    Attributes:
        view: the view of its matrices, set by the renderer.
    """

    def __init__(self, name: str, *variant: str) -> None:
        files = (str(_SHADERS / f"{name}.{ending}") for ending in ("vert", "frag"))
        super().__init__(*files, defines=dict.fromkeys(variant, 1))
        self._add_to_context()
        count = GL.glGetProgramiv(self._program_id, GL.GL_ACTIVE_UNIFORMS)
        self._names = {GL.glGetActiveUniform(self._program_id, i)[0].decode() for i in range(count)}
        self.view: object = None
        self._hollows: Hollows | None = None

    def set_uniform(self, name: str, value: Any, unsigned: bool = False) -> None:
        """Set a uniform if the shaders have it; pyrender sets many that they lack."""
        if name in self._names:
            super().set_uniform(name, value, unsigned)

    def set_hollows(self, hollows: Hollows | None) -> None:
        """Set what is known of lids and lips, if the shaders ask for it and it is new."""
        before = self._hollows
        if hollows is None or hollows is before or "lips" not in self._names:
            return
        self._hollows = hollows
        self.set_uniform("lids", hollows.lids)
        self.set_uniform("lips", hollows.lips)
        if before is None or before.head is not hollows.head:
            self.set_uniform("head", hollows.head)

    def _load(self, shader_filename: str) -> str:
        path = Path(shader_filename)
        version, _, text = path.read_text(encoding="utf-8").partition("\n")
        for name in _INCLUDE.findall(text):
            shared = path.with_name(name).read_text(encoding="utf-8")
            text = text.replace(f'#include "{name}"', shared)
        return "\n".join([version, *(f"#define {name}" for name in self.defines), text])

"""pyrender's classes that draw the face. Imports PyOpenGL: `contexts.choose_backend` comes first.

This package finds pyrender's modules as its own: they are imported as they are, but without
pyrender's `__init__`. That imports a viewer with pyglet, a tree of nodes with networkx, and all of
trimesh with half of scipy: 0.6 s of the start, and 60 MB (docs/adr/0011-pyrender.md).
"""

from pkgutil import extend_path

__path__ = extend_path(__path__, "pyrender")

from faceedit_app.render.pyrender_parts.camera import Camera, OrthographicCamera, PerspectiveCamera
from faceedit_app.render.pyrender_parts.constants import FLOAT_SZ, GLTF, RenderFlags
from faceedit_app.render.pyrender_parts.material import Material, MetallicRoughnessMaterial
from faceedit_app.render.pyrender_parts.offscreen import OffscreenRenderer
from faceedit_app.render.pyrender_parts.primitive import Primitive
from faceedit_app.render.pyrender_parts.renderer import Renderer
from faceedit_app.render.pyrender_parts.shader_program import ShaderProgram
from faceedit_app.render.pyrender_parts.texture import Texture

__all__ = [
    "FLOAT_SZ",
    "GLTF",
    "Camera",
    "Material",
    "MetallicRoughnessMaterial",
    "OffscreenRenderer",
    "OrthographicCamera",
    "PerspectiveCamera",
    "Primitive",
    "RenderFlags",
    "Renderer",
    "ShaderProgram",
    "Texture",
]

"""pyrender's classes that draw the face. Imports PyOpenGL: `contexts.choose_backend` comes first.

The package itself also imports a viewer with pyglet, and all of trimesh with half of scipy, for
which nothing is needed here: 0.3 s of the start, and 50 MB.
"""

from faceedit_app.render.lazy import lazily

with lazily("pyrender", "trimesh"):
    from pyrender.camera import OrthographicCamera, PerspectiveCamera
    from pyrender.constants import FLOAT_SZ, GLTF, RenderFlags
    from pyrender.material import Material, MetallicRoughnessMaterial
    from pyrender.mesh import Mesh
    from pyrender.offscreen import OffscreenRenderer
    from pyrender.primitive import Primitive
    from pyrender.renderer import Renderer
    from pyrender.scene import Scene
    from pyrender.shader_program import ShaderProgram
    from pyrender.texture import Texture

__all__ = [
    "FLOAT_SZ",
    "GLTF",
    "Material",
    "Mesh",
    "MetallicRoughnessMaterial",
    "OffscreenRenderer",
    "OrthographicCamera",
    "PerspectiveCamera",
    "Primitive",
    "RenderFlags",
    "Renderer",
    "Scene",
    "ShaderProgram",
    "Texture",
]

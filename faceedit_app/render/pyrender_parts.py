"""pyrender's classes that draw the face. Imports PyOpenGL: `contexts.choose_backend` comes first.

The package itself also imports its viewer with pyglet, its tree of nodes with networkx, and all of
trimesh with half of scipy: 0.4 s of the start, and 60 MB. Text and textures, which most characters
do not have, would bring FreeType and Pillow.
"""

from faceedit_app.render.lazy import lazily

with lazily("pyrender", "trimesh", "freetype", "PIL.Image"):
    from pyrender.camera import Camera, OrthographicCamera, PerspectiveCamera
    from pyrender.constants import FLOAT_SZ, GLTF, RenderFlags
    from pyrender.material import Material, MetallicRoughnessMaterial
    from pyrender.mesh import Mesh
    from pyrender.offscreen import OffscreenRenderer
    from pyrender.primitive import Primitive
    from pyrender.renderer import Renderer
    from pyrender.shader_program import ShaderProgram
    from pyrender.texture import Texture

__all__ = [
    "FLOAT_SZ",
    "GLTF",
    "Camera",
    "Material",
    "Mesh",
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

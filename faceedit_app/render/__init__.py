"""Draws the face with pyrender; knows nothing of windows."""

from faceedit_app.render.camera import Camera, default_camera
from faceedit_app.render.renderer import FaceRenderer, open_renderer

__all__ = ["Camera", "FaceRenderer", "default_camera", "open_renderer"]

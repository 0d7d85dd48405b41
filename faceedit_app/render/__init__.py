"""Draws the face with pyrender, without Qt."""

from faceedit_app.render.camera import Aim, Camera, aimed_camera, default_camera
from faceedit_app.render.renderer import FaceRenderer, open_ahead, open_renderer, shade_of

__all__ = [
    "Aim",
    "Camera",
    "FaceRenderer",
    "aimed_camera",
    "default_camera",
    "open_ahead",
    "open_renderer",
    "shade_of",
]

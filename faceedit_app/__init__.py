"""FaceEdit: edit tracked facial animation by dragging eight plain curves."""

__version__ = "0.1.0"

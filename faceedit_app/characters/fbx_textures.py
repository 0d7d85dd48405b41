"""The objects of an FBX file that hold a material's picture: a texture and its embedded file."""

from __future__ import annotations

from faceedit_app.characters.fbx_tree import Record

UV_SET = "UV"


def video_children(name: str, content: bytes) -> tuple[Record, ...]:
    """The records of a `Video` with a picture file in it.

    Args:
        name: of the file.
        content: its bytes.
    """
    path = Record("P", ("Path", "KString", "XRefUrl", "", name))
    return (
        Record("Type", ("Clip",)),
        Record("Properties70", (), (path,)),
        Record("UseMipMap", (0,)),
        Record("Filename", (name,)),
        Record("RelativeFilename", (name,)),
        Record("Content", (content,)),
    )


def texture_children(name: str) -> tuple[Record, ...]:
    """The records of a `Texture` that shows the picture file of this name."""
    properties = (
        Record("P", ("UVSet", "KString", "", "", UV_SET)),
        Record("P", ("UseMaterial", "bool", "", "", 1)),
    )
    return (
        Record("Type", ("TextureVideoClip",)),
        Record("Version", (202,)),
        Record("TextureName", (f"{name}\0\1Texture",)),
        Record("Properties70", (), properties),
        Record("Media", (f"{name}\0\1Video",)),
        Record("FileName", (name,)),
        Record("RelativeFilename", (name,)),
        Record("ModelUVTranslation", (0.0, 0.0)),
        Record("ModelUVScaling", (1.0, 1.0)),
        Record("Texture_Alpha_Source", ("None",)),
        Record("Cropping", (0, 0, 0, 0)),
    )

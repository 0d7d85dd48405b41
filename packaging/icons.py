"""The application's icon as files, from the drawing that the window uses.

    python packaging/icons.py FOLDER

Writes faceedit.svg, faceedit-SIZE.png, faceedit.ico (Windows) and faceedit.icns (macOS).
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PIL import Image
from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QGuiApplication, QImage, QPainter
from PySide6.QtSvg import QSvgGenerator

from faceedit_app.ui.look.icons import APP_GRID, paint_app_icon

PNG_SIZES = (16, 24, 32, 48, 64, 128, 256, 512, 1024)
ICO_SIZES = (16, 24, 32, 48, 64, 128, 256)


def write_icons(folder: Path) -> None:
    """Write all formats."""
    app = QGuiApplication.instance() or QGuiApplication(sys.argv[:1])
    assert app is not None
    folder.mkdir(parents=True, exist_ok=True)
    _write_svg(folder / "faceedit.svg")
    for size in PNG_SIZES:
        _write_png(folder / f"faceedit-{size}.png", size)
    pictures = [Image.open(folder / f"faceedit-{size}.png") for size in PNG_SIZES]
    largest = pictures[-1]
    # Each size is drawn by itself; pillow would scale the largest down.
    sizes = [(size, size) for size in ICO_SIZES]
    largest.save(folder / "faceedit.ico", sizes=sizes, append_images=pictures[:-1])
    largest.save(folder / "faceedit.icns", append_images=pictures[:-1])


def _write_png(path: Path, size: int) -> None:
    image = QImage(size, size, QImage.Format.Format_ARGB32)
    image.fill(Qt.GlobalColor.transparent)
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.scale(size / APP_GRID, size / APP_GRID)
    paint_app_icon(painter)
    painter.end()
    if not image.save(str(path)):
        raise OSError(f"{path} was not written")


def _write_svg(path: Path) -> None:
    drawing = QSvgGenerator()
    drawing.setFileName(str(path))
    drawing.setSize(QSize(APP_GRID, APP_GRID))
    drawing.setViewBox(QRectF(0, 0, APP_GRID, APP_GRID))
    drawing.setTitle("FaceEdit")
    painter = QPainter(drawing)
    paint_app_icon(painter)
    painter.end()


if __name__ == "__main__":
    write_icons(Path(sys.argv[1] if len(sys.argv) > 1 else "build/packaging/icons"))

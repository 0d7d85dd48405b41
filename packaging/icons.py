"""The application's icon as files, from the drawing that the window uses.

    python packaging/icons.py FOLDER

Writes faceedit.svg, faceedit-SIZE.png, faceedit.ico (Windows) and faceedit.icns (macOS).
"""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PIL import Image
from PySide6.QtGui import QGuiApplication

from faceedit_app.ui.look.icons import APP_ICON, icon_file, picture

PNG_SIZES = (16, 24, 32, 48, 64, 128, 256, 512, 1024)
ICO_SIZES = (16, 24, 32, 48, 64, 128, 256)


def write_icons(folder: Path) -> None:
    """Write all formats."""
    app = QGuiApplication.instance() or QGuiApplication(sys.argv[:1])
    assert app is not None
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(icon_file(APP_ICON), folder / "faceedit.svg")
    for size in PNG_SIZES:
        path = folder / f"faceedit-{size}.png"
        if not picture(APP_ICON, "", size, 1.0).save(str(path)):
            raise OSError(f"{path} was not written")
    pictures = [Image.open(folder / f"faceedit-{size}.png") for size in PNG_SIZES]
    largest = pictures[-1]
    # Each size is drawn by itself; pillow would scale the largest down.
    sizes = [(size, size) for size in ICO_SIZES]
    largest.save(folder / "faceedit.ico", sizes=sizes, append_images=pictures[:-1])
    largest.save(folder / "faceedit.icns", append_images=pictures[:-1])


if __name__ == "__main__":
    write_icons(Path(sys.argv[1] if len(sys.argv) > 1 else "build/packaging/icons"))

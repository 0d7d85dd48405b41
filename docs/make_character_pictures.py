"""Writes the pictures of docs/your_character.md from the real window, on ICT-FaceKit's light head.

    python docs/make_character_pictures.py ict_facekit.npz

ICT-FaceKit (USC Institute for Creative Technologies, 2020) is under the MIT licence, which allows
its pictures. The head itself is no part of the project: an `.npz` of its neutral vertices
(`vertices_cm`), triangles (`faces`), and shapes (`names`, `deltas_cm`) is read from where you have
it. Needs no display.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import numpy as np
import trimesh
from make_screenshots import PICTURES, SIZE, do, go_to, wait
from PySide6.QtCore import QPoint, QSettings
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QWidget

from faceedit_app.characters.character import Character, MeshPart, Surface
from faceedit_app.characters.fitted import fit
from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.ui.character.checklist import CharacterChecklist
from faceedit_app.ui.start.application import application
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.preferences import Preferences

# Linear colours of the head's pieces, by their numbers of vertices; the rest is teeth.
SKIN, MOUTH, TOOTH = (0.56, 0.36, 0.27), (0.3, 0.09, 0.08), (0.72, 0.66, 0.54)
PIECES = {14062: SKIN, 24: SKIN, 2977: MOUTH}
EYEBALL, WHITE, IRIS, PUPIL = 800, (0.75,) * 3, (0.08, 0.13, 0.16), (0.005,) * 3
# Corneas, what is wet around the eyes, and lashes: sheets, whose hair is only in a texture.
CLEAR = (770, 204, 152, 114)
IRIS_SIZE = 0.6  # cm around the axis of an eyeball
BESIDE = QPoint(24, 96)  # of the checklist in the window


def main(head: Path) -> None:
    """Walk from a GLB to its animation."""
    application()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "my_head.glb"
        write_glb(head, path)
        settings = QSettings(str(Path(folder) / "s.ini"), QSettings.Format.IniFormat)
        window = MainWindow(Preferences(settings))
        window.resize(*SIZE)
        window.show()
        window.open_demo_now()
        walk(window, path)
        window.leave()


def write_glb(head: Path, path: Path) -> None:
    """Write the head as a GLB, with colours for skin, eyes and teeth."""
    stored = np.load(head)
    places, faces = stored["vertices_cm"], stored["faces"].astype(np.int32)
    targets = {
        str(name): moves.astype(np.float32)
        for name, moves in zip(stored["names"], stored["deltas_cm"], strict=True)
    }
    labels, sizes = pieces_of(places, faces)
    colors = np.ones((len(places), 4), np.float32)
    for label, size in enumerate(sizes):
        mine = labels == label
        colors[mine, :3] = PIECES.get(size, TOOTH)
        if size == EYEBALL:
            colors[mine, :3] = eye_colors(places[mine])
    shown = faces[~np.isin(sizes[labels[faces[:, 0]]], CLEAR)]
    part = MeshPart("head", places, shown, targets, colors=colors, surface=Surface("Skin"))
    write_rig(path, fit(Character(path, "GLB", (part,))).rig)


def pieces_of(places: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The piece of each vertex (V,), and the number of vertices of each piece."""
    edges = trimesh.Trimesh(places, faces, process=False).edges
    labels = trimesh.graph.connected_component_labels(edges, len(places))
    return labels, np.bincount(labels)


def eye_colors(places: np.ndarray) -> np.ndarray:
    """(N, 3) white, iris and pupil of an eyeball that looks forward."""
    middle = (places.min(axis=0) + places.max(axis=0)) / 2
    aside = np.linalg.norm((places - middle)[:, :2], axis=1)
    aside[places[:, 2] < middle[2]] = np.inf
    colors = np.tile(np.array(WHITE), (len(places), 1))
    colors[aside < IRIS_SIZE] = IRIS
    colors[aside < IRIS_SIZE / 2.2] = PUPIL
    return colors


def walk(window: MainWindow, head: Path) -> None:
    """Open the head, fix lips on it, and look at what is exported."""
    editor = window.editor
    assert editor is not None
    wait(1.0)
    window.commands.file.character.open(head)
    while window.document.character is None:
        wait(0.1)
    checklist = window.findChild(CharacterChecklist)
    assert isinstance(checklist, CharacterChecklist)
    wait(1.0)
    shoot(window, "character_checklist", checklist)
    checklist.close()
    wait(1.0)  # problems are searched again, on the new character
    go_to(window, editor, "character")
    window.timeline.show_range(window.timeline.time - 1.6, window.timeline.time + 1.6)
    wait(1.0)
    shoot(window, "character_open_lips")
    there = window.timeline.time
    do(window, "fix_problem")
    wait(0.5)
    do(window, "accept_fix")
    window.timeline.go_to_time(there)
    wait(1.0)
    shoot(window, "character_shut_lips")


def shoot(window: MainWindow, name: str, dialog: QWidget | None = None) -> None:
    """The window as it is now, with a dialog over it."""
    picture = window.grab()
    if dialog is not None:
        with QPainter(picture) as painter:
            painter.drawPixmap(BESIDE, dialog.grab())
    picture.save(str(PICTURES / f"{name}.png"))


if __name__ == "__main__":
    main(Path(sys.argv[1]))

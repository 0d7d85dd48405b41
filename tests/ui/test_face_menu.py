"""What can be done with the face: where it is looked at from, and its picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QContextMenuEvent, QGuiApplication, QImage, qRgb
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QToolButton
from support.faces import shipped_rig
from support.waiting import run_events
from support.windows import Bench, drag, trigger

from faceedit_app.render import Aim, aimed_camera, default_camera
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.face.viewport import Viewport
from faceedit_app.ui.start.window import MainWindow

RIGHT = Qt.MouseButton.RightButton


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return bench.editing()


def viewport_of(window: MainWindow) -> Viewport:
    assert window.editor is not None
    return window.editor.face.viewport


def menus(window: MainWindow) -> list[QMenu]:
    """The context menus of the face that are open."""
    assert window.editor is not None
    return [menu for menu in window.editor.face.findChildren(QMenu) if menu.isVisible()]


def texts(menu: QMenu) -> list[str]:
    return [action.text().replace("&", "") for action in menu.actions() if action.text()]


def test_a_right_click_opens_the_menu_and_a_right_drag_moves_the_view(window: MainWindow) -> None:
    viewport = viewport_of(window)
    home = viewport.camera
    drag(viewport, QPoint(60, 0), RIGHT)
    assert menus(window) == []
    assert viewport.camera != home
    trigger(window, "reset_camera")
    QTest.mouseClick(viewport, RIGHT, pos=viewport.rect().center())
    (menu,) = menus(window)
    assert viewport.camera == home
    assert texts(menu)[:3] == ["Reset camera", "Left side", "Right side"]
    assert {"Show both faces", "Show difference", "Copy picture", "Save picture…"} <= {*texts(menu)}
    mouth = next(action for action in menu.actions() if action.text().endswith("Mouth"))
    menu.close()
    mouth.trigger()
    assert viewport.camera.distance < home.distance


def test_the_press_of_a_right_button_alone_opens_nothing(window: MainWindow) -> None:
    viewport, at = viewport_of(window), QPoint(30, 90)
    event = QContextMenuEvent(QContextMenuEvent.Reason.Mouse, at, viewport.mapToGlobal(at))
    QApplication.sendEvent(viewport, event)
    assert menus(window) == []


def test_the_key_for_menus_opens_it_too(window: MainWindow) -> None:
    viewport, at = viewport_of(window), QPoint(0, 0)
    event = QContextMenuEvent(QContextMenuEvent.Reason.Keyboard, at, viewport.mapToGlobal(at))
    QApplication.sendEvent(viewport, event)
    (menu,) = menus(window)
    menu.close()


@pytest.mark.parametrize(
    ("aim", "key"),
    [
        (Aim.LEFT, Qt.Key.Key_L),
        (Aim.RIGHT, Qt.Key.Key_R),
        (Aim.MOUTH, Qt.Key.Key_M),
        (Aim.EYES, Qt.Key.Key_E),
    ],
)
def test_cameras_are_chosen_by_key_and_stay_framed(
    bench: Bench, window: MainWindow, aim: Aim, key: Qt.Key
) -> None:
    viewport, rig = viewport_of(window), shipped_rig()
    window.activateWindow()
    bench.qtbot.waitActive(window)
    QTest.keyClick(QApplication.focusWidget() or window, key, Qt.KeyboardModifier.ShiftModifier)

    def framed(faces: int) -> bool:
        aspect = viewport.width() / faces / viewport.height()
        return viewport.camera == aimed_camera(rig, aim, aspect)

    assert framed(1)
    trigger(window, "show_both")
    assert framed(2)
    viewport.resize(viewport.width() - 100, viewport.height())
    assert framed(2)
    drag(viewport, QPoint(20, 0), Qt.MouseButton.LeftButton)
    turned = viewport.camera
    trigger(window, "show_edited")
    assert viewport.camera == turned, "what the user chose stays"
    trigger(window, "reset_camera")
    assert viewport.camera == default_camera(rig, viewport.width() / viewport.height())


def test_the_picture_is_copied_as_it_is_shown(window: MainWindow) -> None:
    viewport = viewport_of(window)
    trigger(window, "copy_picture")
    image = QGuiApplication.clipboard().image()
    ratio = viewport.devicePixelRatioF()
    assert image.width() == round(viewport.width() * ratio)
    assert image.height() == round(viewport.height() * ratio)
    trigger(window, "show_both")
    trigger(window, "copy_picture")
    pair = QGuiApplication.clipboard().image()
    names = pair.copy(0, pair.height() - 34, pair.width(), 24)
    below = image.copy(0, pair.height() - 34, pair.width(), 24)
    assert names != below, "it says which face is which"


def test_the_picture_is_saved(
    bench: Bench, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Path] = []

    def answer(_parent: object, suggestion: Path) -> Path:
        asked.append(suggestion)
        return bench.folder / "face.png"

    monkeypatch.setattr(dialogs, "ask_save_picture", answer)
    window.timeline.go_to_frame(30)
    trigger(window, "save_picture")
    assert asked == [bench.take.with_name("take_frame_31.png")]
    viewport = viewport_of(window)
    with Image.open(bench.folder / "face.png") as picture:
        assert picture.size[0] == round(viewport.width() * viewport.devicePixelRatioF())
    assert bench.errors == []
    (bench.folder / "face.png").write_text("my only recording")
    shown = QImage(5, 3, QImage.Format.Format_RGB32)  # of a width that Qt pads
    for x, y in np.ndindex(5, 3):
        shown.setPixel(x, y, qRgb(40 * x, 90 * y, 7))
    monkeypatch.setattr(viewport, "picture", lambda: shown)
    trigger(window, "save_picture")
    with Image.open(bench.folder / "face.png") as picture:
        assert all(picture.getpixel((x, y)) == (40 * x, 90 * y, 7) for x, y in np.ndindex(5, 3))
    assert "; the file that was there is now face.png.bak" in window.status.currentMessage()


def test_a_picture_that_cannot_be_written_is_one_line(
    bench: Bench, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dialogs, "ask_save_picture", lambda *_: bench.folder / "no" / "face.png")
    trigger(window, "save_picture")
    (line,) = bench.errors
    assert "face.png" in line
    assert not (bench.folder / "no").exists()


def test_without_a_face_there_is_no_picture(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("faceedit_app.render.open_renderer", bench.no_gl)
    window = bench.editing()
    assert not window.actions_["copy_picture"].isEnabled()
    assert not window.actions_["save_picture"].isEnabled()
    viewport_of(window).close_renderer()


def test_beside_a_film_there_is_room_for_the_words_on_the_buttons(window: MainWindow) -> None:
    assert window.editor is not None
    pane = window.editor.face
    buttons = [b for b in pane.findChildren(QToolButton) if b.text() in ("Edited", "Tracked")]
    assert len(buttons) == 2
    pane.resize(pane.minimumSizeHint())
    run_events()
    assert all(button.width() >= button.sizeHint().width() for button in buttons)

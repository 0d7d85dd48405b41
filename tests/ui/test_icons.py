"""The icons are there for every command that names one, and are drawn in the colour asked for."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import pytest
from PySide6.QtGui import QColor, QIcon, QPixmap
from PySide6.QtWidgets import QApplication, QMenu
from support.theme import themed

from faceedit_app.ui.commands.menus import MENUS
from faceedit_app.ui.look import icons
from faceedit_app.ui.look.palette import FAINT, TEXT

NAMES = sorted(path.stem for path in icons.icon_file("x").parent.glob("*.svg"))

assert NAMES, "the icons have moved"


def inks(pixmap: QPixmap) -> set[str]:
    """The colours of the pixels that are covered in full."""
    image = pixmap.toImage()
    colors = (image.pixelColor(x, y) for x in range(image.width()) for y in range(image.height()))
    return {color.name() for color in colors if color.alpha() == 255}


def test_every_command_has_the_icon_that_it_names() -> None:
    named = {command.icon for menu in MENUS for command in menu.commands if command.icon}
    assert len(named) > 20
    assert named <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_files_are_drawings_in_the_colour_asked_for(qapp: QApplication, name: str) -> None:
    root = ElementTree.parse(icons.icon_file(name)).getroot()
    colors = {
        value
        for element in root.iter()
        for key, value in element.attrib.items()
        if key in ("fill", "stroke") and value != "none"
    }
    # The style sheet cannot ask for a colour.
    if name in (icons.APP_ICON, "list_arrow", "menu_tick", "menu_tick_disabled"):
        assert "currentColor" not in colors
        return
    assert colors == {"currentColor"}
    assert root.get("viewBox") == f"0 0 {icons.SIZE} {icons.SIZE}"
    drawn = inks(icons.picture(name, "#123456", 64, 1.0))
    assert drawn
    assert all(abs(QColor(ink).blue() - 0x56) < 3 for ink in drawn)


def test_no_screen_shows_a_scaled_icon(qapp: QApplication, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(icons, "_ratios", lambda: [1.0, 1.25, 2.0])
    icon = icons.icon("play")
    for mode in (QIcon.Mode.Normal, QIcon.Mode.Disabled):
        widths = {size.width() for size in icon.availableSizes(mode)}
        assert widths == {16, 20, 32}
    assert icons.picture("play", "#ffffff", 16, 1.25).devicePixelRatio() == 1.25


def test_menus_show_what_is_on_with_and_without_an_icon(qapp: QApplication) -> None:
    themed()
    for name in ("tool_move", ""):
        menu, pictures = QMenu(), []
        action = menu.addAction(icons.icon(name) if name else QIcon(), "Move")
        action.setCheckable(True)
        for is_on in (False, True):
            action.setChecked(is_on)
            menu.adjustSize()
            pictures.append(menu.grab(menu.actionGeometry(action)).toImage())
        assert pictures[0] != pictures[1], name or "without an icon"


def test_the_tick_of_what_is_disabled_is_as_dim_as_its_icon_would_be(qapp: QApplication) -> None:
    themed()
    menu = QMenu()
    action = menu.addAction("")  # nothing but the tick
    action.setCheckable(True)
    action.setChecked(True)
    for is_enabled, color in ((True, TEXT), (False, FAINT)):
        action.setEnabled(is_enabled)
        menu.adjustSize()
        drawn = menu.grab(menu.actionGeometry(action))
        assert max(inks(drawn), key=lambda ink: QColor(ink).lightness()) == color

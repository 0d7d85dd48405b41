"""Context menus of the curves panel: on a curve, on its name and on the ruler."""

from __future__ import annotations

from PySide6.QtCore import QPoint, SignalInstance
from PySide6.QtGui import QAction

from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.look.widgets import context_menu
from faceedit_app.ui.state.actions import Actions

Groups = tuple[tuple[str, ...], ...]  # ids of commands; a line separates the groups

CURVE: Groups = (
    ("undo",),
    ("fix_close_lips", "fix_blink", "fix_problem"),
    ("reset_curve", "reset_range"),
    ("copy", "copy_changes", "paste", "paste_mirrored"),
    ("mark_start", "mark_end", "select_all", "deselect"),
    ("fit", "fit_values"),
)
NAME: Groups = (("raise", "lower"), ("link",), ("reset_curve",), ("fit_values",))
RULER: Groups = (
    ("mark_start", "mark_end", "select_all", "deselect"),
    ("fit", "zoom_in", "zoom_out"),
    ("unit_seconds", "unit_frames", "unit_timecode"),
    ("go_to", "play_around", "loop"),
)


def connect_menus(curves: CurvesPanel, actions: Actions) -> None:
    """Show the context menus when the panel asks for them."""
    for asked, groups in (
        (curves.curve_menu_asked, CURVE),
        (curves.name_menu_asked, NAME),
        (curves.time_menu_asked, RULER),
    ):
        _connect(curves, actions, asked, groups)


def _connect(curves: CurvesPanel, actions: Actions, asked: SignalInstance, groups: Groups) -> None:
    def show(place: QPoint) -> None:
        actions.refresh()
        chosen: list[list[QAction]] = [[actions[name] for name in group] for group in groups]
        context_menu(curves, *chosen).popup(place)

    asked.connect(show)

"""Context menus of the curves panel: on a curve, on its name and on the ruler."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QPoint, SignalInstance

from faceedit_app.editing.help.presets import shipped_presets
from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.look.widgets import context_menu
from faceedit_app.ui.state.actions import Actions

Groups = tuple[tuple[str, ...], ...]  # ids of commands; a line separates the groups

NAME: Groups = (
    ("choose_curve", "link"),
    ("raise", "lower"),
    ("reset_curve",),
    ("show_only_curve", "hide_curve", "show_all_curves"),
    ("enlarge_curve", "fit_values"),
)
RETIME = ("stretch_time", "move_time", "cut_time", "insert_pause")
RULER: Groups = (
    ("mark_start", "mark_end", "select_around", "select_all", "deselect"),
    RETIME,
    ("fit", "view_all", "zoom_in", "zoom_out"),
    ("unit_seconds", "unit_frames", "unit_timecode"),
    ("go_to", "play_around", "loop"),
)


def curve_groups(control: str) -> Groups:
    """What is possible on the curve of a control; of the fixes, those that change it."""
    fixes = (
        f"fix_{preset.id}"
        for preset in shipped_presets()
        if any(control in edit.controls for edit in preset.edits)
    )
    return (
        ("undo",),
        (*fixes, "fix_problem"),
        ("reset_curve", "reset_range"),
        ("copy", "copy_changes", "paste", "paste_mirrored"),
        RETIME,
        ("select_around", "mark_start", "mark_end", "select_all", "deselect"),
        ("fit", "view_all", "fit_values"),
    )


def connect_menus(curves: CurvesPanel, actions: Actions) -> None:
    """Show the context menus when the panel asks for them."""

    def on_curve() -> Groups:
        return curve_groups(curves.focused_control or "")

    _connect(curves, actions, curves.curve_menu_asked, on_curve)
    _connect(curves, actions, curves.name_menu_asked, lambda: NAME)
    _connect(curves, actions, curves.time_menu_asked, lambda: RULER)


def _connect(
    curves: CurvesPanel, actions: Actions, asked: SignalInstance, groups: Callable[[], Groups]
) -> None:
    def show(place: QPoint) -> None:
        actions.refresh()
        chosen = [[actions[name] for name in group] for group in groups()]
        context_menu(curves, *chosen).popup(place)

    asked.connect(show)

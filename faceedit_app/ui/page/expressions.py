"""Expressions and mouth shapes, each with a picture of the face."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from PySide6.QtCore import QSize, Qt, QTimer
from PySide6.QtGui import QIcon, QPixmap, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QGridLayout, QScrollArea, QToolButton, QWidget

from faceedit_app.core.controls import control_named
from faceedit_app.core.regions import BROWS, EYELIDS, JAW, LOWER
from faceedit_app.core.texts import listed
from faceedit_app.editing.help.poses import has_pose, pose_of
from faceedit_app.editing.help.presets import Alone, Preset, shipped_presets
from faceedit_app.render import Aim
from faceedit_app.ui.face.viewport import Viewport
from faceedit_app.ui.look.theme import GAP, MARGIN
from faceedit_app.ui.look.widgets import Elided, OneClick
from faceedit_app.ui.state.actions import Actions, tip_of
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.time_display import shown_range
from faceedit_app.ui.state.timeline import Timeline

if TYPE_CHECKING:  # the networks are imported after the window is up
    from faceedit_app.core.rig import Rig
    from faceedit_app.networks.engine import Engine

PICTURE = (70, 42)  # pixels: on a small screen two rows are seen, with their names
_WIDTH = PICTURE[0] + 22
_DETAILS = {Aim.MOUTH: {LOWER.id, JAW.id}, Aim.EYES: {EYELIDS.id, BROWS.id}}


def aim_of(preset: Preset) -> Aim:
    """What a picture of a preset shows: the part of the face that it moves, or the whole face."""
    controls = {control for edit in preset.edits for control in edit.controls}
    moved = {control_named(control).region for control in controls}
    return next((aim for aim, regions in _DETAILS.items() if moved <= regions), Aim.FRONT)


def where_acts(presets: Sequence[Preset], line: Timeline) -> tuple[str, str]:
    """Where presets act if they are chosen now, in few words and in a sentence."""
    if line.own_selection is not None and line.rows is not None:
        span = shown_range(line.rows, *line.own_selection, line.display.unit)
        return f"In the selection, {span}", f"A click acts in the selection, {span}"
    whole = [preset.name for preset in presets if preset.alone is Alone.TAKE]
    if not whole:
        return "At the playhead", "A click acts at the playhead; select a range to act there"
    names, verb = listed(whole), "acts" if len(whole) == 1 else "act"
    if len(whole) == len(presets):
        return "On the whole take", "A click acts on the whole take; select a range to act there"
    text = f"{names} {verb} on the whole take, the others at the playhead; select a range instead"
    return f"{names}: whole take; others: at the playhead", text


class Expressions(QScrollArea):
    """A button for each; a click applies it to the selection, or where its fix acts without one.

    The pictures are drawn when they are first seen, one at a time, and again for another
    character.
    """

    def __init__(
        self, actions: Actions, document: Document, viewport: Viewport, timeline: Timeline
    ) -> None:
        super().__init__()
        self._document, self._viewport, self._timeline = document, viewport, timeline
        self._presets = tuple(preset for preset in shipped_presets() if has_pose(preset))
        self._waiting: list[Preset] = []
        self._drawn_for: tuple[Rig, Engine | None] | None = None
        self._next = QTimer(self, singleShot=True, interval=0)  # when no event is waiting
        self._next.timeout.connect(self._draw_next)
        self.buttons = {preset.id: self._button(actions, preset) for preset in self._presets}
        self.where = Elided()
        self._build()
        for changed in (timeline.selection_changed, timeline.display.changed, document.opened):
            changed.connect(self._show_where)
        self._show_where()
        document.changed.connect(self._look)
        viewport.opened.connect(self._look)

    def _button(self, actions: Actions, preset: Preset) -> QToolButton:
        action = actions[f"fix_{preset.id}"]
        button = OneClick()
        button.setObjectName("tool")
        button.setText(preset.name)
        button.setToolTip(tip_of(action))
        button.setIcon(action.icon())
        button.setIconSize(QSize(*PICTURE))
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextUnderIcon)
        button.setFixedWidth(_WIDTH)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        button.clicked.connect(action.trigger)
        return button

    def _build(self) -> None:
        self.setObjectName("expressions")
        self.setAccessibleName("Expressions")
        self.setFrameShape(QScrollArea.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        page = QWidget()
        self._grid = QGridLayout(page)
        self._grid.setContentsMargins(GAP, 0, GAP, 0)  # two rows just fit
        self._grid.setSpacing(GAP // 2)
        self._grid.setAlignment(Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft)
        self.setWidget(page)
        self.where.setParent(self)
        self.where.setObjectName("caption")
        self._place()

    def _show_where(self) -> None:
        """Say where a click acts: in the selection, else on the whole take or at the playhead."""
        self.where.short, text = where_acts(self._presets, self._timeline)
        self.where.setText(text)
        self.where.setToolTip(text)

    def _place(self) -> None:
        """As many beside each other as there is room for."""
        columns = max((self.viewport().width() - 2 * GAP) // (_WIDTH + GAP // 2), 1)
        for number, button in enumerate(self.buttons.values()):
            self._grid.addWidget(button, number // columns, number % columns)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fill the width."""
        super().resizeEvent(event)
        height = self.where.sizeHint().height() + GAP // 2
        self.setViewportMargins(0, height, 0, 0)
        self.where.setGeometry(MARGIN, 0, self.width() - 2 * MARGIN, height)
        self._place()

    # --- pictures ------------------------------------------------------------------------------

    @property
    def is_drawn(self) -> bool:
        """Whether all pictures are those of the present character."""
        return self._drawn_for is not None and not self._waiting

    def showEvent(self, event: QShowEvent) -> None:
        """Draw the pictures, if they are not there yet."""
        super().showEvent(event)
        self._look()

    def _look(self) -> None:
        """Draw the pictures again if character or networks are others."""
        session = self._document.session
        if session is None or not self.isVisible() or not self._viewport.can_draw:
            return
        rig, engine = session.shown_rig, self._document.engine
        drawn, drawn_engine = self._drawn_for or (None, None)
        if rig is not drawn or engine is not drawn_engine:
            self._drawn_for, self._waiting = (rig, engine), list(self._presets)
            self._next.start()

    def _draw_next(self) -> None:
        session = self._document.session
        if session is None or not self._waiting:
            return
        preset = self._waiting.pop(0)
        weights = pose_of(preset, session, self._document.engine)
        ratio = self.devicePixelRatioF()
        size = round(PICTURE[0] * ratio), round(PICTURE[1] * ratio)
        image = self._viewport.thumbnail(weights, size, aim_of(preset))
        if image is not None:
            image.setDevicePixelRatio(ratio)
            self.buttons[preset.id].setIcon(QIcon(QPixmap.fromImage(image)))
        if self._waiting:
            self._next.start()

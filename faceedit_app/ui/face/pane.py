"""The face pane: the viewport and its buttons, following the playhead and the edits."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPoint, QRect, QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from faceedit_app.core.arrays import Floats
from faceedit_app.editing.session import EditSession
from faceedit_app.render import Aim
from faceedit_app.ui.face.handles import FaceHandles
from faceedit_app.ui.face.viewport import Viewport
from faceedit_app.ui.look.theme import GAP, MARGIN
from faceedit_app.ui.look.widgets import context_menu, icon_button, segments
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.gap_frames import values_at, weights_at
from faceedit_app.ui.state.timeline import Timeline

MENU = (
    ("reset_camera", *(f"camera_{aim}" for aim in Aim if aim is not Aim.FRONT), "focus_face"),
    ("show_edited", "show_tracked", "show_both", "show_difference", "follow_head"),
    ("neutral_frame",),
    ("copy_picture", "save_picture"),
)


class FacePane(QWidget):
    """Shows the frame at the playhead, edited or tracked.

    Signals:
        switched(): the face shown, or its tint, changed.
    """

    switched = Signal()

    def __init__(self, actions: Actions, document: Document, timeline: Timeline) -> None:
        super().__init__()
        self._actions, self._document, self._timeline = actions, document, timeline
        self._tracked, self._glancing, self._both = False, False, False
        self._difference = self._follows = False
        self._shown: list[Floats] = []  # what the edited face was last drawn from
        self.viewport = Viewport(self)
        self.handles = FaceHandles(self.viewport)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.viewport)
        self._overlay = QWidget(self)
        row = QHBoxLayout(self._overlay)
        row.setContentsMargins(MARGIN, MARGIN, MARGIN, 0)
        which = segments(
            (actions["show_edited"], "Edited"),
            (actions["show_tracked"], "Tracked"),
            (actions["show_both"], "Both"),
        )
        row.addWidget(which)
        row.addStretch()
        camera = icon_button(actions["reset_camera"])
        row.addWidget(camera)
        self._switches = (which, camera)
        self.viewport.covered_by = (*self._switches, self.viewport.legend)
        # Only the buttons take the mouse, so that the camera can be moved between them.
        self._overlay.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        self.viewport.opened.connect(self.switched)
        self.viewport.menu_asked.connect(self._show_menu)
        timeline.playhead_moved.connect(self.refresh)
        document.opened.connect(self.refresh)
        document.changed.connect(self.refresh)

    @property
    def shows_tracked(self) -> bool:
        """Whether the tracked face is shown."""
        return self._tracked or self._glancing

    def set_tracked(self, tracked: bool) -> None:
        """Show the tracked face, or the edited one."""
        self._tracked, self._both = tracked, False
        self._switched()

    @property
    def is_glancing(self) -> bool:
        """Whether the tracked face is shown only while a key is held."""
        return self._glancing

    @property
    def shows_both(self) -> bool:
        """Whether the tracked face is shown beside the edited one."""
        return self._both and not self._glancing

    def show_both(self) -> None:
        """Show the tracked face beside the edited one."""
        self._tracked, self._both = False, True
        self._switched()

    @property
    def shows_difference(self) -> bool:
        """Whether the edited face is tinted by its distance from the tracked one."""
        return self._difference

    def show_difference(self, wanted: bool) -> None:
        """Tint the edited face, and show it; or remove the tint."""
        self._difference = wanted
        if wanted:
            self._tracked = False
        self._switched()

    @property
    def follows_head(self) -> bool:
        """Whether the head turns as it was recorded."""
        return self._follows

    def follow_head(self, wanted: bool) -> None:
        """Turn the head as it was recorded, or keep it straight."""
        self._follows = wanted
        self._switched()

    def _turn_heads(self, session: EditSession) -> None:
        """Turn the heads as they are at the playhead, if they are to follow."""
        line, edited, tracked = self._timeline, session.rotations, session.take.clip.rotations
        if not self._follows or edited is None or tracked is None:
            self.viewport.turn_heads(None)
            return
        shown = tracked if self.shows_tracked else edited
        self.viewport.turn_heads(values_at(shown, line), values_at(tracked, line))

    def aim(self, aim: str) -> None:
        """Point the camera: see `render.Aim`."""
        self.viewport.aim(Aim(aim))

    def glance(self, glancing: bool) -> None:
        """Show the tracked face while a key is held."""
        self._glancing = glancing
        self._switched()

    def _switched(self) -> None:
        self._place_legend()
        self.switched.emit()
        self.refresh()

    def _pose(self, session: EditSession) -> list[Floats]:
        """What the edited face at the playhead is drawn from."""
        turns, line = session.rotations, self._timeline
        weights = session.shown_rig.from_arkit(weights_at(session, line)).copy()
        return [weights] if turns is None else [weights, values_at(turns, line).copy()]

    def _tracked_pose(self, session: EditSession) -> Floats:
        """What the tracked face at the playhead is drawn from."""
        return session.shown_rig.from_arkit(values_at(session.tracked_weights, self._timeline))

    def refresh_if_other(self) -> None:
        """Show the frame at the playhead, unless it is shown: a new picture is rough at first."""
        session = self._document.session
        if session is None:
            return
        now = self._pose(session)
        if len(now) != len(self._shown) or not all(map(np.array_equal, now, self._shown)):
            self.refresh()

    def refresh(self) -> None:
        """Show the frame at the playhead."""
        session = self._document.session
        if session is not None:
            self._shown = self._pose(session)
            compares = self._difference and not self.shows_tracked
            needs_tracked = compares or self.shows_both or self.shows_tracked
            tracked = self._tracked_pose(session) if needs_tracked else None
            self.handles.use_rig(session.shown_rig)
            self.handles.is_wanted = not (self.shows_tracked or self.shows_both)
            self._turn_heads(session)
            self.viewport.show_weights(
                tracked if tracked is not None and self.shows_tracked else self._shown[0],
                beside=tracked if self.shows_both else None,
                against=tracked if compares else None,
            )

    def _show_menu(self, at: QPoint) -> None:
        """Show the viewport's menu."""
        groups = [[self._actions[name] for name in group] for group in MENU]
        context_menu(self, *groups).popup(at)

    def minimumSizeHint(self) -> QSize:
        """Wide enough for the buttons and their texts."""
        buttons = self._overlay.minimumSizeHint().width()
        return super().minimumSizeHint().expandedTo(QSize(buttons, 0))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the buttons at the top, and the legend in its place."""
        super().resizeEvent(event)
        self._overlay.setGeometry(0, 0, self.width(), self._overlay.sizeHint().height())
        self._place_legend()

    def _place_legend(self) -> None:
        """Put the legend between the buttons, or at the bottom, where it hides no face.

        There it is short: beside the neck, or between the names of two faces.
        """
        legend = self.viewport.legend
        legend.shorten(False)
        which, camera = (switch.sizeHint().width() for switch in self._switches)
        at = QPoint(self.width() - MARGIN - camera - GAP - legend.sizeHint().width(), MARGIN)
        if at.x() < MARGIN + which + GAP:
            legend.shorten(True)
            size = legend.sizeHint()
            middle = (self.width() - size.width()) // 2
            at.setX(middle if self.shows_both else self.width() - GAP // 2 - size.width())
            at.setY(self.height() - GAP // 2 - size.height())
        legend.setGeometry(QRect(at, legend.sizeHint()))

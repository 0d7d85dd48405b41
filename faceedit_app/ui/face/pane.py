"""The face pane: the viewport with its switches, following the playhead and the edits."""

from __future__ import annotations

from PySide6.QtCore import QPoint, QRect, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from faceedit_app.render import Aim
from faceedit_app.ui.face.viewport import Viewport
from faceedit_app.ui.look.theme import GAP, MARGIN
from faceedit_app.ui.look.widgets import context_menu, icon_button, segments
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline

MENU = (
    ("reset_camera", *(f"camera_{aim}" for aim in Aim if aim is not Aim.FRONT), "focus_face"),
    ("show_edited", "show_tracked", "show_both", "show_difference"),
    ("copy_picture", "save_picture"),
)


class FacePane(QWidget):
    """Shows the frame under the playhead, as edited or as tracked.

    Signals:
        switched(): another face, a tint, or none is shown.
    """

    switched = Signal()

    def __init__(self, actions: Actions, document: Document, timeline: Timeline) -> None:
        super().__init__()
        self._actions, self._document, self._timeline = actions, document, timeline
        self._tracked, self._glancing, self._both = False, False, False
        self._difference = False
        self.viewport = Viewport(self)
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
        # Only its buttons take the mouse: the face between them can be turned.
        self._overlay.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        self.viewport.opened.connect(self.switched)
        self.viewport.menu_asked.connect(self._show_menu)
        timeline.playhead_moved.connect(self.refresh)
        document.opened.connect(self.refresh)
        document.changed.connect(self.refresh)

    @property
    def shows_tracked(self) -> bool:
        """Whether the face as tracked is on screen."""
        return self._tracked or self._glancing

    def set_tracked(self, tracked: bool) -> None:
        """Show the face as tracked, or as edited."""
        self._tracked, self._both = tracked, False
        self._switched()

    @property
    def shows_both(self) -> bool:
        """Whether the tracked face stands beside the edited one."""
        return self._both and not self._glancing

    def show_both(self) -> None:
        """Show the face as tracked beside the edited one."""
        self._tracked, self._both = False, True
        self._switched()

    @property
    def shows_difference(self) -> bool:
        """Whether the edited face is tinted where and how far it is from the tracked one."""
        return self._difference

    def show_difference(self, wanted: bool) -> None:
        """Tint the edited face, and let it be seen; or leave it plain."""
        self._difference = wanted
        if wanted:
            self._tracked = False
        self._switched()

    def aim(self, aim: str) -> None:
        """Point the camera: see `render.Aim`."""
        self.viewport.aim(Aim(aim))

    def glance(self, glancing: bool) -> None:
        """Show the face as tracked for as long as a key is held."""
        self._glancing = glancing
        self._switched()

    def _switched(self) -> None:
        self.switched.emit()
        self.refresh()

    def refresh(self) -> None:
        """Show the frame under the playhead."""
        session = self._document.session
        if session is not None:
            frame = min(max(self._timeline.frame, 0), len(session.weights) - 1)
            compares = self._difference and not self.shows_tracked
            tracked = (
                session.rig_weights(frame, tracked=True) if compares or self.shows_both else None
            )
            self.viewport.show_weights(
                session.rig_weights(frame, self.shows_tracked),
                beside=tracked if self.shows_both else None,
                against=tracked if compares else None,
            )

    def _show_menu(self, at: QPoint) -> None:
        """What can be done with the face."""
        groups = [[self._actions[name] for name in group] for group in MENU]
        context_menu(self, *groups).popup(at)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the switches at the top, and the legend between or below them."""
        super().resizeEvent(event)
        height = self._overlay.sizeHint().height()
        self._overlay.setGeometry(0, 0, self.width(), height)
        which, camera = (switch.sizeHint().width() for switch in self._switches)
        size, at = self.viewport.legend.sizeHint(), QPoint(0, MARGIN)
        at.setX(self.width() - MARGIN - camera - GAP - size.width())
        if at.x() < MARGIN + which + GAP:
            at = QPoint(self.width() - MARGIN - size.width(), height + GAP // 2)
        self.viewport.legend.setGeometry(QRect(at, size))

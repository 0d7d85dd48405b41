"""The page with an open take: strip, curves and face side by side, transport."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractScrollArea, QSplitter, QVBoxLayout, QWidget

from faceedit_app.ui.actions import Actions
from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.document import Document
from faceedit_app.ui.face import FacePane
from faceedit_app.ui.playback import Playback
from faceedit_app.ui.strip import SettingsStrip
from faceedit_app.ui.timeline import Timeline
from faceedit_app.ui.toolbar import ToolBar
from faceedit_app.ui.tooling import Tooling
from faceedit_app.ui.transport import Transport

_SHARES = (760, 520)  # of the window's width at first: curves, face


class Editor(QWidget):
    """Puts the parts together and lets each hear of the others' changes."""

    def __init__(
        self,
        actions: Actions,
        document: Document,
        timeline: Timeline,
        playback: Playback,
        tooling: Tooling,
    ) -> None:
        super().__init__()
        self._document, self._timeline, self._playback = document, timeline, playback
        self.strip = SettingsStrip(actions, document)
        self.tools = ToolBar(actions, tooling)
        self.curves = CurvesPanel(timeline, tooling)
        self.face = FacePane(
            document,
            timeline,
            actions["show_edited"],
            actions["show_tracked"],
            actions["reset_camera"],
        )
        self.transport = Transport(actions, timeline, playback)
        self.panes = QSplitter(Qt.Orientation.Horizontal)
        self.panes.setChildrenCollapsible(False)
        self.panes.setHandleWidth(6)
        self.panes.addWidget(self.curves)
        self.panes.addWidget(self.face)
        self.panes.setSizes(_SHARES)
        self.panes.setStretchFactor(0, 3)
        self.panes.setStretchFactor(1, 2)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.strip)
        column.addWidget(self.tools)
        column.addWidget(self.panes, 1)
        column.addWidget(self.transport)
        for view in self.curves.findChildren(QAbstractScrollArea):
            # Graphics views take every drop and do nothing with it; files are the window's.
            view.setAcceptDrops(False)
            view.viewport().setAcceptDrops(False)
        self.curves.edited.connect(self._dragged)
        self.curves.committed.connect(document.changed)
        document.changed.connect(self.curves.refresh)

    def open(self) -> None:
        """Show the document's take from its beginning."""
        session = self._document.session
        assert session is not None
        clip = session.take.clip
        self._timeline.open(clip)
        self.curves.set_session(session)
        self.transport.set_clip(clip)
        self.face.refresh()

    def _dragged(self) -> None:
        # The face stays on the frame that is being changed.
        self._playback.pause()
        self.face.refresh()

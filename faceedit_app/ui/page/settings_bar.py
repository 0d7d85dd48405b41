"""The bar above the curves: undo, reset, and the settings that apply to all edits."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget

from faceedit_app.formats.timing import counted
from faceedit_app.ui.edits.groups import groups_of
from faceedit_app.ui.look.theme import GAP
from faceedit_app.ui.look.widgets import Elided, bar_row, caption, divider, icon_button, segments
from faceedit_app.ui.page.setting_slider import NAME, SettingSlider
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline

PRESERVE_TIP = (
    "Preserve the take: only the frames and curves that your edits affect change;\n"
    "everything else stays exactly as tracked."
)
RESYNTHESIZE_TIP = (
    "Resynthesize: the face model generates the edited regions of the face from\n"
    "the curves, over the whole take. Every frame changes a little."
)
EXACT_TIP = (
    "How closely the face follows your curves, for all edits.\n"
    "Natural: only as far as the face model thinks natural.\n"
    "Middle: as close as a natural face can get; FaceEdit starts here, and a double click\n"
    "goes back here.\n"
    "Exact: to the letter."
)


class SettingsBar(QWidget):
    """Undo, redo, reset; mode, natural to exact; the number of edits."""

    def __init__(self, actions: Actions, document: Document, timeline: Timeline) -> None:
        super().__init__()
        self._document, self._actions, self._timeline = document, actions, timeline
        actions["preserve"].setToolTip(PRESERVE_TIP)
        actions["resynthesize"].setToolTip(RESYNTHESIZE_TIP)
        self.setting = SettingSlider(document, EXACT_TIP)
        self.exactness = self.setting.slider
        self.edits = Elided()
        self.edits.setObjectName("caption")
        self._lay_out()
        document.opened.connect(self.sync)
        document.changed.connect(self.sync)
        self.sync()

    def _lay_out(self) -> None:
        row = bar_row(self, "bar")
        row.addWidget(icon_button(self._actions["open"]))
        row.addWidget(icon_button(self._actions["save"]))
        row.addWidget(icon_button(self._actions["export"], text="Export"))
        row.addWidget(divider())
        row.addWidget(icon_button(self._actions["undo"], repeats=True))
        row.addWidget(icon_button(self._actions["redo"], repeats=True))
        row.addWidget(icon_button(self._actions["reset_range"], text="Reset range"))
        row.addWidget(divider())
        row.addSpacing(GAP // 2)
        row.addWidget(self.edits, 1)
        row.addWidget(
            segments(
                (self._actions["preserve"], "Preserve"),
                (self._actions["resynthesize"], "Resynthesize"),
            )
        )
        row.addSpacing(GAP)
        row.addWidget(caption("Natural"))
        row.addWidget(self.exactness)
        row.addWidget(caption("Exact"))
        self.exactness.setAccessibleName(NAME)

    def settle(self) -> None:
        """Commit a gesture on the slider now."""
        self.setting.settle()

    def cancel(self) -> bool:
        """Cancel the slider's drag; False if there is none."""
        return self.setting.cancel()

    # --- what it shows -----------------------------------------------------------------------

    def sync(self) -> None:
        """Show the open take's settings."""
        self.setting.sync()
        self._count()

    def _count(self) -> None:
        session, text, edits = self._document.session, "", ""
        if session is not None and session.is_previewing:
            return  # its frames are not those of the kept edits
        if session is not None and not session.edits:
            text = "No edits"
        elif session is not None:
            filled = len(self._timeline.filled_frames or ())  # `changed_frames` would wait for them
            frames = counted(session.live.changed_frames + filled, "frame")
            edits = counted(len(groups_of(session.edits)), "edit")  # as many as rows
            text = f"{edits} · {frames} changed"
        self.edits.short = edits
        self.edits.setText(text)
        self.edits.setToolTip(text)

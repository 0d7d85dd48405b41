"""The bar above the curves: undo, reset, and the settings that apply to all edits."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget

from faceedit_app.formats.timing import counted
from faceedit_app.ui.look.theme import GAP
from faceedit_app.ui.look.widgets import Elided, bar_row, caption, divider, icon_button, segments
from faceedit_app.ui.page.setting_slider import SettingSlider
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.document import Document

PRESERVE_TIP = (
    "Preserve the take: only the frames and curves that your edits affect change;\n"
    "everything else stays exactly as recorded."
)
RESYNTHESIZE_TIP = (
    "Resynthesize: the face model generates the edited regions of the face from\n"
    "the curves, over the whole take. Every frame changes a little."
)
NATURAL_TIP = (
    "How natural the face must look after an edit.\n"
    "0 %: follow the curve to the letter. 100 %: do only what real faces do."
)
REACH_TIP = (
    "How closely the face follows the curve you asked for.\n"
    "0 %: as close as the face model gets. 100 %: as close as a face can."
)


class SettingsBar(QWidget):
    """Undo, redo, reset; mode, naturalness and reach; the number of edits."""

    def __init__(self, actions: Actions, document: Document) -> None:
        super().__init__()
        self._document, self._actions = document, actions
        actions["preserve"].setToolTip(PRESERVE_TIP)
        actions["resynthesize"].setToolTip(RESYNTHESIZE_TIP)
        self.sliders = (
            SettingSlider(document, "naturalness", NATURAL_TIP),
            SettingSlider(document, "reach", REACH_TIP),
        )
        self.natural, self.reach = (slider.slider for slider in self.sliders)
        self.percent = self.sliders[0].percent
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
        row.addWidget(icon_button(self._actions["undo"]))
        row.addWidget(icon_button(self._actions["redo"]))
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
        for words, slider in zip(("Natural", "Reach"), self.sliders, strict=True):
            row.addSpacing(GAP)
            row.addWidget(caption(words, slider.slider))
            row.addWidget(slider.slider)
            row.addWidget(slider.percent)

    def settle(self) -> None:
        """Commit a gesture on a slider now."""
        for slider in self.sliders:
            slider.settle()

    def cancel(self) -> bool:
        """Cancel a slider's drag; False if there is none."""
        return any(slider.cancel() for slider in self.sliders)

    # --- what it shows -----------------------------------------------------------------------

    def sync(self) -> None:
        """Show the open take's settings."""
        for slider in self.sliders:
            slider.sync()
        self._count()

    def _count(self) -> None:
        session, text = self._document.session, ""
        if session is not None and not session.edits:
            text = "No edits"
        elif session is not None:
            frames = counted(session.changed_frames(), "frame")
            text = f"{counted(len(session.edits), 'edit')} · {frames} changed"
        self.edits.setText(text)
        self.edits.setToolTip(text)

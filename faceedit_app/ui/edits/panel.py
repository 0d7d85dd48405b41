"""The panel with the list of edits, and their strength."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from PySide6.QtCore import QItemSelection, QItemSelectionModel, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtWidgets import (
    QApplication,
    QHBoxLayout,
    QLabel,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.retime import reshaped
from faceedit_app.ui.edits.delegate import STRONGEST, EditsDelegate, RowField
from faceedit_app.ui.edits.model import EditsModel
from faceedit_app.ui.edits.rows import EditRows
from faceedit_app.ui.edits.undone import UndoneChoice
from faceedit_app.ui.look.gesture_slider import GestureSlider
from faceedit_app.ui.look.theme import GAP, MARGIN
from faceedit_app.ui.look.widgets import caption, context_menu, icon_button
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline

_EMPTY = (
    "No edits yet. Drag a curve, or click one of the fixes above. "
    "Each is listed here, to change its strength, switch it off or delete it."
)
MENU = ("toggle_edit", "rename_edit", "edit_up", "edit_down", "delete_edit")


class EditsPanel(QWidget):
    """List and strength; the selected edit shows its range on the curves.

    Signals:
        selected(): the selected edits may have changed.
    """

    selected = Signal()

    def __init__(self, actions: Actions, document: Document, timeline: Timeline) -> None:
        super().__init__()
        self._actions, self._document, self._timeline = actions, document, timeline
        self.model = EditsModel(document, timeline)
        self.list = EditRows()
        self._delegate = EditsDelegate(self.list)
        self.strength = self._slider()
        self.percent = QLabel()
        self.done = icon_button(actions["deselect"], "small_button", "Done")
        self._pages = QStackedWidget()
        self._showing = False  # the panel is changing the range, not the user
        self._is_dragged = False  # the strength; the preview is the slider's
        self._is_reshaped = False  # the selected edit; the preview is its new range
        self._moved_to: int | None = None  # row to which the selected edit is being moved
        self._is_new = False  # the selected edits have just been made
        self._undone = UndoneChoice(document)
        self.reshaping: Callable[[], bool] = lambda: False  # edges belong to the selected edit
        self._build()
        selection = self.list.selectionModel()
        selection.currentChanged.connect(self._chosen)
        selection.selectionChanged.connect(self._sync)
        timeline.selection_changed.connect(self._other_range)
        timeline.falloff_changed.connect(self._other_falloff)
        timeline.display.changed.connect(self.list.viewport().update)
        self.model.moving.connect(self._edit_moves)
        self.model.regrouped.connect(self._hide_rows)
        self.model.regrouped.connect(self._sync)
        document.opened.connect(self.refresh)
        document.changed.connect(self.refresh)
        self.refresh()

    def _build(self) -> None:
        self.setObjectName("edits")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        view = self.list
        view.setModel(self.model)
        view.setItemDelegate(self._delegate)
        empty = QLabel(_EMPTY)
        empty.setObjectName("caption")
        empty.setAlignment(Qt.AlignmentFlag.AlignCenter)
        empty.setWordWrap(True)
        empty.setContentsMargins(MARGIN, 0, MARGIN, 0)
        self._pages.addWidget(empty)
        self._pages.addWidget(view)
        self.percent.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.percent.setMinimumWidth(self.percent.fontMetrics().horizontalAdvance("150 %"))
        bar = QHBoxLayout()
        bar.setContentsMargins(MARGIN, 3, MARGIN - 4, 3)
        bar.setSpacing(GAP // 2)
        bar.addWidget(self.done)
        bar.addStretch()
        bar.addWidget(caption("Strength", self.strength))
        bar.addWidget(self.strength)
        bar.addWidget(self.percent)
        bar.addSpacing(GAP)
        bar.addWidget(icon_button(self._actions["delete_edit"]))
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addLayout(bar)
        column.addWidget(self._pages, 1)

    def _slider(self) -> GestureSlider:
        slider = GestureSlider(0, STRONGEST, 130, start=100)
        slider.setToolTip(
            "Strength: how much of the edit is applied.\n"
            "100 %: as you made it; a double click goes back to it."
        )
        slider.dragged.connect(self._drag_strength)
        slider.sliderReleased.connect(self._released)
        slider.stepped.connect(self._step_strength)
        slider.left.connect(self._document.seal)
        return slider

    # --- which edit --------------------------------------------------------------------------

    @property
    def current(self) -> int | None:
        """Row of the selected edit."""
        row = self.list.currentIndex().row()
        return row if 0 <= row < len(self.model.edits) else None

    @property
    def rows(self) -> list[int]:
        """Rows of all selected edits."""
        chosen = {index.row() for index in self.list.selectionModel().selectedIndexes()}
        known = [row for row in chosen if row < len(self.model.edits)]
        return sorted({one for row in known for one in self.model.stands_for(row)})

    def select(self, row: int | None) -> None:
        """Select an edit, or none."""
        if row is None:
            self.list.clearSelection()
            self.list.selectionModel().clearCurrentIndex()
        else:
            self.list.setCurrentIndex(self.model.index(row))

    def select_new(self, count: int = 1) -> None:
        """Select the newest edits, so that their range and strength can be changed at once."""
        self._choose(range(max(len(self.model.edits) - count, 0), len(self.model.edits)))
        self._is_new = True

    def _choose(self, rows: Sequence[int]) -> None:
        """Select edits, and show their handles."""
        self._select_quietly(rows)
        if self.bound == self.rows:  # edits in several places have no handles in common
            self._show_handles()

    def _select_quietly(self, rows: Sequence[int]) -> None:
        """Select edits without changing range or view."""
        with QSignalBlocker(self.list.selectionModel()):
            self._select_rows(list(rows))
        self._leave()
        if rows:  # without its signals the view does not scroll
            self.list.reveal(rows[0], rows[-1])
        self._sync()
        self.list.viewport().update()

    def _select_rows(self, rows: list[int]) -> None:
        """Select rows, and make the first the current one."""
        if not rows:
            return
        self.list.setCurrentIndex(self.model.index(rows[0]))
        first, last = self.model.index(rows[0]), self.model.index(rows[-1])
        if len(rows) == rows[-1] - rows[0] + 1:
            spans = QItemSelection(first, last)
        else:
            spans = QItemSelection()
            for row in rows:
                spans.select(self.model.index(row), self.model.index(row))
        flag = QItemSelectionModel.SelectionFlag
        self.list.selectionModel().select(spans, flag.ClearAndSelect)

    def refresh(self) -> None:
        """Update the list; a new edit is not selected, a changed one stays selected."""
        row, rows = self.current, self.rows
        if self._moved_to is not None:  # a moved edit stays selected
            row, rows, self._moved_to = self._moved_to, [self._moved_to], None
        focus = QApplication.focusWidget()
        typed = focus is not None and self.list.viewport().isAncestorOf(focus)
        with QSignalBlocker(self.list.selectionModel()):
            self.model.refresh()
            self._hide_rows()
            if row is not None and row < len(self.model.edits):
                self._select_rows([row] if row not in rows else rows)
        if typed:  # the text field is gone, and Qt would focus the next widget
            self.list.setFocus()
        if self.current is None:
            self._undone.lose()
            self._leave(is_undone=True)
        self._pages.setCurrentIndex(1 if self.model.edits else 0)
        self._sync()
        if self.current is None and (back := self._undone.back(self.model.edits)):
            self._choose(back)
        elif self.is_tied:  # undo may have changed its range
            self._show_handles()

    def _hide_rows(self) -> None:
        """Show one row for each closed group."""
        for row in range(len(self.model.edits)):
            self.list.setRowHidden(row, self.model.is_hidden(row))

    def _chosen(self) -> None:
        self.settle()
        self._is_new = False
        self._sync()
        if self.current is not None:
            self._show_handles()
            self._bring_into_view(self.model.edits[self.current])
        else:
            self._leave()

    @property
    def is_tied(self) -> bool:
        """Whether the range on the curves is that of the selected edit."""
        return self._timeline.shows_edit and self.current is not None

    @property
    def bound(self) -> list[int]:
        """The selected rows that Range and Falloff act on: those with the current one's range."""
        row, edits = self.current, self.model.edits
        if row is None:
            return []
        return [other for other in self.rows if _range(edits[other]) == _range(edits[row])]

    @property
    def chosen_edit(self) -> tuple[int, Edit] | None:
        """Row of the only selected edit, and the edit, while the curves show its range."""
        row = self.current
        if row is None or not self.is_tied or self.rows != [row]:
            return None
        return row, self.model.edits[row]

    def leave(self) -> None:
        """Choose no edit; a selection that the user made stays."""
        self._leave()
        self.select(None)

    def _show_handles(self) -> None:
        """Show on the curves where the current edit acts."""
        if self.current is None:
            return
        edit, line = self.model.edits[self.current], self._timeline
        start = min(max(edit.start, 0.0), line.duration)
        end = min(max(edit.end, start), line.duration)
        self._showing = True
        line.show_edit((start, end), edit.falloff, edit.fade_out, edit.op is not Op.RETIME)
        self._showing = False

    def _bring_into_view(self, edit: Edit) -> None:
        line = self._timeline
        first, last = line.view
        if edit.end < first or edit.start > last:
            width, middle = last - first, 0.5 * (edit.start + edit.end)
            line.show_range(middle - width / 2, middle + width / 2)

    def _other_range(self) -> None:
        """A new selection by the user no longer belongs to the edit."""
        if not (self._showing or self.reshaping()) and self.is_tied:
            self._timeline.shows_edit = False
            self._leave()
            self.select(None)

    def _other_falloff(self) -> None:
        """A turn of the wheel in a drag sets the falloff of later drags."""
        if not (self._showing or self.reshaping()):
            self._timeline.keep_falloffs()

    def _leave(self, is_undone: bool = False) -> None:
        """Give range and falloffs back to the user."""
        self._showing = True
        self._timeline.leave_edit(is_undone)
        self._showing = False

    def _sync(self) -> None:
        row = self.current
        self._undone.note(self.model.edits, self.rows)
        self.selected.emit()
        self.strength.setEnabled(row is not None)
        self.done.setVisible(row is not None)
        if self.strength.isSliderDown():
            return
        percent = 100 if row is None else round(100 * self.model.edits[row].strength)
        with QSignalBlocker(self.strength):
            self.strength.setValue(percent)
        self.percent.setText(f"{percent} %" if row is not None else "")

    # --- changing it -------------------------------------------------------------------------

    def _strengthened(self, percent: int) -> list[Edit]:
        """The list of edits with another strength for the selected ones."""
        edits = list(self.model.edits)
        for row in self.rows:
            if percent != round(100 * edits[row].strength):
                edits[row] = replace(edits[row], strength=percent / 100)
        return edits

    def _drag_strength(self, percent: int) -> None:
        self._is_dragged = True
        self.percent.setText(f"{percent} %")
        edits = self._strengthened(percent)
        self._document.act(lambda session: session.preview_list(edits))

    def _step_strength(self, percent: int) -> None:
        edits, rows = self._strengthened(percent), tuple(self.rows)
        self._document.act(lambda session: session.put(edits, "Edit strength", ("strength", rows)))

    def settle(self) -> None:
        """Commit a drag of the strength."""
        if self._is_dragged:
            self._is_dragged = False
            self._document.commit("Edit strength")

    def cancel(self) -> bool:
        """Cancel a drag of the strength; False if there is none."""
        if not self._is_dragged:
            return False
        self._is_dragged = False
        self.strength.cancel_drag()
        self._document.cancel()
        return True

    def _released(self) -> None:
        self.settle()
        self._sync()

    def reshape(self, start: float, end: float, fade_in: float, fade_out: float) -> None:
        """Preview the selected edit with dragged edges."""
        if not self.is_tied:
            return
        edits, rows = list(self.model.edits), self.bound
        for row in rows:
            edits[row] = reshaped(edits[row], start, end, fade_in, fade_out)
        if self._is_new:
            self._timeline.keep_falloffs()
        self._is_reshaped = True
        self._document.act(lambda session: session.preview_list(edits))

    def end_reshape(self) -> None:
        """Commit the edges: they were released, dragged back, or set by a number."""
        if self._is_reshaped:
            self._is_reshaped = False
            by_number = self.reshaping()
            merge = ("range", tuple(self.bound)) if by_number else None
            self._document.commit("Range", merge)

    def delete(self) -> None:
        """Delete the selected edits."""
        rows = self.rows
        if rows:
            self._leave()
            name = f"Delete {self.model.counted(rows)}"
            self._document.act(lambda session: session.remove(*rows, name=name))
            if left := len(self.model.edits):  # choose the next one, wherever in the take it is
                self._choose([min(rows[0], left - 1)])
            else:
                self.select(None)

    def toggle(self) -> None:
        """Switch the selected edits on or off."""
        rows, edits = self.rows, list(self.model.edits)
        if rows:
            on = not edits[rows[0]].enabled
            for row in rows:
                edits[row] = replace(edits[row], enabled=on)
            name = f"Switch {self.model.counted(rows)} {'on' if on else 'off'}"
            self._document.act(lambda session: session.put(edits, name))

    def rename(self) -> None:
        """Let the user type another name."""
        self.list.setFocus()  # a field that is open takes what was typed, and closes
        if self.current is not None and not self.list.is_typed:
            self._delegate.edits = RowField.NAME
            self.list.edit(self.list.currentIndex())

    def move_edit(self, by: int) -> None:
        """Move the selected edit up or down the list."""
        row = self.current
        if row is not None and 0 <= row + by < len(self.model.edits):
            self.model.move_edit(row, row + by)

    def _edit_moves(self, row: int) -> None:
        self._moved_to = row

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Show the menu of the edit under the pointer."""
        if self.current is not None:
            context_menu(self, [self._actions[name] for name in MENU]).popup(event.globalPos())


def _range(edit: Edit) -> tuple[float, float, float, float]:
    return edit.start, edit.end, edit.falloff, edit.fade_out

"""The problems as a list: what, when and how bad, with ticks for those to fix."""

from __future__ import annotations

from PySide6.QtCore import (
    QModelIndex,
    QPersistentModelIndex,
    QPoint,
    QSignalBlocker,
    QSize,
    Qt,
    Signal,
)
from PySide6.QtGui import QFocusEvent, QKeyEvent, QShowEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QLabel,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTreeView,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.editing.help.problems import Problem
from faceedit_app.ui.look.theme import GAP, MARGIN
from faceedit_app.ui.look.widgets import Choice, caption, context_menu, icon_button
from faceedit_app.ui.page.fix_trials import FixTrials
from faceedit_app.ui.page.problems_bar import NAMES, ProblemsBar
from faceedit_app.ui.page.problems_model import AMOUNT, KIND, TIME, ProblemsModel
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.time_display import shown_time
from faceedit_app.ui.state.timeline import Timeline

_EVERYTHING = "All kinds"
_HIDDEN = "The problem at the playhead is of another kind: click one in the list"
_Index = QModelIndex | QPersistentModelIndex


_MENU = (("fix_problem",), ("tick_problem", "tick_all", "untick_all"), ("fix_all",))


class _Rows(QTreeView):
    """Rows that keys go through.

    Signals:
        stepped(QModelIndex): a key went to another row.
    """

    stepped = Signal(QModelIndex)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Qt makes the first row the current one: ↓ would then skip it."""
        super().focusInEvent(event)
        if not self.selectionModel().hasSelection():
            self.setCurrentIndex(QModelIndex())

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Say where a key went."""
        before = self.currentIndex()
        super().keyPressEvent(event)
        if self.currentIndex() != before:
            self.stepped.emit(self.currentIndex())


class _Indent(QStyledItemDelegate):
    """Leaves the place of the box free in rows that have none, so that all names are in line."""

    def initStyleOption(self, option: QStyleOptionViewItem, index: _Index) -> None:
        """Ask for room for an icon that draws nothing."""
        super().initStyleOption(option, index)
        has_box = QStyleOptionViewItem.ViewItemFeature.HasCheckIndicator
        if not option.features & has_box:
            other = QStyleOptionViewItem(option)
            other.features |= has_box
            box = QStyle.SubElement.SE_ItemViewItemCheckIndicator
            width = option.widget.style().subElementRect(box, other, option.widget).width()
            option.features |= QStyleOptionViewItem.ViewItemFeature.HasDecoration
            option.decorationSize = QSize(width, 1)


class ProblemsList(QWidget):
    """A row for each problem; a click or an arrow key goes to it.

    Its tick says whether to fix it with the others.

    Ticks are kept until another take is opened. While the list is seen, the fixes are tried, and
    what they would make is shown.

    Signals:
        ticked(): another set of problems is ticked.
    """

    ticked = Signal()

    def __init__(
        self, actions: Actions, bar: ProblemsBar, timeline: Timeline, trials: FixTrials
    ) -> None:
        super().__init__()
        self._actions, self._bar, self._timeline = actions, bar, timeline
        self.trials = trials
        self.kinds = Choice()
        self.kinds.setToolTip("Show problems of one kind only")
        self.model = ProblemsModel(self._shown_time, self)
        self.rows = _Rows()
        self._empty = QLabel()
        self._build(actions)
        self.kinds.currentIndexChanged.connect(self._fill)
        self.model.ticked.connect(self.ticked)
        self.model.modelReset.connect(self._select_current)
        self.rows.clicked.connect(self._go)
        self.rows.activated.connect(self._go)
        self.rows.stepped.connect(self._go)
        self.rows.customContextMenuRequested.connect(self._show_menu)
        bar.found.connect(self.sync)
        trials.tried.connect(self.model.show_brought)
        timeline.display.changed.connect(self._fill)
        self._shown: tuple[Problem, ...] | None = None
        self.sync()

    def _build(self, actions: Actions) -> None:
        self.setObjectName("edits")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        rows = self.rows
        rows.setObjectName("problems_list")
        rows.setAccessibleName("Problems")
        rows.setModel(self.model)
        rows.setItemDelegateForColumn(KIND, _Indent(rows))
        rows.setRootIsDecorated(False)
        rows.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        rows.setUniformRowHeights(True)
        rows.setSortingEnabled(True)
        rows.sortByColumn(TIME, Qt.SortOrder.AscendingOrder)
        rows.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        rows.header().setStretchLastSection(False)
        rows.header().setResizeContentsPrecision(0)  # by the rows in view: there may be thousands
        rows.header().setSectionResizeMode(KIND, rows.header().ResizeMode.Stretch)
        for place in (TIME, AMOUNT):
            rows.header().setSectionResizeMode(place, rows.header().ResizeMode.ResizeToContents)
        self._empty.setObjectName("caption")
        self._empty.setAlignment(Qt.AlignmentFlag.AlignCenter)
        bar = QHBoxLayout()
        bar.setContentsMargins(MARGIN, 3, MARGIN - 4, 3)
        bar.setSpacing(GAP // 2)
        bar.addWidget(caption("Show", self.kinds))
        bar.addWidget(self.kinds)
        bar.addStretch()
        self._fix = icon_button(actions["fix_problem"], text="Fix")
        actions["fix_problem"].changed.connect(self._sync_fix)
        bar.addWidget(self._fix)
        bar.addWidget(icon_button(actions["fix_all"], text="Fix ticked"))
        stack = QVBoxLayout(self)
        stack.setContentsMargins(0, 0, 0, 0)
        stack.setSpacing(0)
        stack.addLayout(bar)
        stack.addWidget(rows, 1)
        stack.addWidget(self._empty, 1)

    @property
    def chosen(self) -> tuple[Problem, ...]:
        """The ticked problems that can be fixed, of the kind that is shown."""
        return self.model.chosen

    @property
    def advice(self) -> str:
        """What to do with the ticks, at the end of a sentence about the fixes that are shown."""
        if self.trials.is_trying:
            return "trying whether they make other problems…"
        unticked, left_out = len(self.model.unticked), len(self.model.left_out)
        if not unticked:
            return "untick those that you do not want."
        why = "as the fix would make another problem"
        more = f"{unticked} more {'is' if unticked == 1 else 'are'} not ticked"
        if not left_out:
            return f"{more}."
        return f"{more}, {why}." if left_out == unticked else f"{more}, {left_out} of them {why}."

    @property
    def short_advice(self) -> str:
        """The same in few words."""
        unticked = len(self.model.unticked)
        if unticked:
            return f"Fixes shown; {unticked} not ticked: see the list"
        return "Untick those that you do not want"

    def _shown_time(self, seconds: float) -> str:
        rows = self._timeline.rows
        return shown_time(rows, seconds, self._timeline.display.unit) if rows is not None else ""

    def sync(self) -> None:
        """Show what was found, and which problem is at the playhead."""
        if not self._bar.is_searched:
            self.model.forget_ticks()  # they are of another take
        if self._bar.problems is not self._shown:
            self._shown = self._bar.problems
            self._fill_kinds()
            self._fill()
        self._say_why_empty()
        self._select_current()
        if self.isVisible():
            self.trials.begin()

    def showEvent(self, event: QShowEvent) -> None:
        """Find out what the fixes would make."""
        super().showEvent(event)
        self.trials.begin()

    def _select_current(self) -> None:
        current = self._bar.current
        row = self.model.row_of(current) if current is not None else None
        if row is None:
            self.rows.clearSelection()
        else:
            self.rows.setCurrentIndex(row)
            self.rows.scrollTo(row)
        self._sync_fix()

    def _sync_fix(self) -> None:
        """The button fixes only what the list shows, which may be another kind."""
        action, current = self._actions["fix_problem"], self._bar.current
        is_hidden = current is not None and self.model.row_of(current) is None
        self._fix.setEnabled(action.isEnabled() and not is_hidden)
        why_not = _HIDDEN if is_hidden and action.isEnabled() else ""
        self._fix.setToolTip("\n".join(filter(None, (action.toolTip(), why_not))))

    def _fill_kinds(self) -> None:
        """Offer the kinds that there are, with their number."""
        kind = self.kinds.currentData()
        counts = dict.fromkeys(NAMES, 0)
        for problem in self._bar.problems:
            counts[problem.kind] += 1
        with QSignalBlocker(self.kinds):
            self.kinds.clear()
            self.kinds.addItem(_EVERYTHING, None)
            for name, count in counts.items():
                if count:
                    self.kinds.addItem(f"{_label(name)} ({count})", name)
            self.kinds.setCurrentIndex(max(self.kinds.findData(kind), 0))

    def _fill(self) -> None:
        has_take = self._timeline.clip is not None
        self.model.show(self._bar.problems if has_take else (), self.kinds.currentData())
        self._say_why_empty()
        is_empty = self.model.rowCount() == 0
        self._empty.setVisible(is_empty)
        self.rows.setVisible(not is_empty)
        self.ticked.emit()

    def _say_why_empty(self) -> None:
        searched = "No problems found" if self._bar.is_searched else "Looking for problems…"
        self._empty.setText(searched)

    def _go(self, row: QModelIndex) -> None:
        if row.isValid():
            self._bar.picked.emit(self.model.number(row))

    def _show_menu(self, place: QPoint) -> None:
        """The menu of the row under the pointer, to which a right click has gone."""
        self._go(self.rows.indexAt(place))
        self._actions.refresh()
        groups = [[self._actions[name] for name in group] for group in _MENU]
        context_menu(self, *groups).popup(self.rows.viewport().mapToGlobal(place))


def _label(kind: str) -> str:
    return NAMES[kind].capitalize()

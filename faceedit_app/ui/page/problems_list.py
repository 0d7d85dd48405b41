"""The problems as a list: what, when and how bad, with ticks for those to fix."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QLabel,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.editing.help.problems import Problem
from faceedit_app.ui.look.theme import GAP, MARGIN
from faceedit_app.ui.look.widgets import Choice, caption, icon_button
from faceedit_app.ui.page.problems_bar import NAMES, ONE, ProblemsBar
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.clock import shown_time
from faceedit_app.ui.state.timeline import Timeline

_KIND, _TIME, _AMOUNT = range(3)
_EVERYTHING = "All kinds"
_KEY = Qt.ItemDataRole.UserRole  # what a column is sorted by
_INDEX = Qt.ItemDataRole.UserRole + 1  # of the problem

Key = tuple[str, float]


class ProblemsList(QWidget):
    """A row for each problem; a click goes to it, its tick says whether to fix it with the others.

    Ticks are kept when the take is searched again.

    Signals:
        ticked(): another set of problems is ticked.
    """

    ticked = Signal()

    def __init__(self, actions: Actions, bar: ProblemsBar, timeline: Timeline) -> None:
        super().__init__()
        self._bar, self._timeline = bar, timeline
        self._unticked: set[Key] = set()
        self.kinds = Choice()
        self.kinds.setToolTip("Show problems of one kind only")
        self.rows = QTreeWidget()
        self._empty = QLabel()
        self._build(actions)
        self.kinds.currentIndexChanged.connect(self._fill)
        self.rows.itemChanged.connect(self._tick)
        self.rows.itemClicked.connect(self._go)
        self.rows.itemActivated.connect(self._go)
        bar.found.connect(self.sync)
        timeline.clock.changed.connect(self._fill)
        self._shown: tuple[Problem, ...] | None = None
        self.sync()

    def _build(self, actions: Actions) -> None:
        self.setObjectName("edits")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        rows = self.rows
        rows.setObjectName("problems_list")
        rows.setAccessibleName("Problems")
        rows.setColumnCount(3)
        rows.setHeaderLabels(["Problem", "Time", "How bad"])
        rows.setRootIsDecorated(False)
        rows.setUniformRowHeights(True)
        rows.setSortingEnabled(True)
        rows.sortByColumn(_TIME, Qt.SortOrder.AscendingOrder)
        rows.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        rows.header().setStretchLastSection(False)
        rows.header().setSectionResizeMode(_KIND, rows.header().ResizeMode.Stretch)
        for place in (_TIME, _AMOUNT):
            rows.header().setSectionResizeMode(place, rows.header().ResizeMode.ResizeToContents)
        self._empty.setObjectName("caption")
        self._empty.setAlignment(Qt.AlignmentFlag.AlignCenter)
        bar = QHBoxLayout()
        bar.setContentsMargins(MARGIN, 3, MARGIN - 4, 3)
        bar.setSpacing(GAP // 2)
        bar.addWidget(caption("Show", self.kinds))
        bar.addWidget(self.kinds)
        bar.addStretch()
        bar.addWidget(icon_button(actions["fix_problem"], text="Fix"))
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
        return tuple(
            problem
            for problem in self._visible
            if problem.fix and _key(problem) not in self._unticked
        )

    @property
    def _visible(self) -> tuple[Problem, ...]:
        kind = self.kinds.currentData()
        return tuple(p for p in self._bar.problems if kind is None or p.kind == kind)

    def sync(self) -> None:
        """Show what was found, and which problem is at the playhead."""
        if self._bar.problems is not self._shown:
            self._shown = self._bar.problems
            self._unticked &= {_key(problem) for problem in self._shown}
            self._fill_kinds()
            self._fill()
        self._say_why_empty()
        here = self._bar.current_problem
        with QSignalBlocker(self.rows):
            for row in self._items():
                is_here = self._bar.problems[row.data(_KIND, _INDEX)] is here
                row.setSelected(is_here)
                if is_here:
                    self.rows.scrollToItem(row)

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
        clip = self._timeline.clip
        shown = self._visible if clip is not None else ()
        with QSignalBlocker(self.rows):
            self.rows.setSortingEnabled(False)
            self.rows.clear()
            for index, problem in enumerate(self._bar.problems):
                if problem in shown and clip is not None:
                    time = shown_time(clip, problem.time, self._timeline.clock.unit)
                    self.rows.addTopLevelItem(_Row(problem, index, time))
            for row in self._items():
                problem = self._bar.problems[row.data(_KIND, _INDEX)]
                on = bool(problem.fix) and _key(problem) not in self._unticked
                state = Qt.CheckState.Checked if on else Qt.CheckState.Unchecked
                if problem.fix:
                    row.setCheckState(_KIND, state)
            self.rows.setSortingEnabled(True)
        self._say_why_empty()
        self._empty.setVisible(not shown)
        self.rows.setVisible(bool(shown))
        self.ticked.emit()

    def _say_why_empty(self) -> None:
        searched = "No problems found" if self._bar.is_searched else "Looking for problems…"
        self._empty.setText(searched)

    def _items(self) -> list[QTreeWidgetItem]:
        items = (self.rows.topLevelItem(i) for i in range(self.rows.topLevelItemCount()))
        return [item for item in items if item is not None]

    def _tick(self, row: QTreeWidgetItem) -> None:
        key = _key(self._bar.problems[row.data(_KIND, _INDEX)])
        if row.checkState(_KIND) is Qt.CheckState.Checked:
            self._unticked.discard(key)
        else:
            self._unticked.add(key)
        self.ticked.emit()

    def _go(self, row: QTreeWidgetItem) -> None:
        self._bar.picked.emit(row.data(_KIND, _INDEX))


class _Row(QTreeWidgetItem):
    """A problem; the columns sort by kind, time and severity, not by their texts."""

    def __init__(self, problem: Problem, index: int, time: str) -> None:
        super().__init__([ONE[problem.kind], time, problem.amount])
        keys = problem.kind.value, problem.time, problem.severity
        for column, key in enumerate(keys):
            self.setData(column, _KEY, key)
            self.setToolTip(column, problem.message)
        self.setData(_KIND, _INDEX, index)
        self.setData(_KIND, Qt.ItemDataRole.AccessibleTextRole, f"{problem.message}, at {time}")
        self.setTextAlignment(_AMOUNT, Qt.AlignmentFlag.AlignRight)

    def __lt__(self, other: QTreeWidgetItem) -> bool:
        tree = self.treeWidget()
        column = tree.sortColumn() if tree is not None else _TIME
        return bool(self.data(column, _KEY) < other.data(column, _KEY))


def _label(kind: str) -> str:
    return NAMES[kind].capitalize()


def _key(problem: Problem) -> Key:
    return problem.kind.value, problem.time

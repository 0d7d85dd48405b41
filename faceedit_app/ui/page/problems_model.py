"""The rows of the list of problems; their texts are made when they come into view."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from PySide6.QtCore import (
    QAbstractTableModel,
    QModelIndex,
    QObject,
    Qt,
    Signal,
)

from faceedit_app.editing.help.problems import Problem
from faceedit_app.editing.help.trying import Brought, is_worth
from faceedit_app.ui.look.model_index import Index
from faceedit_app.ui.page.problems_bar import ONE, words_for_made

KIND, TIME, AMOUNT = range(3)
_HEADS = ("Problem", "Time", "How bad")
_ROOT = QModelIndex()
_KEYS: tuple[Callable[[Problem], Any], ...] = (
    lambda problem: problem.kind.value,
    lambda problem: problem.time,
    lambda problem: problem.severity,
)


class ProblemsModel(QAbstractTableModel):
    """Problems with ticks, sorted by a column.

    A problem whose fix would make another one is ticked only if the user does it, unless the other
    is far smaller. What the user ticks or unticks stays so, also if the problem comes back, as when
    an edit that makes it is undone and made again.

    Signals:
        ticked(): a tick was set or removed.
    """

    ticked = Signal()

    def __init__(self, shown_time: Callable[[float], str], parent: QObject | None = None) -> None:
        """
        Args:
            shown_time: seconds as the user reads them.
        """
        super().__init__(parent)
        self._shown_time = shown_time
        self._problems: tuple[Problem, ...] = ()
        self._order: list[int] = []  # of the problems in each row
        self._by_hand: dict[tuple[str, float], bool] = {}  # the ticks that the user has set
        self._brought: Brought = {}
        self._column, self._is_descending = TIME, False

    @property
    def chosen(self) -> tuple[Problem, ...]:
        """The ticked problems in the list that can be fixed, in order of time."""
        shown = (self._problems[number] for number in sorted(self._order))
        return tuple(problem for problem in shown if self.is_ticked(problem))

    @property
    def can_tick(self) -> bool:
        """Whether a problem in the list can be fixed."""
        return any(self._problems[number].fix for number in self._order)

    def is_ticked(self, problem: Problem) -> bool:
        """Whether a problem can be fixed and is ticked."""
        by_hand = self._by_hand.get(_key(problem))
        return bool(problem.fix) and (self._is_harmless(problem) if by_hand is None else by_hand)

    def _is_harmless(self, problem: Problem) -> bool:
        brought = self._brought.get(problem)
        return brought is None or is_worth(problem, brought)

    @property
    def unticked(self) -> tuple[Problem, ...]:
        """The problems in the list that can be fixed and are not ticked."""
        shown = (self._problems[number] for number in sorted(self._order))
        return tuple(problem for problem in shown if problem.fix and not self.is_ticked(problem))

    @property
    def left_out(self) -> tuple[Problem, ...]:
        """Those of them that are not ticked because of what their fixes would make."""
        return tuple(problem for problem in self.unticked if not self._is_harmless(problem))

    def tick(self, problems: Iterable[Problem], on: bool) -> None:
        """Set or remove the ticks of problems."""
        self._by_hand |= {_key(problem): on for problem in problems if problem.fix}
        self._say_ticked()

    def forget_ticks(self) -> None:
        """Leave all ticks to what the fixes would make."""
        self._by_hand = {}

    def show_brought(self, brought: Brought) -> None:
        """Say what fixes would make, and tick those that do more good than harm."""
        if brought != self._brought:
            self._brought = brought
            self._say_ticked()

    def made_by(self, problem: Problem) -> str:
        """What the fix of a problem would make, after "It …"; empty if nothing is known of it."""
        brought = self._brought.get(problem)
        return words_for_made(brought, self._shown_time(brought.time)) if brought else ""

    def _say_ticked(self) -> None:
        if self._order:
            ends = (self.index(row, KIND) for row in (0, len(self._order) - 1))
            self.dataChanged.emit(*ends)
        self.ticked.emit()

    def tick_all(self, on: bool) -> None:
        """Set or remove the ticks of all problems in the list."""
        self.tick((self._problems[number] for number in self._order), on)

    def show(self, problems: tuple[Problem, ...], kind: str | None) -> None:
        """Show problems of one kind, or all if None."""
        self.beginResetModel()
        self._problems = problems
        still = {*problems} & self._brought.keys()
        self._brought = {problem: self._brought[problem] for problem in still}
        self._order = [i for i, found in enumerate(problems) if kind is None or found.kind == kind]
        self._sort()
        self.endResetModel()

    def sort(self, column: int, order: Qt.SortOrder = Qt.SortOrder.AscendingOrder) -> None:
        """Sort the rows by kind, time or severity."""
        self.beginResetModel()
        self._column, self._is_descending = column, order is Qt.SortOrder.DescendingOrder
        self._sort()
        self.endResetModel()

    def _sort(self) -> None:
        key = _KEYS[self._column]
        self._order.sort(key=lambda i: key(self._problems[i]), reverse=self._is_descending)

    def number(self, index: Index) -> int:
        """Which of the problems is in a row."""
        return self._order[index.row()]

    def row_of(self, number: int) -> Index | None:
        """The row of a problem; None if it is not in the list."""
        return self.index(self._order.index(number), 0) if number in self._order else None

    def rowCount(self, parent: Index = _ROOT) -> int:
        """One row a problem."""
        return 0 if parent.isValid() else len(self._order)

    def columnCount(self, parent: Index = _ROOT) -> int:
        """What, when, and how bad."""
        return 0 if parent.isValid() else len(_HEADS)

    def headerData(
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        """The titles of the columns."""
        if orientation is not Qt.Orientation.Horizontal:
            return None
        if role == Qt.ItemDataRole.TextAlignmentRole and section == AMOUNT:
            return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        if role == Qt.ItemDataRole.InitialSortOrderRole and section == AMOUNT:
            return Qt.SortOrder.DescendingOrder.value  # the first click shows the worst first
        return _HEADS[section] if role == Qt.ItemDataRole.DisplayRole else None

    def flags(self, index: Index) -> Qt.ItemFlag:
        """What can be fixed has a tick."""
        flags = super().flags(index)
        can_tick = index.column() == KIND and bool(self._problems[self.number(index)].fix)
        return flags | Qt.ItemFlag.ItemIsUserCheckable if can_tick else flags

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """A text, or the tick."""
        problem, column = self._problems[self.number(index)], index.column()
        match role:
            case Qt.ItemDataRole.DisplayRole if column == TIME:
                return self._shown_time(problem.time)
            case Qt.ItemDataRole.DisplayRole:
                return self._name(problem) if column == KIND else problem.amount
            case Qt.ItemDataRole.CheckStateRole if column == KIND and problem.fix:
                on = self.is_ticked(problem)
                return Qt.CheckState.Checked if on else Qt.CheckState.Unchecked
            case Qt.ItemDataRole.ToolTipRole:
                return "\n".join([problem.message, *self._remarks(problem)])
            case Qt.ItemDataRole.AccessibleTextRole if column == KIND:
                at = f"{problem.message}, at {self._shown_time(problem.time)}"
                return ". ".join([at, *self._remarks(problem)])
            case Qt.ItemDataRole.TextAlignmentRole if column == AMOUNT:
                return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
            case _:
                return None

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Set or remove a tick."""
        if role != Qt.ItemDataRole.CheckStateRole:
            return False
        problem = self._problems[self.number(index)]
        self.tick((problem,), Qt.CheckState(value) is Qt.CheckState.Checked)
        return True

    def _name(self, problem: Problem) -> str:
        name = f"{ONE[problem.kind]}: {problem.about}" if problem.about else ONE[problem.kind]
        if made := self.made_by(problem):
            return f"{name} – fix {made}"
        return name if problem.fix else f"{name} (no fix)"

    def _remarks(self, problem: Problem) -> list[str]:
        """What is to be said of its fix."""
        if why := problem.why_unfixed:
            return [f"No fix: {why}"]
        made = self.made_by(problem)
        return [f"Its fix {made}"] if made else []


def _key(problem: Problem) -> tuple[str, float]:
    return problem.kind.value, problem.time

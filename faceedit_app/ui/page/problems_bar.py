"""The problems of the take, marked under the curves."""

from __future__ import annotations

import time
from collections.abc import Sequence

from PySide6.QtCore import QEvent, QPointF, QRectF, Qt, QTimer, Signal
from PySide6.QtGui import (
    QHelpEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QPolygonF,
    QShowEvent,
)
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QToolTip, QWidget

from faceedit_app.editing.help.problems import Problem, find_problems, search_of
from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.scale import Scale
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.texts import plain_tip
from faceedit_app.ui.look.widgets import OnePush, icon_button
from faceedit_app.ui.state.actions import Actions, tip_of
from faceedit_app.ui.state.background import Background
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline

HEIGHT = 24
_SIZES = 3.0, 6.5  # pixels of the mark of the slightest and of the worst problem
_WAIT_MS = 250  # after the last change
_LONG = 20_000  # frames: longer takes are searched in the background, not to block the window
_NEAR = 7.0  # pixels
_FONT_SIZES = 0.88, 0.78  # of the number of problems; the second for two digits
_CLOSE = 2.0  # seconds in view, at least, to judge a problem by
_AROUND = 4.0  # times its length
# Okabe and Ito's colours, safe for colour-blind people; the shapes differ too.
COLORS = {
    "lips": "#d55e00",
    "blink": "#e69f00",
    "jitter": "#cc79a7",
    "character": style.CHARACTER,
    "dropped": "#9aa0aa",
    "unsure": "#56b4e9",
}
NAMES = {
    "lips": "lips that stay open",
    "blink": "half blinks",
    "jitter": "shaking",
    "character": "open on your character",
    "dropped": "lost frames",
    "unsure": "hidden faces",
}
ONE = {
    "lips": "Lips stay open",
    "blink": "Half blink",
    "jitter": "Shaking",
    "character": "Open on your character",
    "dropped": "Lost frames",
    "unsure": "Hidden face",
}

_LEFT = {  # by a fix that makes such a problem
    "lips": "leaves the lips {} open",
    "blink": "leaves a blink {}",
    "jitter": "makes shaking {}",
    "character": "leaves {} open on your character",
    "dropped": "leaves {} lost",
    "unsure": "leaves the tracker {}",
}


def words_for_made(problem: Problem, when: str) -> str:
    """What a fix does that makes a problem: "makes shaking 2.1 mm at 7.300 s"."""
    return f"{_LEFT[problem.kind].format(problem.amount)} at {when}"


class ProblemsBar(QWidget):
    """A mark for each problem; a click goes to it.

    Signals:
        found(): the list of problems changed.
        picked(int): a mark was clicked.
    """

    found = Signal()
    picked = Signal(int)

    def __init__(self, document: Document, timeline: Timeline) -> None:
        super().__init__()
        self._document, self._timeline = document, timeline
        self.problems: tuple[Problem, ...] = ()
        self.current: int | None = None
        self.is_searched = False  # until then, no problems does not mean none
        self._playhead = 0.0  # seconds, as painted
        self._timer = QTimer(self, singleShot=True, interval=_WAIT_MS)
        self._timer.timeout.connect(self._search_soon)
        self._background = Background(self)
        self._newest = 0  # number of the latest search in the background
        self.setFixedHeight(HEIGHT)
        self.setObjectName("problems")
        self.setAccessibleName("Problems of the take")
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        document.opened.connect(self.restart)
        document.changed.connect(self._timer.start)
        timeline.view_changed.connect(self.update)
        timeline.playhead_moved.connect(self._moved)

    def restart(self) -> None:
        """Start over for another take."""
        self.problems, self.current = (), None
        self._timer.start()
        self._announce()

    def _search_soon(self) -> None:
        """Search once the take has not changed for a moment."""
        session = self._document.session
        if session is None:
            return
        if session.is_previewing or not session.live.is_complete or not session.find_filled(0.0):
            self._timer.start()
        elif len(session.take.clip) < _LONG:
            self.search()
        else:
            self._search_beside(session)

    def _search_beside(self, session: EditSession) -> None:
        self._newest += 1
        number = self._newest

        def done(problems: list[Problem]) -> None:
            if number == self._newest and self._document.session is session:
                self.problems = tuple(problems)
                self._moved()
                self._announce(True)

        def failed(_: Exception) -> None:
            """Show no marks."""

        self._background.run(search_of(session), done, failed)

    def search(self) -> list[Problem]:
        """Search the take as edited.

        Returns:
            Those that were not there before.
        """
        self._timer.stop()
        session = self._document.session
        if session is None:
            return []
        if session.is_previewing:
            self._timer.start()
            return []
        began, before = time.perf_counter(), self.problems
        is_known = self.is_searched
        self.problems = tuple(find_problems(session))
        # Long takes are searched less often.
        cost = 1000 * (time.perf_counter() - began)
        self._timer.setInterval(round(min(max(_WAIT_MS, 4 * cost), 3000)))
        self._moved()
        self._announce(True)
        found = self.problems if is_known else ()
        return [problem for problem in found if not any(map(problem.is_as, before))]

    @staticmethod
    def words_for(new: Sequence[Problem]) -> str:
        """One line about the problems that a fix has made."""
        worst = max(new, key=lambda problem: problem.severity)
        count = "A new problem" if len(new) == 1 else f"{len(new)} new problems, the worst"
        return f"{count} at {worst.time:.1f} s: {worst.message[:1].lower()}{worst.message[1:]}"

    def _announce(self, is_searched: bool = False) -> None:
        self.is_searched = is_searched
        count = len(self.problems)
        self.setAccessibleDescription(f"{count} found" if count else "No problems found")
        self.found.emit()
        self.update()

    @property
    def summary(self) -> str:
        """The number of problems of each kind."""
        counts = dict.fromkeys(NAMES, 0)
        for problem in self.problems:
            counts[problem.kind] += 1
        return "\n".join(f"{n} × {NAMES[kind]}" for kind, n in counts.items() if n)

    @property
    def current_problem(self) -> Problem | None:
        """The problem at the playhead."""
        known = self.current is not None and self.current < len(self.problems)
        return self.problems[self.current] if known and self.current is not None else None

    def step(self, by: int) -> int | None:
        """Index of the problem after or before the playhead, wrapping around at the ends."""
        if not self.problems:
            return None
        if self.current is not None:
            return (self.current + by) % len(self.problems)
        now = self._timeline.time
        after = [i for i, problem in enumerate(self.problems) if problem.time > now + 1e-6]
        following = after[0] if after else 0
        return following if by > 0 else (following - 1) % len(self.problems)

    def next_fixable(self, seconds: float) -> int | None:
        """Index of the next problem after a time that has a fix, wrapping around at the end."""
        fixable = [i for i, problem in enumerate(self.problems) if problem.fix]
        after = [i for i in fixable if self.problems[i].time > seconds]
        return next(iter([*after, *fixable]), None)

    def go_to(self, index: int) -> None:
        """Put the playhead where a problem is worst, with enough time in view to judge it."""
        problem, line = self.problems[index], self._timeline
        wanted = max(_AROUND * (problem.end - problem.start), _CLOSE)
        first, last = line.view
        is_close = wanted / 2 <= last - first <= 2 * wanted
        if not (is_close and first <= problem.start and problem.end <= last):
            width = min(wanted, line.duration)
            line.show_range(problem.time - width / 2, problem.time + width / 2)
        line.go_to_time(problem.time)
        self.current = index
        self.update()
        self.found.emit()

    def _moved(self) -> None:
        """The playhead moved: update which problem it is on."""
        now = self._timeline.time
        scale, before, self._playhead = self._scale, self._playhead, now
        for seconds in (before, now):
            self.update(round(scale.x_of(seconds)) - 2, 0, 5, self.height())
        here = [
            (abs(problem.time - now), i)
            for i, problem in enumerate(self.problems)
            if problem.is_at(now)
        ]
        current = min(here)[1] if here else None
        if current != self.current:
            self.current = current
            self.found.emit()
            self.update()

    # --- mouse and painting ------------------------------------------------------------------

    @property
    def _scale(self) -> Scale:
        return Scale(self.width(), self.height(), self._timeline.view, (0.0, 1.0))

    def place_of(self, index: int) -> QPointF:
        """The position of a problem's mark, in pixels."""
        return QPointF(self._scale.x_of(self.problems[index].time), 0.5 * self.height())

    def _at(self, x: float) -> int | None:
        near = [(abs(self.place_of(i).x() - x), i) for i in range(len(self.problems))]
        nearest = min(near, default=(_NEAR + 1, 0))
        return nearest[1] if nearest[0] <= _NEAR else None

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Go to the problem under the pointer."""
        index = self._at(event.position().x())
        if index is not None:
            self.picked.emit(index)

    def event(self, event: QEvent) -> bool:
        """Show a problem's message as its tooltip."""
        if isinstance(event, QHelpEvent):
            index = self._at(event.pos().x())
            text = self.problems[index].message if index is not None else self.summary
            QToolTip.showText(event.globalPos(), plain_tip(text or "No problems found"), self)
            return True
        return super().event(event)

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Spans and marks."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), style.color(style.PLOT))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if not self.problems:
            painter.setFont(style.scaled_font(self, 0.82))
            painter.setPen(style.color(style.MUTED))
            words = "No problems found" if self.is_searched else "Looking for problems…"
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, words)
            return
        scale = self._scale
        for problem in self.problems:
            left, right = scale.x_of(problem.start), scale.x_of(problem.end)
            if right < -9 or left > self.width() + 9:
                continue
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(style.color(COLORS[problem.kind], 70))
            painter.drawRoundedRect(QRectF(left, 4, max(right - left, 2), HEIGHT - 8), 2, 2)
        for i, problem in enumerate(self.problems):
            lit = i == self.current
            self._paint_mark(painter, self.place_of(i), problem.kind, problem.severity, lit)
        x = round(scale.x_of(self._timeline.time))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        painter.setPen(QPen(style.color(style.PLAYHEAD, 150), 0))
        painter.drawLine(QPointF(x, 0), QPointF(x, self.height()))

    @staticmethod
    def _paint_mark(painter: QPainter, at: QPointF, kind: str, severity: float, lit: bool) -> None:
        """A circle for lips, a diamond for blinks, triangles for shaking and the user's character.

        A square is for gaps, an upright bar for hidden faces. The worse the problem, the larger.
        """
        size = _SIZES[0] + severity * (_SIZES[1] - _SIZES[0]) + (1.0 if lit else 0.0)
        painter.setPen(QPen(style.color(style.TEXT if lit else style.BACKGROUND), 1.4))
        painter.setBrush(style.color(COLORS[kind]))
        if kind == "lips":
            painter.drawEllipse(at, size, size)
            return
        shapes = {
            "blink": [(-1.2, 0), (0, -1.2), (1.2, 0), (0, 1.2)],
            "jitter": [(-1.1, 0.9), (0, -1.1), (1.1, 0.9)],
            "character": [(-1.1, -0.9), (0, 1.1), (1.1, -0.9)],
            "dropped": [(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            "unsure": [(-0.55, -1.2), (0.55, -1.2), (0.55, 1.2), (-0.55, 1.2)],
        }
        corners = [QPointF(at.x() + size * x, at.y() + size * y) for x, y in shapes[kind]]
        painter.drawPolygon(QPolygonF(corners))


class ProblemsHead(QWidget):
    """Left of the bar: the number of problems, and buttons to step through them."""

    def __init__(self, actions: Actions, bar: ProblemsBar) -> None:
        super().__init__()
        self._bar, self._tip = bar, tip_of(actions["list_problems"])
        self.count = OnePush()
        self.count.setObjectName("count")
        self.count.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.count.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.count.clicked.connect(actions["list_problems"].trigger)
        self.setFixedWidth(style.HEADER_WIDTH)
        self._layout = row = QHBoxLayout(self)
        row.setContentsMargins(1, 0, 0, 0)  # room for “No problems” in any font
        row.setSpacing(0)
        row.addWidget(self.count, 1)
        for name in ("previous_problem", "next_problem"):
            row.addWidget(icon_button(actions[name], "small", repeats=True))
        row.addWidget(icon_button(actions["fix_problem"], "small", "Fix"))
        bar.found.connect(self.sync)
        self.sync()

    def showEvent(self, event: QShowEvent) -> None:
        """Its room is known now."""
        super().showEvent(event)
        self._layout.activate()
        self.sync()

    def sync(self) -> None:
        """Show what was found."""
        count = len(self._bar.problems)
        words = "problem" if count == 1 else "problems"
        none = "No problems" if self._bar.is_searched else "Looking…"
        text = f"{count} {words}" if count else none
        self.count.setText(text)
        for size in _FONT_SIZES:
            self.count.setFont(style.scaled_font(self, size))
            if self.count.sizeHint().width() <= self.count.width():
                break
        else:
            self.count.setText(str(count) if count else text)
        self.count.setAccessibleName(f"{count} {words}")
        self.count.setToolTip(f"{self._bar.summary}\n{self._tip}".strip())

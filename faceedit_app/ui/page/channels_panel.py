"""All channels: the weights and rotations of the take as plain curves, for those who know them."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSignalBlocker, Qt, QTimer
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QCheckBox,
    QHBoxLayout,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.editing.edits.channels import CHANNELS, is_rotation
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving.channel_edits import channels_of
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.channel_plot import ChannelArea, ChannelPlot
from faceedit_app.ui.curves.gestures import Span
from faceedit_app.ui.curves.plot import Marks
from faceedit_app.ui.curves.ruler import Ruler
from faceedit_app.ui.look.number import NumberBox
from faceedit_app.ui.look.texts import plain_tip
from faceedit_app.ui.look.theme import GAP, MARGIN
from faceedit_app.ui.look.widgets import Elided, OnePush
from faceedit_app.ui.page.channel_values import idle_channels, points_of, value_at
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline

MOST_PLOTS = 4
_CEILING, _CEILING_TURN = 0.8, 20.0  # of Limit at first: a weight, degrees
_FIRST = ("jawOpen",)  # selected at first
_NONE_SHOWN = "The list shows no channel: change what is searched for"
_NONE_CHOSEN = "No channel is chosen: click one in the list"


class ChannelsPanel(QWidget):
    """A list of channels with search; those that are selected are plotted and can be edited.

    The buttons act on the selected channels, in the selected time range or the whole take. What the
    list does not show is never selected: a search that hides the selected channels selects the
    first one that it shows.
    """

    def __init__(self, document: Document, timeline: Timeline) -> None:
        super().__init__()
        self._document, self._timeline = document, timeline
        self.plots: list[ChannelPlot] = []
        self._known: list[ChannelPlot] = []  # those on the screen, and some more
        self._items: dict[str, QListWidgetItem] = {}
        self._latest: tuple[str, ...] = _FIRST  # selected, also while none is shown
        self.search = QLineEdit()
        self.search.setObjectName("search")
        self.search.setPlaceholderText("Search channels")
        self.search.setAccessibleName("Search channels")
        self.search.setClearButtonEnabled(True)
        self.search.textChanged.connect(self._filter)
        self.none = Elided()  # why the list is empty
        self.none.setObjectName("caption")
        self.none.short = "No such channel"
        self.list = QListWidget()
        self.list.setAccessibleName("Channels")
        self.list.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.list.itemSelectionChanged.connect(self._choose)
        self.area = ChannelArea()
        self.area.setBackground(style.BACKGROUND)
        self.area.ci.setContentsMargins(0, 0, 0, 0)
        self.area.ci.setSpacing(2)
        self.area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.ruler = Ruler(timeline)
        self.draw = QCheckBox("&Draw")
        self.draw.setToolTip("Drag on a plot to draw; otherwise a drag selects a time range")
        self.factor = _number(0.0, 10.0, 0.05, 0.5, "×", "Factor for Scale")
        self.smoothing = _number(10.0, 2000.0, 10.0, 80.0, " ms", "Width of Smooth")
        self.ceiling = _number(0.05, 1.0, 0.05, _CEILING, "", "Ceiling for Limit")
        self._buttons = {
            self._button(text, act): f"{tip}, in the selected range or the whole take"
            for text, tip, act in (
                ("Scale", "Multiply the distance from the median of the take", self.scale),
                ("Smooth", "Calm shaking", self.smooth),
                ("Limit", "Approach a ceiling smoothly and never pass it", self.limit),
                ("Mute", "Set to 0", self.mute),
            )
        }
        self._lay_out()
        document.opened.connect(self.reload)
        for changed in (document.changed, document.previewed):
            changed.connect(self.refresh)
        for moved in (
            timeline.playhead_moved,
            timeline.selection_changed,
            timeline.falloff_changed,
        ):
            moved.connect(self._mark)
        self.reload()

    @staticmethod
    def _button(text: str, act: object) -> QPushButton:
        button = OnePush(text)
        button.clicked.connect(act)
        return button

    def _lay_out(self) -> None:
        row = QHBoxLayout()
        row.setSpacing(GAP)
        scale, smooth, limit, mute = self._buttons
        for button, field in (
            (scale, self.factor),
            (smooth, self.smoothing),
            (limit, self.ceiling),
        ):
            row.addWidget(button)
            row.addWidget(field)
            row.addSpacing(GAP)
        row.addWidget(mute)
        row.addSpacing(GAP)
        row.addWidget(self.draw)
        row.addStretch()
        left, right = QWidget(), QWidget()
        # The times stand above the plots, not above their numbers.
        times = QHBoxLayout()
        times.addSpacing(style.AXIS_WIDTH)
        times.addWidget(self.ruler)
        for box, parts in ((left, (self.search, self.none, self.list)), (right, (self.area,))):
            column = QVBoxLayout(box)
            column.setContentsMargins(0, 0, 0, 0)
            column.setSpacing(GAP // 2)
            if box is right:
                column.addLayout(times)
            for part in parts:
                column.addWidget(part)
            if box is right:
                column.addLayout(row)
        split = QSplitter(Qt.Orientation.Horizontal)
        split.setChildrenCollapsible(False)
        split.addWidget(left)
        split.addWidget(right)
        split.setSizes((190, 900))
        split.setStretchFactor(1, 1)
        whole = QVBoxLayout(self)
        whole.setContentsMargins(MARGIN, GAP // 2, MARGIN, GAP // 2)
        whole.addWidget(split)

    # --- the list ----------------------------------------------------------------------------

    @property
    def channels(self) -> tuple[str, ...]:
        """The channels that the take has, in ARKit order, then the rotations."""
        session = self._document.session
        if session is None:
            return ()
        has = channels_of(session.take.clip)
        return tuple(name for name in CHANNELS if name in has)

    @property
    def chosen(self) -> tuple[str, ...]:
        """The selected channels, in the order of the list."""
        return tuple(name for name in self.channels if self._items[name].isSelected())

    def choose(self, *channels: str) -> None:
        """Select channels; a search that hides one is ended."""
        if any(self._items[name].isHidden() for name in channels if name in self._items):
            self.search.clear()
        self._select(channels)

    def _select(self, channels: Sequence[str]) -> None:
        with QSignalBlocker(self.list):
            for number, name in enumerate(channels):
                if not number and name in self._items:  # where the arrows go on from
                    self.list.setCurrentItem(self._items[name])
            for name, item in self._items.items():
                item.setSelected(name in channels)
        self._choose()

    def reload(self) -> None:
        """Another take: list its channels, and keep those that are selected."""
        self.list.blockSignals(True)
        self.list.clear()
        session = self._document.session
        idle = idle_channels(session) if session is not None else set()
        self._items = {}
        for name in self.channels:
            item = self._items[name] = QListWidgetItem(name)
            if name in idle:
                item.setForeground(style.color(style.MUTED))
                item.setToolTip("Idle: the take never moves it")
            self.list.addItem(item)
        self.list.blockSignals(False)
        kept = [name for name in self._latest if name in self._items]
        self._select(kept or _FIRST)
        self._filter(self.search.text())
        if session is not None:
            clip = session.take.clip
            gaps = clip.gap_times
            self.ruler.show_clip(clip, gaps)
        self._choose()
        self._scroll_to_chosen()

    def _scroll_to_chosen(self) -> None:
        for item in self.list.selectedItems()[:1]:
            self.list.scrollToItem(item, QAbstractItemView.ScrollHint.PositionAtCenter)

    def _filter(self, text: str) -> None:
        wanted = text.strip()
        for name, item in self._items.items():
            item.setHidden(wanted.lower() not in name.lower())
        shown = [name for name, item in self._items.items() if not item.isHidden()]
        self.none.setVisible(not shown and bool(self._items))
        self.none.setText(f"No channel is called “{wanted}”")
        self.none.setToolTip(plain_tip(self.none.text()))
        self._deselect_hidden()
        if not self.chosen:
            latest = [name for name in self._latest if name in shown]
            self._select(latest or shown[:1])
        else:
            self._choose()
        self._scroll_to_chosen()

    def _deselect_hidden(self) -> None:
        """Deselect what the list does not show; Ctrl+A selects it, and so does a range over it."""
        with QSignalBlocker(self.list):
            for item in self.list.selectedItems():
                if item.isHidden():
                    item.setSelected(False)

    def _choose(self) -> None:
        """Plot the first of the selected channels; the buttons act on all of them."""
        self._deselect_hidden()
        chosen = self.chosen
        self._latest = chosen or self._latest
        wanted = chosen[:MOST_PLOTS]
        if [plot.channel for plot in self.plots] != list(wanted):
            self._plot(wanted)
        why_not = "" if chosen else _NONE_CHOSEN if self.none.isHidden() else _NONE_SHOWN
        for button, tip in self._buttons.items():
            button.setEnabled(not why_not)
            button.setToolTip("\n".join(filter(None, (tip, why_not))))
        self._set_unit(bool(chosen) and all(map(is_rotation, chosen)))
        self.refresh()

    def _plot(self, channels: Sequence[str]) -> None:
        """Plot these channels; a plot takes long to make, so each is used again."""
        self.cancel_gesture()
        for plot in self.plots[len(channels) :]:
            self.area.ci.removeItem(plot)
        shown, known = len(self.plots), self._known
        while len(known) < len(channels):
            known.append(ChannelPlot(self._timeline, "", self._session, self.draw.isChecked))
        self.plots = known[: len(channels)]
        for row, (plot, name) in enumerate(zip(self.plots, channels, strict=True)):
            plot.channel = name
            if row >= shown:
                self.area.ci.addItem(plot, row, 0)

    def _set_unit(self, turns: bool) -> None:
        """Let the ceiling be in degrees, or a weight."""
        if turns == bool(self.ceiling.suffix()):
            return
        self.ceiling.setSuffix("°" if turns else "")
        self.ceiling.setRange(*((1.0, 180.0) if turns else (0.05, 1.0)))
        self.ceiling.setSingleStep(1.0 if turns else 0.05)
        self.ceiling.setDecimals(0 if turns else 2)
        self.ceiling.setValue(_CEILING_TURN if turns else _CEILING)

    # --- the plots ---------------------------------------------------------------------------

    def _session(self) -> EditSession | None:
        return self._document.session

    def showEvent(self, event: QShowEvent) -> None:
        """Show what has changed meanwhile."""
        super().showEvent(event)
        self.refresh()
        QTimer.singleShot(0, self, self._scroll_to_chosen)  # after the layout

    def refresh(self) -> None:
        """Show the channels as they are now."""
        session = self._document.session
        if session is None or not self.isVisible():
            return
        for plot in self.plots:
            tracked, edited = points_of(session, plot.channel, self._timeline.filled_frames)
            plot.show_values(tracked, edited, self.devicePixelRatioF())
        self._mark()

    def _mark(self) -> None:
        session, line = self._document.session, self._timeline
        if session is None or not self.isVisible():
            return
        span = None
        if line.selection is not None:
            span = Span(*line.selection, line.falloff, line.falloff_out)
        self.ruler.show_marks(Marks(selection=span), line.time)
        for plot in self.plots:
            plot.show_marks(value_at(session, plot.channel, line), line.time, span)

    # --- gestures ----------------------------------------------------------------------------

    def cancel_gesture(self) -> bool:
        """Drop what is being drawn; False if nothing is."""
        drawing = [plot for plot in self.plots if plot.is_drawing]
        for plot in drawing:
            plot.cancel()
        return bool(drawing)

    def mouse_lost(self) -> None:
        """End drawing and keep it: the release was lost."""
        for plot in self.plots:
            plot.mouse_lost()

    # --- edits -------------------------------------------------------------------------------

    def scale(self) -> None:
        """Scale the selected channels."""
        self._add(Op.SCALE, self.factor.value())

    def smooth(self) -> None:
        """Smooth the selected channels."""
        self._add(Op.SMOOTH, self.smoothing.value() / 1000.0)

    def limit(self) -> None:
        """Limit the selected channels softly."""
        self._add(Op.LIMIT, self.ceiling.value())

    def mute(self) -> None:
        """Set the selected channels to 0."""
        self._add(Op.SCALE, 0.0, about=0.0)

    def _add(self, op: Op, value: float, about: float | None = None) -> None:
        """Edit the selected channels: weights and rotations in an edit each, as one step."""
        session, line = self._document.session, self._timeline
        if session is None:
            return
        start, end, fade_in, fade_out = 0.0, line.duration, 0.0, 0.0
        if line.own_selection is not None:
            (start, end), (fade_in, fade_out) = line.own_selection, line.own_falloffs
        falloff_out = None if fade_out == fade_in else fade_out
        edits = [
            Edit(
                (),
                op,
                start,
                end,
                fade_in,
                round(value, 4),
                falloff_out=falloff_out,
                about=about,
                channels=channels,
            )
            for channels in _by_unit(self.chosen)
        ]
        session.add(*edits)


def _by_unit(channels: Sequence[str]) -> list[tuple[str, ...]]:
    """The weights among channels, and the rotations, without empty groups."""
    groups = (tuple(c for c in channels if is_rotation(c) is turns) for turns in (False, True))
    return [group for group in groups if group]


def _number(low: float, high: float, step: float, value: float, unit: str, name: str) -> NumberBox:
    """A field for a number."""
    field = NumberBox()
    field.setAlignment(Qt.AlignmentFlag.AlignCenter)  # as beside the ruler
    field.setRange(low, high)
    field.setSingleStep(step)
    field.setDecimals(0 if step >= 1 else 2)
    if unit == "×":
        field.setPrefix("× ")
    else:
        field.setSuffix(unit)
    field.setValue(value)
    field.setAccessibleName(name)
    field.setToolTip(name)
    return field

"""The page with an open take: settings, curves and face side by side, transport."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import (
    QAbstractSlider,
    QSplitter,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.edits.groups import groups_of
from faceedit_app.ui.edits.panel import EditsPanel
from faceedit_app.ui.face.pane import FacePane
from faceedit_app.ui.media.film_pane import FilmPane, FilmPlace, best_place
from faceedit_app.ui.media.sound_player import SoundPlayer
from faceedit_app.ui.media.take_media import TakeMedia
from faceedit_app.ui.media.volume import Volume
from faceedit_app.ui.media.waveform import SoundRow
from faceedit_app.ui.media.words_row import WordsRow
from faceedit_app.ui.page.channels_panel import ChannelsPanel
from faceedit_app.ui.page.curve_menus import connect_menus
from faceedit_app.ui.page.expressions import Expressions
from faceedit_app.ui.page.first_steps import Card, HintLayer
from faceedit_app.ui.page.fix_trials import FixTrials
from faceedit_app.ui.page.keys_back import turn_to
from faceedit_app.ui.page.overview import Overview
from faceedit_app.ui.page.problems_bar import ProblemsBar, ProblemsHead
from faceedit_app.ui.page.problems_list import ProblemsList
from faceedit_app.ui.page.proposal_bar import ProposalBar
from faceedit_app.ui.page.settings_bar import SettingsBar
from faceedit_app.ui.page.side_pane import SidePane
from faceedit_app.ui.page.time_rows import TimeRows
from faceedit_app.ui.page.toolbar import ToolBar
from faceedit_app.ui.page.transport import Transport
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.background_solving import BackgroundSolving
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.gap_frames import GapFrames
from faceedit_app.ui.state.playback import Playback
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.tools import Tools

_SHARES = (760, 520)  # of the window's width at first: curves, face
_SIDE = (560, 204)  # of the height beside the curves: face, lists with five rows
_STACKED = (630, 100)  # the same, with the film above or below the face, or on a low screen
_HEAD, _TWO_HEADS = QSize(7, 10), QSize(14, 10)  # their shapes
_LOW = 600  # pixels; 1920 x 1080 at twice the size have 540


class Editor(QWidget):
    """Puts the parts together and passes changes between them."""

    def __init__(
        self,
        actions: Actions,
        document: Document,
        timeline: Timeline,
        playback: Playback,
        tools: Tools,
        media: TakeMedia,
        sound_player: SoundPlayer,
        parent: QWidget,
    ) -> None:
        super().__init__(parent)
        self._document, self._timeline, self._playback = document, timeline, playback
        self._tools = tools
        self._take: Path | None = None
        self.gap_frames = GapFrames(document, timeline, self)
        self.settings_bar = SettingsBar(actions, document, timeline)
        self.tool_bar = ToolBar(actions, tools)
        self.proposal = ProposalBar(actions, document)
        self.curves = CurvesPanel(timeline, tools)
        self.problems = ProblemsBar(document, timeline)
        self.curves.add_row(ProblemsHead(actions, self.problems), self.problems)
        self.curves.cover_legend(self.proposal)
        self.overview = Overview(document, timeline)
        self.curves.add_row(QWidget(), self.overview)
        self.sound = SoundRow(media, timeline)
        self.words = WordsRow(actions, document, timeline)
        self.film = FilmPane(media, timeline)
        self.face = FacePane(actions, document, timeline)
        self.edits = EditsPanel(actions, document, timeline)
        self.trials = FixTrials(document, self.problems)
        self.problem_list = ProblemsList(actions, self.problems, timeline, self.trials)
        self.expressions = Expressions(actions, document, self.face.viewport, timeline)
        self.channels: ChannelsPanel | None = None  # once it has been opened
        self.lists = QTabWidget()
        self.transport = Transport(actions, timeline, playback)
        self.transport.extras.addWidget(Volume(actions["mute"], media, sound_player))
        self.solving = BackgroundSolving(document, timeline, self)
        self._lay_out()
        self.hints = HintLayer(self, self._first_steps())
        self._edits = 0
        self._fits_film = True  # the user has not chosen where it is shown
        self._connect(actions)

    def _lay_out(self) -> None:
        """Lay the parts out from the outside in: each is moved into its place only once.

        With hundreds of widgets, that takes a twentieth off the time until a take is open.
        """
        column = _column(self)
        column.addWidget(self.settings_bar)
        column.addWidget(self.tool_bar)
        self.panes = _splitter(Qt.Orientation.Horizontal)
        column.addWidget(self.panes, 1)
        self.panes.addWidget(TimeRows(self.curves, self.sound, self.words))
        self._lay_out_side()
        self.panes.setSizes(_SHARES)
        self.panes.setStretchFactor(0, 3)
        self.panes.setStretchFactor(1, 2)
        column.addWidget(self.transport)

    def _lay_out_side(self) -> None:
        """What is beside it: film and face, and the lists under them."""
        self.stage = _splitter(Qt.Orientation.Horizontal)
        self.stage.addWidget(self.film)  # before the lists, which Tab reaches after the face
        self.stage.addWidget(self.face)
        self.side = SidePane(self.stage, self.lists)
        self.panes.addWidget(self.side)
        self.lists.setDocumentMode(True)
        self.lists.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.lists.tabBar().setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.lists.tabBar().setAccessibleName("Lists")
        self.lists.addTab(self.edits, "Edits")
        self.lists.addTab(self.problem_list, "Problems")
        self.lists.addTab(self.expressions, "Expressions")
        is_low = self.screen().availableSize().height() < _LOW
        self.side.setSizes(_STACKED if is_low else _SIDE)

    def _connect(self, actions: Actions) -> None:
        document = self._document
        document.changed.connect(self.curves.refresh)
        document.changed.connect(self._count_edits)
        document.previewed.connect(self._previewed)
        self.curves.reshaped.connect(self._reshape)
        self.curves.reshape_ended.connect(self.edits.end_reshape)
        self.curves.fields.left.connect(document.seal)
        # Also an edit with the same range: what was typed wrongly was meant for the other one.
        self.edits.list.selectionModel().currentChanged.connect(lambda: self.curves.fields.sync())
        self.curves.edit_began.connect(self._drag_began)
        self.curves.edit_made.connect(self.edits.select_new)
        self.curves.follow_chosen(lambda: self.edits.chosen_edit)
        self.face.handles.hand = self.curves.hand
        self._playback.playing_changed.connect(self._set_quality)
        self._timeline.playhead_moved.connect(self._played)
        self.edits.reshaping = lambda: self.curves.is_reshaping
        self.solving.advanced.connect(self._advanced)
        self.gap_frames.changed.connect(self._advanced)
        self.gap_frames.changed.connect(self.settings_bar.sync)
        self.solving.finished.connect(self._solved)
        self.edits.selected.connect(actions.refresh)
        self._timeline.range_toggled.connect(actions.refresh)
        self.problems.found.connect(actions.refresh)
        self.proposal.toggled.connect(actions.refresh)
        self.problem_list.ticked.connect(actions.refresh)
        for news in (self.problem_list.ticked, self.trials.tried):
            news.connect(lambda: self._propose_ticked(actions))
        for changed in (document.changed, document.opened, self.problems.found):
            changed.connect(self._name_tabs)
        for changed in (self.face.switched, self.film.screen_.shaped):
            changed.connect(self._fit_film)
            changed.connect(actions.refresh)
        connect_menus(self.curves, actions)

    @property
    def film_place(self) -> FilmPlace:
        """Where the film is shown."""
        if self.stage.orientation() == Qt.Orientation.Horizontal:
            return FilmPlace.BESIDE
        return FilmPlace.ABOVE if self.stage.indexOf(self.film) == 0 else FilmPlace.BELOW

    def place_film(self, place: FilmPlace) -> None:
        """Show the film beside, above or below the face from now on, in equal shares."""
        self._fits_film = False
        self._put_film(place)

    def _fit_film(self) -> None:
        """Until the user has chosen: show the film beside or above the face, as is larger."""
        if not self._fits_film or self.face.is_glancing or self.film.screen_.is_waiting:
            return
        shape = self.film.screen_.shape
        place = FilmPlace.BESIDE
        if shape is not None:
            rooms = (
                QSize(self.side.width(), self.side.height() * face // (face + lists))
                for face, lists in (_SIDE, _STACKED)
            )
            place = best_place(shape, _TWO_HEADS if self.face.shows_both else _HEAD, *rooms)
        if place is not self.film_place:
            self._put_film(place)

    def settle_layout(self) -> None:
        """Undo what only the present take has changed in the layout, before it is remembered."""
        self.side.unfold()
        if self._fits_film and self.film_place is not FilmPlace.BESIDE:
            self._put_film(FilmPlace.BESIDE)

    def _put_film(self, place: FilmPlace) -> None:
        beside = place is FilmPlace.BESIDE
        wanted = Qt.Orientation.Horizontal if beside else Qt.Orientation.Vertical
        if self.stage.orientation() is not wanted:
            self.stage.setOrientation(wanted)
            self.side.setSizes(_SIDE if beside else _STACKED)
        self.stage.insertWidget(1 if place is FilmPlace.BELOW else 0, self.film)
        self.stage.setSizes([1000, 1000])

    def _name_tabs(self) -> None:
        """Show how many edits and problems there are."""
        session = self._document.session
        edits = len(groups_of(session.edits)) if session is not None else 0
        counts = edits, len(self.problems.problems)
        for tab, (name, count) in enumerate(zip(("Edits", "Problems"), counts, strict=True)):
            self.lists.setTabText(tab, f"{name}  {count}" if count else name)

    def _propose_ticked(self, actions: Actions) -> None:
        """Another set of problems is ticked: propose those instead, or nothing if none is."""
        proposal, waits = self.proposal, self.proposal.waits
        if not (proposal.is_open and proposal.is_for_all):
            return
        if self.problem_list.chosen:
            actions["fix_all"].trigger()
            if waits:
                actions["accept_fix"].trigger()
        elif proposal.discard() and waits and not self.trials.is_trying:
            proposal.dropped.emit("Nothing was fixed: each fix would make another problem")

    def list_edits(self) -> None:
        """Show the list of edits instead of the list of problems, to set a new edit's strength."""
        if self.lists.currentWidget() is self.problem_list:
            turn_to(self.lists, self.edits, self.curves)

    def list_problems(self) -> None:
        """Show the list of problems."""
        self.side.unfold()
        turn_to(self.lists, self.problem_list, self.curves)

    def _first_steps(self) -> tuple[Card, ...]:
        return (
            Card(
                "1  Drag a curve",
                "Each curve is one movement of the face over time. Drag one up or down: the face"
                " follows, and the rest of the take stays as it was. Esc cancels a drag;"
                " Ctrl+Z undoes it.",
                (self.curves,),
                (self.face,),
            ),
            Card(
                "2  Or let FaceEdit do it",
                "Close lips, Blink and Smile take one click. Marks under the curves show problems:"
                " lips that stay open, half blinks, shaking. Press ↓ to go to the next one and P"
                " to preview a fix.",
                (self.tool_bar, self.proposal),
            ),
            Card(
                "3  Change your mind, then export",
                "Every edit is listed here. Select one to change its strength, switch it off or"
                " delete it. Ctrl+S saves your work as a project; Ctrl+E exports the edited"
                " take.",
                (self.lists,),
            ),
        )

    def open(self) -> None:
        """Show the document's take from its beginning."""
        session = self._document.session
        assert session is not None
        clip = session.take.clip
        self.hints.finish()
        self._timeline.open(clip, session.take.lost_rows)
        self.gap_frames.refresh()
        if session.take.path != self._take:  # not the same one at another frame rate
            self._restore_settings()
        self._take, self._edits = session.take.path, len(session.edits)
        self.curves.set_session(session)
        self.transport.set_clip(clip)
        self.problems.restart()
        self.solving.watch()
        self.settings_bar.sync()
        self.edits.refresh()
        self.face.refresh()

    def _restore_settings(self) -> None:
        """Undo what the last take left on, which nobody expects in the next."""
        self._timeline.restore_falloffs()
        self._tools.link(True)
        self._playback.set_loop(False)
        self.transport.restore_speed()

    def cancel_gesture(self) -> bool:
        """Esc: cancel a drag, discard a proposal; False if there is none."""
        if self.words.strip.is_held:
            self.words.strip.cancel()
            return True
        if self.channels is not None and self.channels.cancel_gesture():
            return True
        return self.settings_bar.cancel() or self.edits.cancel() or self.proposal.discard()

    def _set_quality(self, plays: bool) -> None:
        """In playback, a picture has the time between two frames; in a drag, hardly any."""
        clip, quality = self._timeline.clip, self.face.viewport.quality
        if plays and clip is not None:
            quality.play(clip.rate * max(abs(self._playback.pace), 1.0))
        else:
            quality.rest()

    def _played(self) -> None:
        """In fast playback, draw the face while the rest of the window is painted."""
        if self._playback.playing and not self.face.viewport.quality.is_hurried:
            self.face.viewport.hurry()

    def mouse_lost(self) -> None:
        """The mouse is lost to another window: end drags and keep their result."""
        for part in (self.curves, self.sound.waveform, self.words.strip, self.face.viewport):
            part.mouse_lost()
        if self.channels is not None:
            self.channels.mouse_lost()
        for slider in self.findChildren(QAbstractSlider):
            slider.setSliderDown(False)

    def settle(self) -> None:
        """Commit gestures on the sliders."""
        self.settings_bar.settle()
        self.edits.settle()

    def _drag_began(self, is_new: bool) -> None:
        """Show the frame being changed from now on: playback would carry it away."""
        self._playback.pause()
        if is_new:
            self.edits.leave()

    def _previewed(self) -> None:
        """Start on the face first: it is drawn while the curves are painted."""
        if not self.proposal.is_open:
            self.trials.stop()  # what the hand does comes first
        is_dragging = self.curves.is_dragging
        if is_dragging:  # also an edge of the selection
            self._playback.pause()
        self.face.refresh()
        if is_dragging:
            self.face.viewport.hurry()
        self.curves.refresh()

    def _advanced(self) -> None:
        """Some more of a wide edit has been computed."""
        self.face.refresh_if_other()
        self.curves.refresh()
        if self.channels is not None:
            self.channels.refresh()

    def _solved(self) -> None:
        """A wide edit has been computed in full."""
        self.gap_frames.refresh()
        self._advanced()
        self.settings_bar.sync()

    def _count_edits(self) -> None:
        """An edit made under the first steps is what they ask for."""
        session = self._document.session
        before, self._edits = self._edits, len(session.edits) if session is not None else 0
        if self._edits > before:
            self.hints.use()

    def _reshape(self) -> None:
        """Apply the dragged edges of the selection to the selected edit."""
        line = self._timeline
        if line.selection is not None:
            self.edits.reshape(*line.selection, line.falloff, line.falloff_out)


def _column(box: QWidget) -> QVBoxLayout:
    """The layout of what lies one above the other, without gaps."""
    column = QVBoxLayout(box)
    column.setContentsMargins(0, 0, 0, 0)
    column.setSpacing(0)
    return column


def _splitter(orientation: Qt.Orientation) -> QSplitter:
    """Panes that the user can resize."""
    splitter = QSplitter(orientation)
    splitter.setChildrenCollapsible(False)
    splitter.setHandleWidth(6)
    return splitter

"""The undo history of a take, and the state that a gesture previews.

Edits, settings and media all change the same way: a gesture previews states, then commits the last
one as a step or cancels it. Callers say where a gesture ends; nothing is guessed here.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field, replace

from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.edits.following import following, words_following
from faceedit_app.editing.edits.media import Placement
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.words.transcript import Transcript


@dataclass(frozen=True)
class EditState:
    """A state of the take: what a step changes.

    Attributes:
        edits: oldest first.
        settings: how they are answered.
        media: the sound and film; None = the files found next to the take.
        words: what was said, if the user gave it.
    """

    edits: tuple[Edit, ...] = ()
    settings: Settings = field(default_factory=Settings)
    media: Placement | None = None
    words: Transcript | None = None


@dataclass(frozen=True)
class Origin:
    """What a take was opened with, or saved last: where Undo leads after a recovery.

    Attributes:
        state: its state then.
        rate: its frame rate then, as `Take.fps`; the times in `state` are those at that rate.
        is_saved: whether its files hold all of that.
    """

    state: EditState = field(default_factory=EditState)
    rate: float | None = None
    is_saved: bool = True


@dataclass(frozen=True)
class Step:
    """One entry of the history.

    Attributes:
        name: shown after Undo and Redo, such as "Smile".
        before, after: the states before and after it.
        rates: the frame rates before and after it, as `Take.fps`, if it changed that. Times in
            the states on either side of it are then those of the take at the rate of that side.
    """

    name: str
    before: EditState
    after: EditState
    rates: tuple[float | None, float | None] | None = None


class Steps:
    """The undo history, and the state that a gesture previews.

    Attributes:
        state: the kept state.
        preview: the state that the gesture in progress shows instead; None between gestures.
        done: the steps that lead to `state`, oldest first; Undo takes back the last one.
        undone: the steps that were undone; Redo repeats the last one.
        rate: the frame rate of the take to which `state` belongs, as `Take.fps`.
    """

    def __init__(self, rate: float | None = None) -> None:
        self.state, self.rate = EditState(), rate
        self.preview: EditState | None = None
        self.done: list[Step] = []
        self.undone: list[Step] = []
        self._key: Hashable = None  # the last step's, while it may be extended
        self._dropped: list[Step] = []  # the redo steps that it replaced

    @property
    def shown(self) -> EditState:
        """The state on screen: the preview, else the kept state."""
        return self.state if self.preview is None else self.preview

    def show(self, state: EditState) -> bool:
        """Preview a state; edits that it leaves as they were follow the retimes that it changes.

        So do words of a take that has no sound: they were found in the face. Others stay with the
        sound.

        Returns:
            Whether the preview has changed.
        """
        before, after = self.state.edits, state.edits
        if after is not before:
            words, media = state.words, state.media
            if words is not None and words is self.state.words and media == Placement():
                words = words_following(words, before, after)
            state = replace(state, edits=following(before, after), words=words)
        is_new, self.preview = state != self.preview, state
        return is_new

    def extends(self, key: Hashable) -> bool:
        """Whether a commit with this merge key would extend the last step."""
        return key is not None and key == self._key

    def commit(self, name: str, merge: Hashable = None) -> bool:
        """Keep the preview as one step.

        A preview that equals the kept state makes no step and leaves Redo alone; so does an
        extended step that returns to where it began.

        Args:
            name: the step's name.
            merge: extends the last step if it had the same key and nothing happened between, as
                for the ticks of a wheel; None = a step of its own.

        Returns:
            Whether the kept state has changed.
        """
        state, self.preview = self.preview, None
        if state is None or state == self.state:
            return False
        if not self.extends(merge):
            self._dropped, self.undone = self.undone, []
            self.done.append(Step(name, self.state, state))
            self._key = merge
        elif state != (last := self.done.pop()).before:
            self.done.append(Step(name, last.before, state))
        else:
            self.undone = self._dropped
            self.seal()
        self.state = state
        return True

    def cancel(self) -> bool:
        """Drop the preview; False if there is none."""
        state, self.preview = self.preview, None
        return state is not None

    def seal(self) -> None:
        """Let no later commit extend the last step."""
        self._key, self._dropped = None, []

    def undo(self) -> bool:
        """Undo the last step, and drop the preview; False if there is no step."""
        if not self.done:
            return False
        step = self.done.pop()
        self.undone.append(step)
        if step.rates is not None:
            self.rate = step.rates[0]
        self._go_to(step.before)
        return True

    def redo(self) -> bool:
        """Redo the step that was undone last; False if there is none."""
        if not self.undone:
            return False
        step = self.undone.pop()
        self.done.append(step)
        if step.rates is not None:
            self.rate = step.rates[1]
        self._go_to(step.after)
        return True

    def rate_after(self, count: int) -> float | None:
        """The frame rate after redoing some steps, or undoing as many if below 0."""
        rate, forward = self.rate, count > 0
        steps = self.undone if forward else self.done
        for step in list(reversed(steps))[: abs(count)]:
            if step.rates is not None:
                rate = step.rates[forward]
        return rate

    def begin_with(self, state: EditState) -> None:
        """Start from a state, with an empty history."""
        self.done, self.undone = [], []
        self._go_to(state)

    def continue_from(self, other: Steps) -> None:
        """Take over another history."""
        self.done, self.undone, self.rate = [*other.done], [*other.undone], other.rate
        self._go_to(other.state)

    def step_to(self, name: str, rate: float | None, state: EditState) -> None:
        """Add a step to a state as it is, also if the take has another frame rate there.

        Args:
            rate: the take's frame rate from now on, as `Take.fps`.
            state: in times of the take at that rate; nothing in it follows retimes.
        """
        self.undone = []
        rates = (self.rate, rate) if rate != self.rate else None
        self.done.append(Step(name, self.state, state, rates))
        self.rate = rate
        self._go_to(state)

    def _go_to(self, state: EditState) -> None:
        self.state, self.preview = state, None
        self.seal()

"""The history of a take: what is kept, what a gesture previews, undo and redo.

Edits, settings and media all change in one way: a gesture previews states, then commits the last
one as a step or cancels it. Nothing here guesses where a gesture ends: whoever runs it says so.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field

from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.edits.media import Placement
from faceedit_app.editing.edits.settings import Settings


@dataclass(frozen=True)
class EditState:
    """What undo steps through.

    Attributes:
        edits: oldest first.
        settings: how they are answered.
        media: the take's sound and film; None = what lies beside it, as it lies there.
    """

    edits: tuple[Edit, ...] = ()
    settings: Settings = field(default_factory=Settings)
    media: Placement | None = None


@dataclass(frozen=True)
class Step:
    """One entry of the history.

    Attributes:
        name: what the user reads after Undo and Redo, such as "Smile".
        before, after: the states on either side of it.
    """

    name: str
    before: EditState
    after: EditState


class Steps:
    """Undo and redo, and the state that a gesture previews.

    Attributes:
        state: what is kept.
        preview: what the gesture in progress shows in its place; None between gestures.
        done: the steps that lead to `state`, oldest first; Undo takes the last one back.
        undone: the steps that were taken back; Redo takes the last one again.
    """

    def __init__(self) -> None:
        self.state = EditState()
        self.preview: EditState | None = None
        self.done: list[Step] = []
        self.undone: list[Step] = []
        self._key: Hashable = None  # of the last step, as long as it may still be extended
        self._dropped: list[Step] = []  # what Redo lost to that step

    @property
    def shown(self) -> EditState:
        """What is to be seen: the preview, else what is kept."""
        return self.state if self.preview is None else self.preview

    def extends(self, key: Hashable) -> bool:
        """Whether a commit with this merge key would extend the last step."""
        return key is not None and key == self._key

    def commit(self, name: str, merge: Hashable = None) -> bool:
        """Keep what is previewed as one step.

        A preview that equals what is kept is no step, and Redo keeps what it had. Nor is a step
        that was extended until it is back where it began.

        Args:
            name: of the step.
            merge: extends the last step if that had the same key and nothing came between, as
                for the ticks of a wheel; None = a step of its own.

        Returns:
            Whether what is kept is another state now.
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
        """Drop what is previewed; False if nothing was."""
        state, self.preview = self.preview, None
        return state is not None

    def seal(self) -> None:
        """End the last gesture for good: whatever comes now is a step of its own."""
        self._key, self._dropped = None, []

    def undo(self) -> bool:
        """Take the last step back, and drop what is previewed; False if there is no step."""
        if not self.done:
            return False
        step = self.done.pop()
        self.undone.append(step)
        self._go_to(step.before)
        return True

    def redo(self) -> bool:
        """Take the step again that was undone last; False if there is none."""
        if not self.undone:
            return False
        step = self.undone.pop()
        self.done.append(step)
        self._go_to(step.after)
        return True

    def begin_with(self, state: EditState) -> None:
        """Start from a state that has nothing before it to go back to."""
        self.done, self.undone = [], []
        self._go_to(state)

    def _go_to(self, state: EditState) -> None:
        self.state, self.preview = state, None
        self.seal()

"""What the Fix menu does to channels: a neutral rest, and the strength of each channel."""

from __future__ import annotations

from faceedit_app.ui.commands.workspace import Workspace

OFFER = (
    "This take is not neutral at rest: the {what}. You can remove that; blinks and words keep "
    "their height."
)
_WORDS = {"eyeBlink": "lids are half shut", "eyeSquint": "eyes squint", "jawOpen": "mouth is open"}


class CalibrationCommands:
    """Makes the rest of a take neutral, and sets the strength of its channels."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._document, self._timeline = workspace.document, workspace.timeline

    def _range(self) -> tuple[float, float, float]:
        """The selection with its falloff, or the whole take: start, end, falloff."""
        line = self._timeline
        if line.own_selection is None:
            return 0.0, line.duration, 0.0
        return (*line.own_selection, line.falloff)

    def this_frame(self) -> None:
        """Make the pose at the playhead neutral, in the selection or the whole take."""
        from faceedit_app.editing.help.calibrating import neutral_at

        session = self._document.session
        if session is None:
            return
        self._workspace.end_gestures()
        edit = neutral_at(session, self._timeline.time, *self._range())
        if edit is None:
            self._workspace.message.emit("This frame is neutral already")
        else:
            self._workspace.add_edits((edit,), "This frame is neutral")

    def offer_neutral(self) -> bool:
        """Offer a neutral rest for a take that plainly has none; whether it did."""
        from faceedit_app.editing.help.calibrating import NOT_NEUTRAL, neutral_rest

        session = self._document.session
        if session is None or session.edits:
            return False
        edit = neutral_rest(session)
        if edit is None:
            return False
        rests = dict(zip(edit.channels, edit.amounts, strict=True))
        found = [name for name, most in NOT_NEUTRAL.items() if rests.get(name, (0.0,))[0] > most]
        words = {_WORDS[part]: None for part in _WORDS for name in found if name.startswith(part)}
        text = OFFER.format(what=" and ".join(words))
        self._workspace.offer.emit(text, "Make the rest neutral", self.neutral_rest)
        return True

    def neutral_rest(self) -> None:
        """Make the rest of the take neutral, if it is plainly not so."""
        from faceedit_app.editing.help.calibrating import neutral_rest

        session = self._document.session
        edit = neutral_rest(session) if session is not None else None
        if edit is not None:
            self._workspace.end_gestures()
            self._workspace.add_edits((edit,), "Neutral rest")

    def levels(self) -> None:
        """Show the table of all channels with their strength."""
        from faceedit_app.editing.help.calibrating import levels
        from faceedit_app.ui.page.levels_dialog import LevelsDialog

        session = self._document.session
        if session is None:
            return
        self._workspace.end_gestures()
        start, end, falloff = self._range()
        LevelsDialog(
            self._workspace.window,
            self._document,
            session.take.clip.channels,
            self._workspace.shown_range(start, end),
            lambda chosen: levels(chosen, start, end, falloff),
            lambda edit: self._workspace.add_edits((edit,), "Strength by channel"),
        ).show()

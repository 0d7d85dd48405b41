"""When commands are possible, and what the user can do if they are not."""

from __future__ import annotations

from typing import Any

from faceedit_app.ui.state.actions import When

# What carries out a command has the property that is asked for; see the table that uses it.
CAN_UNDO = When[Any](lambda do: do.can_undo, "There is nothing to undo")
CAN_REDO = When[Any](lambda do: do.can_redo, "Nothing was undone")
HAS_RANGE = When[Any](
    lambda do: do.has_range, "No time range is selected: drag in the bar under the ruler"
)
HAS_COPIED = When[Any](
    lambda do: do.has_copied, "Nothing has been copied yet: select a range and choose Copy range"
)
HAS_EDITS = When[Any](lambda do: do.has_edits, "There are no edits yet")
HAS_SELECTED_EDIT = When[Any](
    lambda do: do.has_selected_edit, "No edit is chosen: click one in the list of edits"
)
CAN_MOVE_UP = When[Any](lambda do: do.can_move(-1), "No edit is chosen, or it is the first already")
CAN_MOVE_DOWN = When[Any](lambda do: do.can_move(1), "No edit is chosen, or it is the last already")
NOT_FILMING = When[Any](lambda do: not do.is_filming, "A film is being written: wait for its end")
SHOWS_OWN = When[Any](
    lambda do: do.character.is_shown,
    "FaceEdit's own character is shown: open yours with File > Character > Open…",
)
CAN_SHOW_OWN = When[Any](
    lambda do: do.character.can_show_own, "FaceEdit's own character is shown already"
)
CLOSES = When[Any](
    lambda do: do.character.is_shown and do.character.closes,
    "Needs your own character, and File > Character > Close on my character",
)
HAS_WORDS = When[Any](
    lambda do: do.words.has_words, "The words of the take are not known: Take > Words…"
)
HAS_PROBLEMS = When[Any](lambda do: bool(do.problems), "No problems were found in the take")
CAN_FIX = When[Any](
    lambda do: do.can_fix, "There is no problem with a fix at the playhead: ↓ goes to the next one"
)
CAN_FIX_ALL = When[Any](lambda do: do.can_fix_all, "No problem that can be fixed is ticked")
CAN_TICK = When[Any](lambda do: do.can_tick, "The list has no problem that can be fixed")
HAS_VARIATIONS = When[Any](
    lambda do: do.has_variations, "No proposal with variations is shown: Fix > Fill makes one"
)
HAS_PROPOSAL = When[Any](
    lambda do: do.has_proposal, "No proposal is shown: P shows the fix of a problem"
)
HAS_SOUND = When[Any](lambda do: do.has_sound, "The take has no sound: Take > Add sound or film…")
HAS_FILM = When[Any](lambda do: do.has_film, "The take has no film: Take > Add sound or film…")
HAS_LANDMARKS = When[Any](
    lambda do: do.has_landmarks, "Needs a take that FaceEdit tracked, with its film"
)
HAS_TIMECODE = When[Any](lambda do: do.has_timecode, "The take has no timecode")
HAS_ROTATIONS = When[Any](lambda do: do.has_rotations, "The take has no head rotation")
HAS_PICTURE = When[Any](lambda do: do.has_picture, "No face is drawn")
SHOWS_CURVES = When[Any](lambda do: do.shown_curves > 1, "It is the only curve that is shown")
HIDES_CURVES = When[Any](lambda do: do.hides_curves, "No curve is hidden")

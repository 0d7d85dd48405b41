"""The list of edits as the panel changes it, and what edits are called."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from support.faces import talking_clip
from support.sessions import session_by_rig, strengthen, switch, take_of

from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX
from faceedit_app.editing.edits.describe import describe
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.edits.retiming import retimed
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.history import EDITS, SOUND
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.steps import EditState, Origin
from faceedit_app.formats.take import Take

MOUTH = CONTROL_INDEX["mouth_opening"]
A = Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.5, 0.2, 4.0)
B = Edit(("mouth_width",), Op.OFFSET, 1.2, 1.7, 0.2, 3.0)
C = Edit(("mouth_opening",), Op.SET, 2.2, 2.4, 0.1, 9.0)


@lru_cache(maxsize=1)
def take() -> Take:
    return take_of(talking_clip(180))


@pytest.fixture
def session() -> EditSession:
    session = session_by_rig(take())
    session.add(A, B, C)
    return session


STEPS: dict[str, tuple[Callable[[EditSession], object], tuple[Edit, ...]]] = {
    "replace": (lambda s: s.replace_edit(1, C), (A, C, C)),
    "switch off": (lambda s: switch(s, 0, False), (replace(A, enabled=False), B, C)),
    "strength": (lambda s: strengthen(s, 2, 1.5), (A, B, replace(C, strength=1.5))),
    "rename": (lambda s: s.rename(0, " jaw "), (replace(A, name="jaw"), B, C)),
    "rename by what no file holds": (
        lambda s: s.rename(0, "j\ud800w"),
        (replace(A, name="j�w"), B, C),
    ),
    "remove": (lambda s: s.remove(0), (B, C)),
    "remove several": (lambda s: s.remove(-1, 0), (B,)),
    "move down": (lambda s: s.move(0, 2), (B, C, A)),
    "move up": (lambda s: s.move(2, 0), (C, A, B)),
    "move too far": (lambda s: s.move(1, 99), (A, C, B)),
    "move too far up": (lambda s: s.move(1, -7), (B, A, C)),
    "restore": (lambda s: s.restore(EditState((C,), Settings())), (C,)),
    "float and keep": (lambda s: (s.preview(A, B), s.commit()), (A, B, C, A, B)),
    "float another list": (lambda s: (s.preview_list([B]), s.commit()), (B,)),
    "float a change": (lambda s: (s.preview_replace(0, C), s.commit()), (C, B, C)),
}


@pytest.mark.parametrize("name", STEPS)
def test_each_change_of_the_list_is_one_undo_step(session: EditSession, name: str) -> None:
    change, expected = STEPS[name]
    before = session.weights.copy()
    heard: list[EditState] = []
    session.stepped.connect(heard.append)
    change(session)
    assert session.edits == expected
    assert not session.is_previewing
    after = session.weights.copy()
    assert [state.edits for state in heard] == [expected]
    session.undo()
    assert session.edits == (A, B, C)
    np.testing.assert_array_equal(session.weights, before)
    session.redo()
    np.testing.assert_array_equal(session.weights, after)
    assert len(heard) == 3

    fresh = session_by_rig(take())
    fresh.add(*expected)
    np.testing.assert_array_equal(fresh.weights, after)


NO_STEPS: dict[str, Callable[[EditSession], object]] = {
    "same strength": lambda s: strengthen(s, 0, 1.0),
    "same place": lambda s: s.move(1, 1),
    "same settings": lambda s: s.configure(Settings()),
    "nothing removed": lambda s: s.remove(),
    "nothing added": lambda s: s.add(),
    "nothing floats": lambda s: s.commit(),
    "the same floats": lambda s: (s.preview_list(s.edits), s.commit()),
    "cancelled": lambda s: (s.preview(A), s.preview_replace(0, B), s.cancel()),
    "preview of nothing": lambda s: (s.preview(None), s.preview(), s.commit()),
}


@pytest.mark.parametrize("name", NO_STEPS)
def test_what_changes_nothing_is_no_step(session: EditSession, name: str) -> None:
    before = session.weights.copy()
    heard: list[EditState] = []
    session.stepped.connect(heard.append)
    NO_STEPS[name](session)
    assert not session.is_previewing
    np.testing.assert_array_equal(session.weights, before)
    assert heard == []
    session.undo()
    assert session.edits == ()


def test_a_preview_is_shown_and_is_no_step(session: EditSession) -> None:
    heard: list[EditState] = []
    session.stepped.connect(heard.append)
    before = session.asked.copy()
    session.preview_replace(0, replace(A, strength=0.0))
    assert session.is_previewing
    assert (session.asked[70:90, MOUTH] < before[70:90, MOUTH] - 1).all()
    assert session.edits == (A, B, C)
    session.undo()
    assert not session.is_previewing
    assert heard == [EditState()]


@pytest.mark.parametrize("action", ["replace_edit", "rename", "remove", "move"])
def test_position_that_is_not_there_is_an_error_and_no_step(
    session: EditSession, action: str
) -> None:
    arguments = {"remove": (3,), "replace_edit": (3, A)}.get(action, (3, 0))
    with pytest.raises(IndexError):
        getattr(session, action)(*arguments)
    with pytest.raises(ValueError, match="strength"):
        strengthen(session, 0, 2.0)
    assert session.edits == (A, B, C)


def test_edit_that_is_off_or_without_strength_leaves_no_trace() -> None:
    session = session_by_rig(take())
    session.add(replace(A, enabled=False), replace(B, strength=0.0))
    assert session.changed_frames() == 0
    np.testing.assert_array_equal(session.asked, session.tracked)


def test_strength_is_how_much_of_the_change_is_made() -> None:
    session = session_by_rig(take())
    hold = slice(62, 90)
    for strength in (0.5, 1.0, 1.5):
        session.preview(replace(A, strength=strength))
        change = (session.asked - session.tracked)[hold, MOUTH]
        np.testing.assert_allclose(change, 4.0 * strength, atol=1e-4)
    for strength, left in ((0.5, 0.5), (1.0, 0.0), (1.5, 0.5)):
        session.preview(replace(A, op=Op.SET, value=20.0, strength=strength))
        off = np.abs(session.asked[hold, MOUTH] - 20.0)
        expected = left * np.abs(session.tracked[hold, MOUTH] - 20.0)
        np.testing.assert_allclose(off, expected, atol=1e-4)


def test_smooth_and_reset_never_overshoot() -> None:
    session = session_by_rig(take())
    session.add(A)
    reset = Edit(("mouth_opening",), Op.RESET, 1.0, 1.5, 0.0)
    for strength, left in ((0.5, 2.0), (1.0, 0.0), (1.5, 0.0)):
        session.preview(replace(reset, strength=strength))
        change = (session.asked - session.tracked)[70:80, MOUTH]
        np.testing.assert_allclose(change, left, atol=1e-4)
    session.cancel()
    rough = []
    for strength in (0.5, 1.0, 1.5):
        session.preview(Edit(("mouth_opening",), Op.SMOOTH, 0.0, 3.0, 0.0, 0.1, strength=strength))
        rough.append(float(np.abs(np.diff(session.asked[:, MOUTH], 2)).sum()))
    assert rough[0] > rough[1] > rough[2]


def test_falloffs_may_differ() -> None:
    edit = replace(A, falloff=0.5, falloff_out=0.1)
    assert edit.span == (0.5, 1.6)
    mask = edit.mask(np.array([0.5, 0.75, 1.0, 1.5, 1.55, 1.6]))
    np.testing.assert_allclose(mask, [0, 0.5, 1, 1, 0.5, 0], atol=1e-9)
    same = replace(A, falloff_out=0.2)
    assert same.effect == A
    np.testing.assert_array_equal(same.mask(take().clip.times), A.mask(take().clip.times))
    hard = replace(A, falloff=0.0)
    assert hard.mask(np.array([0.99, 1.0, 1.5, 1.51])).tolist() == [0, 1, 1, 0]


def test_a_name_computes_nothing_again() -> None:
    assert replace(A, name="x").effect == A
    assert A.effect is A


def test_scale_may_be_about_a_length() -> None:
    session = session_by_rig(take())
    session.add(replace(A, op=Op.SCALE, value=0.5, about=0.0))
    inside = slice(60, 91)
    np.testing.assert_allclose(
        session.asked[inside, MOUTH], 0.5 * session.tracked[inside, MOUTH], rtol=1e-5
    )
    with pytest.raises(ValueError, match="about"):
        replace(A, about=0.0)


def test_drawn_line_is_followed() -> None:
    session = session_by_rig(take())
    points = ((1.1, 5.0), (1.3, 9.0))
    session.add(Edit(("mouth_opening",), Op.DRAW, 1.0, 1.5, 0.0, points=points))
    at = [60, 66, 72, 78, 90]
    np.testing.assert_allclose(session.asked[at, MOUTH], [5, 5, 7, 9, 9], atol=1e-5)


def test_shifted_stretched_and_mirrored_edits_take_their_points_along() -> None:
    drawn = Edit(("left_corner",), Op.ADD, 1.0, 2.0, 0.1, points=((1.0, 1.0), (1.5, 2.0)))
    assert drawn.shifted(2.0).points == ((3.0, 1.0), (3.5, 2.0))
    assert drawn.stretched(4.0, 8.0).points == ((4.0, 1.0), (6.0, 2.0))
    assert drawn.stretched(4.0, 4.0).points == ((4.0, 1.0),)
    assert drawn.mirrored().controls == ("right_corner",)
    assert A.mirrored() == A


@pytest.mark.parametrize("seconds", [0.0, 1e-3, 1e-6, 1e-13, 1e-16, 1e-300])
def test_a_drawn_edit_can_be_squeezed_to_almost_nothing(seconds: float) -> None:
    """Its points may then fall together by rounding."""
    line = tuple((57.7 + 0.007 * k, float(k)) for k in range(8000))
    drawn = Edit(("left_corner",), Op.ADD, 57.7, line[-1][0], 0.1, points=line)
    for start in (0.0, 50.0, 64.69065):
        squeezed = drawn.stretched(start, start + seconds)
        assert {mm for _, mm in squeezed.points} <= {mm for _, mm in line}
        for other in (squeezed.shifted(1000.0), squeezed.stretched(3.0, 4.0)):
            assert 1 <= len(other.points) <= len(squeezed.points)
        assert retimed(squeezed, 0.5).points


NAMES = {
    "Mouth opening +8.0 mm": Edit(("mouth_opening",), Op.OFFSET, 0, 1, 0, 8.0),
    "Mouth opening −8.0 mm": Edit(("mouth_opening",), Op.OFFSET, 0, 1, 0, -8.0),
    "Close lips": Edit(("mouth_opening",), Op.SET, 0, 1, 0, 0.0),
    "Close eyes": Edit(("left_eyelid", "right_eyelid"), Op.SET, 0, 1, 0, 0.0),
    "Close left eye": Edit(("left_eyelid",), Op.SET, 0, 1, 0, 0.0),
    "Mouth width to 45.0 mm": Edit(("mouth_width",), Op.SET, 0, 1, 0, 45.0),
    "jawForward × 0.50 about the median": Edit(
        (), Op.SCALE, 0, 1, 0, 0.5, channels=("jawForward",)
    ),
    "headYaw × 0.50 about −2.00°": Edit(
        (), Op.SCALE, 0, 1, 0, 0.5, about=-2.0, channels=("headYaw",)
    ),
    "jawForward × 2.00": Edit((), Op.SCALE, 0, 1, 0, 2.0, about=0.0, channels=("jawForward",)),
    "Mouth corners × 1.30": Edit(("right_corner", "left_corner"), Op.SCALE, 0, 1, 0, 1.3),
    "Smooth all curves (40 ms)": Edit(CONTROL_IDS, Op.SMOOTH, 0, 1, 0, 0.04),
    "Mouth back to tracked": Edit(CONTROL_IDS[:6], Op.RESET, 0, 1, 0),
    "Draw left mouth corner": Edit(("left_corner",), Op.DRAW, 0, 1, 0, points=((0, 1),)),
    "Add to mouth opening and mouth width": Edit(
        ("mouth_width", "mouth_opening"), Op.ADD, 0, 1, 0, points=((0, 1),)
    ),
    "Mouth opening and 2 more +1.0 mm": Edit(CONTROL_IDS[:3], Op.OFFSET, 0, 1, 0, 1.0),
    "Jaw": replace(A, name="Jaw"),
}


@pytest.mark.parametrize("name", NAMES)
def test_edits_say_what_they_do(name: str) -> None:
    assert describe(NAMES[name]) == name


def test_nothing_lies_before_the_state_of_a_project(session: EditSession) -> None:
    session.undo()
    session.begin_with(EditState((B, C), Settings()))
    assert session.edits == (B, C)
    assert not session.can_undo
    assert not session.can_redo
    assert not session.is_saved


@pytest.mark.parametrize("is_saved", [True, False])
@pytest.mark.parametrize("rate", [None, 25.0])
def test_undo_of_a_recovery_leads_to_what_had_been_opened_or_saved(
    rate: float | None, is_saved: bool
) -> None:
    """To the edits of a project, and to the frame rate that a take without times had then."""
    stretch = Edit(CONTROL_IDS, Op.RETIME, 0.5, 1.5, 0.0, pins=((0.9, 1.1),))
    before = EditState((replace(stretch, pins=((0.9, 1.0),)), A))
    after = EditState((stretch, A, B), Settings(naturalness=0.5))
    session = session_by_rig(take())
    session.recover(after, Origin(before, rate, is_saved))
    assert session.state == after, "A does not follow the retime a second time"
    assert session.origin == Origin(before, rate, is_saved)
    assert not session.is_saved
    assert session.rate_after(-1) == rate
    if rate is not None:
        at_rate = session_by_rig(replace(take(), fps=rate))
        at_rate.arrive_from(session, -1)
        session = at_rate
    else:
        session.undo()
    assert session.state == before
    assert session.is_saved is is_saved
    assert not session.can_undo
    assert session.origin == Origin(before, rate, is_saved), "it may crash again"
    assert (session.asked != session.tracked).any()


def test_a_project_without_sound_and_film_has_none_to_save(session: EditSession) -> None:
    """Before it is in a file that it belongs to: its take had to be shown."""
    session.begin_with(EditState((B,), media=Placement()))
    assert session.unsaved == (EDITS,)
    session.recover(EditState((B, C), media=Placement()), session.origin)
    assert session.unsaved == (EDITS,)
    session.place(Placement(MediaFile(Path("/voice.wav"))))
    assert session.unsaved == (EDITS, SOUND)


def test_a_recovery_of_what_was_opened_has_nothing_to_undo() -> None:
    session = session_by_rig(take())
    session.recover(EditState((A,)), Origin(EditState((A,)), is_saved=False))
    assert (session.edits, session.can_undo, session.is_saved) == ((A,), False, False)
    assert (session.asked != session.tracked).any()


def test_the_origin_is_what_was_opened_until_something_is_saved(session: EditSession) -> None:
    assert session.origin == Origin()
    session.begin_with(EditState((B, C)))
    session.add(A)
    assert session.origin == Origin(EditState((B, C)), is_saved=False)
    session.mark_saved()
    session.undo()
    assert session.origin == Origin(EditState((B, C, A)))

"""Retimes as users make them: stretch, move, cut, pause; and in files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.retimes import ALL, MADE, STRETCH, clip_of, speeds

from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.edits.clock import Clock
from faceedit_app.editing.edits.describe import describe
from faceedit_app.editing.edits.edit import Edit, Op, from_json, to_json
from faceedit_app.editing.edits.retiming import retimed
from faceedit_app.editing.help import retime
from faceedit_app.editing.help.presets import left_out, save_preset

# --- by hand ----------------------------------------------------------------------------------


@settings(deadline=None, derandomize=True, max_examples=200)
@given(
    start=st.floats(0, 7.5),
    length=st.floats(0, 3),
    goal=st.tuples(st.floats(-3, 12), st.floats(-3, 12)),
)
def test_a_drag_never_plays_too_slow_or_too_fast(
    start: float, length: float, goal: tuple[float, float]
) -> None:
    clip = clip_of()
    span = start, min(start + length, float(clip.times[-1]))
    to = retime.nearest(clip, span, goal)
    edit = retime.retime(clip, span, to)
    assert clip.times[0] - 1e-4 <= edit.start <= edit.end <= clip.times[-1] + 1e-4
    rates = speeds(edit)
    assert rates.size == 0 or 0.45 < rates.min() <= rates.max() < 2.2


@pytest.mark.parametrize("by", [1e-4, -5e-4, 9e-4, -9e-4])
@pytest.mark.parametrize("span", [(3.0, 3.0), (3.0, 4.0), (0.0, 2.0), (3.0, 3.0005)])
def test_a_drag_by_less_than_a_millisecond_is_none(span: tuple[float, float], by: float) -> None:
    clip, (start, end) = clip_of(), span
    for goal in ((start + by, end + by), (start + by, end), (start, end + by)):
        assert retime.nearest(clip, span, goal) == span


def test_names_say_what_was_done() -> None:
    clip = clip_of()
    assert describe(retime.stretched(clip, (1.2, 1.85), 1.3)) == "Stretch to 130 %"
    assert describe(retime.moved(clip, (3.0, 4.0), -0.12)) == "Move in time −0.12 s"
    assert describe(retime.moved(clip, (3.0, 3.0), 0.12)) == "Move in time +0.12 s"
    assert describe(retime.cut(clip, (3.0, 3.5))) == "Cut 0.50 s"
    assert describe(retime.pause(clip, 3.0, 0.4)) == "Pause 0.40 s"
    assert describe(replace(STRETCH, pins=((3.0, 2.5), (4.0, 4.5), (5.0, 5.2)))) == "Retime"
    assert describe(replace(STRETCH, name="Slower")) == "Slower"


@pytest.mark.parametrize("at", [0.0, 3.0, 7.9])
def test_pauses_and_cuts_use_the_side_that_has_room(at: float) -> None:
    clip = clip_of()
    end = float(clip.times[-1])
    pause = retime.pause(clip, at, 0.5)
    assert 0 <= pause.start <= pause.end <= end + 1e-4
    cut = retime.cut(clip, (at, min(at + 0.4, end)))
    assert 0 <= cut.start <= cut.end <= end + 1e-4


CLIP = clip_of()


def test_a_face_that_soon_stands_still_makes_up_for_it_there() -> None:
    clip = clip_of()
    weights = clip.weights.copy()
    weights[(clip.times > 4.0) & (clip.times < 4.6)] = weights[clip.frame_at(4.0)]
    clip = replace(clip, weights=weights)
    pause = retime.pause(clip, 3.2, 0.3)
    assert pause.pins[-1][0] == pytest.approx(4.0, abs=0.04)
    assert pause.end == pytest.approx(4.6, abs=0.04)
    clock = Clock(pause)
    between = np.linspace(3.6, 3.9, 10)
    assert clock.shown(between) == pytest.approx(between + 0.3, abs=0.05)
    cut = retime.cut(clip, (3.2, 3.5))
    assert cut.end == pytest.approx(4.6, abs=0.04)
    assert Clock(cut).shown(between) == pytest.approx(between - 0.3, abs=0.05)
    assert describe(pause) == "Pause 0.30 s"
    assert describe(cut) == "Cut 0.30 s"
    far = retime.pause(clip, 0.5, 0.1)
    assert far.end < 1.5


IMPOSSIBLE: tuple[Callable[[], Edit], ...] = (
    lambda: retime.stretched(CLIP, (0.0, 7.98), 1.5),
    lambda: retime.stretched(CLIP, (3.0, 4.0), 3.0),
    lambda: retime.moved(CLIP, (3.0, 4.0), 9.0),
    lambda: retime.moved(CLIP, (20.0, 21.0), 0.1),
    lambda: retime.cut(CLIP, (1.0, 7.5)),
    lambda: retime.cut(CLIP, (3.0, 3.0)),
    lambda: retime.pause(CLIP, 4.0, 8.0),
    lambda: retime.pause(CLIP, 4.0, 0.0),
    lambda: retime.by_pins(CLIP, []),
    lambda: retime.by_pins(CLIP, [(3.0, 3.5), (3.2, 3.4)]),
    lambda: retime.by_pins(CLIP, [(3.0, 30.0)]),
    lambda: retime.by_pins(CLIP, [(3.0, 3.5)], 3.2, 4.0),
)


@pytest.mark.parametrize("do", IMPOSSIBLE)
def test_what_cannot_be_is_one_line(do: Callable[[], Edit]) -> None:
    with pytest.raises(FaceEditError) as caught:
        do()
    assert "\n" not in str(caught.value)


# --- files ------------------------------------------------------------------------------------


def test_json_keeps_the_pins() -> None:
    for edit in ALL:
        assert from_json(to_json(edit)) == edit


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"pins": [[4.0, 3.0], [3.0, 3.5]]}, "cross"),
        ({"pins": [[1.0, 3.0]]}, "outside its range"),
        ({"falloff": 0.2}, "no falloff"),
        ({"op": "fill"}, "no pins"),
        ({"control": None, "channels": ["jawOpen"]}, "no retime"),
    ],
)
def test_damaged_pins_are_refused(change: dict[str, object], complaint: str) -> None:
    entry = to_json(STRETCH) | change
    if "channels" in entry:
        entry = {name: value for name, value in entry.items() if not name.startswith("control")}
    with pytest.raises(ValueError, match=complaint):
        from_json(entry)


def test_another_range_scales_the_pins() -> None:
    scaled = STRETCH.stretched(2.0, 4.0)
    assert scaled.pins == ((2.5, 2.25), (3.0, 3.25))
    assert STRETCH.stretched(3.0, 3.0).effect is None
    assert STRETCH.shifted(1.0).pins == ((4.0, 3.5), (5.0, 5.5))
    assert retimed(STRETCH, 0.5).pins == ((1.5, 1.25), (2.0, 2.25))


def test_by_its_handles_a_range_changes_around_the_pins() -> None:
    wider = retime.reshaped(STRETCH, 1.8, 6.0, 0.0, 0.5)
    assert (wider.start, wider.end, wider.pins) == (1.8, 6.5, STRETCH.pins)
    tight = retime.reshaped(STRETCH, 2.9, 4.6, 0.0, 0.0)
    assert (tight.start, tight.end) == (2.0, 5.0)
    assert 0.49 < speeds(tight).min() <= speeds(tight).max() < 2.01
    moved = retime.reshaped(STRETCH, 2.5, 6.5, 0.0, 0.0)
    assert moved == STRETCH.shifted(0.5)
    other = Edit((LIP_OPENING,), Op.OFFSET, 1.0, 2.0, 0.2, 3.0)
    assert retime.reshaped(other, 1.0, 3.0, 0.1, 0.3) == replace(
        other, end=3.0, falloff=0.1, falloff_out=0.3
    )


def test_a_preset_takes_whole_retimes_only(tmp_path: Path) -> None:
    kept = save_preset("Slower", [STRETCH, MADE], 1.0, 7.0, tmp_path)
    assert left_out([STRETCH, MADE], 1.0, 7.0) == []
    assert left_out([STRETCH, MADE], 3.0, 3.5) == [STRETCH]
    assert [edit.op for edit in kept.edits] == [Op.RETIME, Op.SET]
    cut_off = save_preset("Lips", [STRETCH, MADE], 3.0, 3.5, tmp_path)
    assert [edit.op for edit in cut_off.edits] == [Op.SET]

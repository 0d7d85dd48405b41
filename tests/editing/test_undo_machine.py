"""Whatever is done, undone and done again: the same edits export the same bytes."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)
from support.chance import CHARACTERS, TIMES
from support.edits import pins
from support.faces import shipped_rig
from support.sessions import engine, strengthen, switch
from support.takes import make_livelink_csv

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.editing.edits.channels import CHANNEL_OPS, OPS
from faceedit_app.editing.edits.edit import (
    LONGEST_SMOOTH,
    STRONGEST,
    WITH_POINTS,
    Company,
    Edit,
    Op,
)
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.help.clipboard import Copied, copy_range
from faceedit_app.editing.help.fixes import apply_preset
from faceedit_app.editing.help.presets import load_presets
from faceedit_app.editing.help.problems import find_problems
from faceedit_app.editing.opening import open_session
from faceedit_app.editing.steps import EditState
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take
from faceedit_app.networks.engine import Engine

ACTIONS = 200
SECONDS = 1.5
PRESETS = load_presets(Path("nowhere"))[0]


@lru_cache(maxsize=1)
def small_take() -> Take:
    with tempfile.TemporaryDirectory() as folder:
        return open_take(make_livelink_csv(Path(folder) / "take.csv", SECONDS, 30))


moments = st.floats(0.0, SECONDS).map(lambda seconds: round(seconds, 3))
points = st.dictionaries(moments, st.floats(0, 30), min_size=1, max_size=4)


@st.composite
def edits_of_channels(draw: st.DrawFn) -> Edit:
    start, end = sorted((draw(moments), draw(moments)))
    op = draw(st.sampled_from([op for op in Op if op.value in OPS]))
    channels = draw(st.lists(st.sampled_from(ARKIT_CHANNELS), min_size=1, max_size=5, unique=True))
    values = {
        Op.SCALE: st.floats(0, 3),
        Op.SMOOTH: st.floats(0, LONGEST_SMOOTH),
        Op.LIMIT: st.floats(0.01, 1),
    }
    amounts = {
        Op.NEUTRAL: st.tuples(st.floats(0, 0.4), st.floats(0.5, 1)),
        Op.LEVELS: st.tuples(st.floats(0, 3), st.floats(-1, 1), st.floats(0.1, 1)),
    }
    return Edit(
        (),
        op,
        start,
        end,
        draw(st.floats(0, 0.5)),
        draw(values.get(op, st.floats(-1, 1))),
        strength=draw(st.floats(0, STRONGEST)),
        points=tuple(sorted(draw(points).items())) if op in WITH_POINTS else (),
        channels=tuple(channels),
        amounts=tuple(draw(amounts[op]) for _ in channels) if op in amounts else (),
    )


@st.composite
def edits_of_curves(draw: st.DrawFn) -> Edit:
    start, end = sorted((draw(moments), draw(moments)))
    op = draw(st.sampled_from([op for op in Op if op.value not in CHANNEL_OPS]))
    retimes = op is Op.RETIME
    values = {Op.SCALE: st.floats(0, 3), Op.SMOOTH: st.floats(0, LONGEST_SMOOTH)}
    return Edit(
        controls=tuple(draw(st.lists(st.sampled_from(CONTROL_IDS), min_size=1, unique=True))),
        op=op,
        start=start,
        end=end,
        falloff=0.0 if retimes else draw(st.floats(0, 0.5)),
        value=draw(values.get(op, st.floats(-10, 10))),
        falloff_out=None if retimes else draw(st.none() | st.floats(0, 0.5)),
        strength=draw(st.floats(0, STRONGEST)),
        enabled=draw(st.booleans()),
        points=tuple(sorted(draw(points).items())) if op in WITH_POINTS else (),
        companions=draw(st.sampled_from(Company)),
        pins=draw(pins(start, end)) if retimes else (),
    )


edits = edits_of_curves() | edits_of_channels()
any_settings = st.builds(
    Settings, st.sampled_from(Mode), st.sampled_from([0.0, 0.5, 1.0]), st.sampled_from([0.0, 1.0])
)


class Editing(RuleBasedStateMachine):
    """Random gestures on one take; `past` is what undo must lead back to."""

    runs = 2 * TIMES

    def engine(self) -> Engine | None:
        """What answers the edits."""
        return None

    @initialize()
    def open(self) -> None:
        self.take = small_take()
        self.session = open_session(self.take, shipped_rig(), self.engine())
        self.past: list[tuple[EditState, bytes]] = [(EditState(), self.exported())]
        self.at = 0
        self.key: str | None = None  # of the last step, as long as it may be extended
        self.dropped: list[tuple[EditState, bytes]] = []  # what that step took from redo

    def exported(self) -> bytes:
        weights = self.session.clip_weights()
        return self.take.source.encode(self.take.clip.weights, weights)

    def finished(self, merge: str | None = None) -> None:
        """A gesture came to its end: it is a new step if it changed something."""
        state = self.session.state
        if state == self.past[self.at][0]:
            return
        if merge is None or merge != self.key:
            self.dropped, self.key = self.past[self.at + 1 :], merge
            self.past[self.at + 1 :] = [(state, self.exported())]
            self.at += 1
        elif state != self.past[self.at - 1][0]:
            self.past[self.at] = (state, self.exported())
        else:
            self.past[self.at :] = self.dropped
            self.at -= 1
            self.key = None

    def an_index(self, data: st.DataObject) -> int:
        return data.draw(st.integers(0, len(self.session.edits) - 1))

    # --- gestures ------------------------------------------------------------------------------

    @rule(some=st.lists(edits, max_size=2))
    def add(self, some: list[Edit]) -> None:
        self.session.add(*some)
        self.finished()

    @rule(first=edits, second=edits, keep=st.booleans())
    def drag(self, first: Edit, second: Edit, keep: bool) -> None:
        self.session.preview(first)
        self.session.preview(second)
        self.session.commit() if keep else self.session.cancel()
        self.finished()

    @rule(start=moments, end=moments)
    def reset(self, start: float, end: float) -> None:
        self.session.reset(min(start, end), max(start, end))
        self.finished()

    @rule(how=any_settings)
    def configure(self, how: Settings) -> None:
        self.session.configure(how)
        self.finished()

    @rule(shares=st.lists(st.sampled_from([0.0, 0.5, 1.0]), max_size=4), back=st.booleans())
    def turn_the_wheel_over_naturalness(self, shares: list[float], back: bool) -> None:
        for share in [*shares, *[self.session.settings.naturalness] * back]:
            settings = replace(self.session.settings, naturalness=share)
            self.session.configure(settings, merge="naturalness")
            self.finished("naturalness")

    @rule(hows=st.lists(any_settings, max_size=3), keep=st.booleans())
    def drag_a_setting(self, hows: list[Settings], keep: bool) -> None:
        for how in hows:
            self.session.preview_settings(how)
        self.session.commit("Naturalness") if keep else self.session.cancel()
        self.finished()

    @rule(offsets=st.lists(st.floats(-9, 9), max_size=3), keep=st.booleans())
    def drag_the_sound(self, offsets: list[float], keep: bool) -> None:
        before = self.exported()
        for offset in offsets:
            self.session.preview_media(Placement(MediaFile(Path("/a.wav"), offset)))
        self.session.commit("Move sound") if keep else self.session.cancel()
        assert self.exported() == before
        self.finished()

    @rule(preset=st.sampled_from(PRESETS), start=moments, end=moments, selected=st.booleans())
    def fix(self, preset: Any, start: float, end: float, selected: bool) -> None:
        selection = (min(start, end), max(start, end)) if selected else None
        self.session.preview(*apply_preset(self.session, preset, selection, start, 0.1))
        self.session.commit()
        self.finished()

    @rule(sound=st.none() | st.floats(-9, 9), film=st.none() | st.floats(-9, 9))
    def place_media(self, sound: float | None, film: float | None) -> None:
        media = [None if at is None else MediaFile(Path("/a.mov"), at) for at in (sound, film)]
        before = self.exported()
        self.session.place(Placement(*media))
        assert self.exported() == before
        self.finished()

    @rule()
    def fix_all(self) -> None:
        self.session.add(*(edit for p in find_problems(self.session) for edit in p.fix))
        self.finished()

    @rule(start=moments, end=moments, at=moments, what=st.sampled_from(Copied))
    def copy_and_paste(self, start: float, end: float, at: float, what: Copied) -> None:
        copied = copy_range(self.session, min(start, end), max(start, end), CONTROL_IDS, what)
        self.session.add(*copied.mirrored().paste(at))
        self.finished()

    @precondition(lambda self: self.session.edits)
    @rule(data=st.data(), edit=edits, strengths=st.lists(st.floats(0, STRONGEST), max_size=3))
    def reshape(self, data: st.DataObject, edit: Edit, strengths: list[float]) -> None:
        index = self.an_index(data)
        for _ in strengths:
            self.session.preview_replace(index, edit)
        self.session.commit()
        self.finished()

    @precondition(lambda self: self.session.edits)
    @rule(data=st.data(), strength=st.floats(0, STRONGEST), on=st.booleans())
    def weaken_or_switch(self, data: st.DataObject, strength: float, on: bool) -> None:
        index = self.an_index(data)
        if data.draw(st.booleans()):
            strengthen(self.session, index, strength)
        else:
            switch(self.session, index, on)
        self.finished()

    @precondition(lambda self: self.session.edits)
    @rule(data=st.data(), name=st.text(CHARACTERS, max_size=3))
    def rename_or_move(self, data: st.DataObject, name: str) -> None:
        if data.draw(st.booleans()):
            self.session.rename(self.an_index(data), name)
        else:
            self.session.move(self.an_index(data), self.an_index(data))
        self.finished()

    @precondition(lambda self: self.session.edits)
    @rule(data=st.data(), many=st.booleans())
    def remove(self, data: st.DataObject, many: bool) -> None:
        self.session.remove(*{self.an_index(data) for _ in range(1 + 3 * many)})
        self.finished()

    @rule(times=st.integers(1, 6))
    def undo(self, times: int) -> None:
        for _ in range(times):
            self.session.undo()
        self.went_to(max(self.at - times, 0))

    @rule(times=st.integers(1, 6))
    def redo(self, times: int) -> None:
        for _ in range(times):
            self.session.redo()
        self.went_to(min(self.at + times, len(self.past) - 1))

    def went_to(self, at: int) -> None:
        if at != self.at:
            self.at, self.key = at, None
        self.check()

    def check(self) -> None:
        state, content = self.past[self.at]
        assert self.session.state == state
        assert self.exported() == content

    @invariant()
    def steps_are_where_they_should_be(self) -> None:
        if hasattr(self, "past"):
            assert self.session.can_undo == (self.at > 0)
            assert self.session.can_redo == (self.at < len(self.past) - 1)
            assert not self.session.is_previewing

    def teardown(self) -> None:
        if not hasattr(self, "past"):
            return
        self.check()
        final = self.past[self.at]
        back = self.at
        while self.session.can_undo:
            self.session.undo()
        assert self.exported() == self.past[0][1]
        for _ in range(back):
            self.session.redo()
        assert (self.session.state, self.exported()) == final
        fresh = open_session(self.take, shipped_rig(), self.engine())
        fresh.restore(final[0])
        assert self.take.source.encode(self.take.clip.weights, fresh.clip_weights()) == final[1]


class EditingWithNetworks(Editing):
    """The same, answered by networks."""

    runs = TIMES  # each takes three times as long

    def engine(self) -> Engine | None:
        return engine()


@pytest.mark.timeout(600)
@pytest.mark.parametrize("machine", [Editing, EditingWithNetworks])
def test_undo_then_redo_of_200_random_actions_exports_the_same_bytes(
    machine: type[Editing],
) -> None:
    run_state_machine_as_test(
        machine,
        settings=settings(
            max_examples=machine.runs,
            stateful_step_count=ACTIONS,
            deadline=None,
            derandomize=True,
            database=None,
            suppress_health_check=list(HealthCheck),
        ),
    )

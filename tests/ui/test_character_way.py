"""The whole way of docs/your_character.md: open a GLB and a take, fix lips, export the GLB."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.character_files import parts_of, write_glb, write_vrm
from support.windows import Bench, session_of, trigger

from faceedit_app.characters.closure import SHUT, Openings
from faceedit_app.characters.fitted import open_character
from faceedit_app.characters.map_file import map_path
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.levels import Levels
from faceedit_app.editing.exporting import Options, choose
from faceedit_app.editing.help.on_character import NAME
from faceedit_app.formats.opening import open_take
from faceedit_app.ui.commands import dialogs

ALL = {channel: {channel: 1.0} for channel in ARKIT_CHANNELS}
HEADS: dict[str, Callable[[Path], Path]] = {
    "GLB": lambda folder: write_glb(folder / "head.glb", lambda name: f"Face_{name}"),
    "VRM": lambda folder: write_vrm(folder / "head.vrm", version=1, presets=ALL),
}


@pytest.mark.parametrize(("kind", "follows"), [("GLB", True), ("VRM", False)])
def test_my_head_a_take_fixed_lips_and_my_head_with_animation(
    kind: str, follows: bool, bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    head = HEADS[kind](bench.folder)
    strength = {"jawOpen": {"multiplier": 1.8}, "mouthPressLeft": {"limit": 0.5}}
    strength |= {f"eyeBlink{side}": {"offset": -0.3} for side in ("Left", "Right")}
    written = {"faceedit_character_map": 1, "strength": strength}
    map_path(head).write_text(json.dumps(written), encoding="utf-8")
    window = bench.editing()
    monkeypatch.setattr(dialogs, "ask_character", lambda *_: head)
    trigger(window, "open_character")
    bench.qtbot.waitUntil(lambda: window.document.character is not None)
    session = session_of(window)
    theirs = Openings.of(session.shown_rig)
    tracked = session.take.clip.arkit_weights()
    was_open = (Openings.of(session.rig).measure(tracked) < SHUT) & (theirs.measure(tracked) > SHUT)
    assert was_open.any()

    trigger(window, "close_range")
    session.live.work()
    assert [edit.name for edit in session.edits] == [NAME]
    still_open = was_open & (theirs.measure(session.weights) > SHUT)
    assert still_open.sum() < 0.1 * was_open.sum()

    if follows:
        trigger(window, "follow_head")
    out = bench.folder / "talk.glb"
    bench.answers |= {"export_as": (choose(out), Options()), "export": out}
    trigger(window, "export_as")
    bench.qtbot.waitUntil(lambda: bool(bench.exported), timeout=20_000)
    assert not bench.errors
    again = open_take(out).clip
    found = again.arkit_weights()
    known = [i for i, c in enumerate(session.shown_rig.channels) if c in again.channels]
    assert len(known) > 20
    shown = session.shown_rig.from_arkit(session.weights)[:, known]
    played = replace(session.shown_rig, levels=Levels()).from_arkit(found)[:, known]
    np.testing.assert_allclose(played, shown, atol=1e-6)
    back = open_character(out)
    assert set(back.checklist.matched) == set(open_character(head).checklist.matched)
    plain = Openings.of(replace(back.rig, levels=Levels()))  # the file holds what its shapes show
    assert (was_open & (plain.measure(found) > SHUT)).sum() == still_open.sum()
    document, _ = parts_of(out.read_bytes())
    paths = {c["target"]["path"] for c in document["animations"][0]["channels"]}
    assert paths == ({"weights", "rotation"} if follows else {"weights"})

"""The whole way of docs/your_character.md: open a GLB and a take, fix lips, export the GLB."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from support.character_files import parts_of, write_glb
from support.windows import Bench, session_of, trigger

from faceedit_app.characters.closure import SHUT, Gaps
from faceedit_app.characters.fitted import open_character
from faceedit_app.characters.map_file import map_path
from faceedit_app.core.levels import Levels
from faceedit_app.editing.exporting import Options, choose
from faceedit_app.editing.help.on_character import NAME
from faceedit_app.formats.opening import open_take
from faceedit_app.ui.commands import dialogs


@pytest.mark.parametrize("follows", [False, True])
def test_my_glb_a_take_fixed_lips_and_my_glb_with_animation(
    follows: bool, bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    head = write_glb(bench.folder / "head.glb", lambda name: f"Face_{name}")
    strength = {"jawOpen": {"multiplier": 1.8}, "mouthPressLeft": {"limit": 0.5}}
    strength |= {f"eyeBlink{side}": {"offset": -0.3} for side in ("Left", "Right")}
    written = {"faceedit_character_map": 1, "strength": strength}
    map_path(head).write_text(json.dumps(written), encoding="utf-8")
    window = bench.editing()
    monkeypatch.setattr(dialogs, "ask_character", lambda *_: head)
    trigger(window, "open_character")
    bench.qtbot.waitUntil(lambda: window.document.character is not None)
    session = session_of(window)
    theirs = Gaps.of(session.shown_rig)
    tracked = session.take.clip.arkit_weights()
    was_open = (Gaps.of(session.rig).measure(tracked) < SHUT) & (theirs.measure(tracked) > SHUT)
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
    targets = open_character(out).character.targets
    assert targets == open_character(head).character.targets
    document, _ = parts_of(out.read_bytes())
    paths = {c["target"]["path"] for c in document["animations"][0]["channels"]}
    assert paths == ({"weights", "rotation"} if follows else {"weights"})

"""Every kind of file goes through the window: opened, edited, exported, opened again, undone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.kinds import FACE, FRAMES, KINDS, RATE, Kind
from support.windows import Bench, add_edit, bench, drop, open_path, session_of, trigger

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.formats.opening import open_take
from faceedit_app.ui.commands import dialogs, file_kinds
from faceedit_app.ui.start.window import MainWindow

__all__ = ["bench"]


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The questions for a frame rate, which are answered; GLBs are takes."""
    questions: list[str] = []

    def answer(_: object, question: str, frames: int, rate: float) -> float:
        questions.append(question)
        assert frames == FRAMES
        return RATE

    monkeypatch.setattr(dialogs, "ask_rate", answer)
    monkeypatch.setattr(dialogs, "ask_take_or_character", lambda *_: dialogs.OpenAs.TAKE)
    return questions


def _wait_for(bench: Bench, window: MainWindow, path: Path) -> None:
    bench.qtbot.waitUntil(lambda: window.document.path == path, timeout=20_000)


def exported(bench: Bench, window: MainWindow, name: str) -> Path:
    out = open_path(window).with_stem(name)
    bench.answers["export"] = out
    trigger(window, "export")
    unfinished = window.workspace.unfinished  # else the next export would be refused
    bench.qtbot.waitUntil(lambda: out.exists() and not unfinished.names, timeout=20_000)
    assert bench.errors == []
    return out


def test_kinds_open_by_drop_and_come_back_with_their_edit_alone(
    bench: Bench, asked: list[str]
) -> None:
    """One after the other in one window, as users go through a folder."""
    window = bench.window()
    for name, kind in KINDS.items():
        asked.clear()
        folder = bench.folder / name.replace("/", " ")
        folder.mkdir()
        path = kind.make(folder)
        drop(window, path)
        _wait_for(bench, window, path)
        clip = session_of(window).take.clip
        assert (clip.rate, clip.gaps, len(asked)) == (RATE, (), int(kind.asks)), name
        assert np.allclose(clip.arkit_weights(), FACE, atol=kind.step), name
        bar = window.status
        assert "30 fps" in bar.facts.text()
        assert kind.says in bar.remarks.toolTip()
        assert bool(bar.remarks.text()) == bool(kind.says)
        _edit_and_undo(bench, window, kind)


def _edit_and_undo(bench: Bench, window: MainWindow, kind: Kind) -> None:
    add_edit(window)
    session, path = session_of(window), open_path(window)
    clip = session.take.clip
    changed = session.weights != clip.arkit_weights()
    assert changed[:, ARKIT_CHANNELS.index("jawOpen")].any()
    again = open_take(exported(bench, window, "edited"), RATE if kind.asks else None)
    assert (again.clip.rate, len(again.clip)) == (RATE, FRAMES)
    assert np.allclose(again.clip.arkit_weights(), session.weights, atol=0.51 * kind.step + 1e-5)
    untouched = ~changed
    assert np.array_equal(again.clip.arkit_weights()[untouched], clip.arkit_weights()[untouched])
    trigger(window, "undo")
    assert exported(bench, window, "undone").read_bytes() == path.read_bytes(), path


def test_the_dialog_offers_and_opens_them(bench: Bench, asked: list[str]) -> None:
    window = bench.editing()
    for name in ("USD", "a line for each weight", "iFacialMocap", "VTube Studio"):
        path = KINDS[name].make(bench.folder)
        assert f"*{path.suffix}" in file_kinds.all_that_opens()
        bench.answers["open"] = path
        trigger(window, "open")
        _wait_for(bench, window, path)
        assert len(session_of(window).take.clip) == FRAMES


NO_TAKES = {
    b"frame, AU01_r, AU02_r\n1, 0.1, 0.2\n": "action units",
    b"PK\x03\x04 take.csv": "is compressed; unpack it",
    b"<html>Sign in</html>": "is a web page",
    b"PXR-USDC" + bytes(80): "USD file in binary form; save it as text",
}


def test_what_is_no_take_is_named_and_the_open_take_stays(bench: Bench) -> None:
    path = bench.folder / "other.csv"
    window = bench.editing()
    for content, says in NO_TAKES.items():
        path.write_bytes(content)
        bench.errors.clear()
        drop(window, path)
        bench.qtbot.waitUntil(lambda: bool(bench.errors), timeout=20_000)
        assert says in bench.errors[0]
        assert open_path(window) == bench.take

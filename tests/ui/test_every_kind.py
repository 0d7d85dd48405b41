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


def exported(bench: Bench, window: MainWindow, name: str) -> Path:
    out = bench.folder / f"{name}{open_path(window).suffix}"
    bench.answers["export"] = out
    trigger(window, "export")
    unfinished = window.workspace.unfinished  # else the next export would be refused
    bench.qtbot.waitUntil(lambda: out.exists() and not unfinished.names, timeout=20_000)
    assert bench.errors == []
    return out


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_a_kind_opens_by_drop_and_comes_back_with_its_edit_alone(
    bench: Bench, asked: list[str], kind: Kind
) -> None:
    path = kind.make(bench.folder)
    window = bench.window()
    drop(window, path)
    bench.qtbot.waitUntil(lambda: window.document.path == path, timeout=20_000)
    clip = session_of(window).take.clip
    assert (clip.rate, clip.gaps, len(asked)) == (RATE, (), int(kind.asks))
    assert np.allclose(clip.arkit_weights(), FACE, atol=kind.step)
    bar = window.status
    assert "30 fps" in bar.facts.text()
    assert kind.says in bar.remarks.toolTip()
    assert bool(bar.remarks.text()) == bool(kind.says)

    add_edit(window)
    session = session_of(window)
    changed = session.weights != clip.arkit_weights()
    assert changed[:, ARKIT_CHANNELS.index("jawOpen")].any()
    again = open_take(exported(bench, window, "edited"), RATE if kind.asks else None)
    assert (again.clip.rate, len(again.clip)) == (RATE, FRAMES)
    assert np.allclose(again.clip.arkit_weights(), session.weights, atol=0.51 * kind.step + 1e-5)
    untouched = ~changed
    assert np.array_equal(again.clip.arkit_weights()[untouched], clip.arkit_weights()[untouched])

    trigger(window, "undo")
    assert exported(bench, window, "undone").read_bytes() == path.read_bytes()


@pytest.mark.parametrize("name", ["USD", "a line for each weight", "iFacialMocap", "VTube Studio"])
def test_the_dialog_offers_and_opens_it(bench: Bench, asked: list[str], name: str) -> None:
    path = KINDS[name].make(bench.folder)
    assert f"*{path.suffix}" in file_kinds.all_that_opens()
    window = bench.editing()
    bench.answers["open"] = path
    trigger(window, "open")
    bench.qtbot.waitUntil(lambda: window.document.path == path, timeout=20_000)
    assert len(session_of(window).take.clip) == FRAMES


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"frame, AU01_r, AU02_r\n1, 0.1, 0.2\n", "action units"),
        (b"PK\x03\x04 take.csv", "is compressed; unpack it"),
        (b"<html>Sign in</html>", "is a web page"),
        (b"PXR-USDC" + bytes(80), "USD file in binary form; save it as text"),
    ],
)
def test_what_is_no_take_is_named_and_the_open_take_stays(
    bench: Bench, content: bytes, says: str
) -> None:
    path = bench.folder / "other.csv"
    path.write_bytes(content)
    window = bench.editing()
    drop(window, path)
    bench.qtbot.waitUntil(lambda: bool(bench.errors), timeout=20_000)
    assert says in bench.errors[0]
    assert open_path(window) == bench.take

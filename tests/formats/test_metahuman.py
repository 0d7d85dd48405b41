"""MetaHuman's control curves open as ARKit channels, and an export changes their controls."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.formats.metahuman import CONTROLS, control_of
from faceedit_app.formats.opening import open_take, write_take

# (control, the number at frame n)
LIPS = ("mouthFunnelUL", "mouthFunnelUR", "mouthFunnelDL", "mouthFunnelDR")
NAMES = ("jawOpen", "eyeBlinkL", "eyeLookRightL", *LIPS, "mouthStickyUC", "noseNostrilDilateL")
FRAMES = 40


def number(n: int, k: int) -> float:
    return round(0.3 + 0.2 * float(np.sin(n / 9 + k)), 4)


def csv_text(prefix: str = "CTRL_expressions_") -> str:
    head = ",".join(["time", *(prefix + name for name in NAMES)])
    rows = (
        ",".join([f"{n / 30:.4f}", *(f"{number(n, k):.4f}" for k in range(len(NAMES)))])
        for n in range(FRAMES)
    )
    return "\n".join([head, *rows]) + "\n"


def json_text() -> str:
    frames = [
        {"frame": n, "curves": {f"CTRL_expressions_{c}": number(n, k) for k, c in enumerate(NAMES)}}
        for n in range(FRAMES)
    ]
    return json.dumps({"fps": 30, "frames": frames})


CONTENTS = {
    "CSV": csv_text(),
    "CSV of an asset's paths": csv_text("Face_Archetype.CTRL_expressions."),
    "JSON": json_text(),
}


def test_every_channel_has_controls_of_its_own() -> None:
    assert tuple(CONTROLS) == ARKIT_CHANNELS
    owners = Counter(name for names in CONTROLS.values() for name in names)
    assert set(owners.values()) == {1}
    for name in ARKIT_CHANNELS:
        sides = {control[-1] for control in CONTROLS[name]} & {"L", "R"}
        if name.endswith("Left") and name not in ("jawLeft", "mouthLeft"):
            assert sides == {"L"}
        if name.endswith("Right") and name not in ("jawRight", "mouthRight"):
            assert sides == {"R"}


@pytest.mark.parametrize("name", ["CTRL_expressions_eyeBlinkL", "ctrl_expressions.EyeBlinkL"])
def test_controls_are_found_under_every_spelling(name: str) -> None:
    assert control_of(name) == "eyeBlinkL"


@pytest.mark.parametrize("content", CONTENTS.values(), ids=CONTENTS)
def test_a_channel_is_the_mean_of_its_controls(tmp_path: Path, content: str) -> None:
    path = tmp_path / ("take.json" if content.startswith("{") else "take.csv")
    path.write_text(content)
    take = open_take(path)
    clip = take.clip
    assert (take.format, len(clip), clip.rate) == ("MetaHuman controls", FRAMES, 30)
    assert clip.channels == ("jawOpen", "eyeBlinkLeft", "eyeLookInLeft", "mouthFunnel")
    funnel = [np.mean([number(n, k) for k in range(3, 7)]) for n in range(FRAMES)]
    assert np.allclose(clip.weights[:, 3], funnel, atol=1e-6)
    assert np.allclose(clip.weights[:, 2], [number(n, 2) for n in range(FRAMES)], atol=1e-6)
    notes = " / ".join(take.notes)
    assert "approximation" in notes
    assert "2 controls without an ARKit channel are carried" in notes
    assert "mouthStickyUC, noseNostrilDilateL" in notes


@pytest.mark.parametrize("content", CONTENTS.values(), ids=CONTENTS)
def test_an_edit_moves_the_controls_of_its_channel_alike_and_no_other(
    tmp_path: Path, content: str
) -> None:
    suffix = ".json" if content.startswith("{") else ".csv"
    path, out = tmp_path / f"take{suffix}", tmp_path / f"out{suffix}"
    path.write_text(content)
    take = open_take(path)
    write_take(out, take, take.clip.weights)
    assert out.read_text() == content

    edited = take.clip.weights.copy()
    edited[11, 3] += 0.125
    write_take(out, take, edited)
    assert np.allclose(open_take(out).clip.weights, edited, atol=1e-6)
    before, after = path.read_text().split(","), out.read_text().split(",")
    changed = [k for k, (a, b) in enumerate(zip(before, after, strict=True)) if a != b]
    assert len(changed) == len(LIPS)


def test_controls_without_any_channel_are_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text("time,CTRL_expressions_mouthStickyUC\n0,0.1\n0.1,0.2\n")
    with pytest.raises(Exception, match="holds no ARKit channel"):
        open_take(path)

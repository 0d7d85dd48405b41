"""Edits of real recordings with the shipped networks; skipped where there are none at hand."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from support.places import SHARED
from support.sessions import session_by_networks, session_by_rig, shipped_engine

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.names import canonical_channel
from faceedit_app.core.regions import REGIONS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving.request import SPILL
from faceedit_app.formats.opening import open_take

LIVELINK = sorted((SHARED / "data" / "livelink").glob("*.csv"))
START, END, FALLOFF = 20.0, 20.4, 0.2
MOVES = (
    *(("mouth_opening", 8.0), ("mouth_width", -4.0)),
    *(("left_corner", 4.0), ("right_eyelid", -6.0)),
)

# What an edit may change.
EDITED = [ARKIT_INDEX[c] for r in REGIONS for c in (*r.channels, *r.accompanying)]
CARRIED = [i for i in range(52) if i not in EDITED]

pytestmark = pytest.mark.skipif(
    not LIVELINK, reason="no real takes here; FACEEDIT_SHARED may name their folder"
)
every_take = pytest.mark.parametrize("path", LIVELINK, ids=lambda path: path.stem)


take_at = lru_cache(maxsize=4)(open_take)


def edited(path: Path, *edits: Edit) -> EditSession:
    session = session_by_networks(take_at(path), shipped_engine())
    session.add(*edits)
    return session


@pytest.mark.parametrize(
    ("path", "control", "millimetres"),
    [
        pytest.param(path, *move, id=f"{path.stem}-{move[0]}")
        for number, path in enumerate(LIVELINK)
        for place, move in enumerate(MOVES)
        if number == 0 or number % len(MOVES) == place  # all on one take, one on each other
    ],
)
def test_one_edit_of_a_real_take(
    path: Path, control: str, millimetres: float, tmp_path: Path
) -> None:
    session = edited(path, Edit((control,), Op.OFFSET, START, END, FALLOFF, millimetres))
    out = tmp_path / "out.csv"
    session.export(out)
    again = open_take(out)
    times, tracked = session.take.clip.times, session.take.clip
    inside = (times >= START) & (times <= END)
    reach = FALLOFF + SPILL
    outside = (times < START - reach) | (times > END + reach)

    np.testing.assert_array_equal(again.clip.weights[outside], tracked.weights[outside])
    source, result = path.read_bytes().splitlines(True), out.read_bytes().splitlines(True)
    assert len(source) == len(result)
    changed = sum(a != b for a, b in zip(source, result, strict=True))
    assert 0 < changed <= np.count_nonzero(~outside)

    column = CONTROL_INDEX[control]
    measured = session_by_rig(out).tracked[inside, column]
    moved = measured - session.tracked[inside, column]
    asked = session.asked[inside, column] - session.tracked[inside, column]
    open_to_move = np.abs(asked) > 0.5  # an eye that is closed already cannot close
    assert np.all(moved[open_to_move] * np.sign(millimetres) > 0)
    assert np.median(moved[open_to_move] / asked[open_to_move]) > 0.8

    written = again.clip.arkit_weights()
    assert np.isfinite(written).all()
    touched = (written != tracked.arkit_weights())[:, EDITED]
    values, before = written[:, EDITED], tracked.arkit_weights()[:, EDITED]
    assert values[touched].min() >= 0
    # A tracked value above 1 is let go of as the edit fades in, never raised.
    assert np.all(values[touched] <= np.maximum(before, 1)[touched])
    np.testing.assert_array_equal(written[:, CARRIED], tracked.arkit_weights()[:, CARRIED])


@every_take
def test_no_edit_exports_the_source(path: Path, tmp_path: Path) -> None:
    edited(path).export(tmp_path / "out.csv")
    assert (tmp_path / "out.csv").read_bytes() == path.read_bytes()


@every_take
def test_wild_edits_of_a_real_take_stay_within_what_a_face_can_do(path: Path) -> None:
    frame = 1 / 30
    session = edited(
        path,
        Edit(("mouth_opening",), Op.OFFSET, START, START + frame, 0.0, 80.0),
        Edit(("left_eyelid", "right_eyelid"), Op.OFFSET, 0.0, 1e4, 0.0, -20.0),
    )
    tracked = session.take.clip.arkit_weights()
    changed = session.weights != tracked
    assert np.isfinite(session.weights).all()
    assert session.weights[changed].min() >= 0
    assert session.weights[changed].max() <= 1
    assert not changed[:, CARRIED].any()
    eyes = session.achieved[:, [CONTROL_INDEX["left_eyelid"], CONTROL_INDEX["right_eyelid"]]]
    assert np.percentile(eyes, 95) < 1.5  # mm: closed
    assert session.achieved[:, CONTROL_INDEX["mouth_opening"]].max() < 60


def test_channel_names_of_real_takes_are_known() -> None:
    for path in LIVELINK:
        header = path.read_text().splitlines()[0].split(",")
        assert sum(canonical_channel(name) is not None for name in header) == 52

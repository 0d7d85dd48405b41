"""What edits do to curves that they do not name, measured on takes of people."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from support.faces import random_engine
from support.people import source_with, take_with
from support.performances import RIG, folder_of_takes, performance

from faceedit_app.cli import main
from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX, MOUTH_WIDTH
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.session import EditSession
from faceedit_app.lab.evaluation import untouched


def test_changes_count_for_curves_that_the_edit_does_not_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    take = take_with(performance(8.0).weights)

    def widen(session: EditSession, edits: Sequence[Edit]) -> None:
        """2 mm wider than asked for, with a step in a channel where the first edit begins."""
        session.asked[:] = session.tracked
        session.achieved[:] = session.tracked
        session.achieved[:, CONTROL_INDEX[MOUTH_WIDTH]] += 2.0
        session.weights[:] = take.clip.arkit_weights()
        begin = min(edit.start for edit in edits)
        session.weights[take.clip.times >= begin, ARKIT_INDEX["jawOpen"]] += 0.25

    monkeypatch.setattr(untouched, "_show", widen)
    source, engine = source_with(take), random_engine()
    found = untouched.measure_untouched([source], RIG, engine, lambda done, of: None)
    assert {curve for (_, curve), mm in found.changed.items() if max(mm) > 1e-3} == {"mouth width"}
    assert found.changed["mouth corners, one side +", "mouth width"] == pytest.approx([2.0] * 18)
    assert ("mouth width +", "mouth width") not in found.changed
    missed = {kind for kind, mm in found.missed.items() if max(mm) > 1e-3}
    assert missed == {"mouth width +", "mouth width −"}
    assert np.unique(np.round(found.jumps["one"], 3)).tolist() == [0.0, 0.25]
    page = untouched.untouched_part(found)
    assert "(2.0, 2.0)" in next(line for line in page.splitlines() if "corners + |" in line)


def test_the_page_is_written_from_edits_of_the_takes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(untouched, "BY", (1.0,))
    monkeypatch.setattr(untouched, "ROUNDS", 1)
    few = [untouched.Drag.of(name) for name in ("mouth_opening", "left_corner")]
    monkeypatch.setattr(untouched, "DRAGS", few)
    takes = folder_of_takes(tmp_path / "someone", count=1, seconds=6.0)
    given = ["experiment", "untouched", "--held-out", str(takes), "-o", str(tmp_path / "report")]
    assert main(given) == 0
    page = (tmp_path / "report" / "untouched.md").read_text(encoding="utf-8")
    rows = [line.strip("| ").split(" | ") for line in page.splitlines() if line.startswith("| ")]
    missed = {row[0]: float(row[3]) for row in rows if row[0].endswith("+")}
    assert [*missed] == ["mouth opening +", "mouth corners, one side +"]
    assert missed["mouth opening +"] < 0.2
    assert "two that overlap add" in page

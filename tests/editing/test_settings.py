"""Naturalness and reach as one number: from natural to exact."""

from __future__ import annotations

import pytest

from faceedit_app.editing.edits.settings import Mode, Settings


@pytest.mark.parametrize(
    ("exactness", "naturalness", "reach"),
    [(0.0, 1.0, 0.0), (0.25, 1.0, 0.5), (0.5, 1.0, 1.0), (0.75, 0.5, 1.0), (1.0, 0.0, 1.0)],
)
def test_the_path_from_natural_to_exact(exactness: float, naturalness: float, reach: float) -> None:
    settings = Settings(Mode.RESYNTHESIZE, closes=False).with_exactness(exactness)
    assert settings == Settings(Mode.RESYNTHESIZE, naturalness, reach, closes=False)
    assert settings.exactness == pytest.approx(exactness)


def test_it_starts_in_the_middle() -> None:
    assert Settings().exactness == 0.5
    assert Settings().with_exactness(0.5) == Settings()


def test_settings_off_the_path_have_a_place_on_it() -> None:
    assert Settings(naturalness=0.5, reach=0.25).exactness == pytest.approx(0.125)
    assert Settings(naturalness=0.5, reach=0.75).exactness == pytest.approx(0.75)

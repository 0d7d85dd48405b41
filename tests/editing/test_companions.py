"""The width of the mouth follows its corners, and they it; any fix after any other is a face."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from support.sessions import demo_take, session_by_networks, shipped_engine

from faceedit_app.core import regions
from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.edit import Company, Edit, Op
from faceedit_app.editing.help.fixes import apply_preset
from faceedit_app.editing.help.presets import load_presets
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving.companions import Companions
from faceedit_app.editing.solving.request import Request, request

LOWER = regions.LOWER.own
WIDTH, LEFT, RIGHT = (CONTROL_INDEX[c] for c in ("mouth_width", "left_corner", "right_corner"))
UPPER_LIP, LOWER_LIP = CONTROL_INDEX["upper_lip"], CONTROL_INDEX["lower_lip"]
CORNERS = ("left_corner", "right_corner")
TIMES = np.arange(100) / 25.0
TRACKED = np.full((100, 8), 20.0)
HELD = 50  # a frame within the edits below


def covariance() -> np.ndarray:
    random = np.random.default_rng(2)
    mixing = random.normal(size=(6, 6))
    mixing[1:4] += 2 * random.normal(size=6)  # width and corners move together
    return mixing @ mixing.T


def offset(
    *controls: str,
    value: float = 3.0,
    op: Op = Op.OFFSET,
    company: Company = Company.YIELD,
    start: float = 1.0,
) -> Edit:
    return Edit(controls, op, start, 3.0, 0.5, value, companions=company)


def ask(*edits: Edit) -> Request:
    companions = Companions({LOWER: covariance()})
    return request(TIMES, 25.0, TRACKED, np.full(8, 19.0), edits, companions)


def moved(*edits: Edit) -> np.ndarray:
    change: np.ndarray = (ask(*edits).curves - TRACKED)[HELD]
    return change


def test_width_follows_the_corners_by_what_is_most_probable() -> None:
    result = moved(offset(*CORNERS))
    given = [0, 2, 3, 4, 5]
    # The mode of the Gaussian, found by a slow scan instead of by the formula.
    precision = np.linalg.inv(covariance() + 0.01 * np.diag([1, 0, 1, 1, 1, 1]))
    scan = np.linspace(-20, 20, 40001)
    point = np.tile(result[:6], (len(scan), 1))
    point[:, WIDTH] = scan
    best = scan[np.argmin(np.einsum("nc,cd,nd->n", point, precision, point))]
    assert abs(best) > 0.1
    np.testing.assert_allclose(result[WIDTH], best, atol=0.01)
    np.testing.assert_allclose(result[given], [0, 3, 3, 0, 0])


def test_followers_are_not_asked_for_and_fade_with_their_leaders() -> None:
    asked = ask(offset(*CORNERS))
    assert not asked.hold[:, WIDTH].any()
    change = asked.curves - TRACKED
    np.testing.assert_allclose(change[:, WIDTH] * change[HELD, LEFT],
                               change[:, LEFT] * change[HELD, WIDTH], atol=1e-9)  # fmt: skip
    np.testing.assert_array_equal(change[TIMES < 0.5], 0)


@pytest.mark.parametrize("control", ["mouth_opening", "upper_lip", "lower_lip", "left_eyelid"])
def test_controls_without_companions_leave_the_others_alone(control: str) -> None:
    expected = np.zeros(8)
    expected[CONTROL_INDEX[control]] = 3.0
    np.testing.assert_allclose(moved(offset(control)), expected, atol=1e-12)


def test_what_the_user_put_somewhere_follows_no_more() -> None:
    first, second = offset(*CORNERS), offset("mouth_width", value=-1.0)
    both = moved(first, second)
    np.testing.assert_allclose(both[[LEFT, RIGHT]], 3.0)
    np.testing.assert_allclose(both[WIDTH], moved(first)[WIDTH] - 1.0)
    turned = moved(second, first)
    np.testing.assert_allclose(turned[WIDTH], -1.0)
    assert turned[LEFT] != pytest.approx(3.0), "it had followed the width before it was dragged"


def test_an_edit_of_the_width_at_another_time_leaves_a_smile_alone() -> None:
    early = Edit(("mouth_width",), Op.OFFSET, 0.0, 0.2, 0.1, -1.0)
    np.testing.assert_array_equal(moved(early, offset(*CORNERS)), moved(offset(*CORNERS)))


def test_shaping_a_curve_claims_nothing() -> None:
    calm = Edit(LOWER, Op.SCALE, 1.0, 3.0, 0.5, 0.5)
    calmed = moved(calm)
    np.testing.assert_allclose(moved(calm, offset(*CORNERS)) - calmed, moved(offset(*CORNERS)))
    np.testing.assert_allclose(moved(offset(*CORNERS), calm) - calmed, moved(offset(*CORNERS)) / 2)


def test_expressions_add_up_in_any_order_and_take_the_lips_along() -> None:
    smile = offset(*CORNERS, company=Company.ALONG)
    pucker = offset("mouth_width", value=-2.0, company=Company.ALONG)
    np.testing.assert_allclose(moved(smile, pucker), moved(smile) + moved(pucker))
    np.testing.assert_allclose(moved(pucker, smile), moved(smile, pucker))
    assert (np.abs(moved(smile)[[WIDTH, UPPER_LIP, LOWER_LIP]]) > 0.01).all()
    dragged = offset("mouth_width", value=-1.0)
    np.testing.assert_allclose((moved(dragged, smile) - moved(dragged)), moved(smile))


def test_nothing_follows_an_edit_that_says_so() -> None:
    expected = np.zeros(8)
    expected[[LEFT, RIGHT]] = 3.0
    np.testing.assert_allclose(moved(offset(*CORNERS, company=Company.STAY)), expected)


def test_resetting_the_leaders_brings_the_followers_back() -> None:
    back = Edit(CORNERS, Op.RESET, 1.0, 3.0, 0.5)
    np.testing.assert_allclose(moved(offset(*CORNERS), back), 0, atol=1e-12)


# --- the one-click fixes on the demo take, answered by the networks that ship --------------------

MEASURED = {"smile": "mouthSmile", "frown": "mouthFrown", "pucker": "mouthPucker"}
SELECTION = (2.0, 6.0)


@lru_cache(maxsize=1)
def demo() -> EditSession:
    return session_by_networks(demo_take(), shipped_engine())


@lru_cache(maxsize=200)
def after(*fixes: str) -> dict[str, float]:
    """Mean weights in the selection after a sequence of fixes on it."""
    session, presets = demo(), {p.id: p for p in load_presets(Path("nowhere"))[0]}
    while session.can_undo:
        session.undo()
    for name in fixes:
        session.add(*apply_preset(session, presets[name], SELECTION, 0.0, 0.2))
    times = session.take.clip.times
    rows = (times >= SELECTION[0]) & (times <= SELECTION[1])
    means = {}
    for name, channel in MEASURED.items():
        sides = [c for c in ARKIT_INDEX if c.startswith(channel)]
        means[name] = float(session.weights[rows][:, [ARKIT_INDEX[c] for c in sides]].mean())
    return means


def sequences(fix: str, others: Sequence[str]) -> list[tuple[str, ...]]:
    """A fix before, between and after up to two others."""
    return [
        sequence
        for count in range(len(others))
        for chosen in itertools.combinations(others, count)
        for sequence in itertools.permutations((fix, *chosen))
    ]


@pytest.mark.parametrize("sequence", sequences("smile", ("calm_down", "exaggerate", "widen")))
def test_a_smile_stays_a_smile(sequence: tuple[str, ...]) -> None:
    smiling = after(*sequence)
    rest = after(*(fix for fix in sequence if fix != "smile"))
    assert smiling["smile"] > rest["smile"] + 0.1
    assert smiling["frown"] < rest["frown"] + 0.08
    assert smiling["smile"] > smiling["frown"]


@pytest.mark.parametrize("sequence", sequences("sad_mouth", ("calm_down", "exaggerate")))
def test_a_sad_mouth_stays_sad(sequence: tuple[str, ...]) -> None:
    sad = after(*sequence)
    rest = after(*(fix for fix in sequence if fix != "sad_mouth"))
    assert sad["frown"] > rest["frown"] + 0.2
    assert sad["smile"] <= rest["smile"] + 0.01


@pytest.mark.parametrize("sequence", sequences("pucker", ("calm_down", "exaggerate")))
def test_a_pucker_stays_a_pucker(sequence: tuple[str, ...]) -> None:
    pursed = after(*sequence)
    rest = after(*(fix for fix in sequence if fix != "pucker"))
    assert pursed["pucker"] > rest["pucker"] + 0.15
    assert pursed["frown"] < rest["frown"] + 0.1
    assert pursed["smile"] < 0.05


@pytest.mark.parametrize("fixes", [("smile", "pucker"), ("widen", "pucker")])
def test_opposites_nearly_cancel_in_either_order(fixes: tuple[str, ...]) -> None:
    for sequence in itertools.permutations(fixes):
        assert max(after(*sequence).values()) < 0.15


def test_a_smile_by_hand_calmed_down_is_a_smile() -> None:
    session, presets = demo(), {p.id: p for p in load_presets(Path("nowhere"))[0]}
    calm = after("calm_down")
    while session.can_undo:
        session.undo()
    session.add(Edit(CORNERS, Op.OFFSET, *SELECTION, 0.2, 3.0))
    session.add(*apply_preset(session, presets["calm_down"], SELECTION, 0.0, 0.2))
    rows = (session.take.clip.times >= SELECTION[0]) & (session.take.clip.times <= SELECTION[1])
    means = {
        name: session.weights[rows][:, [ARKIT_INDEX[f"{name}{side}"] for side in ("Left", "Right")]]
        for name in ("mouthSmile", "mouthFrown")
    }
    assert means["mouthSmile"].mean() > calm["smile"] + 0.02
    assert means["mouthFrown"].mean() < calm["frown"] + 0.1

"""GLBs with several people, takes and meshes: what follows is edited along, all else is kept."""

from __future__ import annotations

from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from support.animated_glb import Numbers, Played, outputs, write_animations

from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.take import Take

NAMES = ("jawOpen", "mouthClose", "eyeBlinkLeft", "cheekPuff")
FRAMES = 40


def moving(seed: float, still: tuple[int, ...] = (3,)) -> Numbers:
    """(T, 4) weights; those of the last channel are 0."""
    n = np.arange(FRAMES)[:, None]
    weights = 0.5 + 0.3 * np.sin(n / 5 + np.arange(4) + seed)
    weights[:, list(still)] = 0
    return weights.astype("<f4").astype(np.float64)


ANNA, BOB = moving(0), moving(2.2)
TEETH = np.where([1, 1, 0, 0], ANNA, 0)


def edit(path: Path, channel: str = "jawOpen") -> tuple[Take, list[list[Numbers]]]:
    """Set a channel of frame 7 to 0.75, and read what is written."""
    take, out = open_take(path), path.with_name("out.glb")
    weights = take.clip.weights.copy()
    weights[7, take.clip.channels.index(channel)] = 0.75
    write_take(out, take, weights)
    return take, outputs(out)


PEOPLE = {
    "in one animation": [("Scene", [Played("Anna", ANNA), Played("Bob", BOB)])],
    "in two": [("A", [Played("Anna", ANNA)]), ("B", [Played("Bob", BOB)])],
    "two takes": [("Take1", [Played("Anna", ANNA)]), ("Take2", [Played("Anna", BOB)])],
    "who is still": [("Scene", [Played("Anna", ANNA), Played("Bob", 0 * BOB)])],
    "alike in a channel": [
        ("Scene", [Played("Anna", ANNA), Played("Bob", np.where([1, 0, 0, 0], ANNA, BOB))])
    ],
}


@pytest.mark.parametrize("animations", PEOPLE.values(), ids=PEOPLE)
@pytest.mark.parametrize("channel", ["jawOpen", "cheekPuff"])
@pytest.mark.parametrize("number", ["<f4", "u1"])
def test_another_person_or_take_is_kept_and_said(
    tmp_path: Path, animations: list[tuple[str, list[Played]]], channel: str, number: str
) -> None:
    meshes = {"Anna": NAMES, "Bob": NAMES}
    path = write_animations(tmp_path / "take.glb", meshes, animations, number)
    take, after = edit(path, channel)
    assert [note for note in take.unread if note.startswith("one of 2 animations is read")]
    _, before = chain(*outputs(path))
    first, second = chain(*after)
    np.testing.assert_array_equal(second, before)
    assert first.reshape(FRAMES, 4)[7, NAMES.index(channel)] == 0.75


def test_the_mesh_is_named_where_one_animation_has_two(tmp_path: Path) -> None:
    animations = [("Scene", [Played("Anna", ANNA), Played("Bob", BOB)])]
    path = write_animations(tmp_path / "a.glb", {"Anna": NAMES, "Bob": NAMES}, animations)
    assert open_take(path).unread == ('one of 2 animations is read: that of "Anna"',)


@pytest.mark.parametrize("share", [1.0, 0.8])
@pytest.mark.parametrize("head_first", [True, False])
def test_teeth_that_follow_keep_their_share(tmp_path: Path, share: float, head_first: bool) -> None:
    played = [Played("Head", ANNA), Played("Teeth", share * ANNA)]
    animations = [("Scene", played if head_first else played[::-1])]
    path = write_animations(tmp_path / "a.glb", {"Head": NAMES, "Teeth": NAMES}, animations)
    take, [after] = edit(path)
    head, teeth = after if head_first else after[::-1]
    assert take.notes == ()
    assert (head[28], teeth[28]) == (0.75, np.float32(0.75 * share))


def test_teeth_with_a_share_of_their_own_in_each_channel_are_kept(tmp_path: Path) -> None:
    teeth = ANNA * [1, 0.5, 0.7, 1]
    animations = [("Scene", [Played("Head", ANNA), Played("Teeth", teeth)])]
    path = write_animations(tmp_path / "a.glb", {"Head": NAMES, "Teeth": NAMES}, animations)
    take, [[_, after]] = edit(path)
    assert take.unread == ('one of 2 animations is read: that of "Head"',)
    np.testing.assert_array_equal(after, outputs(path)[0][1])


@pytest.mark.parametrize("first", [Played("Head", ANNA), Played("Teeth", TEETH)])
def test_teeth_follow_in_the_channels_in_which_they_move(tmp_path: Path, first: Played) -> None:
    last = Played("Teeth", TEETH) if first.mesh == "Head" else Played("Head", ANNA)
    meshes = {"Head": NAMES, "Teeth": NAMES}
    path = write_animations(tmp_path / "a.glb", meshes, [("Scene", [first, last])])
    teeth = 1 if first.mesh == "Head" else 0
    take, [jaw] = edit(path, "jawOpen")
    _, [blink] = edit(path, "eyeBlinkLeft")
    assert take.notes == ()
    np.testing.assert_array_equal(take.clip.weights, ANNA.astype("<f4"))
    assert [one[28] for one in jaw] == [0.75, 0.75]
    assert blink[1 - teeth][30] == 0.75
    np.testing.assert_array_equal(blink[teeth], outputs(path)[0][teeth])


def test_a_tongue_with_channels_of_its_own_belongs_to_the_take(tmp_path: Path) -> None:
    tongue = BOB[:, :1]
    animations = [("Head", [Played("Head", ANNA)]), ("Tongue", [Played("Tongue", tongue)])]
    meshes = {"Head": NAMES, "Tongue": ("tongueOut",)}
    path = write_animations(tmp_path / "a.glb", meshes, animations)
    take, [_, [after]] = edit(path, "tongueOut")
    assert take.clip.channels == (*NAMES, "tongueOut")
    assert after[7] == 0.75


def test_numbers_that_another_animation_shares_are_written_anew(tmp_path: Path) -> None:
    slow = Played("Head", ANNA, np.arange(FRAMES) / 15)
    animations = [("Take", [Played("Head", ANNA)]), ("Slow", [slow])]
    path = write_animations(tmp_path / "a.glb", {"Head": NAMES}, animations)
    content = path.read_bytes().replace(b'"output": 5', b'"output": 3')
    path.write_bytes(content)
    _, [[after], [other]] = edit(path)
    assert after[28] == 0.75
    np.testing.assert_array_equal(other.reshape(FRAMES, 4), ANNA)


def test_only_edited_keys_get_new_tangents(tmp_path: Path) -> None:
    stored = np.stack([-ANNA, ANNA, 2 * ANNA], axis=1)
    path = write_animations(
        tmp_path / "a.glb", {"Head": NAMES}, [("Take", [Played("Head", stored)])]
    )
    take, out = open_take(path), tmp_path / "out.glb"
    weights = take.clip.weights.copy()
    weights[10:20, 0] += np.float32(0.1) * np.arange(1, 11, dtype=np.float32)
    write_take(out, take, weights)
    before, after = (outputs(one)[0][0].reshape(FRAMES, 3, 4) for one in (path, out))
    assert len(out.read_bytes()) == len(path.read_bytes())
    rows, _, shapes = np.nonzero(before != after)
    assert (set(rows), set(shapes)) == (set(range(10, 20)), {0})
    np.testing.assert_allclose((after - before)[11:19, ::2, 0], 0.1 * 30, atol=1e-5)
    assert any("slopes" in note for note in take.notes)


IDLES = {
    "two keys": Played("Head", 0.1 * ANNA[:2], np.arange(2.0)),
    "few keys": Played("Head", 0.1 * ANNA[:5], np.arange(5) / 2),
    "nothing moves": Played("Head", 0 * ANNA),
}


@pytest.mark.parametrize("idle", IDLES.values(), ids=IDLES)
@pytest.mark.parametrize(("name", "says"), [("Talk", '"Talk"'), ("", "number 2")])
def test_a_performance_is_read_although_an_idle_comes_first(
    tmp_path: Path, idle: Played, name: str, says: str
) -> None:
    animations = [("Idle", [idle]), (name, [Played("Head", BOB)])]
    path = write_animations(tmp_path / "a.glb", {"Head": NAMES}, animations)
    take, [[first], [second]] = edit(path)
    assert take.unread == (f"one of 2 animations is read: {says}",)
    np.testing.assert_array_equal(first, outputs(path)[0][0])
    assert second[28] == 0.75


def test_of_two_performances_the_first_is_read(tmp_path: Path) -> None:
    animations = [("Take1", [Played("Head", ANNA[:5])]), ("Take2", [Played("Head", BOB)])]
    path = write_animations(tmp_path / "a.glb", {"Head": NAMES}, animations)
    take = open_take(path)
    assert len(take.clip) == 5
    assert take.unread == ("one of 2 animations is read",)

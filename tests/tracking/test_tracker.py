"""From a film to a take, on films of the character whose weights are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from support.face_films import (
    RATE,
    SIZE,
    face_pictures,
    make_face_film,
    speaking,
    turning_pictures,
)
from support.faces import shipped_rig
from support.films import damage_pictures, make_film, make_wav
from support.tracker import needs_tracker

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take
from faceedit_app.media.container import Abandoned
from faceedit_app.tracking.film_landmarks import (
    Chosen,
    Faces,
    NoFaceThere,
    Progress,
    read_landmarks,
)
from faceedit_app.tracking.landmarker import FaceLandmarker
from faceedit_app.tracking.tracker import Tracked, track_film, write_take

pytestmark = needs_tracker


def controls_of(weights: NDArray[np.floating]) -> NDArray[np.float32]:
    return shipped_rig().arkit_distances.measure(weights.astype(np.float32))


@pytest.fixture(scope="module")
def pictures() -> list[NDArray[np.uint8]]:
    return face_pictures(speaking())


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory, pictures: list[NDArray[np.uint8]]) -> Path:
    return make_face_film(tmp_path_factory.mktemp("film") / "face.mp4", pictures)


@pytest.fixture(scope="module")
def tracked(film: Path) -> Tracked:
    return track_film(film, shipped_rig())


def test_curves_follow_the_film(tracked: Tracked) -> None:
    truth, found = controls_of(speaking()), controls_of(tracked.weights)
    for control in ("mouth_opening", "left_eyelid", "right_eyelid"):
        index = CONTROL_INDEX[control]
        assert np.corrcoef(truth[:, index], found[:, index])[0, 1] > 0.95, control


def test_lips_shut_and_eyes_close_when_they_do_in_the_film(tracked: Tracked) -> None:
    truth, found = controls_of(speaking()), controls_of(tracked.weights)
    opening = CONTROL_INDEX["mouth_opening"]
    shut = truth[:, opening] < 1.5
    assert found[shut, opening].max() < 2.5
    assert found[truth[:, opening] > 6.0, opening].min() > 3.0
    lid = CONTROL_INDEX["left_eyelid"]
    assert abs(int(found[:, lid].argmin()) - int(truth[:, lid].argmin())) <= 1
    assert found[:, lid].min() < 1.5


def test_a_still_head_is_not_turned(tracked: Tracked) -> None:
    assert np.degrees(np.abs(tracked.head - np.median(tracked.head, axis=0))).max() < 2.0


def test_a_turned_head_turns_the_take(tmp_path: Path) -> None:
    turned = np.radians(18.0)
    still = np.zeros((12, len(ARKIT_INDEX)), np.float32)
    faces = [(row, yaw) for yaw in (0.0, turned) for row in still]
    path = make_face_film(tmp_path / "turn.mp4", turning_pictures(faces))
    found = track_film(path, shipped_rig())
    yaw = found.head[:, 0]
    # Seen from its left, the head has turned to its right, which is positive.
    assert np.degrees(np.median(yaw[12:]) - np.median(yaw[:12])) == pytest.approx(18.0, abs=4.0)


@pytest.mark.parametrize(("turns", "way"), [(1, "on its right side"), (2, "upside down")])
def test_a_film_that_lies_on_its_side_or_head_is_tracked_upright(
    tmp_path: Path,
    pictures: list[NDArray[np.uint8]],
    tracked: Tracked,
    turns: int,
    way: str,
) -> None:
    lying = [np.ascontiguousarray(np.rot90(picture, turns)) for picture in pictures[:24]]
    found = track_film(make_face_film(tmp_path / "lying.mp4", lying), shipped_rig())
    assert any(f"{way} in the film" in note for note in found.notes)
    assert not any("in the film" in note for note in tracked.notes)
    seen = found.sure
    assert seen.sum() >= len(lying) - 2
    assert np.degrees(np.abs(found.head - tracked.head[:24])[seen]).max() < 3.0
    away = np.abs(controls_of(found.weights) - controls_of(tracked.weights[:24]))[seen]
    assert away[:, CONTROL_INDEX["mouth_opening"]].mean() < 0.5


def test_the_same_film_gives_the_same_bytes(film: Path, tracked: Tracked) -> None:
    assert track_film(film, shipped_rig()).to_livelink() == tracked.to_livelink()


def test_the_take_opens_with_the_times_of_the_film(tmp_path: Path, tracked: Tracked) -> None:
    write_take(tracked, tmp_path / "take.csv")
    take = open_take(tmp_path / "take.csv")
    assert take.clip.rate == RATE
    np.testing.assert_allclose(take.clip.times, tracked.landmarks.times, atol=1e-4)
    np.testing.assert_allclose(take.clip.arkit_weights(), tracked.weights, atol=1e-6)
    assert take.clip.confidence == pytest.approx(tracked.confidence, abs=6e-4)
    assert "HeadYaw" in take.carried
    assert "LeftEyePitch" in take.carried


def test_a_take_can_have_another_frame_rate(tmp_path: Path, tracked: Tracked) -> None:
    write_take(tracked, tmp_path / "take.csv", fps=60.0)
    clip = open_take(tmp_path / "take.csv").clip
    assert clip.rate == 60.0
    assert clip.duration == pytest.approx(len(speaking()) / RATE, abs=0.02)
    assert clip.confidence is not None
    assert clip.confidence.mean() == pytest.approx(tracked.confidence.mean(), abs=0.01)


def test_varying_times_are_kept(tmp_path: Path, pictures: list[NDArray[np.uint8]]) -> None:
    times = np.cumsum([0.0, *np.tile([0.03, 0.05], 12)[:23]])
    path = make_face_film(tmp_path / "phone.mp4", pictures[:24], times.tolist())
    np.testing.assert_allclose(track_film(path, shipped_rig()).landmarks.times, times, atol=2e-4)


def test_pictures_without_the_face_are_a_gap(
    tmp_path: Path, pictures: list[NDArray[np.uint8]]
) -> None:
    hidden = pictures[:22]
    hidden[8:14] = [np.full((SIZE, SIZE, 3), 90, np.uint8)] * 6
    found = track_film(make_face_film(tmp_path / "gone.mp4", hidden), shipped_rig())
    assert not found.sure[8:14].any()
    assert found.sure[:8].all()
    assert found.sure[15:].all()
    assert found.notes
    write_take(found, tmp_path / "take.csv")
    clip = open_take(tmp_path / "take.csv").clip
    assert [(gap.frame, gap.missing) for gap in clip.gaps] == [(7, 6)]


@pytest.mark.parametrize(
    ("tint", "last"),
    [((200, 150, 125), 13), ((25, 25, 28), 13), ((150, 140, 130), 22)],
    ids=["hand", "microphone", "for long"],
)
def test_what_is_hidden_is_not_made_up(
    tmp_path: Path, pictures: list[NDArray[np.uint8]], tint: tuple[int, int, int], last: int
) -> None:
    """The landmarker is sure of a mouth behind a hand; the take is not."""
    hidden = pictures[: last + 10]
    random = np.random.default_rng(1)
    for index in range(8, last + 1):
        picture = hidden[index].astype(np.float64)
        fingers = picture[SIZE * 5 // 9 : SIZE * 7 // 9, SIZE // 3 : SIZE * 2 // 3]
        fingers[:] = np.array(tint) + random.normal(0, 6, fingers.shape)
        fingers[::14] *= 0.7
        hidden[index] = np.clip(picture, 0, 255).astype(np.uint8)
    found = track_film(make_face_film(tmp_path / "hand.mp4", hidden), shipped_rig())
    assert (found.landmarks.probabilities[8 : last + 1] > 0.9).all()
    assert not found.sure[8 : last + 1].any()
    assert (found.confidence[:7] > 0.9).all()
    assert (found.confidence[last + 2 :] > 0.9).all()


def test_a_scene_in_other_light_is_no_hand(
    tmp_path: Path, pictures: list[NDArray[np.uint8]]
) -> None:
    side = np.linspace(0.25, 1.5, SIZE)[None, :, None]
    lit = [
        np.clip(picture * (side if index < 12 else side[:, ::-1]), 0, 255).astype(np.uint8)
        for index, picture in enumerate(pictures[:24])
    ]
    found = track_film(make_face_film(tmp_path / "light.mp4", lit), shipped_rig())
    assert found.sure.all()


def test_damaged_pictures_are_a_gap(tmp_path: Path, film: Path) -> None:
    """A player shows the picture before them, and of its face the tracker would be sure."""
    path = tmp_path / "damaged.mp4"
    path.write_bytes(film.read_bytes())
    damage_pictures(path, slice(-6, -2))
    found = track_film(path, shipped_rig())
    lost = np.flatnonzero(~found.sure)
    assert 4 <= len(lost) <= 8
    assert lost.min() >= len(found.sure) - 8
    said = " ".join(found.notes)
    assert f"{found.landmarks.damaged} of {len(found.sure)} pictures are damaged" in said
    assert ("badly" in said) == (len(lost) > found.landmarks.damaged)


def test_a_face_that_is_never_seen_well_is_no_take(tmp_path: Path) -> None:
    turned = face_pictures(speaking(10), yaw=np.radians(62.0))
    with pytest.raises(FileError, match=r"the face well in only \d pictures? of 10; use a film"):
        track_film(make_face_film(tmp_path / "side.mp4", turned), shipped_rig())


def test_a_pause_of_the_camera_is_a_gap_and_no_slow_film(
    tmp_path: Path, pictures: list[NDArray[np.uint8]]
) -> None:
    times = np.arange(20) / RATE
    times[10:] += 30.0
    found = track_film(
        make_face_film(tmp_path / "paused.mp4", pictures[:20], times.tolist()), shipped_rig()
    )
    write_take(found, tmp_path / "take.csv")
    clip = open_take(tmp_path / "take.csv").clip
    assert clip.rate == pytest.approx(RATE)
    assert [gap.frame for gap in clip.gaps] == [9]


def test_a_moment_between_lost_pictures_is_lost_too(
    tmp_path: Path, pictures: list[NDArray[np.uint8]]
) -> None:
    hidden = pictures[:26]
    for index in (8, 9, 11, 12, 18, 22):
        hidden[index] = np.full((SIZE, SIZE, 3), 90, np.uint8)
    found = track_film(make_face_film(tmp_path / "gone.mp4", hidden), shipped_rig())
    assert np.flatnonzero(~found.sure).tolist() == [8, 9, 10, 11, 12, 18, 22]


def test_the_largest_face_is_tracked_or_the_one_that_was_chosen(
    tmp_path: Path, pictures: list[NDArray[np.uint8]]
) -> None:
    """The small face keeps still. It is not there at first, so it is chosen in a later picture."""
    absent, chosen_in = 6, 12
    still = face_pictures(np.zeros((1, len(ARKIT_INDEX)), np.float32), size=240)[0]
    both = []
    for index, large in enumerate(pictures[:25]):
        picture = np.zeros((SIZE, SIZE + 240, 3), np.uint8)
        picture[:, :SIZE] = large
        if index >= absent:
            picture[:240, SIZE:] = still
        both.append(picture)
    path = make_face_film(tmp_path / "two.mp4", both)
    opening = CONTROL_INDEX["mouth_opening"]
    largest = controls_of(track_film(path, shipped_rig()).weights)[:, opening]
    assert np.ptp(largest) > 4.0
    seen: list[Progress] = []
    face = Chosen(0.8, 0.3, chosen_in / RATE)
    found = track_film(path, shipped_rig(), seen.append, face=face)
    assert np.flatnonzero(found.sure).tolist() == list(range(absent, 25))
    assert np.ptp(controls_of(found.weights)[found.sure, opening]) < 2.0
    assert (found.landmarks.points[found.sure, 1, 0] > SIZE).all()
    looked = [round(progress.seconds * RATE) for progress in seen if progress.picture is not None]
    assert looked == [*range(chosen_in, 25), *range(chosen_in - 1, -1, -1)]
    with pytest.raises(NoFaceThere, match=r"shows no face at 0\.80,0\.90; choose a place"):
        track_film(path, shipped_rig(), face=Chosen(0.8, 0.9))


def test_of_several_faces_in_the_first_picture_the_user_chooses(
    tmp_path: Path, pictures: list[NDArray[np.uint8]]
) -> None:
    picture = np.zeros((SIZE, SIZE + 240, 3), np.uint8)
    picture[:, :SIZE] = pictures[0]
    picture[:240, SIZE:] = np.asarray(Image.fromarray(pictures[0]).resize((240, 240)))
    film = make_face_film(tmp_path / "two.mp4", [picture] * 8)
    asked: list[Faces] = []

    def choose(faces: Faces) -> int:
        asked.append(faces)
        return 1

    landmarker = FaceLandmarker()
    seen = read_landmarks(film, landmarker, choose=choose)
    (faces,) = asked
    share = SIZE / (SIZE + 240)
    assert (faces.boxes[0, :3:2] < share).all()
    assert (faces.boxes[1, :3:2] > share).all()
    assert (seen.points[:, 1, 0] > SIZE).all()
    largest = read_landmarks(film, landmarker)
    assert (largest.points[:, 1, 0] < SIZE).all()
    assert largest.remarks == ("it shows 2 faces: the largest was followed, as no place was given",)


def test_a_small_face_in_a_large_picture_is_found(
    tmp_path: Path, pictures: list[NDArray[np.uint8]]
) -> None:
    small = []
    for picture in pictures[:10]:
        large = np.full((720, 1280, 3), 90, np.uint8)
        large[500:596, 900:996] = np.asarray(Image.fromarray(picture).resize((96, 96)))
        small.append(large)
    found = track_film(make_face_film(tmp_path / "far.mp4", small), shipped_rig())
    assert found.sure.all()
    assert ("pixels high: lips and lids are less exact") in found.notes[-1]


def test_progress_shows_every_picture_and_can_be_stopped(film: Path) -> None:
    seen: list[Progress] = []
    with pytest.raises(Abandoned):
        track_film(film, shipped_rig(), seen.append, lambda: len(seen) >= 5)
    assert [progress.done for progress in seen] == [1, 2, 3, 4, 5]
    assert seen[-1].picture is not None
    assert seen[-1].points is not None


def _numbers(path: Path) -> Path:
    return make_film(path / "numbers.mp4", frames=12)


def _slow(path: Path) -> Path:
    return make_film(path / "slow.mp4", frames=12, rate=2)


def _short(path: Path) -> Path:
    return make_film(path / "short.mp4", frames=3)


def _sound(path: Path) -> Path:
    return make_wav(path / "sound.wav")


def _broken(path: Path) -> Path:
    (path / "broken.mp4").write_bytes(b"no film" * 50)
    return path / "broken.mp4"


def _photo(path: Path) -> Path:
    Image.new("RGB", (64, 64)).save(path / "photo.png")
    return path / "photo.png"


def _gif(path: Path) -> Path:
    frames = [Image.new("RGB", (64, 64), (i, 0, 0)) for i in range(20)]
    frames[0].save(path / "moving.gif", save_all=True, append_images=frames[1:], duration=40)
    return path / "moving.gif"


def _huge(path: Path) -> Path:
    return make_face_film(path / "huge.mp4", [np.zeros((64, 4112, 3), np.uint8)] * 2)


@pytest.mark.parametrize(
    ("make", "problem"),
    [
        (_numbers, "shows no face"),
        (_slow, "too few"),
        (_short, "too few"),
        (_sound, "has no pictures"),
        (_broken, "cannot be read"),
        (_photo, "is a picture"),
        (_gif, "is a picture"),
        (_huge, "4112 x 64"),
        (lambda path: path / "nowhere.mp4", "is missing"),
    ],
)
def test_what_cannot_be_tracked_is_one_line(tmp_path: Path, make: object, problem: str) -> None:
    assert callable(make)
    with pytest.raises(FileError, match=problem) as caught:
        track_film(make(tmp_path), shipped_rig())
    assert "\n" not in str(caught.value)

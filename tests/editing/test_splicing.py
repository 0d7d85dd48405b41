"""A new take without some time, or with more: its file, its sound and its film stay in step."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from support.films import make_film, make_wav, number_of
from support.speech import said
from support.takes import make_livelink_csv, make_plain_csv

from faceedit_app.core.errors import FileError
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.edits.splice import Splice
from faceedit_app.editing.filming import media_of
from faceedit_app.editing.splicing import Written, ending_for, write_spliced
from faceedit_app.formats.opening import open_take
from faceedit_app.media.container import Abandoned
from faceedit_app.media.film import Film
from faceedit_app.media.sound import read_sound


def written(take: Path, out: Path, *splices: Splice, media: Placement | None = None) -> Written:
    opened = open_take(take)
    return write_spliced(opened, opened.clip, splices, out, media or media_of(opened))


def burst_of(path: Path) -> float:
    """Seconds at which the burst in a sound begins."""
    sound = read_sound(path)
    assert sound is not None
    return sound.start + int(np.argmax(np.abs(sound.samples[:, 0]) > 3000)) / sound.rate


def test_take_sound_and_film_are_cut_alike(tmp_path: Path) -> None:
    take = make_plain_csv(tmp_path / "take.csv", 2.0)
    make_film(tmp_path / "take.mp4", frames=60, sound=1.5)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    found = written(take, tmp_path / "new.csv", Splice(0.5, 1.0), Splice(1.2, 1.2, 0.4))
    assert found.names == "new.csv, new.wav, new.mp4"
    assert {path: path.read_bytes() for path in before} == before
    again = open_take(found.path)
    assert len(again.clip) == 60 - 15 + 12
    np.testing.assert_allclose(again.clip.weights, found.clip.weights, atol=6e-6)
    assert found.sound is not None
    assert burst_of(found.sound) == pytest.approx(1.4, abs=0.03)
    film = Film(tmp_path / "new.mp4")
    assert len(film) == 57
    shown = [number_of(film.picture(k)) for k in (0, 14, 15, 20, 21, 32, 33, 56)]
    assert shown == [0, 14, 30, 35, 36, 36, 36, 59]
    film.close()


@pytest.mark.parametrize("lost", ["nan", "", None], ids=["nan", "empty", "no rows"])
@pytest.mark.parametrize(
    ("one", "seconds", "heard"),
    [(Splice(0.4, 0.6), 1.8, 0.8), (Splice(0.5, 0.5, 0.5), 2.5, 1.5)],
    ids=["cut", "pause"],
)
def test_sound_follows_a_splice_in_a_gap(
    tmp_path: Path, lost: str | None, one: Splice, seconds: float, heard: float
) -> None:
    take = make_plain_csv(tmp_path / "take.csv", 2.0)
    head, *rows = take.read_text().splitlines()
    for row in range(10, 25):
        rows[row] = ",".join([rows[row].split(",")[0], *[lost or ""] * head.count(",")])
    kept = [row for k, row in enumerate(rows) if lost is not None or not 10 <= k < 25]
    take.write_text("\n".join([head, *kept]) + "\n")
    make_film(tmp_path / "take.mp4", frames=60, sound=1.0)
    found = written(take, tmp_path / "new.csv", one)
    again = open_take(found.path).clip
    assert again.duration == pytest.approx(seconds)
    assert [gap.missing for gap in again.gaps] == [15 + round((seconds - 2.0) * 30)]
    assert found.sound is not None
    assert burst_of(found.sound) == pytest.approx(heard, abs=0.03)


def test_sound_and_film_begin_and_end_with_rows_without_a_face(tmp_path: Path) -> None:
    take = make_plain_csv(tmp_path / "take.csv", 2.0)
    head, *rows = take.read_text().splitlines()
    for row in (*range(6), *range(57, 60)):
        rows[row] = rows[row].split(",")[0] + "," * head.count(",")
    take.write_text("\n".join([head, *rows]) + "\n")
    make_film(tmp_path / "take.mp4", frames=60, sound=1.0)
    found = written(take, tmp_path / "new.csv", Splice(0.2, 0.4))
    again = open_take(found.path)
    assert len(again.clip) == 51 - 6
    assert len(found.path.read_text().splitlines()) == 1 + 54
    assert found.begin == pytest.approx(-again.lead) == pytest.approx(-0.2)
    media = media_of(again)
    assert media.sound is not None
    assert found.sound is not None
    # 0.8 s after the first face, of which 0.2 s are cut out.
    assert burst_of(found.sound) + media.sound.offset == pytest.approx(0.6, abs=0.03)
    sound = read_sound(found.sound)
    assert sound is not None
    assert len(sound.samples) == pytest.approx(1.8 * sound.rate, abs=1)
    film = Film(tmp_path / "new.mp4")
    assert [number_of(film.picture(k)) for k in (0, 11, 12, 53)] == [0, 11, 18, 59]
    assert len(film) == 54
    film.close()


def test_samples_beyond_the_joints_are_those_of_the_sound(tmp_path: Path) -> None:
    take, sound = make_plain_csv(tmp_path / "take.csv", 2.0), tmp_path / "other.wav"
    make_wav(sound, 2.0, channels=2)
    media = Placement(MediaFile(sound, offset=0.25), None)
    found = written(take, tmp_path / "new.csv", Splice(0.2, 0.5), media=media)
    assert found.film is None
    old, new = read_sound(sound), read_sound(tmp_path / "new.wav")
    assert old is not None
    assert new is not None
    assert len(new.samples) == round(1.7 * 8000)
    # From 0.6 s of the take on, 0.35 s of the file.
    assert np.array_equal(new.samples[round(0.3 * 8000) :], old.samples[round(0.35 * 8000) : 14000])
    assert not new.samples[: round(0.2 * 8000)].any()  # the file begins later


def test_words_go_with_the_take_and_those_cut_out_are_gone(tmp_path: Path) -> None:
    words = said(("map", "M AE P"), ("boom", "B UW M"), ("fish", "F IH SH"), start=0.6)
    take = make_plain_csv(tmp_path / "take.csv", 3.0)
    found = written(take, tmp_path / "new.csv", Splice(0.9667, 1.3), Splice(2.0, 2.0, 1.0))
    kept = found.words(words)
    assert kept is not None
    assert kept.text == "map fish"
    assert kept.words[1].start == pytest.approx(words.words[2].start - 1 / 3, abs=0.02)
    assert found.words(None) is None
    assert (found.sound, found.film) == (None, None)


@pytest.mark.parametrize("name", ["take.csv", "there.csv", "take_edited.csv", "there_is.csv"])
def test_nothing_is_replaced_and_no_old_sound_is_found(tmp_path: Path, name: str) -> None:
    take = make_livelink_csv(tmp_path / "take.csv")
    make_wav(tmp_path / "take.wav")
    make_film(tmp_path / "there_is.mp4")
    (tmp_path / "there.wav").write_bytes(b"mine")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    media = Placement() if name == "take_edited.csv" else media_of(open_take(take))
    with pytest.raises(FileError, match="choose another name"):
        written(take, tmp_path / name, Splice(0.5, 1.0), media=media)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_what_is_stopped_or_fails_leaves_nothing(tmp_path: Path) -> None:
    take = open_take(make_livelink_csv(tmp_path / "take.csv"))
    make_film(tmp_path / "take.mp4", sound=0.5)
    before = sorted(tmp_path.iterdir())
    media = media_of(take)
    with pytest.raises(Abandoned):
        write_spliced(
            take, take.clip, [Splice(0.5, 1.0)], tmp_path / "new.csv", media,
            progress=lambda share: share < 0.5,
        )  # fmt: skip
    with pytest.raises(FileError):
        write_spliced(take, take.clip, [Splice(0.5, 1.0)], tmp_path / "no" / "new.csv", media)
    assert sorted(tmp_path.iterdir()) == before


def test_formats_that_cannot_be_written_become_csv(tmp_path: Path) -> None:
    phone = open_take(make_livelink_csv(tmp_path / "take.csv"))
    assert ending_for(phone) == ".csv"
    found = written(phone.path, tmp_path / "new.json", Splice(0.5, 1.0))
    assert "time" not in found.remarks
    assert len(open_take(found.path).clip) == 90


def test_a_new_take_in_another_format_says_so(tmp_path: Path) -> None:
    frames = [
        {"time": k / 25, "weights": {"jawOpen": k / 100, "mouthPucker": 0.2}} for k in range(50)
    ]
    take = tmp_path / "take.json"
    take.write_text(json.dumps(frames))
    found = written(take, tmp_path / "new.json", Splice(0.5, 1.0))
    assert found.remarks == (
        "no new take can be JSON with named weights, so it is written as Audio2Face JSON",
    )
    assert open_take(found.path).kind == "Audio2Face JSON"
    phone = make_livelink_csv(tmp_path / "phone.csv")
    assert not written(phone, tmp_path / "shorter.csv", Splice(0.5, 1.0)).remarks

"""Synthesised performances: believable lips and lids, the same from the same seed."""

from __future__ import annotations

import itertools
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from support.places import ROOT

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.errors import FaceEditError, FileError, Unavailable
from faceedit_app.lab.training import (
    demo_take,
    expressions,
    eyes,
    phonemes,
    speech,
    statistics,
    synthesis,
)
from faceedit_app.lab.training.eyes import Blink, Gaze
from faceedit_app.lab.training.phonemes import (
    PAUSE,
    PHONEMES,
    StressedPhoneme,
    parse,
    with_durations,
)
from faceedit_app.lab.training.sentences import SENTENCES
from faceedit_app.lab.training.speech import Speaker, draw_speaker, synthesize
from faceedit_app.lab.training.visemes import ARTICULATOR_INDEX, VISEMES, articulate

RATE = 60.0
JAW, CLOSE = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]
BLINK_LEFT, BLINK_RIGHT = ARKIT_INDEX["eyeBlinkLeft"], ARKIT_INDEX["eyeBlinkRight"]

needs_espeak = pytest.mark.skipif(
    shutil.which("espeak-ng") is None, reason="espeak-ng is not installed on this computer"
)

Performance = tuple[NDArray[np.float64], NDArray[np.float32]]  # times, weights
Demo = tuple[list[str], list[list[str]], NDArray[np.float64]]  # header, cells, numbers
SAID = tuple(with_durations(parse(text)) for text in demo_take.TRANSCRIPTIONS)


@pytest.fixture(scope="module")
def minute() -> Performance:
    return synthesize(60.0, seed=4, utterances=SAID)


def test_transcriptions_are_read() -> None:
    said = parse("m_'eI_b_i: b_'0_b\nh_'E_v_i_; p_i@ ?_Q_d")
    assert [p.symbol for p in said] == [
        "m", "eI", "b", "i", "b", "A", "b", PAUSE, "h", "E", "v", "i", "p", "i", "@", "d",
    ]  # fmt: skip
    assert [p.stress for p in said if p.symbol in phonemes.VOWELS] == [2, 0, 2, 2, 0, 0, 0]
    assert parse("") == parse("\n ; \n") == ()


def test_durations_follow_stress_phrase_and_tempo() -> None:
    said = with_durations(parse("t_'i:_t_i:_t_i:"))
    stressed, unstressed, last = (p.seconds for p in said if p.symbol == "i")
    assert stressed > unstressed < last
    normal, fast = (sum(p.seconds for p in with_durations(SAID[0], t)) for t in (1.0, 1.25))
    assert fast == pytest.approx(normal / 1.25)
    spoken = [p for said in SAID for p in said if p.symbol != PAUSE]
    assert 9 < len(spoken) / sum(p.seconds for p in spoken) < 16  # phonemes a second


@pytest.mark.parametrize("consonant", ["p", "b", "m"])
@pytest.mark.parametrize("vowel", ["i", "a", "u", "oU"])
def test_bilabials_seal_the_lips_between_any_vowels(consonant: str, vowel: str) -> None:
    said = with_durations(
        (
            StressedPhoneme(vowel, stress=2),
            StressedPhoneme(consonant),
            StressedPhoneme(vowel, stress=2),
        )
    )
    closure = articulate(said, RATE)[:, ARTICULATOR_INDEX["closure"]]
    middle = round((said[0].seconds + said[1].seconds / 2) * RATE)
    assert closure[middle] > 0.97
    assert closure[round(0.5 * said[0].seconds * RATE)] < 0.5  # and the vowels open them again


def test_consonants_take_the_rounding_of_their_neighbours() -> None:
    pucker = ARTICULATOR_INDEX["mouthPucker"]
    spread, rounded = (
        articulate(
            [StressedPhoneme(v, 0.1, 2), StressedPhoneme("t", 0.07), StressedPhoneme(v, 0.1, 2)],
            RATE,
        )
        for v in ("i", "u")
    )
    assert rounded[8, pucker] > spread[8, pucker] + 0.1


def test_every_phoneme_can_be_said_alone() -> None:
    for symbol in PHONEMES:
        curve = articulate([StressedPhoneme(symbol, 0.2)], RATE)
        assert curve.shape == (12, len(ARTICULATOR_INDEX))
        assert np.isfinite(curve).all()
        assert curve.min() >= 0
        assert curve.max() <= 1
    assert all(name in ARTICULATOR_INDEX for v in VISEMES.values() for name in v.targets)


def test_a_blink_closes_faster_than_it_opens() -> None:
    times = np.arange(60) / RATE
    left, right = eyes.lids(times, [Blink(0.2, 0.1, 0.02, 0.22, depth=(1.0, 0.6))]).T
    assert left.max() == pytest.approx(1.0)
    assert right.max() == pytest.approx(0.6)
    assert left[times < 0.2].max() == 0 == left[times > 0.55].max()
    rise = np.argmax(left) - np.argmax(left > 0.1)
    fall = np.flatnonzero(left > 0.1)[-1] - np.argmax(left)
    assert 1.3 < fall / rise < 4


def test_gaze_arrives_quickly_and_stays() -> None:
    times = np.arange(120) / RATE
    yaw, pitch = eyes.gaze_curve(times, [Gaze(0.5, 0.4, 0.0), Gaze(1.5, -0.2, -0.3)]).T
    assert yaw[times < 0.5].max() == 0
    np.testing.assert_allclose(yaw[(times > 0.6) & (times < 1.5)], 0.4)
    np.testing.assert_allclose(pitch[times > 1.65], -0.3)


def test_blinks_come_at_the_rate_asked_for_and_never_overlap() -> None:
    blinks = eyes.draw_blinks(np.random.default_rng(0), 600.0, 15.0)
    assert 12 < len(blinks) / 10 < 18
    assert all(a.start + a.seconds <= b.start for a, b in itertools.pairwise(blinks))


def test_moods_and_gestures_name_real_channels() -> None:
    for shape in (*expressions.MOODS.values(), *expressions.GESTURES.values()):
        for name in shape:
            assert name in ARKIT_INDEX or name + "Left" in ARKIT_INDEX, name


def test_performance_is_made_of_plausible_weights(minute: Performance) -> None:
    times, weights = minute
    assert weights.shape == (3600, 52)
    assert weights.dtype == np.float32
    assert times[0] == 0
    assert times[-1] == pytest.approx(60 - 1 / RATE)
    assert weights.min() >= 0
    assert weights.max() <= 1
    assert (weights[:, CLOSE] <= weights[:, JAW]).all()


def test_performance_moves_like_a_face() -> None:
    speaker = replace(draw_speaker(np.random.default_rng(4)), gestures=0.0)  # no winks
    figures = statistics.measure([synthesize(60.0, 4, utterances=SAID, speaker=speaker)])
    assert 1.5 < figures.jaw_peaks < 3.5
    assert 40 < figures.closures < 110
    assert 5 < figures.blinks < 28
    assert 70 < figures.blink_close_ms < 140 < figures.blink_open_ms < 300
    assert figures.above_8hz < 0.01
    assert figures.correlations["eyeBlinkLeft", "eyeBlinkRight"] > 0.8


def test_same_seed_same_performance(minute: Performance) -> None:
    again = synthesize(60.0, seed=4, utterances=SAID)
    np.testing.assert_array_equal(again[1], minute[1])
    other = synthesize(60.0, seed=5, utterances=SAID)
    assert np.abs(other[1] - minute[1]).max() > 0.1


def test_speakers_differ_and_can_be_chosen() -> None:
    first, second = (draw_speaker(np.random.default_rng(s)) for s in (1, 2))
    assert first.tempo != second.tempo
    assert first.rest is not None
    assert second.rest is not None
    assert not np.array_equal(first.rest, second.rest)
    calm = replace(Speaker(), gestures=0.0, affect=0.0, noise=0.0, idle=0.0, emphasis=0.0)
    _, weights = synthesize(8.0, seed=1, utterances=SAID, speaker=calm)
    assert weights[:, ARKIT_INDEX["mouthFrownLeft"]].max() == 0


@pytest.mark.parametrize("rate", [25.0, 30.0, 59.94])
def test_any_rate_and_any_length(rate: float) -> None:
    for seconds in (0.1, 1.0, 3.3):
        times, weights = synthesize(seconds, seed=2, rate=rate, utterances=SAID)
        assert len(times) == len(weights) == round(seconds * rate)


def test_phonemes_without_durations_are_given_some() -> None:
    bare = [parse(text) for text in demo_take.TRANSCRIPTIONS]
    _, weights = synthesize(5.0, seed=4, utterances=bare)
    _, timed = synthesize(5.0, seed=4, utterances=SAID)
    np.testing.assert_array_equal(weights, timed)


def test_livelink_file_is_laid_out_as_the_app_does(tmp_path: Path) -> None:
    weights = np.zeros((3, 52), np.float32)
    weights[:, ARKIT_INDEX["jawLeft"]] = 0.25
    weights[1, ARKIT_INDEX["eyeLookOutLeft"]] = 1.0
    path = tmp_path / "take.csv"
    synthesis.write_livelink(path, weights, rate=30.0, start="01:59:59:58.250")
    raw = path.read_bytes()
    assert b"\r" not in raw
    assert raw.endswith(b"\n")
    header, *rows = (line.split(",") for line in raw.decode().splitlines())
    assert header[:5] == ["Timecode", "BlendShapeCount", "EyeBlinkLeft", "EyeLookDownLeft",
                          "EyeLookInLeft"]  # fmt: skip
    assert header.index("JawRight") + 1 == header.index("JawLeft")
    assert header.index("MouthRight") + 1 == header.index("MouthLeft")
    assert header[-9] == "HeadYaw"
    assert header[-1] == "RightEyeRoll"
    assert len(header) == 63
    assert [row[0] for row in rows] == ["01:59:59:58.250", "02:00:00:00.250", "02:00:00:02.250"]
    assert {len(row) for row in rows} == {63}
    assert {row[1] for row in rows} == {"61"}
    assert rows[0][header.index("JawLeft")] == "0.2500000000"
    turned, rest = (float(row[header.index("LeftEyeYaw")]) for row in rows[1::-1])
    assert turned < rest  # outwards is negative for the left eye


def test_bad_timecode_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="timecode"):
        synthesis.write_livelink(tmp_path / "x.csv", np.zeros((1, 52), np.float32), start="10:00")


@needs_espeak
def test_transcribing_with_espeak() -> None:
    said = phonemes.transcribe("Maybe Bob can move the map.")
    assert [p.symbol for p in said][:4] == ["m", "eI", "b", "i"]
    assert 1.0 < sum(p.seconds for p in said) < 3.0
    assert phonemes.transcribe("-q") != ()  # text, not an option
    assert all(phonemes.transcribe(sentence) for sentence in SENTENCES)
    _, weights = synthesize(5.0, seed=3)
    assert weights[:, JAW].max() > 0.1


def test_folder_of_takes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speech, "transcribe", lambda _: SAID[0])
    steps: list[tuple[int, int]] = []
    paths = synthesis.write_performances(
        tmp_path / "a", 0.6, seed=7, progress=lambda done, of: steps.append((done, of))
    )
    assert [p.name for p in paths] == [f"speaker_0{i}_take_01.csv" for i in (1, 2, 3, 4)]
    assert steps == [(1, 4), (2, 4), (3, 4), (4, 4)]
    rows = sum(len(p.read_text().splitlines()) - 1 for p in paths)
    assert rows == 0.6 * 60 * 60
    again = synthesis.write_performances(tmp_path / "b", 0.6, seed=7)
    assert [p.read_bytes() for p in again] == [p.read_bytes() for p in paths]


def test_without_espeak_one_line_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    phonemes._espeak.cache_clear()
    with pytest.raises(Unavailable, match="install it") as caught:
        synthesize(1.0, seed=0)
    assert "\n" not in str(caught.value)


def test_a_file_in_place_of_the_folder_is_reported(tmp_path: Path) -> None:
    (tmp_path / "x").write_text("")
    with pytest.raises(FileError, match="cannot be made"):
        synthesis.write_performances(tmp_path / "x", 0.1, seed=0)


def test_minutes_must_be_positive(tmp_path: Path) -> None:
    with pytest.raises(FaceEditError, match="minutes"):
        synthesis.write_performances(tmp_path, 0.0, seed=0)


def test_statistics_find_what_was_put_in() -> None:
    times = np.arange(0, 20, 1 / RATE)
    weights = np.zeros((len(times), 52), np.float32)
    weights[:, JAW] = 0.2 - 0.2 * np.cos(2 * np.pi * 2.0 * times)
    lids = eyes.lids(times, [Blink(1.0 + 4.0 * i) for i in range(5)])
    weights[:, [BLINK_LEFT, BLINK_RIGHT]] = lids
    figures = statistics.measure([(times, weights)])
    assert figures.jaw_peaks == pytest.approx(2.0, rel=0.05)
    assert figures.closures == pytest.approx(120, rel=0.05)
    assert figures.blinks == pytest.approx(15, rel=0.05)
    assert figures.blink_peak == pytest.approx(1.0, abs=0.02)
    assert figures.jaw_above_4hz < 0.01
    assert np.isnan(figures.correlations["jawOpen", "mouthFunnel"])
    text = statistics.table({"made up": figures, "twice": figures})
    assert "lip closures a minute" in text
    assert "made up" in text
    assert "nan" not in text
    with pytest.raises(ValueError, match="one second"):
        statistics.measure([(times[:5], weights[:5])])


@pytest.fixture(scope="module")
def demo() -> Demo:
    lines = (ROOT / "assets" / "demo_take.csv").read_text().splitlines()
    rows = [line.split(",") for line in lines[1:]]
    return lines[0].split(","), rows, np.array([[float(v) for v in row[2:]] for row in rows])


def test_demo_take_is_what_its_command_builds(demo: Demo, tmp_path: Path) -> None:
    path = tmp_path / "demo.csv"
    synthesis.write_livelink(path, demo_take.build()[1], demo_take.RATE, demo_take.START)
    built = [line.split(",") for line in path.read_text().splitlines()]
    assert built[0] == demo[0]
    assert [row[:2] for row in built[1:]] == [row[:2] for row in demo[1]]
    # Other processors may round the last digit of a float32 differently.
    np.testing.assert_allclose(
        [[float(v) for v in row[2:]] for row in built[1:]], demo[2], atol=1e-6
    )


def test_demo_take_has_something_to_repair(demo: Demo) -> None:
    header, rows, values = demo
    assert values.shape == (600, 61)
    assert {row[1] for row in rows} == {"61"}
    column = {name: values[:, i - 2] for i, name in enumerate(header) if i >= 2}
    weights = values[:, :52]
    assert weights.min() >= 0
    assert weights.max() <= 1
    gap = column["JawOpen"] - column["MouthClose"]
    assert gap.min() >= 0
    times = np.arange(600) / RATE
    peaks = [column["EyeBlinkLeft"][(times > b.start) & (times < b.start + 0.4)].max()
             for b in demo_take.BLINKS]  # fmt: skip
    assert min(peaks[0], peaks[2]) > 0.95
    assert 0.4 < peaks[1] < 0.65
    said = demo_take.script()
    bilabials = [i for i, p in enumerate(said.phonemes) if p.symbol in "pbm"]
    assert len(bilabials) >= 8
    closed = {i: gap[(times >= said.span(i)[0]) & (times <= said.span(i)[1])].min()
              for i in bilabials}  # fmt: skip
    assert closed.pop(said.open_closure) > 0.04
    assert max(closed.values()) < 0.02
    assert 0.25 < column["MouthSmileLeft"][times > 9].mean() < 0.5
    assert column["EyeLookOutLeft"].max() > 0.1
    assert column["EyeLookDownLeft"].max() > 0.2

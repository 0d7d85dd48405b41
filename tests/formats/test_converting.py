"""From any source to another format or frame rate, as other readers find it."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support import recordings
from support.chance import TIMES
from support.dialects import drop_frame, milliseconds_of_the_second, running_number
from support.takes import livelink_names, make_livelink_csv, make_plain_csv

from faceedit_app.cli import main
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.clip import Clip
from faceedit_app.formats.converting import converted
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.registry import Format, writable
from faceedit_app.formats.take import Take

WEIGHTS = recordings.face(60)

FORMATS = {form.key: form for form in writable()}


def convert(path: Path, take: Take, form: Format, rate: float | None = None) -> Clip:
    """Write a take in a format; returns its clip as written."""
    found = converted(path, take, form, rate)
    path.write_bytes(found.content)
    return found.clip


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "take.txt"
    path.write_text(recordings.facecap(WEIGHTS))
    return path


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Take:
    """80 s at 30 fps: long enough to tell 59.94 fps from 60."""
    path = tmp_path_factory.mktemp("long") / "take.csv"
    channels = ("jawOpen", "mouthClose", "mouthFunnel", "mouthSmileLeft", "eyeBlinkLeft")
    return open_take(make_plain_csv(path, 80, 30, channels))


def test_a_live_link_face_csv_is_as_the_application_writes_it(source: Path) -> None:
    out = source.with_name("out.csv")
    convert(out, open_take(source), FORMATS["livelink"])
    with out.open(newline="") as file:
        header, *rows = csv.reader(file)
    example = make_livelink_csv(source.with_name("app.csv")).read_text().splitlines()[0]
    assert ",".join(header).lower() == example.lower()
    assert header[2:54] == livelink_names()
    assert {len(row) for row in rows} == {63}
    assert [row[0] for row in rows[29:32]] == [
        "00:00:00:58.000",
        "00:00:01:00.000",
        "00:00:01:02.000",
    ]
    assert {row[1] for row in rows} == {"61"}
    column = header.index("MouthSmileLeft")
    wanted = open_take(source).clip.arkit_weights()[:, ARKIT_CHANNELS.index("mouthSmileLeft")]
    assert np.allclose([float(row[column]) for row in rows], wanted, atol=1e-9)


def test_an_audio2face_export_has_its_own_layout(source: Path) -> None:
    out = source.with_name("out.json")
    convert(out, open_take(source), FORMATS["audio2face"])
    document = json.loads(out.read_text())
    assert document["exportFps"] == 30
    assert (document["numPoses"], document["numFrames"]) == (52, 60)
    assert document["facsNames"] == list(ARKIT_CHANNELS)
    assert np.allclose(document["weightMat"], open_take(source).clip.arkit_weights(), atol=1e-6)


@pytest.mark.parametrize("rate", [24, 25, 30, 48, 50, 60, 30000 / 1001, 24000 / 1001, 60000 / 1001])
@pytest.mark.parametrize("key", [form.key for form in writable()])
def test_what_is_written_opens_at_the_rate_that_was_asked_for(
    tmp_path: Path, long: Take, key: str, rate: float
) -> None:
    form = FORMATS[key]
    out = tmp_path / f"out{form.endings[0]}"
    written = convert(out, long, form, rate)
    clip = open_take(out).clip
    assert clip.rate == pytest.approx(rate, rel=1e-6)
    assert clip.duration == pytest.approx(80, abs=1 / rate)
    assert clip.gaps == ()
    assert np.allclose(clip.arkit_weights(), written.arkit_weights(), atol=6e-6)


@settings(
    deadline=None,
    derandomize=True,
    max_examples=15 * TIMES,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data())
def test_weights_and_gaps_survive_every_way_round(tmp_path: Path, data: st.DataObject) -> None:
    lost = data.draw(st.sets(st.integers(2, 115), max_size=8))
    path = make_livelink_csv(tmp_path / "take.csv", rate=60, seconds=2, dropped=lost)
    clip = before = open_take(path).clip
    for form in data.draw(st.lists(st.sampled_from(["livelink", "csv"]), min_size=1, max_size=4)):
        out = tmp_path / "out.csv"
        convert(out, open_take(path), FORMATS[form])
        path = out.rename(tmp_path / "next.csv")
        clip = open_take(path).clip
    assert np.allclose(clip.arkit_weights(), before.arkit_weights(), atol=2e-6)
    assert clip.gaps == before.gaps
    assert clip.rate == before.rate


def test_gaps_stay_gaps_at_another_rate_and_are_drawn_in_where_there_are_no_times(
    tmp_path: Path,
) -> None:
    lost = range(60, 90)
    take = open_take(make_livelink_csv(tmp_path / "take.csv", seconds=3, untracked=lost))
    slower = convert(tmp_path / "a.csv", take, FORMATS["csv"], 30)
    assert [(gap.frame, gap.missing) for gap in slower.gaps] == [(29, 15)]
    whole = convert(tmp_path / "a.json", take, FORMATS["audio2face"])
    assert len(whole) == 180
    assert whole.gaps == ()


def test_a_timecode_goes_on_from_where_the_recording_began(tmp_path: Path) -> None:
    take = open_take(make_livelink_csv(tmp_path / "take.csv", seconds=2))
    convert(tmp_path / "out.csv", take, FORMATS["livelink"], 30)
    assert (tmp_path / "out.csv").read_text().splitlines()[1].startswith("12:00:00:00.169,61,")


def test_the_own_format_at_the_own_rate_is_byte_for_byte(tmp_path: Path) -> None:
    path = make_livelink_csv(tmp_path / "take.csv", extra={"Angry": "x"})
    assert main(["convert", str(path), str(tmp_path / "out.csv")]) == 0
    assert (tmp_path / "out.csv").read_bytes() == path.read_bytes()


@pytest.mark.parametrize(
    ("options", "rate", "is_said"),
    [
        (["--take-fps", "50"], 60, True),
        (["--take-fps", "60"], 60, False),
        (["--take-fps", "50", "--fps", "50"], 50, False),
        (["--take-fps", "50", "--format", "livelink"], 50, False),
    ],
)
def test_a_rate_that_the_user_gave_is_written_or_said_not_to_be(
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    options: list[str],
    rate: float,
    is_said: bool,
) -> None:
    path, out = make_livelink_csv(tmp_path / "take.csv"), tmp_path / "out.csv"
    assert main(["convert", str(path), str(out), *options]) == 0
    assert open_take(out).clip.rate == rate
    said = "keeps the take's own times, which say 60 fps and not 50 fps"
    assert (said in capfd.readouterr().out) is is_said


def test_the_command_says_what_it_wrote_and_what_it_left_out(
    source: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = source.with_name("out.csv")
    assert main(["convert", str(source), str(out), "--fps", "60", "--format", "csv"]) == 0
    said = capfd.readouterr().out
    assert "CSV with ARKit names, 120 frames at 60 fps" in said
    assert "left out because they are not channels: k, headX" in said
    assert open_take(out).clip.rate == 60


def test_a_take_without_times_is_converted_frame_by_frame(tmp_path: Path) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    path.write_text("jawOpen\n" + "".join(f"{0.01 * n:.2f}\n" for n in range(50)))
    assert main(["convert", str(path), str(out)]) == 2
    assert main(["convert", str(path), str(out), "--fps", "24"]) == 0
    assert (len(open_take(out).clip), open_take(out).clip.rate) == (50, 24)
    assert main(["convert", str(path), str(out), "--take-fps", "50", "--fps", "25"]) == 0
    assert (len(open_take(out).clip), open_take(out).clip.rate) == (25, 25)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["out.xyz"], "no format with this ending can be written"),
        (["out.csv", "--format", "bvh"], "must be one of livelink, csv, audio2face, glb, fbx, usd"),
        (["out.csv", "--fps", "0"], "frames per second"),
    ],
)
def test_what_cannot_be_converted_is_said_in_one_line(
    source: Path, options: list[str], says: str, capfd: pytest.CaptureFixture[str]
) -> None:
    assert main(["convert", str(source), *options]) == 2
    error = capfd.readouterr().err
    assert says in error
    assert len(error.splitlines()) == 1


def test_the_rotations_of_head_and_eyes_survive_another_rate(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    names = [p + a for p in ("Head", "LeftEye", "RightEye") for a in ("Yaw", "Pitch", "Roll")]
    turns = np.linspace(-0.5, 0.5, 9 * 60).reshape(60, 9)
    header = ["Timecode", "BlendshapeCount", *livelink_names(), *names]
    lines = [",".join(header)]
    for frame, row in enumerate(turns):
        cells = ["0.25"] * 52 + [f"{value:.6f}" for value in row]
        lines.append(",".join([f"10:00:00:{frame:02d}.000", "61", *cells]))
    take = tmp_path / "take.csv"
    take.write_text("\n".join(lines) + "\n")
    assert main(["convert", str(take), str(tmp_path / "out.csv"), "--fps", "30"]) == 0
    assert "left out" not in capfd.readouterr().out
    with (tmp_path / "out.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    found = np.array([[float(row[name]) for name in names] for row in rows])
    np.testing.assert_allclose(found[1:-1], turns[2:-2:2], atol=1e-5)
    assert main(["convert", str(take), str(tmp_path / "out.glb")]) == 0
    said = capfd.readouterr().out
    assert "the eyes look where their weights say; their rotations are left out: LeftEye" in said
    assert "not channels" not in said
    assert "the head is straight; --follow-head turns it as recorded" in said
    assert main(["convert", str(take), str(tmp_path / "out.glb"), "--follow-head"]) == 0
    assert "the head is straight" not in capfd.readouterr().out
    assert main(["convert", str(take), str(tmp_path / "out.json")]) == 0
    without = "are left out, as Audio2Face JSON has no place for them: HeadYaw"
    assert without in capfd.readouterr().out


@pytest.mark.parametrize("numerator", [24000, 30000, 48000, 60000, 120000])
@pytest.mark.parametrize("frames", [100, 300, 2500])
def test_a_broadcast_rate_survives_a_live_link_face_csv(
    tmp_path: Path, numerator: int, frames: int
) -> None:
    rate = numerator / 1001
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    rows = "".join(f"{n / rate:.6f},{0.01 * (n % 50):.3f}\n" for n in range(frames))
    path.write_text(f"time_s,jawOpen\n{rows}")
    take = open_take(path)
    convert(out, take, FORMATS["livelink"])
    again = open_take(out).clip
    assert again.rate == pytest.approx(rate, abs=1e-3)
    assert again.gaps == ()
    assert np.allclose(again.times, take.clip.times, atol=1e-4)


@pytest.mark.parametrize("ending", [".ndjson", ".txt"])
def test_convert_writes_what_only_its_own_format_ends_in(tmp_path: Path, ending: str) -> None:
    """Such a file can be written only from a take of that format."""
    lines = (json.dumps({"time": k / 25, "weights": {"jawOpen": k / 100}}) for k in range(50))
    take, out = tmp_path / f"take{ending}", tmp_path / f"out{ending}"
    take.write_text("\n".join(lines))
    assert main(["convert", str(take), str(out)]) == 0
    assert out.read_bytes() == take.read_bytes()
    assert main(["convert", str(take), str(tmp_path / f"sixty{ending}"), "--fps", "60"]) == 2


@pytest.mark.parametrize(
    ("texts", "begins"),
    [
        ([running_number(n + 849, 30) for n in range(40)], "00:00:28:20.000"),
        ([milliseconds_of_the_second(n + 850, 30) for n in range(40)], "00:00:28:20.000"),
        ([drop_frame(n + 1000, ";") for n in range(2000)], "00:00:33:22.000"),
        ([drop_frame(n + 1000, ":") for n in range(2000)], "00:00:33:22.000"),
        ([f"{n * 1.001 / 24:.6f}" for n in range(40)], "00:00:00:00.000"),
        ([f"{n * 1.001 / 60:.6f}" for n in range(40)], "00:00:00:00.000"),
    ],
)
def test_a_timecode_begins_at_what_its_digits_mean(
    tmp_path: Path, texts: list[str], begins: str
) -> None:
    name = "tc" if ":" in texts[0] else "time_s"
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    rows = "".join(f"{text},{k / 5000}\n" for k, text in enumerate(texts))
    path.write_text(f"{name},jawOpen\n{rows}")
    take = open_take(path)
    convert(out, take, FORMATS["livelink"])
    assert out.read_text().splitlines()[1].partition(",")[0] == begins
    assert open_take(out).clip.rate == pytest.approx(take.clip.rate, abs=1e-3)

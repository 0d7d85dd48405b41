"""Packages that run when they are used, and what drawing therefore does not import."""

from __future__ import annotations

import inspect
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from pathlib import Path
from threading import Barrier

import pytest
from support.places import ROOT

from faceedit_app.render.lazy import lazily

BODY = """
from . import first
for _ in range(10_000):  # so that another thread asks meanwhile
    pass
LATER = first.VALUE + 1
"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A package of two modules whose own code imports one of them."""
    folder = tmp_path / "lazy_example"
    folder.mkdir()
    (folder / "__init__.py").write_text(BODY, encoding="utf-8")
    (folder / "first.py").write_text("VALUE = 1", encoding="utf-8")
    (folder / "second.py").write_text("from . import LATER", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    yield folder.name
    for name in [name for name in sys.modules if name.startswith(folder.name)]:
        del sys.modules[name]


def has_run(package: str) -> bool:
    return "LATER" in vars(sys.modules[package])


def test_a_module_is_imported_without_its_package(package: str) -> None:
    with lazily(package):
        assert import_module(f"{package}.first").VALUE == 1
    assert not has_run(package)


def test_a_package_runs_when_it_is_used(package: str) -> None:
    with lazily(package):
        pass
    assert import_module(package).LATER == 2
    assert not hasattr(sys.modules[package], "EARLIER")


def test_looking_at_a_package_does_not_run_it(package: str) -> None:
    with lazily(package):
        pass
    assert not hasattr(sys.modules[package], "__wrapped__")
    assert inspect.getsource(sys.modules[package]) == BODY
    assert not has_run(package)


def test_a_package_runs_before_other_modules_of_it(package: str) -> None:
    with lazily(package):
        pass
    assert import_module(f"{package}.second").LATER == 2
    assert has_run(package)


def test_a_package_that_fails_can_be_tried_again(package: str, tmp_path: Path) -> None:
    content = tmp_path / package / "__init__.py"
    content.write_text("raise ImportError('not now')", encoding="utf-8")
    with lazily(package):
        pass
    for _ in range(2):
        with pytest.raises(ImportError, match="not now"):
            sys.modules[package].LATER  # noqa: B018


def test_threads_that_use_a_package_at_once_all_find_it_complete(package: str) -> None:
    with lazily(package):
        pass
    at_once = Barrier(4)

    def use(_: int) -> int:
        at_once.wait()
        found: int = sys.modules[package].LATER
        return found

    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(use, range(4))) == [2] * 4


def test_a_package_in_a_package_is_lazy_too(package: str, tmp_path: Path) -> None:
    folder = tmp_path / package
    (folder / "__init__.py").write_text("from . import inner", encoding="utf-8")
    (folder / "inner").mkdir()
    (folder / "inner" / "__init__.py").write_text("LATER = 3", encoding="utf-8")
    outer = import_module(package)
    del outer.inner, sys.modules[f"{package}.inner"]
    with lazily(f"{package}.inner"):
        assert import_module(package).inner is sys.modules[f"{package}.inner"]
    assert not has_run(f"{package}.inner")
    assert outer.inner.LATER == 3


def test_what_runs_already_stays(package: str) -> None:
    running = import_module(package)
    with lazily(package):
        assert import_module(package) is running
    assert import_module(f"{package}.second").LATER == 2


def test_a_package_that_is_missing_is_reported() -> None:
    with lazily("no_such_package"), pytest.raises(ModuleNotFoundError, match="no_such_package"):
        import_module("no_such_package.part")


def test_drawing_imports_no_viewer_and_no_readers_of_meshes() -> None:
    """They would take a quarter of the time until the face is there, and 50 MB."""
    code = """
import sys
from PySide6.QtCore import QObject  # from now on, it looks at all modules
from faceedit_app.ui.state.loading import prepare_renderer
prepare_renderer()
assert "faceedit_app.render.studio" in sys.modules, "not prepared"
heavy = {"pyglet", "imageio", "tkinter", "trimesh.base", "networkx", "torch"}
heavy |= {"scipy._lib", "scipy.sparse._base", "unittest", "numpy.f2py.f2py2e"}
print(sorted(heavy & set(sys.modules)))
import numpy, pyrender, trimesh
assert numpy.testing.assert_allclose
assert pyrender.Viewer and trimesh.Trimesh
"""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "[]"

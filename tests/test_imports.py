"""What the application imports is declared; and each import in a function saves something."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from support.places import ROOT

FOR_DEVELOPERS = ("dev", "packaging")
# What is loaded until the window is there, for `faceedit --help`, and then in the background; and
# what measures all that. Imports in functions save time there.
STARTS = (
    "faceedit_app.cli",
    "faceedit_app.command_line.app",
    "faceedit_app.ui.start.app",
    "faceedit_app.ui.state.loading",
    "faceedit_app.editing.opening",
    "faceedit_app.ui.page.editor",
    "faceedit_app.render.contexts",
    "faceedit_app.render.renderer",
    "faceedit_app.lab.bench.starting",
)


def _imports(node: ast.AST, where: str = "module") -> Iterator[tuple[str, ast.stmt]]:
    """Imports that are run, and whether in the "module", in a "function", or only "tried"."""
    if isinstance(node, ast.Import | ast.ImportFrom):
        yield where, node
        return
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
        children: list[ast.AST] = list(node.orelse)
    else:
        children = list(ast.iter_child_nodes(node))
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        where = "function"
    elif isinstance(node, ast.Try) and "ImportError" in "".join(map(ast.unparse, node.handlers)):
        where = "tried"  # some systems lack it
    for child in children:
        if isinstance(child, ast.stmt | ast.ExceptHandler | ast.match_case):
            yield from _imports(child, where)


class Modules:
    """The application's modules and what each imports.

    Attributes:
        paths: their files.
        at_once: what each imports when it is loaded.
        in_functions: what each imports in a function later: its name, the line, what.
        libraries: all that is imported from outside, and a file that does.
    """

    def __init__(self, folder: Path) -> None:
        self.paths = {}
        for path in folder.rglob("*.py"):
            parts = path.relative_to(folder.parent).with_suffix("").parts
            self.paths[".".join(parts).removesuffix(".__init__")] = path
        self.at_once: dict[str, set[str]] = {}
        self.in_functions: list[tuple[str, int, set[str]]] = []
        self.libraries: dict[str, Path] = {}
        for name, path in self.paths.items():
            self.at_once[name] = set()
            for where, node in _imports(ast.parse(path.read_text(encoding="utf-8"))):
                named = self._named(node)
                self.libraries |= {one.partition(".")[0]: path for one in named if _is_library(one)}
                if where == "function":
                    self.in_functions.append((name, node.lineno, named))
                elif where == "module":
                    self.at_once[name] |= named
        self.loaded = cache(self._loaded)

    def _named(self, node: ast.stmt) -> set[str]:
        if isinstance(node, ast.Import):
            return {alias.name for alias in node.names}
        assert isinstance(node, ast.ImportFrom)
        assert node.module is not None
        names = (f"{node.module}.{alias.name}" for alias in node.names)
        return {name if name in self.paths else node.module for name in names}

    def _loaded(self, name: str) -> set[str]:
        """All modules that are in memory once this one is imported."""
        found: set[str] = set()
        fresh = [name]
        while fresh:
            module = fresh.pop()
            if module not in found:
                found.add(module)
                fresh += self.at_once.get(module, ())
                if "." in module:
                    fresh.append(module.rpartition(".")[0])
        return found


def _is_library(module: str) -> bool:
    top = module.partition(".")[0]
    return top != "faceedit_app" and top not in sys.stdlib_module_names


def _savings(modules: Modules, name: str, wanted: set[str]) -> set[str]:
    """What an import in a function of a module leaves for later."""
    needed = set().union(*map(modules.loaded, wanted))
    starts = [start for start in STARTS if name in modules.loaded(start)]
    if starts:
        return set().union(*(needed - modules.loaded(start) for start in starts))
    return {module for module in needed - modules.loaded(name) if _is_library(module)}


@pytest.fixture(scope="module")
def modules() -> Modules:
    return Modules(ROOT / "faceedit_app")


def test_every_library_that_is_imported_is_declared(modules: Modules) -> None:
    """A library that only a tool for developers brings along is missing for the users."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    wanted = list(project["dependencies"])
    wanted += [w for name, some in extras.items() if name not in FOR_DEVELOPERS for w in some]
    declared = {re.split(r"[\s<>=!~\[;]", w)[0].lower().replace("_", "-") for w in wanted}
    providers = packages_distributions()
    assert {"numpy", "torch", "dask"} <= set(modules.libraries)
    for library, path in modules.libraries.items():
        names = {name.lower().replace("_", "-") for name in providers.get(library, [library])}
        assert names & declared, f"{path} imports {library} of {names}"


def test_an_import_in_a_function_saves_something(modules: Modules) -> None:
    """Where it does not, it belongs at the top, where readers look for it."""
    assert len(modules.in_functions) > 200
    assert set(STARTS) <= set(modules.paths)
    useless = [
        f"{modules.paths[name]}:{line} imports {', '.join(sorted(wanted))} in a function"
        for name, line, wanted in modules.in_functions
        if not _savings(modules, name, wanted)
    ]
    assert not useless


def test_takes_are_exported_without_what_characters_need(modules: Modules) -> None:
    """It takes longer to import than anything else that a batch or a command does."""
    loaded = {name.partition(".")[0] for name in modules.loaded("faceedit_app.batch.tasks")}
    assert "numpy" in loaded
    assert not {"scipy", "trimesh", "pygltflib"} & loaded


def test_what_saves_nothing_is_found(tmp_path: Path) -> None:
    folder = tmp_path / "faceedit_app"
    folder.mkdir()
    for name, text in {
        "__init__": "",
        "light": "import json",
        "heavy": "import numpy",
        "user": "def f():\n    from faceedit_app import light\n    from faceedit_app import heavy",
    }.items():
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
    modules = Modules(folder)
    found = {line: _savings(modules, name, wanted) for name, line, wanted in modules.in_functions}
    assert found == {2: set(), 3: {"numpy"}}

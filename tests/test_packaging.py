"""What can be said of the installers without building them; `make package` tries them."""

from __future__ import annotations

import ast
import configparser
import importlib.util
import json
import re
import shutil
import subprocess
import sys
import tomllib
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest
import typer
from support.faces import random_engine
from support.windows import Bench

import faceedit_app
from faceedit_app.cli import main
from faceedit_app.command_line.app import build_app
from faceedit_app.core import optional
from faceedit_app.core.errors import Unavailable
from faceedit_app.core.optional import require
from faceedit_app.formats.registry import mime_types, offered_endings
from faceedit_app.ui.start import smoke
from faceedit_app.ui.state import loading

ROOT = Path(__file__).resolve().parent.parent
PACKAGING = ROOT / "packaging"
LINUX = PACKAGING / "linux"
Tool = Callable[[str], ModuleType]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


@pytest.fixture
def tool(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], ModuleType]:
    """Imports a script of packaging/ by name."""
    monkeypatch.syspath_prepend(str(PACKAGING))
    return _loaded


@cache  # licences.py looks once at every installed file, which takes seconds
def _loaded(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"packaging_{name}", PACKAGING / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


# --- one version, complete metadata ----------------------------------------------------------


def test_the_changelog_knows_this_version() -> None:
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    releases = re.findall(r"^## \[?(\d[\w.]*)\]? - \d{4}-\d\d-\d\d$", changes, re.MULTILINE)
    assert releases[0] == faceedit_app.__version__


def test_the_version_is_written_in_one_place() -> None:
    assert PROJECT["project"]["dynamic"] == ["version"]
    assert PROJECT["tool"]["hatch"]["version"]["path"] == "faceedit_app/__init__.py"
    files = [p for p in PACKAGING.rglob("*") if p.is_file() and p.suffix != ".pyc"]
    assert len(files) > 5
    for path in files:
        assert faceedit_app.__version__ not in path.read_text(encoding="utf-8"), path


def test_appstream_names_this_release_and_existing_things(tool: Tool) -> None:
    template = (LINUX / "faceedit.metainfo.xml.in").read_text(encoding="utf-8")
    root = ElementTree.fromstring(tool("build").describe(template))
    release = root.find("releases/release")
    assert release is not None
    assert release.get("version") == faceedit_app.__version__
    assert re.fullmatch(r"\d{4}-\d\d-\d\d", release.get("date") or "")
    assert root.findtext("launchable") == "faceedit.desktop"
    assert root.findtext("project_license") == PROJECT["project"]["license"]


def test_the_desktop_entry_opens_what_the_application_can(tool: Tool) -> None:
    entry = configparser.ConfigParser(interpolation=None)
    entry.optionxform = str  # type: ignore[assignment,method-assign]
    text = (LINUX / "faceedit.desktop.in").read_text(encoding="utf-8")
    entry.read_string(tool("build").describe(text))
    desktop = entry["Desktop Entry"]
    types = desktop["MimeType"].rstrip(";").split(";")
    mime = ElementTree.parse(LINUX / "faceedit.mime.xml").getroot()
    ours = {str(node.get("type")) for node in mime if node.tag.endswith("mime-type")}
    assert ours <= set(types)
    assert {*types} == {*ours, *mime_types()}
    metainfo = (LINUX / "faceedit.metainfo.xml.in").read_text(encoding="utf-8")
    root = ElementTree.fromstring(tool("build").describe(metainfo))
    assert {node.text for node in root.iter("mediatype")} == {*types}
    assert [node.get("pattern") for node in mime.iter() if node.tag.endswith("glob")] == [
        "*.faceedit"
    ]
    assert desktop["Exec"] == "faceedit %f"


def test_other_systems_offer_the_application_for_the_same_files(tool: Tool) -> None:
    template = (PACKAGING / "windows" / "faceedit.iss.in").read_text(encoding="utf-8")
    installer = tool("build").describe(template)
    assert re.findall(r'"Software\\Classes\\(\.\w+)\\OpenWith', installer) == [*offered_endings()]
    assert f"AppVersion={faceedit_app.__version__}\n" in installer
    assert not re.search("@[A-Z_]+@|#Version", installer), "each name has its value"
    kinds = tool("contents").macos_properties("1")["CFBundleDocumentTypes"]
    offered = [ending for kind in kinds for ending in kind.get("CFBundleTypeExtensions", [])]
    assert offered == [ending.lstrip(".") for ending in offered_endings()]


@pytest.mark.parametrize(
    ("program", "options", "file"),
    [
        ("desktop-file-validate", [], "faceedit.desktop.in"),
        ("appstreamcli", ["validate", "--no-net"], "faceedit.metainfo.xml.in"),
    ],
)
def test_desktops_accept_the_metadata(
    tool: Tool, tmp_path: Path, program: str, options: list[str], file: str
) -> None:
    if shutil.which(program) is None:
        pytest.skip(f"{program} is not installed")
    copy = tmp_path / file.removesuffix(".in")
    copy.write_text(tool("build").describe((LINUX / file).read_text(encoding="utf-8")), "utf-8")
    done = subprocess.run([program, *options, str(copy)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


# --- what is shipped -------------------------------------------------------------------------


def test_the_wheel_carries_every_file_that_the_code_asks_for() -> None:
    carried = PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    code = [p.read_text(encoding="utf-8") for p in (ROOT / "faceedit_app").rglob("*.py")]
    asked = {name for text in code for name in re.findall(r'shipped\("([^"]+)"\)', text)}
    asked |= {name for text in code for name in re.findall(r'"(assets/[\w.]+)"', text)}
    assert {"assets/character.glb", "assets/demo_take.csv", "models"} <= asked
    for name in asked:
        assert carried[name] == f"faceedit_app/shipped/{name}"
        assert (ROOT / name).exists()


def _imports(text: str) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        if isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def test_the_bundle_leaves_out_nothing_that_the_application_imports(tool: Tool) -> None:
    excluded = set(tool("contents").EXCLUDED)
    guarded = {
        ROOT / "faceedit_app" / "command_line" / name for name in ("laboratory.py", "attacks.py")
    }
    parts = [{*name.split(".")} for name in excluded]
    for path in (ROOT / "faceedit_app").rglob("*.py"):
        inside = path.relative_to(ROOT / "faceedit_app").as_posix()
        text = path.read_text(encoding="utf-8")
        if inside.startswith("lab/") or path in guarded:
            continue
        words = set(re.findall(r"\w+", text))
        if any(name <= words for name in parts):  # parsing all files would take seconds
            assert not _imports(text) & excluded, path


def test_the_face_is_drawn_without_what_the_bundle_leaves_out(tool: Tool) -> None:
    code = f"""
import sys
left_out = {tool("contents").EXCLUDED!r}
class LeftOut:
    def find_spec(self, name, path=None, target=None):
        if any(f"{{name}}.".startswith(f"{{other}}.") for other in left_out):
            raise ModuleNotFoundError(name, name=name)
sys.meta_path.insert(0, LeftOut())
import numpy as np
from faceedit_app.characters.glb import read_rig
from faceedit_app.core.errors import Unavailable
from faceedit_app.core.resources import CHARACTER, shipped
from faceedit_app.render.snapshot import snapshot
rig = read_rig(shipped(CHARACTER))
try:
    print(snapshot(rig, np.zeros(len(rig.channels), np.float32), 64, 64).max() > 100)
except Unavailable as error:
    print(error)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, encoding="utf-8", check=False
    )
    assert done.returncode == 0, done.stderr
    if "no OpenGL" in done.stdout:
        pytest.skip(done.stdout)
    assert done.stdout.strip() == "True"


def test_the_bundle_holds_what_a_window_needs(tool: Tool) -> None:
    is_wanted = tool("contents").is_wanted
    plugins = "PySide6/Qt/plugins"
    for name in (
        "faceedit_app/shipped/models/lower.onnx",
        "faceedit_app/render/shaders/face.frag",
        "faceedit_app/ui/look/icons/play.svg",
        f"{plugins}/platforms/libqxcb.so",
        f"{plugins}/platforms/libqwayland.so",
        f"{plugins}/platforms/libqoffscreen.so",
        f"{plugins}/imageformats/libqsvg.so",
        "PySide6\\plugins\\platforms\\qwindows.dll",
        "PySide6/Qt/lib/libQt6Core.so.6",
        "libpython3.11.so.1.0",
        "libxcb-cursor.so.0",
    ):
        assert is_wanted(name), name
    for name in (
        f"{plugins}/platforms/libqeglfs.so",
        f"{plugins}/platformthemes/libqgtk3.so",
        f"{plugins}/imageformats/libqtiff.so",
        "PySide6/Qt/translations/qtbase_de.qm",
        "libstdc++.so.6",
    ):
        assert not is_wanted(name), name


def test_links_to_what_was_left_out_go_too(tool: Tool) -> None:
    there = [("PySide6/Qt/lib/libA.so", "/x/libA.so", "BINARY")]
    links = [
        ("libA.so", "PySide6/Qt/lib/libA.so", "SYMLINK"),
        ("libB.so", "PySide6/Qt/lib/libB.so", "SYMLINK"),
        ("notes.txt", "/x/notes.txt", "DATA"),
    ]
    kept = tool("contents").without_dangling(links, there)
    assert [name for name, _, _ in kept] == ["libA.so", "notes.txt"]


def test_every_file_in_the_bundle_needs_a_licence(tool: Tool, tmp_path: Path) -> None:
    licences = tool("licences")
    numpy = Path(str(importlib.util.find_spec("numpy").origin))  # type: ignore[union-attr]
    title, text = licences._origin(numpy)
    assert title.startswith("numpy ")
    assert "Redistribution and use in source and binary forms" in text()
    title, _ = licences._origin(Path(str(json.__file__)))
    assert title.startswith("Python 3.")
    for made in ("work/base_library.zip", "stripped/python3.11/lib-dynload/_json.so"):
        assert licences._origin(tmp_path / made)[0].startswith("Python 3.")
    stray = tmp_path / "stray.so"
    stray.touch()
    with pytest.raises(licences.Unlicensed, match="unknown origin"):
        licences._origin(stray)


def test_the_bundle_says_what_is_in_it_and_only_that(tool: Tool) -> None:
    sources = [Path(str(importlib.util.find_spec(name).origin)) for name in ("numpy", "av")]  # type: ignore[union-attr]
    entries = tool("licences").metadata_of([*sources, ROOT / "faceedit_app/cli.py"])
    names = [name.partition("-")[0] for name, _, _ in entries]
    assert names == ["av", "numpy"]
    for name, source, kind in entries:
        assert name.endswith(".dist-info/METADATA")
        assert "License" in Path(source).read_text(encoding="utf-8")
        assert kind == "DATA"


# --- the smoke test --------------------------------------------------------------------------


def test_the_smoke_test_reads_what_the_window_writes(tool: Tool) -> None:
    test = tool("smoke_test")
    for name in ("EDITED", "EDITS", "PICTURE", "REPORT"):
        assert getattr(test, name) == getattr(smoke, name)
    assert f'"{smoke.VARIABLE}"' in (PACKAGING / "smoke_test.py").read_text(encoding="utf-8")


def test_the_smoke_test_sees_no_source_tree_and_no_virtual_environment(
    tool: Tool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setenv("VIRTUAL_ENV", sys.prefix)
    env = tool("smoke_test").environment(tmp_path, ":9")
    assert env["DISPLAY"] == ":9"
    assert not {"PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV"} & set(env)
    assert str(Path(sys.executable).parent) not in env["PATH"].split(":")
    assert all(str(ROOT) not in value for value in env.values())


def test_the_smoke_test_complains(tool: Tool, tmp_path: Path) -> None:
    test = tool("smoke_test")
    one, other = tmp_path / "one", tmp_path / "other"
    one.write_bytes(test.PNG + bytes(10))
    other.write_bytes(b"GIF")
    with pytest.raises(test.Failed, match="anything on it"):
        test.check_picture(one)
    with pytest.raises(test.Failed, match="no PNG"):
        test.check_picture(other)
    with pytest.raises(test.Failed, match="differs"):
        test.check_same(one, other)
    good = {"networks": True, "face_message": "", "torch": False}
    good |= {"changed_frames": 3, "face_drawn": 1}
    test.check_report(good)
    for wrong in ({"networks": False}, {"face_message": "no OpenGL"}, {"changed_frames": 0}):
        with pytest.raises(test.Failed, match=next(iter(wrong))):
            test.check_report(good | wrong)
    with pytest.raises(test.Failed, match="exit code 3: broken"):
        test.run(
            [sys.executable, "-c", "import sys; sys.stderr.write('broken'); sys.exit(3)"],
            test.environment(tmp_path),
            tmp_path,
        )


def test_a_window_that_works_by_itself(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(sys, "excepthook", sys.excepthook)  # restored afterwards
    monkeypatch.setattr(loading, "load_engine", lambda rig: random_engine())
    window = bench.window(start=False)
    folder = tmp_path / "smoke"
    folder.mkdir()
    smoke.play(window, folder)
    window.start(bench.take)
    bench.qtbot.waitUntil(lambda: not window.isVisible(), timeout=15_000)
    report = json.loads((folder / smoke.REPORT).read_text(encoding="utf-8"))
    assert report["changed_frames"] > 0
    assert report["networks"] is True
    assert report["version"] == faceedit_app.__version__
    assert (folder / smoke.EDITED).read_bytes() != bench.take.read_bytes()
    assert (folder / smoke.PICTURE).stat().st_size > 1000
    assert json.loads((folder / smoke.EDITS).read_text(encoding="utf-8"))["edits"]


# --- optional parts --------------------------------------------------------------------------


def test_a_missing_part_is_one_line_with_the_remedy(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    require("json", extra="training")
    with pytest.raises(Unavailable, match=r'needs nowhere.*pip install "faceedit\[training\]"'):
        require("nowhere.to.be.found", extra="training")
    monkeypatch.setattr(optional, "find_spec", lambda _name: None)
    for command in (["train", "--data", "takes"], ["evaluate", "takes"], ["statistics", "takes"]):
        assert main(command) == 2
        line = capsys.readouterr().err
        assert line.count("\n") == 1
        assert 'needs torch, which is not installed; pip install "faceedit[training]"' in line


def test_an_application_without_the_laboratory_says_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    command = typer.main.get_command(build_app(has_laboratory=False))
    monkeypatch.setattr(optional, "find_spec", lambda _name: None)
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    for given in (["train", "--data", "takes"], ["evaluate-words", "a.csv"], ["fuzz"]):
        with pytest.raises(Unavailable, match="leaves training out"):
            command(given, standalone_mode=False)
    command(["--help"], standalone_mode=False)
    out = capsys.readouterr().out
    assert "convert" in out
    assert "evaluate" not in out

"""Libraries and their licences come from the metadata of what is installed."""

from __future__ import annotations

import sys
from collections.abc import Callable
from email.message import Message
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest

from faceedit_app.core import licences


def package(folder: Path, name: str, *lines: str) -> None:
    info = folder / f"{name}-1.0.dist-info"
    info.mkdir(parents=True)
    head = ("Metadata-Version: 2.1", f"Name: {name}", "Version: 1.0")
    (info / "METADATA").write_text("\n".join([*head, *lines]) + "\n")


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Makes an environment in which only the packages named are installed."""
    monkeypatch.setattr(sys, "path", [str(tmp_path)])
    return lambda name, *lines: package(tmp_path, name, *lines)


def test_what_is_needed_is_followed_and_what_is_absent_left_out(
    install: Callable[..., None],
) -> None:
    install(
        "faceedit",
        "Requires-Dist: Some_Lib>=2,<3",
        'Requires-Dist: elsewhere; sys_platform == "other"',
        'Requires-Dist: developers-only; extra == "dev"',
    )
    install("some.lib", "License-Expression: MIT", "Requires-Dist: deeper (>=1)")
    bsd = "Classifier: License :: OSI Approved :: BSD License"
    install("deeper", bsd, "Requires-Dist: some-lib")
    install("developers-only", "License: GPL")
    found = licences.libraries()
    assert [(library.name, library.licence) for library in found] == [
        ("deeper", "BSD License"),
        ("some.lib", "MIT"),
    ]
    assert {library.version for library in found} == {"1.0"}


def test_a_source_tree_that_was_never_installed_lists_nothing(
    install: Callable[..., None],
) -> None:
    assert licences.libraries() == []


@pytest.mark.parametrize(
    ("fields", "name"),
    [
        ({"License": "MIT"}, "MIT"),
        ({"License": "Apache 2.0", "License-Expression": "Apache-2.0"}, "Apache-2.0"),
        ({"License": "Copyright (c)\nPermission is hereby granted"}, "see its licence file"),
        ({}, "see its licence file"),
        ({"License": "x" * 200, "Classifier": "License :: OSI Approved :: MIT License"},
         "MIT License"),
    ],
)  # fmt: skip
def test_a_licence_is_named_not_quoted(fields: dict[str, str], name: str) -> None:
    about: Any = Message()
    for key, value in fields.items():
        about[key] = value
    assert licences.licence_name(about) == name


def test_every_library_here_has_a_licence() -> None:
    found = {library.name: library.licence for library in licences.libraries()}
    assert metadata.version("numpy")
    assert {"numpy", "PySide6_Essentials", "pyqtgraph", "av", "onnxruntime"} <= set(found)
    assert all(found.values())

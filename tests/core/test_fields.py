"""Fields of JSON files: what is right comes back as it is, what is wrong is named."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import Any

import pytest

from faceedit_app.core import fields as module
from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import FieldError, Fields, clean_text, parse, read_document, to_text


class Color(StrEnum):
    RED = "red"
    BLUE = "blue"


Read = Callable[[Fields], Any]
GOOD: list[tuple[Any, Read, Any]] = [
    (1.5, lambda f: f.number("x"), 1.5),
    (7, lambda f: f.number("x", low=0, high=7), 7.0),
    (7, lambda f: f.number_or_none("x"), 7.0),
    (7, lambda f: f.whole("x"), 7),
    ("é", lambda f: f.text("x"), "é"),
    ("a/é.csv", lambda f: f.path("x"), "a/é.csv"),
    (False, lambda f: f.flag("x"), False),
    ("red", lambda f: f.choice("x", Color), Color.RED),
    (None, lambda f: f.choice_or_none("x", Color), None),
    ([1, "a"], lambda f: f.items("x"), [1, "a"]),
    (["a", "b"], lambda f: f.texts("x"), ("a", "b")),
    ([[1, 2], [3, 4.5]], lambda f: f.pairs("x"), ((1.0, 2.0), (3.0, 4.5))),
    ([1, 2], lambda f: f.span("x"), (1.0, 2.0)),
    (None, lambda f: f.span("x"), None),
    ({"y": 3}, lambda f: f.fields("x").number("y"), 3.0),
    (None, lambda f: f.fields_or_none("x"), None),
    ({"a": [1, {"b": None}]}, lambda f: f.plain("x"), {"a": [1, {"b": None}]}),
]
ABSENT: list[tuple[Read, Any]] = [
    (lambda f: f.number("x", 2.0), 2.0),
    (lambda f: f.number_or_none("x"), None),
    (lambda f: f.text("x", ""), ""),
    (lambda f: f.flag("x", False), False),
    (lambda f: f.choice("x", Color, Color.BLUE), Color.BLUE),
    (lambda f: f.choice_or_none("x", Color), None),
    (lambda f: f.items("x", []), []),
    (lambda f: f.pairs("x"), ()),
    (lambda f: f.span("x"), None),
    (lambda f: f.fields_or_none("x"), None),
    (lambda f: f.plain("x"), {}),
]
NUMBERS = (float("nan"), float("inf"), -float("inf"), 1e7, 10**400, "1", True, None, [1])
BAD: list[tuple[Any, Read, str]] = [
    *((value, lambda f: f.number("x"), "") for value in NUMBERS),
    *((value, lambda f: f.number_or_none("x"), "") for value in NUMBERS),
    *((value, lambda f: f.whole("x"), "") for value in (*NUMBERS[3:], 1.0, -1)),
    *(([0, value], lambda f: f.span("x"), "") for value in NUMBERS),
    *(([[0, value]], lambda f: f.pairs("x"), "") for value in NUMBERS),
    (8, lambda f: f.number("x", low=0, high=7), "must be between 0 and 7"),
    ([2, 1], lambda f: f.span("x"), "ends before it begins"),
    ([1], lambda f: f.span("x"), "pairs of numbers"),
    ([[1, 2, 3]], lambda f: f.pairs("x"), "pairs of numbers"),
    ([[1, 2]] * 3, lambda f: f.pairs("x", most=2), "more than 2"),
    (1, lambda f: f.text("x"), "not text"),
    ("x" * 1001, lambda f: f.text("x"), "longer than 1,000"),
    ("\ud800", lambda f: f.text("x"), "damaged"),
    (["\ud800"], lambda f: f.texts("x"), "damaged"),
    (["a", 1], lambda f: f.texts("x"), "not text"),
    ("", lambda f: f.path("x"), "not a path"),
    ("a\0b", lambda f: f.path("x"), "not a path"),
    ("\ud800", lambda f: f.path("x"), "not a path"),
    ("x" * 40_000, lambda f: f.path("x"), "not a path"),
    (7, lambda f: f.path("x"), "not a path"),
    (0, lambda f: f.flag("x"), "neither true nor false"),
    ("green", lambda f: f.choice("x", Color), "one of red, blue"),
    (["red"], lambda f: f.choice("x", Color), "one of red, blue"),
    ("green", lambda f: f.choice_or_none("x", Color), "one of red, blue"),
    ({}, lambda f: f.items("x"), "not a list"),
    ([1, 2, 3], lambda f: f.items("x", most=2), "more than 2"),
    ([], lambda f: f.fields("x"), "not an object"),
    ([], lambda f: f.fields_or_none("x"), "not an object"),
    ([], lambda f: f.plain("x"), "not an object"),
    ({"a": [float("nan")]}, lambda f: f.plain("x"), "number"),
    ({"a": 1e300}, lambda f: f.plain("x"), "number"),
    ({"a": [1] * 200_000}, lambda f: f.plain("x"), "too much"),
    ({"a": "\ud800"}, lambda f: f.plain("x"), "damaged"),
    ({"\ud800": 1}, lambda f: f.plain("x"), "damaged"),
    ({"a": [[[[[[[[]]]]]]]]}, lambda f: f.plain("x"), "too much"),
]


@pytest.mark.parametrize("number", range(len(GOOD)))
def test_good_field_comes_back(number: int) -> None:
    value, read, expected = GOOD[number]
    fields = Fields({"x": value})
    found = read(fields)
    assert found == expected
    assert type(found) is type(expected)
    fields.finish()


@pytest.mark.parametrize("number", range(len(ABSENT)))
def test_absent_field_is_its_default(number: int) -> None:
    read, expected = ABSENT[number]
    assert read(Fields({})) == expected


@pytest.mark.parametrize("number", range(len(BAD)))
def test_bad_field_is_named(number: int) -> None:
    value, read, reason = BAD[number]
    with pytest.raises(FieldError) as caught:
        read(Fields({"x": value}, "view"))
    text = str(caught.value)
    assert text.startswith('"view.x" ')
    assert reason in text
    assert len(text) < 120


def test_field_that_must_be_there_is_named_where_it_is_absent() -> None:
    with pytest.raises(FieldError, match=r'^"x" is missing$'):
        Fields({}).number("x")


def test_field_that_nobody_asked_for_is_named_in_short() -> None:
    fields = Fields({"a": 1, "b" * 5000 + "\n": 2})
    fields.has("a")
    with pytest.raises(FieldError, match="unknown field") as caught:
        fields.finish()
    assert len(str(caught.value)) < 80
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("text", ["[" * 100_000, '{"a":' * 100_000, "1" * 5000, "\xff".encode()])
def test_text_without_end_is_refused(text: str | bytes) -> None:
    with pytest.raises(ValueError):  # noqa: PT011, of several kinds
        parse(text)


def test_text_with_half_a_character_can_be_written_and_read_again() -> None:
    name = "caf\udce9.csv"  # as Linux tells a file name that is not UTF-8
    text = to_text({"path": name, "é": 1})
    assert "é" in text
    assert parse(text.encode()) == {"path": name, "é": 1}
    assert clean_text(f"{name}x", 5) == "caf\ufffd."


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such files")
@pytest.mark.parametrize("kind", ["pipe", "device"])
def test_file_without_end_is_refused_at_once(tmp_path: Path, kind: str) -> None:
    path = Path("/dev/zero")
    if kind == "pipe":
        path = tmp_path / "pipe"
        os.mkfifo(path)
    with pytest.raises(FileError, match="it is not a file"):
        read_document(path, "preset", 1)


def test_file_that_is_too_large_is_refused_before_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "large.json"
    path.write_text(json.dumps({"version": 1, "text": "x" * 3_000_000}), encoding="utf-8")
    assert read_document(path, "preset", 1).has("text")
    monkeypatch.setattr(module, "MOST_BYTES", 2**20)
    monkeypatch.setattr(Path, "read_bytes", lambda _path: pytest.fail("it was read"))
    with pytest.raises(FileError, match="larger than 1 MB"):
        read_document(path, "preset", 1)


@pytest.mark.parametrize("version", [None, True, "1", 2, [1], "x" * 5000])
def test_another_version_is_refused_in_short(tmp_path: Path, version: Any) -> None:
    path = tmp_path / "a.json"
    path.write_text(json.dumps({"version": version}), encoding="utf-8")
    with pytest.raises(FileError, match="this FaceEdit reads version 1") as caught:
        read_document(path, "preset", 1)
    assert len(str(caught.value)) < 250 + len(str(path))

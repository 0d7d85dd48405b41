"""The links in the documents: each names a file that is there, and a heading that it has."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path

import pytest
from support.places import ROOT

DOCUMENTS = sorted(
    path.relative_to(ROOT)
    for folder, pattern in (
        (ROOT, "*.md"),
        (ROOT / "docs", "**/*.md"),
        (ROOT / "models", "**/*.md"),
        (ROOT / "assets", "**/*.md"),
        (ROOT / "packaging", "**/*.md"),
    )
    for path in folder.glob(pattern)
)
CODE = re.compile(r"^(```|~~~).*?^\1|`[^`\n]*`", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\[(?:[^\[\]]|\[[^\]]*\])*\]\(<?([^)\s>]+)>?[^)]*\)|(?:src|href)=\"([^\"]+)\"")
HEADING = re.compile(r"^#{1,6} +(.+?) *#*$", re.MULTILINE)


def links(text: str) -> list[str]:
    """What a Markdown text links to, except in code."""
    return [one or other for one, other in LINK.findall(CODE.sub("", text))]


def anchors(text: str) -> set[str]:
    """The names that a Markdown text's headings have in links to it, as GitHub makes them."""
    found: dict[str, int] = {}
    names = set(re.findall(r'<a (?:id|name)="([^"]+)"', text))
    for heading in HEADING.findall(
        re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    ):
        shown = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        kept = [c for c in shown if c in "-_ " or unicodedata.category(c)[0] in "LNM"]
        name = "".join(kept).replace(" ", "-")
        seen = found.get(name, 0)
        names.add(f"{name}-{seen}" if seen else name)
        found[name] = seen + 1
    return names


def broken(document: Path) -> list[str]:
    """The links in a document that lead nowhere; those to other sites are not followed."""
    wrong = []
    for link in links(document.read_text(encoding="utf-8")):
        if re.match(r"[a-z]+:", link):
            continue
        name, _, anchor = link.partition("#")
        target = (document.parent / name) if name else document
        if not target.exists() or (
            anchor and anchor not in anchors(target.read_text(encoding="utf-8"))
        ):
            wrong.append(link)
    return wrong


@pytest.mark.parametrize("name", DOCUMENTS, ids=str)
def test_every_link_leads_somewhere(name: Path) -> None:
    assert not broken(ROOT / name)


def test_broken_links_are_found(tmp_path: Path) -> None:
    text = (
        "# What it *is*\n[a](there.md) [b](gone.md) [c](#what-it-is) [d](#nothing)\n"
        "[e](there.md#one-more-1) [f](there.md#two) [g](https://example.com) `[h](code.md)`\n"
    )
    (tmp_path / "there.md").write_text("# One more\n## One, more\n", encoding="utf-8")
    (tmp_path / "it.md").write_text(text, encoding="utf-8")
    assert broken(tmp_path / "it.md") == ["gone.md", "#nothing", "there.md#two"]

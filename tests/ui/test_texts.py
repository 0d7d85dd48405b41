"""Texts from files are shown as they are: no rich text, no pictures, no links."""

from __future__ import annotations

from dataclasses import replace

import pytest
from PySide6.QtGui import Qt, QTextDocument
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QLabel, QToolTip
from support.windows import Bench, add_edit

from faceedit_app.ui.edits.model import EditsModel
from faceedit_app.ui.look.texts import name_entry, plain_label, plain_tip

HOSTILE = '<img src="/etc/hostname"><a href="file:///">x</a> & <b>bold</b>'


def visible(tip: str) -> str:
    """What a tooltip shows."""
    if not Qt.mightBeRichText(tip):
        return tip
    document = QTextDocument()
    document.setHtml(tip)
    assert "<img" not in document.toHtml()
    assert "<a " not in document.toHtml()
    return document.toPlainText()


@pytest.mark.parametrize("text", [HOSTILE, "plain & simple", "two\n<i>lines</i>", ""])
def test_a_tooltip_shows_a_text_as_it_is(text: str) -> None:
    assert visible(plain_tip(text)) == text


def test_a_menu_shows_both_ends_of_a_long_name_and_the_whole_of_a_short_one() -> None:
    assert name_entry("you & me.csv") == "you && me.csv"
    long = f"take {'of a long day ' * 20}17.csv"
    assert len(name_entry(long)) <= 60
    assert name_entry(long).startswith("take of a")
    assert name_entry(long).endswith("day 17.csv")


def test_a_label_shows_a_text_as_it_is(bench: Bench) -> None:
    label = plain_label(HOSTILE)
    bench.qtbot.addWidget(label)
    assert label.textFormat() == Qt.TextFormat.PlainText


def test_names_of_columns_and_edits_are_not_rich_text(bench: Bench) -> None:
    window = bench.editing()
    session = window.document.session
    assert session is not None
    assert window.editor is not None
    take = replace(session.take, notes=(HOSTILE,))
    window.status.set_take(take)
    assert visible(window.status.remarks.toolTip()) == HOSTILE
    QTest.mouseClick(window.status.remarks, Qt.MouseButton.LeftButton)
    assert visible(QToolTip.text()) == HOSTILE, "a click shows it as well"
    QToolTip.hideText()
    model = EditsModel(window.document, window.timeline)
    add_edit(window)
    session.rename(0, HOSTILE)
    tip = model.data(model.index(0), Qt.ItemDataRole.ToolTipRole)
    assert visible(tip).startswith(HOSTILE)
    window.workspace.warning.emit(HOSTILE)
    for label in window.findChildren(QLabel):
        if HOSTILE in label.text():
            assert label.textFormat() == Qt.TextFormat.PlainText
    assert window.banner.text.text().endswith(HOSTILE)

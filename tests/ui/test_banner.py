"""The banner says at a glance whether something is wrong."""

from __future__ import annotations

from pytestqt.qtbot import QtBot

from faceedit_app.ui.page.banner import Banner


def test_what_can_be_done_is_no_warning(qtbot: QtBot) -> None:
    banner = Banner()
    qtbot.addWidget(banner)
    banner.offer("Wrote new.csv", "Open it", lambda: None)
    assert not banner.warns
    banner.show_message("The film is missing")
    assert banner.warns
    banner.remove("The film is missing")
    assert not banner.warns


def test_a_warning_is_one_after_the_offer_is_taken(qtbot: QtBot) -> None:
    banner = Banner()
    qtbot.addWidget(banner)
    banner.show_message("The film is missing")
    banner.offer("Wrote new.csv", "Open it", lambda: None)
    banner.button.click()
    assert banner.warns
    banner.dismiss()
    assert not banner.warns


def test_messages_come_back_after_they_were_put_aside(qtbot: QtBot) -> None:
    """A take that cannot be read leaves the open one, and what was said about it, as it was."""
    banner = Banner()
    qtbot.addWidget(banner)
    banner.show_message("The film is missing")
    banner.put_aside(True)
    banner.show_message("The disk is full", lasts=True)
    assert banner.isHidden()
    banner.put_aside(False)
    assert not banner.isHidden()
    assert banner.text.text() == "The film is missing\nThe disk is full"
    banner.put_aside(True)
    banner.dismiss()
    banner.put_aside(False)
    assert banner.isHidden()

"""Files that are dropped on the window are handled once the drop is over."""

from __future__ import annotations

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QApplication, QMessageBox, QWidget
from support.takes import make_livelink_csv
from support.windows import Bench, add_edit, bench, drop, drop_only, editor_of, open_path

from faceedit_app.ui.commands.dialogs import Unsaved

__all__ = ["bench"]


def test_no_question_opens_before_the_drop_is_over_wherever_it_lands(bench: Bench) -> None:
    """One inside the drop would leave the window system in the middle of a drag."""
    window = bench.editing()
    add_edit(window)
    other = make_livelink_csv(bench.folder / "other.csv")
    page = editor_of(window)
    targets: tuple[QWidget, ...] = (
        window,
        window.start_page,
        page,
        page.curves.plots[0],
        page.face.viewport,
        page.film.screen_,
        page.edits.list.viewport(),  # rows of its own may be dropped on it
        window.status,
    )
    for target in targets:
        assert drop_only(target, other)  # `bench` would refuse to answer a question
        bench.answers["unsaved"] = Unsaved.CANCEL
        QApplication.sendPostedEvents(window, QEvent.Type.MetaCall.value)
        assert not bench.answers, target
    assert open_path(window) == bench.take


def test_files_are_refused_while_a_question_is_open(bench: Bench) -> None:
    window = bench.editing()
    other = make_livelink_csv(bench.folder / "other.csv")
    question = QMessageBox(window)
    question.open()
    assert not drop_only(window, other)
    question.reject()
    question.deleteLater()
    drop(window, other)
    bench.qtbot.waitUntil(lambda: open_path(window) == other)

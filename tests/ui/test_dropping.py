"""Files that are dropped on the window are handled once the drop is over."""

from __future__ import annotations

from PIL import Image
from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QApplication, QMessageBox, QWidget
from support.takes import make_livelink_csv
from support.windows import Bench, add_edit, bench, drop, drop_only, editor_of, open_path, trigger

from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.files.edits_file import write_edits
from faceedit_app.ui.commands.dialogs import Unsaved

__all__ = ["bench"]

EDIT = Edit(("mouth_opening",), Op.OFFSET, 0.2, 0.4, 0.1, 4.0)


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


def test_of_several_takes_the_window_says_which_is_open(bench: Bench) -> None:
    window = bench.editing()
    others = [make_livelink_csv(bench.folder / f"other {k}.csv", seconds=1.0) for k in (1, 2)]
    drop(window, *others)
    bench.qtbot.waitUntil(lambda: open_path(window) == others[0])
    bench.qtbot.waitUntil(lambda: "not 1 file dropped with it" in window.banner.text.text())
    edits = bench.folder / "edits.json"
    write_edits(edits, [EDIT, EDIT.shifted(90.0)])
    drop(window, edits)
    text = "1 of 2 edits of edits.json lies outside the take, where nothing changes"
    assert text in window.banner.text.text()
    bench.answers["unsaved"] = Unsaved.DISCARD
    drop(window, bench.take)
    bench.qtbot.waitUntil(lambda: open_path(window) == bench.take)
    assert "dropped with it" not in window.banner.text.text()


def test_a_file_that_cannot_be_opened_is_refused_before_anything_is_asked(bench: Bench) -> None:
    """However it comes; no answer is prepared, so a question would fail."""
    window = bench.editing()
    add_edit(window)
    photo, film = (bench.folder / name for name in ("photo.gif", "film.mp4"))
    for path in (photo, film):
        Image.new("RGB", (64, 64)).save(path, "GIF")
    others = [bench.folder / name for name in ("missing.csv", "empty.csv", "page.csv", "raw.csv")]
    for path, content in zip(others[1:], (b"", b"<html></html>", bytes(1 << 20)), strict=True):
        path.write_bytes(content)
    for path in (photo, *others):
        drop(window, path)
        bench.answers["open"] = path
        trigger(window, "open")
    bench.answers["film_to_track"] = film
    trigger(window, "track_film")
    assert len(bench.errors) == 11
    assert all("is a picture" in error for error in (*bench.errors[:2], bench.errors[-1]))
    assert all(path.name in error for path, error in zip(others, bench.errors[2::2], strict=False))
    assert not bench.answers


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

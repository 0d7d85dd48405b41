"""Channels in the window: plain curves, a neutral rest, strength by channel, head rotation."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDialogButtonBox, QListWidget, QPushButton
from support.sessions import switch
from support.speech import said
from support.takes import livelink_names, make_livelink_csv, speech_like
from support.windows import Bench, bench, drag, editor_of, session_of, trigger

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.curves.channel_plot import ChannelPlot
from faceedit_app.ui.curves.gestures import Pointer
from faceedit_app.ui.page.channels_panel import ChannelsPanel
from faceedit_app.ui.page.levels_dialog import LevelsDialog
from faceedit_app.ui.start.window import MainWindow

__all__ = ["bench"]

JAW, BLINK = ARKIT_INDEX["jawOpen"], ARKIT_INDEX["eyeBlinkLeft"]


def opened(bench: Bench, take: Path | None = None) -> tuple[MainWindow, ChannelsPanel]:
    window = bench.editing(take)
    trigger(window, "all_channels")
    assert window.editor is not None
    panel = window.editor.channels
    assert panel is not None
    bench.qtbot.waitUntil(lambda: panel.isVisible() and panel.plots[0].view.width() > 100)
    return window, panel


def _sees_chosen(rows: QListWidget) -> bool:
    (chosen,) = rows.selectedItems()
    return bool(rows.viewport().rect().contains(rows.visualItemRect(chosen).center()))


def test_in_a_low_window_the_lists_leave_their_height_to_the_face(bench: Bench) -> None:
    window = bench.editing()
    side = editor_of(window).side
    before = side.sizes()
    for _ in range(2):
        trigger(window, "all_channels")
        bench.qtbot.waitUntil(lambda: side.is_folded)
        panel = editor_of(window).channels
        assert panel is not None
        assert panel.search.hasFocus(), "letters find a channel, and are no shortcuts"
        assert side.sizes()[0] > 180
        bench.qtbot.waitUntil(partial(_sees_chosen, panel.list))
        panel.list.scrollToBottom()
        trigger(window, "all_channels")
        bench.qtbot.waitUntil(lambda: side.sizes() == before)
    trigger(window, "all_channels")
    bench.qtbot.waitUntil(lambda: side.is_folded)
    trigger(window, "list_problems")
    assert not side.is_folded
    assert side.sizes()[1] > 120


def test_at_first_they_leave_room_for_all_curves_above_if_the_window_is_high_enough(
    bench: Bench,
) -> None:
    window = bench.editing()
    session_of(window).say(said(("map", "M AE P"), start=1.0))
    window.resize(1440, 840)
    shown = editor_of(window).curves.shown
    bench.qtbot.waitUntil(lambda: shown.spare_height > 0)
    assert shown.spare_height < 300, "they would hide curves"
    trigger(window, "all_channels")
    panel = editor_of(window).channels
    assert panel is not None
    bench.qtbot.waitUntil(lambda: panel.isVisible() and editor_of(window).side.is_folded)
    bench.qtbot.waitUntil(lambda: 0 <= shown.spare_height < 60)
    assert panel.height() > 150


def squinting(folder: Path) -> Path:
    """A take whose lids are a third shut at rest."""
    names = livelink_names()
    weights = speech_like(240, 60.0, names)
    for name in ("EyeBlinkLeft", "EyeBlinkRight"):
        k = names.index(name)
        weights[:, k] = 0.3 + 0.6 * weights[:, k] / weights[:, k].max()
    return make_livelink_csv(folder / "squint.csv", weights=weights)


# --- all channels ------------------------------------------------------------------------------


def test_panel_lists_the_channels_of_the_take_and_its_rotations(bench: Bench) -> None:
    _, panel = opened(bench)
    assert len(panel.channels) == 52 + 9
    panel.search.setText("jaw")
    shown = [
        panel.list.item(row).text() for row in range(61) if not panel.list.item(row).isHidden()
    ]
    assert shown == ["jawForward", "jawLeft", "jawRight", "jawOpen"]
    assert not panel.none.isVisible()
    for text, says in ((" <b> ", "No channel is called “<b>”"), ("x" * 90, panel.none.short)):
        panel.search.setText(text)
        assert panel.none.isVisible()
        assert panel.none.shown == says, "none is found, and the panel is no wider"
    panel.search.clear()
    assert not panel.none.isVisible()


def test_buttons_act_only_on_channels_that_the_list_shows_and_highlights(bench: Bench) -> None:
    window, panel = opened(bench)
    session = session_of(window)
    panel.choose("headYaw")
    mute = next(button for button in panel.findChildren(QPushButton) if button.text() == "Mute")
    for text, wanted in (
        ("cheekPuff", ("cheekPuff",)),
        ("nothing", ()),
        ("cheek", ("cheekPuff",)),
        ("eyeWide", ("eyeWideLeft", "eyeWideRight")),
        ("jawO", ("jawOpen",)),
        ("", ("jawOpen",)),
    ):
        panel.search.setText(text)
        if len(wanted) > 1:
            panel.list.selectAll()  # Qt selects what is hidden, too
        lit = [item for item in panel.list.selectedItems() if not item.isHidden()]
        assert panel.chosen == wanted == tuple(item.text() for item in lit), text
        assert [plot.channel for plot in panel.plots] == list(wanted)
        assert mute.isEnabled() == bool(wanted)
        assert ("shows no channel" in mute.toolTip()) == (not wanted), "and says why it is grey"
        before = len(session.edits)
        mute.click()
        assert [edit.channels for edit in session.edits[before:]] == [wanted] * bool(wanted)
    panel.search.setText("cheek")
    panel.choose("headYaw")
    assert not panel.search.text(), "what is chosen is shown"
    assert panel.chosen == ("headYaw",)


def test_buttons_edit_the_selected_channels_in_the_selected_range(bench: Bench) -> None:
    window, panel = opened(bench)
    session = session_of(window)
    panel.choose("jawOpen", "mouthClose")
    window.timeline.select((1.0, 2.0))
    panel.factor.setValue(0.5)
    panel.scale()
    (edit,) = session.edits
    assert (edit.op, edit.value, edit.channels) == (Op.SCALE, 0.5, ("jawOpen", "mouthClose"))
    assert (edit.start, edit.end, edit.falloff) == (1.0, 2.0, window.timeline.falloff)
    panel.smooth()
    panel.limit()
    assert [edit.op for edit in session.edits] == [Op.SCALE, Op.SMOOTH, Op.LIMIT]
    trigger(window, "undo")
    assert len(session.edits) == 2


def test_rotations_are_muted_in_an_edit_of_their_own(bench: Bench) -> None:
    window, panel = opened(bench)
    session = session_of(window)
    panel.choose("jawOpen", "headYaw", "headPitch", "headRoll")
    panel.mute()
    assert [edit.channels for edit in session.edits] == [
        ("jawOpen",),
        ("headYaw", "headPitch", "headRoll"),
    ]
    assert session.rotations is not None
    assert (session.rotations[:, :3] == 0).all()
    trigger(window, "undo")
    assert session.edits == ()


def test_values_are_shown_at_the_playhead(bench: Bench) -> None:
    window, panel = opened(bench)
    panel.choose("jawOpen")
    window.timeline.go_to_frame(60)
    value = session_of(window).weights[60, JAW]
    assert f"{value:.2f}" in panel.plots[0].shown


def test_drag_on_a_plot_draws_or_selects(bench: Bench) -> None:
    window, panel = opened(bench)
    session = session_of(window)
    panel.choose("jawOpen", "mouthClose")
    area = panel.area
    area.ci.layout.activate()
    between = area.items(area.viewport().rect().center())
    assert not any(isinstance(item, ChannelPlot) for item in between), "a line is between the two"
    drag(area.viewport(), QPoint(120, 0), Qt.MouseButton.LeftButton)
    assert window.timeline.selection is not None
    window.timeline.select(None)
    panel.choose("jawOpen")
    area.ci.layout.activate()
    drag(panel.area.viewport(), QPoint(120, 0), Qt.MouseButton.LeftButton)
    assert window.timeline.selection is not None
    assert not session.edits
    panel.draw.setChecked(True)
    drag(panel.area.viewport(), QPoint(120, 0), Qt.MouseButton.LeftButton)
    (edit,) = session_of(window).edits
    assert edit.op is Op.DRAW
    held = session.take.clip.times
    inside = (held >= edit.start) & (held <= edit.end)
    np.testing.assert_allclose(session.weights[inside, JAW], 0.5, atol=0.1)


def test_escape_drops_what_is_being_drawn(bench: Bench) -> None:
    window, panel = opened(bench)
    session = session_of(window)
    panel.draw.setChecked(True)
    viewport = panel.area.viewport()
    at = viewport.rect().center()
    QTest.mousePress(viewport, Qt.MouseButton.LeftButton, pos=at)
    panel.plots[0].dragged(Pointer(300.0, 20.0))
    assert session.is_previewing
    assert window.workspace.cancel_gesture()
    assert not session.is_previewing
    QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, pos=at)
    assert session.edits == ()


def test_choosing_other_channels_drops_what_is_being_drawn(bench: Bench) -> None:
    window, panel = opened(bench)
    panel.draw.setChecked(True)
    (plot,) = panel.plots
    box = plot.view.rect().center()
    plot.pressed(Pointer(box.x() - 100, box.y()))
    plot.dragged(Pointer(box.x(), box.y() - 40))
    assert session_of(window).is_previewing
    panel.choose("jawLeft", "headYaw", "mouthClose")
    assert not session_of(window).is_previewing
    assert [plot.channel for plot in panel.plots] == list(panel.chosen)
    panel.choose("mouthClose")
    assert [plot.channel for plot in panel.plots] == ["mouthClose"]
    assert plot.shown.startswith("mouthClose")


def test_another_take_replaces_the_list(bench: Bench, tmp_path: Path) -> None:
    window, panel = opened(bench)
    names = [name for name in livelink_names() if name != "CheekPuff"]
    window.commands.file.open(make_livelink_csv(tmp_path / "other.csv", names=names))
    bench.qtbot.waitUntil(lambda: window.document.path == tmp_path / "other.csv")
    assert "cheekPuff" not in panel.channels
    assert panel.chosen == ("jawOpen",)


def test_edit_of_channels_is_in_the_list_and_switched_off_there(bench: Bench) -> None:
    window, panel = opened(bench)
    session = session_of(window)
    before = session.weights.copy()
    panel.mute()
    assert window.editor is not None
    model = window.editor.edits.model
    assert model.data(model.index(0)) == "jawOpen muted"
    switch(session, 0, False)
    assert (session.weights == before).all()


# --- a neutral rest ----------------------------------------------------------------------------


def test_this_frame_is_neutral_keeps_the_height_of_blinks(bench: Bench, tmp_path: Path) -> None:
    window = bench.editing(squinting(tmp_path))
    session = session_of(window)
    peak = float(session.weights[:, BLINK].max())
    window.timeline.go_to_frame(int(session.weights[:, BLINK].argmin()))
    trigger(window, "neutral_frame")
    panel = editor_of(window).edits
    listed = panel.model.columns(session_of(window).edits[0])[0]
    assert f": {listed.replace('–', 'to')};" in window.status.currentMessage()
    (edit,) = session.edits
    assert edit.op is Op.NEUTRAL
    assert session.weights[:, BLINK].min() < 0.01
    assert session.weights[:, BLINK].max() == pytest.approx(peak, abs=1e-4)
    trigger(window, "undo")
    assert (session.weights == session.take.clip.arkit_weights()).all()


def test_neutral_acts_in_the_selection_only(bench: Bench, tmp_path: Path) -> None:
    window = bench.editing(squinting(tmp_path))
    session = session_of(window)
    before = session.weights.copy()
    window.timeline.select((1.0, 2.0))
    trigger(window, "neutral_frame")
    outside = (session.take.clip.times < 0.7) | (session.take.clip.times > 2.3)
    assert (session.weights[outside] == before[outside]).all()
    assert session.changed_frames() > 0


def test_take_that_squints_at_rest_is_offered_a_neutral_rest(bench: Bench, tmp_path: Path) -> None:
    window = bench.editing(squinting(tmp_path))
    assert window.banner.button.isVisible()
    assert "the lids are half shut" in window.banner.text.text()
    window.banner.button.click()
    assert [edit.op for edit in session_of(window).edits] == [Op.NEUTRAL]
    assert not window.banner.button.isVisible()


def test_neutral_take_is_offered_nothing(bench: Bench) -> None:
    window = bench.editing()
    assert not window.banner.button.isVisible()


# --- strength by channel -----------------------------------------------------------------------


def test_strength_by_channel_is_previewed_and_made_as_one_edit(bench: Bench) -> None:
    window = bench.editing()
    session = session_of(window)
    tracked = session.weights.copy()
    trigger(window, "levels")
    dialog = next(w for w in QApplication.topLevelWidgets() if isinstance(w, LevelsDialog))
    assert dialog.edit is None
    row = dialog.model.channels.index("jawOpen")
    with bench.qtbot.waitSignal(window.document.previewed):
        dialog.model.setData(dialog.model.index(row, 1), 0.5)
    np.testing.assert_allclose(session.weights[:, JAW], 0.5 * tracked[:, JAW], atol=1e-5)
    dialog.model.setData(dialog.model.index(row, 3), 0.1)
    dialog.buttons.button(QDialogButtonBox.StandardButton.Ok).click()
    (edit,) = session.edits
    assert (edit.channels, edit.amounts) == (("jawOpen",), ((0.5, 0.0, 0.1),))
    assert session.weights[:, JAW].max() <= 0.1
    trigger(window, "undo")
    assert (session.weights == tracked).all()


def test_cancelled_strength_leaves_the_take(bench: Bench) -> None:
    window = bench.editing()
    session = session_of(window)
    trigger(window, "levels")
    dialog = next(w for w in QApplication.topLevelWidgets() if isinstance(w, LevelsDialog))
    with bench.qtbot.waitSignal(window.document.previewed):
        dialog.model.setData(dialog.model.index(3, 1), 3.0)
    dialog.reject()
    assert not session.is_previewing
    assert session.edits == ()


# --- the head ----------------------------------------------------------------------------------


def test_head_follows_the_recording_when_asked(bench: Bench) -> None:
    window = bench.editing()
    assert window.editor is not None
    viewport = window.editor.face.viewport
    vertex = [int(session_of(window).rig.neutral[:, 1].argmax())]
    straight = viewport.project(vertex)
    trigger(window, "follow_head")
    turned = viewport.project(vertex)
    assert straight is not None
    assert turned is not None
    assert np.abs(turned - straight).max() > 1.0  # pixels: the take's head is turned a little
    session_of(window).add(
        Edit(
            (),
            Op.SCALE,
            0.0,
            9.0,
            0.0,
            0.0,
            about=0.0,
            channels=("headYaw", "headPitch", "headRoll"),
        )
    )
    held = viewport.project(vertex)
    assert held is not None
    assert np.abs(held - straight).max() < 1e-3
    assert bench.preferences().follows_head()
    trigger(window, "follow_head")
    assert not window.actions_["follow_head"].isChecked()


def test_edit_of_a_channel_that_the_take_lacks_is_named_while_it_is_there(
    bench: Bench, tmp_path: Path
) -> None:
    names = [name for name in livelink_names() if name != "CheekPuff"]
    window = bench.window(make_livelink_csv(tmp_path / "take.csv", names=names))
    session = session_of(window)
    session.add(Edit((), Op.OFFSET, 0.0, 1.0, 0.0, 0.2, channels=("cheekPuff",)))
    assert "the take has no cheekPuff to change" in window.banner.text.text()
    session.undo()
    assert "cheekPuff" not in window.banner.text.text()

"""What can be done in lists, panels and dialogs, each as one random gesture."""

from __future__ import annotations

from PySide6.QtCore import QItemSelectionModel, QMimeData, QModelIndex, QPointF, Qt
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QDialog,
    QDoubleSpinBox,
    QLineEdit,
    QPushButton,
    QSpinBox,
    QToolButton,
    QWidget,
)

from faceedit_app.lab.attacks.hands import LEFT_OUT, Hands
from faceedit_app.ui.edits.delegate import cells
from faceedit_app.ui.edits.model import COLUMNS
from faceedit_app.ui.page.channels_panel import ChannelsPanel

_TYPED = (
    *("", "0", "150", "73", "999999", "-5", "1.2 - 3", "0.5", "2 – 1", "1e9", "12:30"),
    *("Smile", '<b>bold</b> & "quoted"', "ÄÖ 笑顔 😀", "x" * 400, "../..\\"),
)
_COLUMNS = 3  # of a row of the list that are typed in: name, range and strength
_SOME = 6  # channels at most


def choose_edit(hands: Hands) -> None:
    """Choose an edit in the list, or a few."""
    edits = hands.editor.edits
    count = len(edits.model.edits)
    if not count:
        return
    edits.select(hands.chance.randrange(count))
    for _ in range(hands.chance.choice((0, 0, 0, 1, 3))):
        index = edits.model.index(hands.chance.randrange(count))
        flag = QItemSelectionModel.SelectionFlag.Toggle
        edits.list.selectionModel().select(index, flag)


def set_strength(hands: Hands) -> None:
    """Move the slider of the chosen edits' strength; now and then give up with Esc."""
    slider = hands.editor.edits.strength
    if slider.isEnabled():
        slider.setSliderDown(True)
        for _ in range(3):
            slider.setSliderPosition(hands.chance.randint(slider.minimum(), slider.maximum()))
        if hands.chance.random() < 0.1:
            hands.window.actions_["deselect"].trigger()
        slider.setSliderDown(False)


def type_in_list(hands: Hands) -> None:
    """Double click on the name, the range or the strength of an edit, and type."""
    edits = hands.editor.edits
    if not edits.model.edits or not edits.list.isVisible():
        return
    index = edits.model.index(hands.chance.randrange(len(edits.model.edits)))
    row = edits.list.visualRect(index)
    if not edits.list.viewport().rect().contains(row.center()):
        edits.list.scrollTo(index)
        row = edits.list.visualRect(index)
    texts = cells(row.toRectF(), str(index.data()), *index.data(COLUMNS))
    hands.double_click(edits.list, hands.chance.choice(texts)[1].center())
    focus = QApplication.focusWidget()
    if isinstance(focus, (QLineEdit, QAbstractSpinBox)) and edits.list.isAncestorOf(focus):
        hands.type_into(focus, hands.chance.choice(_TYPED))


def drag_row(hands: Hands) -> None:
    """Drop an edit between two others."""
    model = hands.editor.edits.model
    count = len(model.edits)
    if count > 1:
        dragged: QMimeData = model.mimeData([model.index(hands.chance.randrange(count))])
        to = hands.chance.randint(-1, count)
        model.dropMimeData(dragged, Qt.DropAction.MoveAction, to, 0, QModelIndex())


def click_in_list(hands: Hands) -> None:
    """Click on a row of the list: on its switch or arrow, or elsewhere."""
    edits = hands.editor.edits
    if edits.model.edits and edits.list.isVisible():
        row = edits.list.visualRect(
            edits.model.index(hands.chance.randrange(len(edits.model.edits)))
        )
        x = hands.chance.choice((14, 40, hands.chance.uniform(0, row.width())))
        hands.drag(edits.list, QPointF(x, row.center().y()), QPointF())


def open_tab(hands: Hands) -> None:
    """Show the edits, the problems or the expressions, and use what is there."""
    lists = hands.editor.lists
    lists.setCurrentIndex(hands.chance.randrange(lists.count()))
    use_something(hands, lists.currentWidget())


def edit_channels(hands: Hands) -> None:
    """Choose channels, rotations among them, and scale, smooth, limit, mute or draw them."""
    if hands.editor.channels is None or not hands.editor.channels.isVisible():
        hands.window.actions_["all_channels"].trigger()
    panel = hands.editor.channels
    if panel is None or not panel.channels:
        return
    chance = hands.chance
    panel.choose(*chance.sample(panel.channels, chance.randint(1, min(_SOME, len(panel.channels)))))
    panel.draw.setChecked(chance.random() < 0.7)
    if chance.random() < 0.5:
        draw_channel(hands, panel)
        return
    use_something(hands, panel)
    chance.choice((panel.scale, panel.smooth, panel.limit, panel.mute))()


def draw_channel(hands: Hands, panel: ChannelsPanel) -> None:
    """Draw on the plot of a channel, or select a range there."""
    if not panel.plots or not panel.isVisible():
        return
    view = hands.chance.choice(panel.plots).view
    box = view.mapRectToScene(view.rect())
    start, end = (
        QPointF(
            box.x() + hands.chance.random() * box.width(),
            box.y() + hands.chance.random() * box.height(),
        )
        for _ in range(2)
    )
    hands.drag(panel.area, start, end - start)


def use_settings(hands: Hands) -> None:
    """Change something in the bars of the page."""
    editor = hands.editor
    bars = (editor.settings_bar, editor.tool_bar, editor.transport, editor.curves.fields)
    use_something(hands, hands.chance.choice(bars))


def use_dialogs(hands: Hands) -> None:
    """Change something in each open dialog, and close half of them."""
    for dialog in hands.window.findChildren(QDialog):
        if dialog.isVisible():
            use_something(hands, dialog)
            if hands.chance.random() < 0.5:
                dialog.close()


def use_something(hands: Hands, inside: QWidget) -> None:
    """Use a slider, a field, a list or a button."""
    kinds = QAbstractButton | QAbstractSlider | QAbstractSpinBox | QComboBox | QLineEdit
    can = [w for w in inside.findChildren(QWidget) if isinstance(w, kinds) and _is_usable(w)]
    if not can:
        return
    match hands.chance.choice(can):
        case QAbstractSpinBox() as box if hands.chance.random() < 0.5:
            hands.type_into(box, hands.chance.choice(_TYPED))
        case QSpinBox() as box:
            box.setValue(hands.chance.randint(box.minimum(), box.maximum()))
        case QDoubleSpinBox() as box:
            box.setValue(hands.chance.uniform(box.minimum(), box.maximum()))
        case QAbstractSlider() as slider:
            slider.setValue(hands.chance.randint(slider.minimum(), slider.maximum()))
        case QComboBox() as choice if choice.count():
            choice.setCurrentIndex(hands.chance.randrange(choice.count()))
        case QLineEdit() as field:
            hands.type_into(field, hands.chance.choice(_TYPED))
        case QAbstractButton() as button:
            button.click()


def _is_usable(widget: QWidget) -> bool:
    """Whether it can be used, and neither opens another take nor a menu that waits."""
    if not widget.isVisible() or not widget.isEnabled():
        return False
    if isinstance(widget, QPushButton):
        return widget.menu() is None
    if isinstance(widget, QToolButton):
        action = widget.defaultAction()
        return widget.menu() is None and (action is None or action.objectName() not in LEFT_OUT)
    return True

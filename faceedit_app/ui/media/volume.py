"""The volume: a mute button and a slider. Hidden without sound."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QHBoxLayout, QWidget

from faceedit_app.ui.look.gesture_slider import Slider
from faceedit_app.ui.look.icons import icon
from faceedit_app.ui.look.palette import MUTED
from faceedit_app.ui.look.texts import plain_tip
from faceedit_app.ui.look.theme import GAP
from faceedit_app.ui.look.widgets import icon_button
from faceedit_app.ui.media.sound_player import SoundPlayer
from faceedit_app.ui.media.take_media import TakeMedia
from faceedit_app.ui.state.actions import tip_of


class Volume(QWidget):
    """Part of the transport."""

    def __init__(self, mute: QAction, media: TakeMedia, sound_player: SoundPlayer) -> None:
        super().__init__()
        self._media, self._sound_player, self._mute = media, sound_player, mute
        self._tip = tip_of(mute)
        self._icons = {False: icon("sound"), True: icon("muted", MUTED)}
        self.button = icon_button(mute)
        self.slider = Slider(0, 100, start=100)
        self.slider.setFixedWidth(72)
        self.slider.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.slider.setAccessibleName("Volume")
        self.slider.setToolTip("Volume of the take's sound")
        self.slider.valueChanged.connect(lambda value: sound_player.set_volume(value / 100))
        row = QHBoxLayout(self)
        row.setContentsMargins(GAP, 0, 0, 0)
        row.setSpacing(2)
        row.addWidget(self.button)
        row.addWidget(self.slider)
        media.sound_changed.connect(self._show)
        sound_player.changed.connect(self._show)
        self._show()

    def _show(self) -> None:
        sound_player = self._sound_player
        self.setVisible(self._media.sound is not None)
        silent = sound_player.muted or sound_player.volume == 0 or bool(sound_player.problem)
        self._mute.setIcon(self._icons[silent])
        self._mute.setToolTip(plain_tip(sound_player.problem or self._tip))
        self.slider.setEnabled(not sound_player.problem)
        with QSignalBlocker(self.slider):
            self.slider.setValue(round(100 * sound_player.volume))

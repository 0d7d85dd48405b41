"""The View menu: the visible time range, the unit of time, the camera, and which face is shown."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtGui import QGuiApplication, QImage
from PySide6.QtWidgets import QMainWindow

from faceedit_app.core.arrays import Pixels
from faceedit_app.core.atomic import said_of
from faceedit_app.core.controls import CONTROLS
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.regions import OPTIONAL_LABEL
from faceedit_app.ui.commands import conditions as c
from faceedit_app.ui.commands import dialogs, places
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.state.actions import Command, Menu
from faceedit_app.ui.state.time_display import Unit

if TYPE_CHECKING:  # comes with the page, after the first paint
    from faceedit_app.ui.curves import CurvesPanel
    from faceedit_app.ui.face.pane import FacePane
    from faceedit_app.ui.page.channels_dock import ChannelsDock

CAMERA, CURVES, FILM = "Ca&mera", "C&urves", "&Film"  # submenus
ZOOM = 0.7  # of the time in view, per step
MARGIN = 0.1  # of the selection, on either side of it


class ViewCommands:
    """Changes the view, never the take."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace, self._timeline = workspace, workspace.timeline
        self._channels: ChannelsDock | None = None

    @property
    def face(self) -> FacePane | None:
        """The face pane, once it is built."""
        page = self._workspace.page
        return page.face if page is not None else None

    # --- the curves --------------------------------------------------------------------------

    @property
    def curves(self) -> CurvesPanel | None:
        """The curves panel, once it is there."""
        page = self._workspace.page
        return page.curves if page is not None else None

    def fit_values(self) -> None:
        """Fit each value axis to the part of its curve in view."""
        if self.curves is not None:
            self.curves.fit_values()

    def enlarge_curve(self) -> None:
        """Enlarge small movements of the focused curve, or stop doing so."""
        if self.curves is not None:
            self.curves.enlarge_focused()

    @property
    def is_curve_enlarged(self) -> bool:
        """Whether small movements of the focused curve are enlarged."""
        return self.curves is not None and self.curves.is_focused_enlarged

    def show_only_curve(self) -> None:
        """Hide all curves but the focused one."""
        if self.curves is not None:
            self.curves.show_only_focused()

    def hide_curve(self) -> None:
        """Hide the focused curve."""
        if self.curves is not None:
            self.curves.hide_focused()

    def show_all_curves(self) -> None:
        """Show the hidden curves again."""
        if self.curves is not None:
            self.curves.shown.show_all()

    @property
    def shown_curves(self) -> int:
        """How many curves are shown."""
        return len(self.curves.shown.controls) if self.curves is not None else len(CONTROLS)

    @property
    def hides_curves(self) -> bool:
        """Whether the user has hidden curves."""
        return self.curves is not None and self.curves.shown.hides_any

    def unfold_curves(self) -> None:
        """Show the optional curves, or fold them away."""
        if self.curves is not None:
            self.curves.shown.unfold(not self.unfolds_curves)

    @property
    def unfolds_curves(self) -> bool:
        """Whether the optional curves are shown."""
        return self.curves is not None and self.curves.shown.is_unfolded

    # --- the time ----------------------------------------------------------------------------

    def fit(self) -> None:
        """Show the selection; if there is none or it is shown already, the whole take.

        The value axes fit what is then in view.
        """
        line = self._timeline
        chosen = line.selection
        if chosen is not None and chosen[1] > chosen[0]:
            margin = MARGIN * (chosen[1] - chosen[0])
            before = line.view
            line.show_range(chosen[0] - margin, chosen[1] + margin)
            if line.view != before:
                self.fit_values()
                return
        line.show_range(0.0, line.duration)
        self.fit_values()

    def view_all(self) -> None:
        """Show the whole take and all its values."""
        self._timeline.show_range(0.0, self._timeline.duration)
        self.fit_values()

    def zoom(self, factor: float) -> None:
        """Zoom in time around the playhead."""
        self._timeline.zoom(factor, self._timeline.time)

    @property
    def unit(self) -> Unit:
        """The unit in which times are shown."""
        return self._timeline.display.unit

    @property
    def has_timecode(self) -> bool:
        """Whether the take has timecode."""
        clip = self._timeline.clip
        return clip is not None and bool(clip.timecodes)

    def show_time_as(self, unit: Unit) -> None:
        """Show times in another unit."""
        self._timeline.display.choose(unit)

    # --- the face ----------------------------------------------------------------------------

    def reset_camera(self) -> None:
        """Look at the face from the front."""
        if self.face is not None:
            self.face.viewport.reset_camera()

    def aim(self, aim: str) -> None:
        """Point the camera at the face from a side, or at a part of it: see `render.Aim`."""
        if self.face is not None:
            self.face.aim(aim)

    def copy_picture(self) -> None:
        """Copy the picture of the face to the clipboard, as shown."""
        if (picture := self._picture()) is not None:
            QGuiApplication.clipboard().setImage(picture)
            self._workspace.message.emit("Copied the picture of the face")

    def save_picture(self) -> None:
        """Save the picture of the face, as shown."""
        from faceedit_app.render.snapshot import write_png

        workspace, frame = self._workspace, self._timeline.frame + 1
        picture = self._picture()
        if picture is None:
            return
        suggestion = workspace.suggest("picture", f"_frame_{frame}", ".png")
        path = places.ask_where(workspace, dialogs.ask_save_picture, suggestion)
        if path is None:
            return
        try:
            backup = write_png(path, _pixels(picture))
        except FaceEditError as error:
            dialogs.show_error(workspace.window, error)
            return
        workspace.preferences.set_folder("picture", path.resolve().parent)
        workspace.message.emit(f"Saved {path}{said_of(backup)}")

    def _picture(self) -> QImage | None:
        return self.face.viewport.picture() if self.face is not None else None

    @property
    def has_picture(self) -> bool:
        """Whether there is a picture of the face."""
        return self.face is not None and self.face.viewport.can_draw

    def show_edited(self) -> None:
        """Show the face with the edits."""
        if self.face is not None:
            self.face.set_tracked(False)

    def show_tracked(self) -> None:
        """Switch between the tracked and the edited face."""
        if self.face is not None:
            self.face.set_tracked(not self.face.shows_tracked)

    def show_both(self) -> None:
        """Show the tracked face beside the edited one."""
        if self.face is not None:
            self.face.show_both()

    def show_difference(self) -> None:
        """Switch the tint that shows where the edited face differs from the tracked one."""
        if self.face is not None:
            wanted = not self.face.shows_difference
            self.face.show_difference(wanted)
            self._workspace.preferences.set_difference(wanted)

    def all_channels(self) -> None:
        """Show the channels of the take as plain curves, or hide them."""
        from faceedit_app.ui.page.channels_dock import ChannelsDock
        from faceedit_app.ui.page.channels_panel import ChannelsPanel

        window, page = self._workspace.window, self._workspace.page
        if page is None or not isinstance(window, QMainWindow):
            return
        if self._channels is None:
            panel = page.channels = ChannelsPanel(self._workspace.document, self._timeline)
            self._channels = ChannelsDock(window, page, panel)
        else:
            self._channels.switch()
        if self.shows_channels:
            self._channels.focus_search()
        else:
            page.curves.setFocus()

    @property
    def shows_channels(self) -> bool:
        """Whether the channels are shown as plain curves."""
        return self._channels is not None and not self._channels.isHidden()

    def follow_head(self) -> None:
        """Turn the head as it was recorded, or keep it straight."""
        if self.face is not None:
            wanted = not self.face.follows_head
            self.face.follow_head(wanted)
            self._workspace.preferences.set_follows_head(wanted)

    @property
    def has_rotations(self) -> bool:
        """Whether the take says how the head turns."""
        session = self._workspace.session
        return session is not None and session.rotations is not None

    def glance(self, glancing: bool) -> None:
        """Show the tracked face while a key is held."""
        if self.face is not None:
            self.face.glance(glancing)

    # --- the film ----------------------------------------------------------------------------

    @property
    def film_place(self) -> str:
        """Where the film is shown: beside, above or below the face."""
        page = self._workspace.page
        return page.film_place if page is not None else ""

    def place_film(self, place: str) -> None:
        """Show the film beside, above or below the face."""
        self._workspace.preferences.set_film_place(place)
        self.restore_film_place()

    def restore_film_place(self) -> None:
        """Show the film where the user wants it."""
        from faceedit_app.ui.media.film_pane import FilmPlace

        place, page = self._workspace.preferences.film_place(), self._workspace.page
        if page is not None and place in list(FilmPlace):
            page.place_film(FilmPlace(place))

    @property
    def has_film(self) -> bool:
        """Whether the take has a film."""
        return self._workspace.media.film is not None

    # --- the keyboard ------------------------------------------------------------------------

    def focus_curve(self, index: int) -> None:
        """Focus a curve."""
        if self._workspace.page is not None:
            self._workspace.page.curves.focus_curve(index)

    def focus_face(self) -> None:
        """Focus the viewport."""
        if self.face is not None:
            self.face.viewport.setFocus()


def _pixels(picture: QImage) -> Pixels:
    """A picture as (H, W, 3) uint8, RGB."""
    image = picture.convertToFormat(QImage.Format.Format_RGB888)
    width, height = image.width(), image.height()
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(height, image.bytesPerLine())
    return np.ascontiguousarray(rows[:, : 3 * width]).reshape(height, width, 3)


def _shows_edited(do: ViewCommands) -> bool:
    return do.face is None or not (do.face.shows_tracked or do.face.shows_both)


def _shows_film(place: str, do: ViewCommands) -> bool:
    return do.film_place == place


# fmt: off
MENU: Menu[ViewCommands] = Menu("&View", (
    Command("reset_camera", "&Reset camera", ViewCommands.reset_camera, ("0",),
            "Look at the face from the front", "camera", needs_take=False),
    Command("camera_left", "&Left side", lambda do: do.aim("left"), ("Shift+L",),
            "Look at the character's left side", submenu=CAMERA),
    Command("camera_right", "&Right side", lambda do: do.aim("right"), ("Shift+R",),
            "Look at the character's right side", submenu=CAMERA),
    Command("camera_mouth", "&Mouth", lambda do: do.aim("mouth"), ("Shift+M",),
            "Look closely at the mouth", submenu=CAMERA),
    Command("camera_eyes", "&Eyes", lambda do: do.aim("eyes"), ("Shift+E",),
            "Look closely at the eyes", submenu=CAMERA),
    Command("fit", "&Zoom to fit", ViewCommands.fit, ("F",),
            "Show the selection or the whole take", "fit"),
    Command("fit_values", "Fit &values", lambda do: do.fit_values(), ("Shift+F",),
            "Fit each value axis to what is in view"),
    Command("view_all", "View &all", ViewCommands.view_all, ("Shift+A",),
            "Show the whole take with all its values"),
    Command("zoom_in", "Zoom &in", lambda do: do.zoom(ZOOM), ("+", "="),
            "Show less time around the playhead", "zoom_in"),
    Command("zoom_out", "Zoom &out", lambda do: do.zoom(1 / ZOOM), ("-",),
            "Show more time around the playhead", "zoom_out"),
    Command("unit_seconds", "&Seconds", lambda do: do.show_time_as(Unit.SECONDS),
            tip="Show times in seconds", checked=lambda do: do.unit is Unit.SECONDS,
            submenu="Show &time as"),
    Command("unit_frames", "&Frames", lambda do: do.show_time_as(Unit.FRAMES),
            tip="Show times in frames, counted from 1", checked=lambda do: do.unit is Unit.FRAMES,
            submenu="Show &time as"),
    Command("unit_timecode", "&Timecode", lambda do: do.show_time_as(Unit.TIMECODE),
            tip="Show times as the take's timecode", checked=lambda do: do.unit is Unit.TIMECODE,
            enabled=c.HAS_TIMECODE, submenu="Show &time as"),
    Command("show_edited", "Show &edited face", ViewCommands.show_edited,
            tip="Show the face with your edits", checked=_shows_edited, starts_group=True),
    Command("show_tracked", "Sho&w tracked face", ViewCommands.show_tracked, ("T",),
            "Show the tracked face instead of the edited one; hold B to show it briefly",
            checked=lambda do: do.face is not None and do.face.shows_tracked),
    Command("show_both", "Show &both faces", ViewCommands.show_both, ("Shift+T",),
            "Show the tracked face beside the edited one",
            checked=lambda do: do.face is not None and do.face.shows_both),
    Command("show_difference", "Show &difference", ViewCommands.show_difference, ("Ctrl+T",),
            "Tint the edited face by its distance from the tracked one",
            checked=lambda do: do.face is not None and do.face.shows_difference),
    Command("follow_head", "Follow the &head", ViewCommands.follow_head, (),
            "Turn the character's head as it was recorded, or keep it straight; for takes with "
            "head rotation", enabled=c.HAS_ROTATIONS,
            checked=lambda do: do.face is not None and do.face.follows_head),
    *(
        Command(f"film_{place}", f"{label} the face", partial(ViewCommands.place_film, place=place),
                tip=f"Show the take's film {place} the face", enabled=c.HAS_FILM,
                checked=partial(_shows_film, place), submenu=FILM)
        for place, label in (("beside", "&Beside"), ("above", "&Above"), ("below", "B&elow"))
    ),
    *(
        Command(f"curve_{index + 1}",
                f"&{index + 1} {control.label}" if control.key else control.label,
                partial(ViewCommands.focus_curve, index=index),
                (control.key,) if control.key else (),
                f"Focus the curve “{control.label}”", submenu="Focus a &curve")
        for index, control in enumerate(CONTROLS)
    ),
    Command("enlarge_curve", "&Enlarge small movements", ViewCommands.enlarge_curve,
            tip="Enlarge small movements of the focused curve; or double-click its name",
            checked=lambda do: do.is_curve_enlarged, submenu=CURVES),
    Command("show_only_curve", "Show &only this curve", ViewCommands.show_only_curve,
            tip="Hide all curves but the focused one and those edited with it",
            enabled=c.SHOWS_CURVES, submenu=CURVES),
    Command("hide_curve", "&Hide this curve", ViewCommands.hide_curve,
            tip="Hide the focused curve", enabled=c.SHOWS_CURVES,
            submenu=CURVES),
    Command("show_all_curves", "Show &all curves", ViewCommands.show_all_curves,
            tip="Show the hidden curves again",
            enabled=c.HIDES_CURVES, submenu=CURVES),
    Command("unfold_curves", f"Show &{OPTIONAL_LABEL.lower()}", ViewCommands.unfold_curves,
            ("Ctrl+B",), f"Show the curves of {OPTIONAL_LABEL.lower()}, or fold them away",
            checked=lambda do: do.unfolds_curves, submenu=CURVES),
    Command("all_channels", "A&ll channels", ViewCommands.all_channels, ("Ctrl+Shift+L",),
            "Show the 52 channels, head and eyes as plain curves, to read, scale, smooth and draw",
            checked=lambda do: do.shows_channels),
    Command("focus_face", "Move camera with &keys", ViewCommands.focus_face, ("9",),
            "Move the camera: arrows orbit, + and - zoom; Esc returns to the curves"),
    Command("copy_picture", "Co&py picture", ViewCommands.copy_picture,
            tip="Copy the picture of the face to the clipboard, as shown",
            enabled=c.HAS_PICTURE, starts_group=True),
    Command("save_picture", "&Save picture…", ViewCommands.save_picture,
            tip="Save the picture of the face as a PNG file, as shown",
            enabled=c.HAS_PICTURE),
))
# fmt: on

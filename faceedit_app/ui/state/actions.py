"""Everything the user can command, in one table: menus, shortcuts and the help come from it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu

from faceedit_app.core.controls import CONTROLS
from faceedit_app.editing.help.presets import shipped_presets
from faceedit_app.ui.look.icons import icon

MENUS = ("File", "Edit", "Tools", "Fix", "View", "Playback", "Help")


@dataclass(frozen=True)
class Command:
    """One thing that the user can do.

    Attributes:
        id: what code and tests call it.
        menu: the menu that it stands in, one of `MENUS`.
        text: the menu's text.
        keys: shortcuts, the first of which is shown.
        tip: one sentence for tooltips and the status bar.
        icon: name of its icon, or nothing.
        checkable: whether it is a state that is switched on and off.
        needs_take: whether it is greyed out while no take is open.
        starts_group: whether a line separates it from the command above.
        submenu: the menu inside the menu that it stands in, if any.
    """

    id: str
    menu: str
    text: str
    keys: tuple[str, ...] = ()
    tip: str = ""
    icon: str = ""
    checkable: bool = False
    needs_take: bool = True
    starts_group: bool = False
    submenu: str = ""


# fmt: off
COMMANDS: tuple[Command, ...] = (
    Command("open", "File", "&Open…", ("Ctrl+O",), "Open a tracked take (CSV) or a project", "open",
            needs_take=False),
    Command("open_demo", "File", "Open &demo take", (), "Open the take that ships with FaceEdit",
            needs_take=False),
    Command("recent", "File", "Open &recent", needs_take=False),
    Command("save", "File", "&Save project", ("Ctrl+S",),
            "Save the take's edits, view, sound and film as a project", "save",
            starts_group=True),
    Command("save_as", "File", "Save project &as…", ("Ctrl+Shift+S",),
            "Save the project under another name"),
    Command("export", "File", "&Export…", ("Ctrl+E",),
            "Write the edited take in the format of its source", "export", starts_group=True),
    Command("save_edits", "File", "Save list of edi&ts…", (),
            "Save the list of edits, to load it for another take or for “faceedit apply”"),
    Command("load_edits", "File", "&Load edits…", (), "Add the edits of a file to this take"),
    Command("add_media", "File", "Add sound or f&ilm…", ("Ctrl+Shift+O",),
            "Put a recording beside the take: WAV, MP3, M4A, MOV, MP4…", starts_group=True),
    Command("remove_sound", "File", "Remove sound", (), "Take the sound away from the take"),
    Command("remove_film", "File", "Remove film", (), "Take the film away from the take"),
    Command("quit", "File", "&Quit", ("Ctrl+Q",), needs_take=False, starts_group=True),

    Command("undo", "Edit", "&Undo", ("Ctrl+Z",), "Take the last step back", "undo"),
    Command("redo", "Edit", "&Redo", ("Ctrl+Shift+Z", "Ctrl+Y"), "Take the step again", "redo"),
    Command("reset_range", "Edit", "Reset r&ange", ("Ctrl+R",),
            "Back to the take as tracked: in the selection, else around the playhead", "reset",
            starts_group=True),
    Command("reset_curve", "Edit", "Reset range of this &curve", ("Ctrl+Shift+R",),
            "Back to the take as tracked, for the curve that has the focus only"),
    Command("copy", "Edit", "&Copy range", ("Ctrl+C",),
            "Copy what the face does in the selection", starts_group=True),
    Command("copy_changes", "Edit", "Copy changes only", ("Ctrl+Shift+C",),
            "Copy what your edits changed in the selection, to add it elsewhere"),
    Command("paste", "Edit", "&Paste at playhead", ("Ctrl+V",), "Put there what was copied"),
    Command("paste_mirrored", "Edit", "Paste mirrored", ("Ctrl+Shift+V",),
            "Put there what was copied, left and right changing places"),
    Command("mirror", "Edit", "&Mirror range", ("Ctrl+Shift+M",),
            "Left and right change places in the selection"),
    Command("toggle_edit", "Edit", "Switch edit &on / off", ("E",),
            "Switch the edit that is selected in the list on or off", starts_group=True),
    Command("rename_edit", "Edit", "Re&name edit", ("F2",),
            "Give the edit that is selected in the list another name"),
    Command("edit_up", "Edit", "Move edit up", ("Alt+Up",),
            "Move the edit that is selected up the list: it acts earlier"),
    Command("edit_down", "Edit", "Move edit down", ("Alt+Down",),
            "Move the edit that is selected down the list: it acts later"),
    Command("delete_edit", "Edit", "&Delete edit", ("Del",),
            "Delete the edit that is selected in the list", "trash"),
    Command("select_all", "Edit", "Select &all", ("Ctrl+A",), "Select the whole take",
            starts_group=True),
    Command("deselect", "Edit", "&Deselect", ("Esc",),
            "Cancel the drag in progress, else drop the selection"),
    Command("preserve", "Edit", "&Preserve the take",
            tip="Change only what the edits reach", checkable=True, starts_group=True),
    Command("resynthesize", "Edit", "Re&synthesize",
            tip="Answer the whole take anew by the networks", checkable=True),

    Command("tool_move", "Tools", "&Move", ("M",),
            "Drag a curve up or down: it moves there, softly to either side", "tool_move",
            checkable=True),
    Command("tool_draw", "Tools", "&Draw", ("D",),
            "Draw the curve freehand; Ctrl draws at 0: lips or lids touching", "tool_draw",
            checkable=True),
    Command("tool_smooth", "Tools", "&Smooth", ("S",),
            "Paint over shaking to calm it: as strong as the slider beside it says",
            "tool_smooth", checkable=True),
    Command("tool_scale", "Tools", "S&cale", ("X",),
            "Drag up for larger movements, down for smaller ones", "tool_scale",
            checkable=True),
    Command("tool_flatten", "Tools", "&Flatten", ("H",),
            "Paint to hold the curve where it was pressed", "tool_flatten", checkable=True),
    Command("tool_restore", "Tools", "&Back to tracked", ("R",),
            "Paint over edits to erase them: the face goes back to the recording",
            "tool_restore", checkable=True),
    Command("link", "Tools", "&Left = right", ("U",),
            "Edit both sides of the face together; hold Alt for one side only", "link",
            checkable=True, starts_group=True),
    Command("raise", "Tools", "&Raise the curve", ("Ctrl+Up",),
            "Raise the curve that has the focus by 0.5 mm, at the playhead or in the selection",
            starts_group=True),
    Command("lower", "Tools", "L&ower the curve", ("Ctrl+Down",),
            "Lower the curve that has the focus by 0.5 mm"),
    Command("raise_fine", "Tools", "Raise a little", ("Ctrl+Shift+Up",),
            "Raise the curve that has the focus by 0.05 mm"),
    Command("lower_fine", "Tools", "Lower a little", ("Ctrl+Shift+Down",),
            "Lower the curve that has the focus by 0.05 mm"),

    *(
        Command(f"fix_{fix.id}", "Fix", fix.menu, (fix.key,) if fix.key else (), fix.hint, fix.icon,
                starts_group=before is not None and before.group != fix.group)
        for before, fix in zip((None, *shipped_presets()), shipped_presets(), strict=False)
    ),
    Command("mood", "Fix", "Smile or sad by a slider…", ("Ctrl+0",),
            "Set how happy the mouth is: in the selection, else in the whole take",
            starts_group=True),
    Command("presets", "Fix", "My p&resets", starts_group=True),
    Command("save_preset", "Fix", "Sa&ve selection as preset…",
            tip="Keep the edits of the selection under a name, to use them elsewhere"),
    Command("next_problem", "Fix", "&Next problem", ("Down",),
            "Go to the next place that is probably wrong", "down", starts_group=True),
    Command("previous_problem", "Fix", "Previous problem", ("Up",),
            "Go to the place before that is probably wrong", "up"),
    Command("fix_problem", "Fix", "&Fix this problem", ("P",),
            "Show what would mend the problem at the playhead, to accept or discard"),
    Command("fix_all", "Fix", "Fix all problems", ("Ctrl+Shift+P",),
            "Show what would mend all problems, to accept or discard"),
    Command("accept_fix", "Fix", "Accept the proposal", ("Return", "Enter"),
            "Make the edits that are proposed", "tick"),
    Command("discard_fix", "Fix", "Discard the proposal", (),
            "Drop the edits that are proposed (Esc)", "close"),

    Command("reset_camera", "View", "&Reset camera", ("0",), "Look at the face from the front",
            "camera", needs_take=False),
    Command("fit", "View", "&Zoom to fit", ("F",), "Show the whole take, or the selection", "fit"),
    Command("zoom_in", "View", "Zoom &in", ("+", "="), "Show less time around the playhead",
            "zoom_in"),
    Command("zoom_out", "View", "Zoom &out", ("-",), "Show more time around the playhead",
            "zoom_out"),
    Command("unit_seconds", "View", "&Seconds", tip="Time in seconds", checkable=True,
            submenu="Show &time as"),
    Command("unit_frames", "View", "&Frames", tip="Time in frames, counted from 1",
            checkable=True, submenu="Show &time as"),
    Command("unit_timecode", "View", "&Timecode", tip="Time as the recording tells it",
            checkable=True, submenu="Show &time as"),
    Command("show_edited", "View", "Show &edited face", tip="Show the face with your edits",
            checkable=True, starts_group=True),
    Command("show_tracked", "View", "Show &tracked face", ("T",),
            "Show the face as tracked instead of as edited; hold B for a glance",
            checkable=True),
    Command("show_both", "View", "Show &both faces", ("Shift+T",),
            "Show the tracked face beside the edited one", checkable=True),
    Command("show_difference", "View", "Show &difference", ("Ctrl+T",),
            "Tint the edited face where and how far it is from the tracked one", checkable=True),
    Command("mirror_film", "View", "&Mirror film",
            tip="Show the film as in a mirror, where left and right are not those of the face",
            checkable=True),
    *(
        Command(f"curve_{number}", "View", f"&{number} {control.label}",
                (control.key,) if control.key else (),
                f"Give the keyboard to the curve “{control.label}”", submenu="Focus a &curve")
        for number, control in enumerate(CONTROLS, start=1)
    ),
    Command("focus_face", "View", "Look around by &keys", ("9",),
            "Give the keyboard to the face: arrows turn it, + and - zoom; Esc gives it back"),

    Command("play", "Playback", "&Play / pause", ("Space",), "Play or pause", "play"),
    Command("play_around", "Playback", "Play a&round", ("/",),
            "Play the selection, else around the playhead, once; then return"),
    Command("rewind", "Playback", "Play bac&kwards", ("J",), "Play backwards; again: faster"),
    Command("stop", "Playback", "&Stop", ("K",), "Pause"),
    Command("fast_forward", "Playback", "Play for&wards", ("L",),
            "Play forwards; again: faster"),
    Command("loop", "Playback", "&Loop", ("Ctrl+L",), "Repeat the selection, or the whole take",
            "loop", checkable=True),
    Command("mute", "Playback", "&Mute sound", ("Ctrl+M",), "Silence the take's sound",
            "sound", checkable=True),
    Command("back", "Playback", "Frame &back", ("Left",), "One frame back", "back",
            starts_group=True),
    Command("forward", "Playback", "Frame &forward", ("Right",), "One frame forward", "forward"),
    Command("second_back", "Playback", "Second back", ("Shift+Left",), "One second back"),
    Command("second_forward", "Playback", "Second forward", ("Shift+Right",),
            "One second forward"),
    Command("start", "Playback", "Go to &start", ("Home",), "Go to the first frame", "start"),
    Command("end", "Playback", "Go to &end", ("End",), "Go to the last frame", "end"),
    Command("go_to", "Playback", "&Go to a time…", ("G",),
            "Type where to go: seconds, a frame or a timecode, as times are shown"),
    Command("mark_start", "Playback", "Selection starts &here", ("I",),
            "Start the selection at the playhead", starts_group=True),
    Command("mark_end", "Playback", "Selection ends here", ("O",),
            "End the selection at the playhead"),

    Command("first_steps", "Help", "&First steps", (),
            "Show where things are and what they are for"),
    Command("shortcuts", "Help", "&Shortcuts", ("F1",), needs_take=False),
    Command("about", "Help", "&About FaceEdit", needs_take=False),
)

# What the mouse and held keys do; they are no menu commands, but the help names them too.
GESTURES: tuple[tuple[str, str, str], ...] = (
    ("Curves", "Drag a curve up or down", "Edit it, with the falloff to either side"),
    ("Curves", "Shift while dragging", "Ten times finer"),
    ("Curves", "Ctrl while dragging", "Snap: to the tracked curve, to 0 (touching), to frames"),
    ("Curves", "Alt and drag", "Edit this side of the face only"),
    ("Curves", "Wheel while dragging", "Change the falloff; with Alt on this side of it only"),
    ("Curves", "Drag an edge of the selection", "Change the range or its falloffs"),
    ("Curves", "Ctrl and click a name", "Choose several curves, to edit them together"),
    ("Curves", "Esc or right button while dragging", "Drop the edit"),
    ("Curves", "Click", "Move the playhead"),
    ("Curves", "Wheel", "Zoom the time; with Shift pan, with Ctrl zoom the millimetres"),
    ("Curves", "Middle drag", "Pan"),
    ("Time ruler", "Drag", "Move the playhead"),
    ("Time ruler", "Shift and drag", "Select a range of time"),
    ("Time ruler", "Double click", "Drop the selection"),
    ("Selection bar", "Drag", "Select a range of time, move it, or change it by its handles"),
    ("Selection bar", "Wheel", "Change both falloffs"),
    ("Face", "Drag", "Turn around the face"),
    ("Face", "Middle or right drag", "Move the view"),
    ("Face", "Wheel", "Zoom"),
    ("Face", "Double click", "Reset the camera"),
    ("Face", "Arrows, after 9", "Turn around the face; with Shift move the view"),
    ("Face", "+ and −, after 9", "Zoom; 0 looks from the front again"),
    ("Face", "Hold B", "See the face as tracked"),
    ("Sound", "Drag", "Scrub, and hear it"),
    ("Sound", "Alt and drag", "Move the sound in time; with Shift ten times finer"),
    ("Window", "Drop a file", "Open a take, load edits, or add sound or film"),
)
# fmt: on


class Actions:
    """The commands as Qt actions, with the menus that hold them.

    Args:
        window: gets the menus and the shortcuts.
        handlers: what to do for each `Command.id`.
    """

    def __init__(self, window: QMainWindow, handlers: Mapping[str, Callable[[], None]]) -> None:
        self._actions: dict[str, QAction] = {}
        self.recent_menu = QMenu("Open &recent", window)
        self.presets_menu = QMenu("My p&resets", window)
        own = {"recent": self.recent_menu, "presets": self.presets_menu}
        menus = {name: window.menuBar().addMenu(f"&{name}") for name in MENUS}
        inner: dict[str, QMenu] = {}
        for command in COMMANDS:
            menu = menus[command.menu]
            if command.starts_group:
                menu.addSeparator()
            if command.submenu:
                if command.submenu not in inner:
                    inner[command.submenu] = menu.addMenu(command.submenu)
                menu = inner[command.submenu]
            if command.id in own:
                action = menu.addMenu(own[command.id])
            else:
                action = self._create(command, window, handlers[command.id])
                menu.addAction(action)
            self._actions[command.id] = action
        self.enable_for_take(False)

    def __getitem__(self, name: str) -> QAction:
        return self._actions[name]

    @staticmethod
    def _create(command: Command, window: QMainWindow, handler: Callable[[], None]) -> QAction:
        action = QAction(command.text, window)
        action.setObjectName(command.id)
        action.setCheckable(command.checkable)
        action.setShortcuts([QKeySequence(keys) for keys in command.keys])
        action.setShortcutContext(Qt.ShortcutContext.WindowShortcut)
        if command.icon:
            action.setIcon(icon(command.icon))
        if command.tip:
            keys = f"  ({shown_keys(command.keys[0])})" if command.keys else ""
            action.setToolTip(command.tip + keys)
            action.setStatusTip(command.tip)
        action.triggered.connect(lambda _checked=False: handler())
        return action

    def enable_for_take(self, is_open: bool) -> None:
        """Grey out what needs a take while none is open."""
        for command in COMMANDS:
            if command.needs_take:
                self._actions[command.id].setEnabled(is_open)


def shown_keys(keys: str) -> str:
    """A shortcut as this platform spells it, such as ⌘Z."""
    return QKeySequence(keys).toString(QKeySequence.SequenceFormat.NativeText)


def help_rows() -> Iterator[tuple[str, str, str]]:
    """(section, keys or gesture, what it does) of everything that has a shortcut."""
    for command in COMMANDS:
        if command.keys:
            keys = "  or  ".join(shown_keys(k) for k in command.keys)
            text = command.tip or command.text.replace("&", "").rstrip("…")
            yield command.menu, keys, text
    yield from GESTURES

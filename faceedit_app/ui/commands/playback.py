"""The Playback menu: playing, the playhead, and marking a selection at it."""

from __future__ import annotations

from faceedit_app.ui.commands import conditions as c
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.state.actions import Command, Menu


class PlaybackCommands:
    """Plays the take and moves the playhead."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._playback, self._timeline = workspace.playback, workspace.timeline
        self._sound = workspace.sound_player

    def play(self) -> None:
        """Play or pause."""
        self._playback.toggle()

    def play_around(self) -> None:
        """Play the selection, or around the playhead, once; then return."""
        self._playback.play_around()

    def shuttle(self, direction: int) -> None:
        """Play forwards (1) or backwards (-1); again is faster."""
        self._playback.shuttle(direction)
        if self._playback.playing:  # faster than the chosen speed, which the bar shows
            way = "backwards" if direction < 0 else "forwards"
            self._workspace.message.emit(f"Playing {way} at {abs(self._playback.pace):g}×")

    def stop(self) -> None:
        """Pause."""
        self._playback.pause()

    @property
    def loops(self) -> bool:
        """Whether playing repeats."""
        return self._playback.loop

    def loop(self) -> None:
        """Switch looping of the selection, or of the whole take, on or off."""
        self._playback.set_loop(not self._playback.loop)

    @property
    def has_sound(self) -> bool:
        """Whether the take has sound that can be heard."""
        return self._workspace.media.sound is not None

    @property
    def muted(self) -> bool:
        """Whether the sound is muted."""
        return self._sound.muted

    def mute(self) -> None:
        """Mute or unmute the take's sound."""
        self._sound.set_muted(not self._sound.muted)

    # --- the playhead ------------------------------------------------------------------------

    def step_frames(self, frames: int) -> None:
        """Move the playhead by frames."""
        self._timeline.step(frames)

    def step_seconds(self, seconds: float) -> None:
        """Move the playhead by seconds."""
        self._timeline.visit(self._timeline.time + seconds)

    def go_to_start(self) -> None:
        """Go to the first frame."""
        self._timeline.go_to_frame(0)

    def go_to_end(self) -> None:
        """Go to the last frame."""
        self._timeline.go_to_frame(self._timeline.frames - 1)

    def type_time(self) -> None:
        """Let the user type a time to go to."""
        if self._workspace.page is not None:
            self._workspace.page.transport.type_time()

    def mark_start(self) -> None:
        """Start the selection at the playhead."""
        line = self._timeline
        last = line.snap(line.duration)
        end = line.own_selection[1] if line.own_selection else last
        line.select((line.time, end if end > line.time else last))

    def mark_end(self) -> None:
        """End the selection at the playhead."""
        line = self._timeline
        start = line.own_selection[0] if line.own_selection else 0.0
        line.select((start if start < line.time else 0.0, line.time))


# fmt: off
MENU: Menu[PlaybackCommands] = Menu("&Playback", (
    Command("play", "&Play / pause", PlaybackCommands.play, ("Space",), "Play or pause", "play"),
    Command("play_around", "Play a&round", PlaybackCommands.play_around, ("/",),
            "Play the selection, or around the playhead, once; then return"),
    Command("rewind", "Play bac&kwards", lambda do: do.shuttle(-1), ("J",),
            "Play backwards; press again to go faster"),
    Command("stop", "&Stop", PlaybackCommands.stop, ("K",), "Pause"),
    Command("fast_forward", "Play for&wards", lambda do: do.shuttle(1), ("L",),
            "Play forwards; press again to go faster"),
    Command("loop", "&Loop", PlaybackCommands.loop, ("Ctrl+L",),
            "Repeat the selection, or the whole take", "loop", checked=lambda do: do.loops),
    Command("mute", "&Mute sound", PlaybackCommands.mute, ("Ctrl+M",),
            "Mute the take's sound", "sound", enabled=c.HAS_SOUND,
            checked=lambda do: do.muted),
    Command("back", "Frame &back", lambda do: do.step_frames(-1), ("Left",), "Go one frame back",
            "back", starts_group=True),
    Command("forward", "Frame &forward", lambda do: do.step_frames(1), ("Right",),
            "Go one frame forward", "forward"),
    Command("second_back", "Secon&d back", lambda do: do.step_seconds(-1), ("Shift+Left",),
            "Go one second back"),
    Command("second_forward", "Second f&orward", lambda do: do.step_seconds(1), ("Shift+Right",),
            "Go one second forward"),
    Command("start", "Go to s&tart", PlaybackCommands.go_to_start, ("Home",),
            "Go to the first frame", "start"),
    Command("end", "Go to &end", PlaybackCommands.go_to_end, ("End",), "Go to the last frame",
            "end"),
    Command("go_to", "&Go to a time…", PlaybackCommands.type_time, ("G",),
            "Type a time to go to, in the unit in which times are shown"),
    Command("mark_start", "Start selection &here", PlaybackCommands.mark_start, ("I",),
            "Start the selection at the playhead", starts_group=True),
    Command("mark_end", "E&nd selection here", PlaybackCommands.mark_end, ("O",),
            "End the selection at the playhead"),
))
# fmt: on

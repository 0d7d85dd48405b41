"""`faceedit live` and `faceedit record`: faces to and from other programs, in real time."""

from __future__ import annotations

import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Optional

import typer

from faceedit_app.command_line import json_output
from faceedit_app.command_line.opening import edited_session
from faceedit_app.command_line.options import (
    EditsOption,
    FollowHeadOption,
    FpsOption,
    JsonOption,
    ModelsOption,
    TakeArgument,
    check_csv,
)
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.texts import say


def live(
    take: TakeArgument,
    host: Annotated[str, typer.Option(help="Where to send it.")] = "127.0.0.1",
    port: Annotated[
        Optional[int],  # noqa: UP045
        typer.Option(help="The port there; default: the protocol's."),
    ] = None,
    protocol: Annotated[
        str, typer.Option(help="livelink (Unreal) or vmc (VSeeFace, Warudo, Unity).")
    ] = "livelink",
    edits: EditsOption = None,
    loop: Annotated[bool, typer.Option("--loop", help="Begin again at the end.")] = False,
    follow_head: FollowHeadOption = False,
    fps: FpsOption = None,
    models: ModelsOption = None,
) -> None:
    """Play a take into another program, in real time; Ctrl+C stops it."""
    from faceedit_app.editing.streaming import play
    from faceedit_app.live.protocols import Sender, find_protocol

    chosen = find_protocol(protocol, sends=True)
    session = edited_session(take, fps, edits, models)
    session.live.work()
    sender = Sender(chosen, host, chosen.port if port is None else port)
    try:
        say(f"Sending {take.name} as {chosen.name} to {host}:{sender.address[1]}")
        say(f"  {chosen.hints[0]}.")
        play(session, sender, loop, follows_head=follow_head)
    finally:
        sender.close()


def record(
    output: Annotated[Path, typer.Argument(help="The new take: a Live Link Face CSV.")],
    protocol: Annotated[str, typer.Option(help="livelink, vmc or ifacialmocap.")] = "livelink",
    host: Annotated[str, typer.Option(help="The address to listen on.")] = "0.0.0.0",
    port: Annotated[
        Optional[int],  # noqa: UP045
        typer.Option(help="The port to listen on; default: the protocol's."),
    ] = None,
    phone: Annotated[
        str, typer.Option(help="For ifacialmocap: the phone's address, which the app shows.")
    ] = "",
    seconds: Annotated[
        Optional[float],  # noqa: UP045
        typer.Option(help="Stop after this many seconds; default: at Ctrl+C."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Record a take from a phone, or from another program."""
    from faceedit_app.editing.recording import Recorder
    from faceedit_app.formats.opening import open_take
    from faceedit_app.formats.summary import summarize
    from faceedit_app.live.protocols import find_protocol, own_address

    check_csv(output)
    chosen = find_protocol(protocol)
    recorder = Recorder(output, chosen, host, port, phone)
    try:
        address = own_address() if host == "0.0.0.0" else host
        where = f"Listening for {chosen.name} on {address}:{recorder.address[1]}; Ctrl+C stops"
        for line in (where, f"  {chosen.hints[1]}."):
            say(line, to=sys.stderr if as_json else sys.stdout)
        wait_for_end(seconds)
    finally:
        has_frames = recorder.stop()
    if recorder.error is not None:
        raise recorder.error
    if not has_frames:
        raise FaceEditError(
            f"Nothing was received ({recorder.ignored} packets were not understood)"
        )
    if as_json:
        facts = summarize(open_take(output))
        json_output.say_json(facts | {"packets_ignored": recorder.ignored})
        return
    say(f"{output}: {recorder.frames} frames, {recorder.seconds:.2f} s")


def wait_for_end(seconds: float | None) -> None:
    """Wait so long, or until Ctrl+C."""
    with suppress(KeyboardInterrupt):
        threading.Event().wait(seconds)

"""Which channels an edit can name in place of curves, and what it may do to them."""

from __future__ import annotations

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX, ROTATIONS, mirrored_channel
from faceedit_app.core.levels import STRONGEST_LEVEL, is_level
from faceedit_app.core.texts import did_you_mean

# All that an edit can name: weights in ARKit order, then rotations in degrees.
CHANNELS: tuple[str, ...] = (*ARKIT_CHANNELS, *ROTATIONS)
CHANNEL_INDEX: dict[str, int] = {name: k for k, name in enumerate(CHANNELS)}

# Operations on channels, and those that only channels have.
OPS = frozenset({"offset", "scale", "smooth", "draw", "limit", "neutral", "levels"})
CHANNEL_OPS = frozenset({"limit", "neutral", "levels"})
# How many amounts each channel has.
_AMOUNTS = {"neutral": 2, "levels": 3}


def is_rotation(channel: str) -> bool:
    """Whether a channel is a rotation, in degrees, rather than a weight."""
    return channel not in ARKIT_INDEX


def channel_problem(
    channels: tuple[str, ...], op: str, value: float, amounts: tuple[tuple[float, ...], ...]
) -> str:
    """What is wrong with these fields of an edit, as a phrase; empty if nothing is."""
    if not channels:
        if op in CHANNEL_OPS:
            return f'a {op} needs "channels"'
        return "only an edit of channels can have amounts" if amounts else ""
    if unknown := [name for name in channels if name not in CHANNEL_INDEX]:
        near = did_you_mean(unknown[0], CHANNEL_INDEX)
        return f"unknown channel {unknown[0][:40]!r}{near}"
    if len(set(channels)) < len(channels):
        return "it names a channel twice"
    if len({is_rotation(name) for name in channels}) > 1:
        return "it names weights and rotations together, which have different units"
    if op not in OPS:
        return f"channels have no {op}"
    if op == "limit" and value <= 0:
        return "a limit needs a value above 0"
    return _amounts_problem(channels, op, amounts)


def _amounts_problem(
    channels: tuple[str, ...], op: str, amounts: tuple[tuple[float, ...], ...]
) -> str:
    width = _AMOUNTS.get(op, 0)
    if not width:
        return f"a {op} has no amounts" if amounts else ""
    if len(amounts) != len(channels) or any(len(row) != width for row in amounts):
        return f"a {op} needs {width} amounts for each channel"
    if is_rotation(channels[0]):
        return f"a {op} needs weights, not rotations"
    if op == "neutral" and not all(0 <= rest < peak for rest, peak in amounts):
        return "a neutral needs a rest of 0 or more, below its peak"
    if op == "levels" and not all(
        is_level((factor, offset, limit)) for factor, offset, limit in amounts
    ):
        return (
            f"levels need a multiplier of 0 to {STRONGEST_LEVEL:g}, an offset of -1 to 1 and a "
            "ceiling above 0, at most 1"
        )
    return ""


def mirrored_channels(channels: tuple[str, ...]) -> tuple[str, ...]:
    """The same channels on the other side of the face."""
    return tuple(_mirrored(name) for name in channels)


def _mirrored(name: str) -> str:
    if name in ARKIT_INDEX:
        return mirrored_channel(name)
    if name.startswith("leftEye"):
        return name.replace("leftEye", "rightEye")
    return name.replace("rightEye", "leftEye")

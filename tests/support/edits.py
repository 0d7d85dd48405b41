"""Any edit that the application allows, for tests that hold for all of them."""

from __future__ import annotations

from hypothesis import strategies as st

from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.editing.edits.channels import CHANNEL_OPS
from faceedit_app.editing.edits.edit import (
    LONGEST_SMOOTH,
    STRONGEST,
    WITH_POINTS,
    Company,
    Edit,
    Op,
)
from support.chance import CHARACTERS

_shares = st.lists(st.floats(0, 1), min_size=1, max_size=4)


@st.composite
def pins(draw: st.DrawFn, start: float, end: float) -> tuple[tuple[float, float], ...]:
    """Any pins that a retime from `start` to `end` may have, with cuts and holds."""
    was, now = (sorted(draw(_shares)) for _ in range(2))
    width = end - start
    return tuple((start + a * width, start + b * width) for a, b in zip(was, now, strict=False))


_points = st.dictionaries(st.floats(-100, 1e5), st.floats(0, 100), min_size=1, max_size=5)


@st.composite
def edits(draw: st.DrawFn) -> Edit:
    """Edits with every field that their operation has."""
    start = draw(st.floats(-100, 1e5))
    op = draw(st.sampled_from([op for op in Op if op.value not in CHANNEL_OPS]))
    values = {Op.SCALE: st.floats(0, 50), Op.SMOOTH: st.floats(0, LONGEST_SMOOTH)}
    end, retimes = start + draw(st.floats(0, 1000)), op is Op.RETIME
    return Edit(
        controls=tuple(draw(st.lists(st.sampled_from(CONTROL_IDS), min_size=1, unique=True))),
        op=op,
        start=start,
        end=end,
        falloff=0.0 if retimes else draw(st.floats(0, 10)),
        value=draw(values.get(op, st.floats(-100, 100))),
        falloff_out=None if retimes else draw(st.none() | st.floats(0, 10)),
        strength=draw(st.floats(0, STRONGEST)),
        enabled=draw(st.booleans()),
        name=draw(st.text(CHARACTERS, max_size=5)),
        about=draw(st.none() | st.floats(0, 50)) if op is Op.SCALE else None,
        points=tuple(sorted(draw(_points).items())) if op in WITH_POINTS else (),
        companions=draw(st.sampled_from(Company)),
        pins=draw(pins(start, end)) if retimes else (),
    )


def offset(
    control: str | tuple[str, ...], start: float, end: float, value: float, falloff: float = 0.1
) -> Edit:
    """An edit that moves curves by so many mm."""
    controls = (control,) if isinstance(control, str) else control
    return Edit(controls, Op.OFFSET, start, end, falloff, value)

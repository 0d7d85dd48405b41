"""Takes and sessions for tests: on a clip, on a file, or on the shipped demo."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.clip import Clip
from faceedit_app.core.resources import shipped
from faceedit_app.editing.opening import load_engine, open_session
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import Take
from faceedit_app.networks.engine import Engine
from support.faces import random_engine, shipped_rig
from support.takes import NoFile

_CLOSE, _JAW = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]


def take_of(clip: Clip) -> Take:
    """A take with nothing but its clip."""
    return Take(Path("take.csv"), "none", clip, (), (), NoFile())


@lru_cache(maxsize=1)
def demo_take() -> Take:
    """The take that FaceEdit ships with."""
    return open_take(shipped("assets/demo_take.csv"))


@lru_cache(maxsize=8)
def engine(seed: int = 11) -> Engine:
    """Networks that answer nonsense, the same for each seed."""
    return random_engine(seed)


@lru_cache(maxsize=1)
def shipped_engine() -> Engine:
    """The networks that FaceEdit ships with."""
    return load_engine(shipped_rig())


def session_by_rig(take: Take | Clip | Path) -> EditSession:
    """A session on the shipped character, answered without networks."""
    return open_session(take_of(take) if isinstance(take, Clip) else take, shipped_rig())


def session_by_networks(
    take: Take | Clip | Path, networks: Engine | None = None, **settings: Any
) -> EditSession:
    """A session on the shipped character, answered by networks (those of `engine`)."""
    take = take_of(take) if isinstance(take, Clip) else take
    session = open_session(take, shipped_rig(), networks or engine())
    session.configure(replace(session.settings, **settings))
    return session


def strengthen(session: EditSession, index: int, strength: float) -> None:
    """Make one edit weaker or stronger, as one step."""
    session.replace_edit(index, replace(session.edits[index], strength=strength), "Strength")


def switch(session: EditSession, index: int, on: bool) -> None:
    """Switch one edit on or off, as one step."""
    session.replace_edit(index, replace(session.edits[index], enabled=on), "Switch")


def assert_believable(session: EditSession) -> None:
    """What is shown is a face: weights are from 0 to 1, and lips close no further than the jaw."""
    weights = session.weights
    assert np.isfinite(weights).all()
    assert np.isfinite(session.achieved).all()
    assert weights.min() >= 0
    assert weights.max() <= 1
    assert (weights[:, _CLOSE] <= weights[:, _JAW] + 1e-6).all()

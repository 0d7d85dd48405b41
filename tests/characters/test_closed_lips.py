"""Heads that were scanned with open lips get a mouth that rests closed along its whole length."""

from __future__ import annotations

import numpy as np
import pytest
from support.faces import shipped_rig

from faceedit_app.characters import making
from faceedit_app.characters.making import Template, make
from faceedit_app.characters.registration import FittedTemplate
from faceedit_app.characters.scans import Scan
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.rig import Rig


@pytest.fixture(scope="module")
def template() -> Template:
    return Template.of(shipped_rig())


def _seam_gaps(template: Template, skin: Doubles) -> Doubles:
    """(P,) mm by which lips are farther apart than the template's, from corner to corner."""
    upper, lower = template.lip_seam.pairs.T
    rest, here = (
        np.linalg.norm(places[lower] - places[upper], axis=1)
        for places in (template.vertices, skin)
    )
    gaps: Doubles = here - rest
    return gaps


def _skin(template: Template, rig: Rig) -> Doubles:
    rows = np.flatnonzero(template.vertex_of >= 0)
    skin = np.empty_like(template.vertices)
    skin[template.vertex_of[rows]] = 1000.0 * rig.neutral[rows]
    return skin


def test_the_seam_runs_from_corner_to_corner(template: Template) -> None:
    upper, lower = template.lip_seam.pairs.T
    x = template.vertices[upper, 0]
    corner = template.vertices[template.points["left_mouth_corner"], 0]
    assert x.max() > 0.7 * corner
    assert x.min() < -0.7 * corner
    opened = template.vertices + template.moves[template.rig.channel_index["jawOpen"]]
    middle = np.abs(x) < 0.4 * corner
    assert (opened[upper, 1] - opened[lower, 1])[middle].min() > 15


# As if the template were fitted exactly, which takes seconds; `test_making.py` fits it to a head
# whose jaw is a little open.
@pytest.mark.parametrize(
    "shapes",
    [
        {"jawOpen": 0.5, "mouthSmileLeft": 0.3},
        {"mouthFunnel": 0.6},
        {"mouthUpperUpLeft": 0.8, "mouthLowerDownRight": 0.5},  # open, but not in the middle
    ],
)
def test_open_lips_meet_from_corner_to_corner(
    template: Template, shapes: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    index = template.rig.channel_index
    opened = template.vertices + sum(w * template.moves[index[c]] for c, w in shapes.items())
    monkeypatch.setattr(making, "register", lambda *_: FittedTemplate(opened, np.eye(4)))
    scan = Scan(opened, np.asarray(template.faces, np.int32), None)
    points = {name: opened[vertex] for name, vertex in template.points.items()}
    made = make(template, scan, template.landmarks(points), "Open")
    assert made.parted > 1.0
    assert _seam_gaps(template, made.skin).max() > 1.0
    skin = _skin(template, made.rig)
    gaps = _seam_gaps(template, skin)
    assert (np.abs(gaps) < 0.5).all()
    upper, lower = template.lip_seam.pairs.T
    heights = (skin - template.vertices)[upper, 1] - (skin - template.vertices)[lower, 1]
    assert heights.min() > -0.5, "no lip passes the other"
    still = np.linalg.norm(template.vertices - template.vertices[upper[0]], axis=1) > 120
    np.testing.assert_allclose(skin[still], made.skin[still], atol=0.1)  # mm


def test_closed_lips_stay_as_they_were_scanned(template: Template) -> None:
    closed, parted = template.lip_seam.closed(
        1.02 * template.vertices, template.moves[template.rig.channel_index["jawOpen"]]
    )
    assert parted == 0.0
    np.testing.assert_array_equal(closed, 1.02 * template.vertices)

"""The table of controls: its rows fit together, and nobody outside core knows one by heart."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.places import ROOT

from faceedit_app.core.controls import (
    COLORS,
    CONTROL_IDS,
    CONTROLS,
    LIDS,
    LIP_OPENING,
    MAIN_CONTROLS,
    MIRRORED_CONTROL,
    OPTIONAL_CONTROLS,
    Closes,
    Control,
    control_named,
)
from faceedit_app.core.regions import LOWER, OPTIONAL_REGIONS, REGIONS

PACKAGE = ROOT / "faceedit_app"
# Where an id is also another word: the command that lowers a curve, the upper and lower eyelid in
# names of blendshapes, the lips as control points, and a heading.
OTHER_WORDS = {
    "ui/commands/tools.py": {"lower"},
    "ui/page/curve_menus.py": {"lower"},
    "characters/assembly.py": {"upper", "lower"},
    "characters/checklist.py": {"upper_lip", "lower_lip"},
    "characters/names.py": {"upper", "lower"},
    "characters/matches.py": {"upper", "lower"},
    "characters/other_names.py": {"upper", "lower"},
    "characters/points.py": {"upper_lip", "lower_lip"},
    "lab/evaluation/people/report.py": {"eyelids"},
    "tracking/face_points.py": {"upper_lip", "lower_lip"},
}


@pytest.mark.parametrize("control", CONTROLS, ids=CONTROL_IDS)
def test_row_fits_the_others(control: Control) -> None:
    regions = OPTIONAL_REGIONS if control.optional else REGIONS
    assert control.region in {region.id for region in regions}
    assert {*control.heard_by} <= {region.id for region in REGIONS} - {control.region}
    assert {*control.leads} <= {*CONTROL_IDS} - {control.id}
    assert all(control_named(name).region == control.region for name in control.leads)
    assert control.color in COLORS
    if control.mirror:
        other = control_named(control.mirror)
        assert other.mirror == control.id != control.mirror
        assert (other.region, other.heard_by, other.color) == (
            control.region,
            control.heard_by,
            control.color,
        )
        assert other.label.lower().replace("right", "left") == control.label.lower().replace(
            "right", "left"
        )


def test_ids_labels_and_keys_are_each_their_own() -> None:
    for values in (CONTROL_IDS, [c.label for c in CONTROLS], [c.key for c in CONTROLS if c.key]):
        assert len({*values}) == len(values)


def test_regions_listen_to_their_own_controls_in_the_order_of_the_table() -> None:
    for region in REGIONS:
        assert {*region.own} <= {*region.controls}
        assert list(region.controls) == sorted(region.controls, key=CONTROL_IDS.index)
    assert sorted(name for region in REGIONS for name in region.own) == sorted(MAIN_CONTROLS)
    optional = [name for region in OPTIONAL_REGIONS for name in region.own]
    assert sorted(optional) == sorted(OPTIONAL_CONTROLS)
    assert not any(region.controls for region in OPTIONAL_REGIONS), "no network listens to them"


def test_what_is_measured_across_the_face_is_alone_in_its_region() -> None:
    across = {control.region for control in CONTROLS if control.sideways}
    assert across == {region.id for region in OPTIONAL_REGIONS if region.is_sideways}
    for region in (region for region in OPTIONAL_REGIONS if region.is_sideways):
        assert len(region.own) == 1
        assert len(region.channels) in (2, 4), "pairs, left and right"
        for left, right in zip(region.channels[::2], region.channels[1::2], strict=True):
            assert left.removesuffix("Left") == right.removesuffix("Right")


def test_what_closes_is_said_by_the_table() -> None:
    assert control_named(LIP_OPENING).region == LOWER.id
    assert tuple(c.id for c in CONTROLS if c.closes is Closes.EYES) == LIDS
    assert {MIRRORED_CONTROL[lid] for lid in LIDS} == {*LIDS}


_HALVES = re.compile(r"""(["'])\s*f?\1""")


def _texts(path: Path) -> Iterator[tuple[int, str]]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.lineno, node.value


def _files() -> list[Path]:
    return [p for p in PACKAGE.rglob("*.py") if p.relative_to(PACKAGE).parts[0] != "core"]


def test_no_control_and_no_region_is_named_outside_core() -> None:
    names = {*CONTROL_IDS, *(region.id for region in (*REGIONS, *OPTIONAL_REGIONS))}
    quoted = re.compile(rf"""["'}}]({"|".join(names)})["'{{]""")
    # Parsing all files would take seconds; a text in two halves counts as well.
    suspects = [p for p in _files() if quoted.search(_HALVES.sub("", p.read_text("utf-8")))]
    assert len(suspects) >= len(OTHER_WORDS)
    found = [
        f"{path.relative_to(PACKAGE)}:{line}: {text!r}"
        for path in suspects
        for line, text in _texts(path)
        if text in names - OTHER_WORDS.get(path.relative_to(PACKAGE).as_posix(), set())
    ]
    assert not found, "take them from core.controls and core.regions"


def test_the_table_is_not_counted_or_cut_outside_core() -> None:
    """No `(T, 8)`, no `CONTROL_IDS[6:]`, no `REGIONS[0]`."""
    counted = re.compile(r"\b[TNM]'?, 8\)|\(8,\)|(CONTROL_IDS|CONTROLS|REGIONS)\[[-\d:]")
    found = [
        f"{path.relative_to(PACKAGE)}:{number}: {line.strip()}"
        for path in _files()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1)
        if counted.search(line)
    ]
    assert not found

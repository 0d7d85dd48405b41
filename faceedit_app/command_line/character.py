"""`faceedit character`: inspect a character, measure its closures, or make one of a scan."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Optional

import typer

from faceedit_app.command_line.json_output import say_kept
from faceedit_app.command_line.opening import rig_of
from faceedit_app.command_line.options import JsonOption, ModelsOption
from faceedit_app.core import on_disk
from faceedit_app.core.atomic import check_folder, check_outputs
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.texts import say

if TYPE_CHECKING:
    from faceedit_app.characters.fitted import FittedCharacter
    from faceedit_app.core.arrays import Doubles
    from faceedit_app.core.rig import Rig
    from faceedit_app.networks.engine import Engine

_FITS_BADLY = 20.0  # mm from the scan, at the 95th percentile

app = typer.Typer(help="Check or make a character of your own.", no_args_is_help=True)

CharacterArgument = Annotated[
    Path, typer.Argument(help="A GLB, glTF, VRM, binary FBX or OBJ, or a folder of OBJ.")
]


@app.command()
def inspect(
    file: CharacterArgument,
    as_json: JsonOption = False,
    write_map: Annotated[
        bool,
        typer.Option(
            "--write-map", help="Write its map next to it for editing; an existing map is kept."
        ),
    ] = False,
) -> None:
    """Show which of its shapes are used, which are missing or dead, and where its points are."""
    from faceedit_app.characters import map_file
    from faceedit_app.characters.fitted import open_character

    fitted = open_character(file)
    if write_map:
        path = map_file.map_path(file)
        if on_disk.exists(path):
            raise FileError(path, "exists", "edit it, or delete it first")
        map_file.write_map(path, fitted.whole_map)
    say(json.dumps(_facts(fitted), indent=2) if as_json else _text(fitted))


@app.command()
def seal(
    file: CharacterArgument,
    takes: Annotated[list[Path], typer.Argument(help="Takes, such as Live Link Face CSVs.")],
    as_json: JsonOption = False,
    output: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option("-o", "--output", help="Folder for the takes with lips and lids closed."),
    ] = None,
    models: ModelsOption = None,
) -> None:
    """Measure how often lips and lids stay open on it where FaceEdit's own character closes them.

    Prints the result before and after closing them by the smallest believable change.
    """
    from faceedit_app.editing.opening import load_engine, shipped_rig

    _check_output(output, takes)
    theirs, ours = rig_of(file), shipped_rig()
    covariances = _covariances(load_engine(ours, models))
    facts = {"character": str(file), **_closed(ours, theirs, covariances, takes, output)}
    say(json.dumps(facts, indent=2) if as_json else _seal_text(facts))


def _closed(
    ours: Rig,
    theirs: Rig,
    covariances: dict[str, Doubles],
    takes: list[Path],
    output: Path | None,
) -> dict[str, Any]:
    """Close lips and lids of takes, write the takes if asked to, and say what that changed."""
    import numpy as np

    from faceedit_app.characters.closure import Openings, closure, together
    from faceedit_app.core.arkit import ARKIT_INDEX
    from faceedit_app.editing.solving.closing import Closing
    from faceedit_app.formats.opening import open_take, write_take

    on_ours, on_theirs = Openings.of(ours), Openings.of(theirs)
    own, before, after, changed = [], [], [], []
    for path in takes:
        take = open_take(path)
        closing = Closing(ours, theirs, frozenset(take.clip.channels), covariances)
        weights = take.clip.arkit_weights()
        closed = closing(weights)
        own.append(on_ours.measure(weights))
        before.append(on_theirs.measure(weights))
        after.append(on_theirs.measure(closed))
        changed.append(np.abs(closed - weights))
        if output is not None:
            columns = [ARKIT_INDEX[channel] for channel in take.clip.channels]
            write_take(output / path.name, take, np.ascontiguousarray(closed[:, columns]))
    shut, moved = together(own), np.concatenate(changed)
    figures = {
        name: vars(closure(shut, together(gaps)))
        for name, gaps in (("before", before), ("after", after))
    }
    return {
        "takes": [str(path) for path in takes],
        "frames": len(shut),
        "changed_frames": int((moved > 0).any(axis=1).sum()),
        "median_change": {
            channel: round(_median(moved[:, ARKIT_INDEX[channel]]), 4)
            for channel in ("jawOpen", "mouthClose", "eyeBlinkLeft", "eyeBlinkRight")
        },
        **{
            share: {when: figures[when][share] for when in figures}
            for share in ("lips_open_share", "lids_open_share")
        },
        **figures,
    }


@app.command()
def make(
    scan: Annotated[Path, typer.Argument(help="OBJ, PLY, STL or GLB of a neutral face.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="The new character (GLB).")],
    points: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="Control points on the scan (JSON); see docs/characters.md."),
    ] = None,
    landmarker: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="MediaPipe's face_landmarker.task, which finds the points by itself."),
    ] = None,
    without: Annotated[
        Optional[list[str]],  # noqa: UP045
        typer.Option(help="hair, brows or lashes: do not add FaceEdit's; repeatable."),
    ] = None,
) -> None:
    """Make all 52 blendshapes for a head that has none, from FaceEdit's own character."""
    from faceedit_app.characters.glb_writing import write_rig
    from faceedit_app.characters.leaving_out import PARTS, without_parts
    from faceedit_app.characters.making import Template
    from faceedit_app.characters.making import make as make_head
    from faceedit_app.characters.scans import read_scan
    from faceedit_app.editing.opening import shipped_rig
    from faceedit_app.scans.landmarks import find_landmarks, read_points

    left_out = without or []
    for part in left_out:
        if part not in PARTS:
            raise FaceEditError(f"--without {part[:40]}: must be {', '.join(PARTS)}")
    check_outputs([output], [scan, points, landmarker])
    template, head = Template.of(shipped_rig()), read_scan(scan)
    if points is not None:
        landmarks = template.landmarks(read_points(points))
    else:
        landmarks = find_landmarks(template, head, scan, landmarker)
    made = make_head(template, head, landmarks, output.stem)
    say_kept(output, write_rig(output, without_parts(made.rig, left_out)))
    middle, most = made.distance_to(head)
    for sentence in head.remarks:
        say(f"{scan}: {sentence}", to=sys.stderr)
    if made.parted:
        say(f"{scan}: its lips are {made.parted:.1f} mm apart; they were closed", to=sys.stderr)
    if most > _FITS_BADLY:
        say(
            f"{scan}: fits badly in places: look at the new character, or give control points "
            "with --points",
            to=sys.stderr,
        )
    say(
        f"{output}: {len(landmarks.positions)} landmarks; the skin of the face is {middle:.2f} mm "
        f"from the scan (95 % within {most:.2f} mm)"
    )


def _covariances(engine: Engine) -> dict[str, Doubles]:
    return {region: model.description.covariance for region, model in engine.models.items()}


def _check_output(output: Path | None, takes: Iterable[Path]) -> None:
    """Check that writing into a folder replaces no take."""
    if output is None:
        return
    if not on_disk.is_folder(output):
        raise FaceEditError(f"--output {output}: is not a folder; create it first")
    check_folder(output)
    names: set[str] = set()
    for path in takes:
        if on_disk.exists(output / path.name) or path.name in names:
            raise FileError(output / path.name, "exists", "choose another folder")
        names.add(path.name)


def _median(values: Any) -> float:
    import numpy as np

    moved = values[values > 0]
    return float(np.median(moved)) if len(moved) else 0.0


def _facts(fitted: FittedCharacter) -> dict[str, Any]:
    """The facts that `inspect --json` prints."""
    check, character = fitted.checklist, fitted.character
    millimetres = 1000.0 * fitted.rig.neutral
    return {
        "file": str(character.path),
        "format": character.format,
        "attribution": character.attribution,
        "vertices": character.vertex_count,
        "triangles": character.triangle_count,
        "scale_mm": round(1000.0 * fitted.frame.scale, 6),
        "matched": {channel: list(names) for channel, names in check.matched.items()},
        "missing": list(check.missing),
        "dead": list(check.dead),
        "several": {channel: list(names) for channel, names in check.several.items()},
        "unknown": list(check.unknown),
        "lost": list(check.lost),
        "points": {
            name: {
                "part": fitted.places[name].part,
                "vertex": fitted.places[name].vertex,
                "mm": [round(float(x), 2) for x in millimetres[vertex]],
            }
            for name, vertex in fitted.points.items()
        },
        "doubts": list(check.doubts),
        "remarks": list(check.remarks),
    }


def _text(fitted: FittedCharacter) -> str:
    check, character = fitted.checklist, fitted.character
    total = len(check.matched) + len(check.missing)
    lines = [
        f"{character.path}: {character.format}, {character.vertex_count} vertices, "
        f"{character.triangle_count} triangles, one unit is {1000 * fitted.frame.scale:.4g} mm",
        f"Shapes: {len(check.matched)} of ARKit's {total} matched",
    ]
    for title, names in (
        ("Missing", check.missing),
        ("Dead (they move the skin by less than 0.3 mm)", check.dead),
        ("Made of several", [f"{c} = {' + '.join(n)}" for c, n in check.several.items()]),
        ("Not used", check.unknown),
        ("Approximate", check.lost),
    ):
        if names:
            lines.append(f"{title}: {', '.join(names)}")
    lines.append("Points, in mm from between the eyes (left is the character's):")
    for name, vertex in fitted.points.items():
        x, y, z = 1000.0 * fitted.rig.neutral[vertex]
        place = fitted.places[name]
        label = name.replace("_", " ")
        lines.append(
            f"  {label:19}{x:7.1f}{y:7.1f}{z:7.1f}   vertex {place.vertex} of {place.part}"
        )
    lines += [f"Doubtful: {sentence}" for sentence in check.doubts]
    lines += [f"Note: {sentence}" for sentence in check.remarks]
    return "\n".join(_plain(line) for line in lines)


def _seal_text(facts: dict[str, Any]) -> str:
    before, after = facts["before"], facts["after"]
    lines = [f"{facts['character']}: {facts['frames']} frames of {len(facts['takes'])} takes"]
    for what, thing in (("lips", "Lips"), ("lids", "Lids")):
        lines.append(
            f"{thing}, {before[f'{what}_frames']} times shut on FaceEdit's own character: open on "
            f"{100 * before[f'{what}_open_share']:.1f} % before, "
            f"{100 * after[f'{what}_open_share']:.1f} % after closing; within 0.5 mm on "
            f"{100 * before[f'{what}_within_share']:.1f} % before, "
            f"{100 * after[f'{what}_within_share']:.1f} % after"
        )
    moved = ", ".join(f"{name} {value:.3f}" for name, value in facts["median_change"].items())
    lines.append(f"Closing changed {facts['changed_frames']} frames; median change: {moved}")
    return "\n".join(_plain(line) for line in lines)


def _plain(line: str) -> str:
    """A line without terminal control characters: names come from files."""
    return "".join(c if c.isprintable() else "?" for c in line)

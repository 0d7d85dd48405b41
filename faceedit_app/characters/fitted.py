"""A character fitted to FaceEdit: its rig, its control points, and its checklist."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.characters.assembly import Assembler, Assembly
from faceedit_app.characters.character import Character, MeshPart, PartVertex, Surface
from faceedit_app.characters.checklist import DEAD, Checklist, lid_doubts, make_checklist
from faceedit_app.characters.face import Points, WeldedFace
from faceedit_app.characters.face_frame import FaceFrame, find_frame
from faceedit_app.characters.gaze import Eye
from faceedit_app.characters.map_file import CharacterMap, map_path, read_map
from faceedit_app.characters.matches import ShapeMatch, Share
from faceedit_app.characters.names import match_channels
from faceedit_app.characters.one_head import with_one_head
from faceedit_app.characters.percent import REMARK, in_percent
from faceedit_app.characters.pictures import read_textures
from faceedit_app.characters.points import PAIRS, POINTS, find_points
from faceedit_app.characters.registry import read_character
from faceedit_app.characters.welding import Weld, weld
from faceedit_app.core.arkit import ARKIT_CHANNELS, mirrored_channel
from faceedit_app.core.arrays import Bools
from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS, control_named
from faceedit_app.core.errors import FileError
from faceedit_app.core.levels import UNCHANGED, Level, Levels
from faceedit_app.core.regions import OPTIONAL_REGIONS
from faceedit_app.core.rig import Material, Rig

# The kind of a surface, by a word in the name of its part or material; the first match counts.
_SURFACES = {
    "lash": "lashes",
    "brow": "brows",
    "hair": "hair",
    "beard": "hair",
    "teeth": "teeth",
    "tooth": "teeth",
    "tongue": "tongue",
    "gum": "gums",
    "eye": "sclera",
    "cornea": "sclera",
    "iris": "iris",
}
_CLAY = (0.52, 0.44, 0.4, 1.0)  # the colour if the file has none
_SKIN_SHARE = 0.5  # share of skin vertices that makes a part skin
_NODS = 15.0  # degrees; how shapes move upright heads differs by 9, and more on cartoons
_MAKE = "make some: File > Character > Make from a scan"
_MAKE_COMMAND = "make some with faceedit character make"
_ADD_OTHERS = "add others, named as in ARKit"
_FEWEST = 3  # matched channels that are needed to edit a face


@dataclass(frozen=True)
class FittedCharacter:
    """A character that can be shown and measured.

    Attributes:
        character: the character as read from its file.
        rig: for the viewport and the solver; its controls are measured between `points`.
        frame: transforms the file's coordinates to the rig's.
        match: the shapes that make each channel, the user's map included.
        points: the control points that were found, as vertices of the rig.
        places: the same points as vertices of the file.
        checklist: what it can and cannot do.
        mapping: the user's map.
        part_of, vertex_of: (V,) the part, and the vertex in it, of each vertex of the rig.
        eyes: the left and the right eye, if they are turned because they have no shapes.
    """

    character: Character
    rig: Rig
    frame: FaceFrame
    match: ShapeMatch
    points: Points
    places: dict[str, PartVertex]
    checklist: Checklist
    mapping: CharacterMap
    part_of: NDArray[np.int32]
    vertex_of: NDArray[np.int32]
    eyes: tuple[Eye, Eye] | None = None

    def place(self, vertex: int) -> PartVertex:
        """A vertex of the rig, as a vertex of the file."""
        part = self.character.parts[int(self.part_of[vertex])]
        return PartVertex(part.name, int(self.vertex_of[vertex]))

    @property
    def shares(self) -> dict[str, tuple[Share, ...]]:
        """The shapes of the file that make each channel of the rig."""
        named = {c: mirrored_channel(c) if self.frame.swapped else c for c in ARKIT_CHANNELS}
        found = {c: tuple(self.match.shares.get(name, ())) for c, name in named.items()}
        return {channel: shares for channel, shares in found.items() if shares}

    def with_level(self, channel: str, level: Level) -> FittedCharacter:
        """The same character with another strength of one channel."""
        levels = {**self.mapping.levels, channel: level}
        levels = {name: one for name, one in levels.items() if one != UNCHANGED}
        rig = replace(self.rig, levels=Levels(levels))
        before = lid_doubts(self.rig, self.points)
        doubts = [one for one in self.checklist.doubts if one not in before]
        doubts += lid_doubts(rig, self.points)
        return replace(
            self,
            rig=rig,
            checklist=replace(self.checklist, doubts=tuple(doubts)),
            mapping=replace(self.mapping, levels=levels),
        )

    @property
    def whole_map(self) -> CharacterMap:
        """A map with every entry filled in, to be edited by hand."""
        return CharacterMap(dict(self.match.shares), dict(self.places), dict(self.mapping.levels))


def open_character(path: Path | str) -> FittedCharacter:
    """Open a character, with the map next to it if there is one.

    Raises:
        FileError: either cannot be read, or the character is not a face.
    """
    path = Path(path)
    character = read_character(path)
    return fit(character, read_map(map_path(path)))


def fit(character: Character, mapping: CharacterMap | None = None) -> FittedCharacter:
    """Fit a character to FaceEdit.

    Args:
        character: the character as read.
        mapping: the user's map, if any.

    Raises:
        FileError: it has no shapes, or they do not make a face.
    """
    mapping = mapping or CharacterMap()
    _need_shapes(character)
    match = _matched(character, mapping)
    character, others = with_one_head(character, match)
    if others:
        match = _matched(character, mapping)
    character = character.shaped(match.played)
    assembler = Assembler(character, match.shares, match.alike)
    frame = find_frame(character, match.shares, assembler.target)
    remarks = [*character.remarks, *filter(None, (others,))]
    full = in_percent(character, match, assembler.target, frame.scale)
    if full is not None:
        match, assembler = full, Assembler(character, full.shares, full.alike)
        remarks.append(REMARK)
    assembly = assembler.assemble(frame)
    welded = weld(assembly)
    face = WeldedFace.of(assembly, welded)
    found, problems = find_points(face)
    problems = [*_absent_shapes(character, mapping), *problems]
    found = _corrected(found, character, mapping, assembly, welded)
    remarks += [*assembler.remarks, *_frame_remarks(frame)]
    rig, faults = _rig(character, assembly, welded, face, found)
    rig = replace(rig, levels=Levels(mapping.levels))
    points = {name: int(welded.first[number]) for name, number in found.items()}
    lids = lid_doubts(rig, points)
    checklist = make_checklist(match, face, found, problems, lids, [*remarks, *faults])
    places = {
        name: PartVertex(
            character.parts[assembly.part_of[vertex]].name, int(assembly.vertex_of[vertex])
        )
        for name, vertex in points.items()
    }
    return FittedCharacter(
        character=character,
        rig=rig,
        frame=frame,
        match=match,
        points=points,
        places=places,
        checklist=checklist,
        mapping=mapping,
        part_of=assembly.part_of,
        vertex_of=assembly.vertex_of,
        eyes=assembly.eyes,
    )


def _corrected(
    found: Points, character: Character, mapping: CharacterMap, assembly: Assembly, welded: Weld
) -> Points:
    """The points that were found, with those that the file, and before it the user's map, names."""
    named = {name: p for name, p in character.points.items() if name not in mapping.points}
    found = found | _placed(character, named, assembly, welded, strict=False)
    found |= _placed(character, mapping.points, assembly, welded)
    return {name: found[name] for name in POINTS if name in found}


def _frame_remarks(frame: FaceFrame) -> Iterator[str]:
    """What is unusual about how the head lies in its file."""
    if frame.nods > _NODS:
        about = f"by about {frame.nods:.0f}°"
        yield f"the head may nod {about} in its file, and is shown as it is there"
    if frame.swapped:
        yield "left and right of its shapes were reversed and have been swapped"


def _need_shapes(character: Character) -> None:
    if not character.targets:
        export = "export it with its morph targets (shape keys)"
        raise FileError(
            character.path,
            "has no blendshapes",
            f"{export}, or {_MAKE}",
            command_remedy=f"{export}, or {_MAKE_COMMAND}",
        )


def _matched(character: Character, mapping: CharacterMap) -> ShapeMatch:
    match = mapping.applied(match_channels(character.targets, character.meshes))
    _need_match(character, match)
    return match


def _need_match(character: Character, match: ShapeMatch) -> None:
    if len(match.matched) >= _FEWEST:
        return
    known = {share.name for shares in match.shares.values() for share in shares}
    others = [name[:30] for name in character.targets if name not in known]
    count = len(character.targets)
    says = f"none of its {count} shapes has a name that FaceEdit knows"
    if known:
        channels = " and ".join(match.matched)
        says = f"has shapes for {channels} only, and {_FEWEST} channels are needed"
    if others:
        says += f" (unknown: {', '.join(others[:3])}{' …' if len(others) > 3 else ''})"
    file = map_path(character.path).name
    remedy = f"rename them as in ARKit, or map them in {file}" if others else _ADD_OTHERS
    command_remedy = ""
    if not known:  # a scan beside other heads, for example
        remedy, command_remedy = (
            f"{remedy}; if it has no blendshapes, {make}" for make in (_MAKE, _MAKE_COMMAND)
        )
    raise FileError(character.path, says, remedy, command_remedy=command_remedy)


def _absent_shapes(character: Character, mapping: CharacterMap) -> list[str]:
    """Sentences about shapes that the map names and the file lacks."""
    has = set(character.targets)
    return [
        f"the map makes {channel} of {share.name[:60]}, which the file does not have"
        for channel, shares in mapping.channels.items()
        for share in shares
        if share.name not in has
    ]


def _placed(
    character: Character,
    places: Mapping[str, PartVertex],
    assembly: Assembly,
    welded: Weld,
    strict: bool = True,
) -> Points:
    """Control points set by the user or the file, as welded vertices.

    Args:
        strict: whether to raise for a vertex that does not exist.
    """
    numbers = {part.name: number for number, part in enumerate(character.parts)}
    points = {}
    for name, place in places.items():
        part = numbers.get(place.part, -1)
        rows = np.flatnonzero((assembly.part_of == part) & (assembly.vertex_of == place.vertex))
        if len(rows):
            points[name] = int(welded.number[rows[0]])
        elif strict:
            raise FileError(
                map_path(character.path),
                f"puts {name} on vertex {place.vertex} of {place.part[:40]}, which does not exist",
                "choose another vertex, or remove the line",
            )
    return points


def _rig(
    character: Character, assembly: Assembly, welded: Weld, face: WeldedFace, points: Points
) -> tuple[Rig, list[str]]:
    """The rig, and sentences about what cannot be drawn as in the file."""
    skin = face.skin[welded.number]
    textures, numbers, faults = read_textures(assembly.parts)
    materials, runs, stop = [], [], 0
    colors, uv = [], []
    start = 0
    faces = _outwards(assembly, welded, face)
    for number, (part, run) in enumerate(zip(assembly.parts, assembly.runs, strict=True)):
        rows = slice(start, start + len(part.neutral))
        start = rows.stop
        is_bare = part.surface == Surface(part.surface.name) and part.colors is None
        tint = np.array(_CLAY if is_bare else part.surface.color, np.float32)
        own = np.ones((len(part.neutral), 4), np.float32) if part.colors is None else part.colors
        colors.append(own * tint)
        if part.surface.cutoff == 0.0:
            colors[-1][:, 3] = 1.0  # what is opaque is so whatever its alpha
        uv.append(np.zeros((len(part.neutral), 2), np.float32) if part.uv is None else part.uv)
        if numbers[number] is None and part.surface.cutoff > float(colors[-1][:, 3].max()):
            continue  # invisible, such as a cornea
        mine = faces[run[0] : run[1]]
        runs.append(mine)
        materials.append(
            Material(
                part.surface.name or part.name,
                stop,
                stop + len(mine),
                part.surface.roughness,
                part.surface.metallic,
                _surface(part, skin[rows]),
                numbers[number],
                part.surface.cutoff,
            )
        )
        stop += len(mine)
    rig = Rig(
        neutral=assembly.neutral,
        faces=np.concatenate(runs),
        channels=assembly.channels,
        deltas=assembly.deltas,
        colors=np.concatenate(colors),
        materials=tuple(materials),
        control_pairs=_control_pairs(face, points, welded),
        name=character.name,
        attribution=character.attribution,
        uv=np.concatenate(uv) if textures else None,
        textures=tuple(textures),
        shading_groups=welded.number.astype(np.int32),
    )
    return rig, faults


def _control_pairs(face: WeldedFace, points: Points, welded: Weld) -> NDArray[np.int32]:
    """(C, 2) as in `Rig`; without optional controls that no shape of their region moves."""
    pairs = np.full((len(CONTROLS), 2), -1, np.int32)
    movers = {region.id: region.channels for region in OPTIONAL_REGIONS}
    for name, a, b in PAIRS:
        if a not in points or b not in points:
            continue
        control, ends = control_named(name), [points[a], points[b]]
        if control.optional:
            channels = movers[control.region]
            moves = np.stack([np.diff(face.move(c)[ends], axis=0)[0] for c in channels])
            amounts = np.abs(moves[:, 0]) if control.sideways else np.linalg.norm(moves, axis=1)
            if amounts.max() < DEAD:
                continue
        pairs[CONTROL_INDEX[name]] = welded.first[ends]
    return pairs


def _surface(part: MeshPart, skin: Bools) -> str:
    words = f"{part.name} {part.surface.name}".casefold()
    for word, surface in _SURFACES.items():
        if word in words:
            return surface
    return "skin" if skin.mean() > _SKIN_SHARE else ""


def _outwards(assembly: Assembly, welded: Weld, face: WeldedFace) -> NDArray[np.int32]:
    """The triangles, flipped if the face shows its back: some files are mirrored."""
    corners = assembly.neutral[assembly.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lips = np.where(face.skin, face.lips, 0.0)[welded.number][assembly.faces].mean(axis=1)
    if float(normals[:, 2].astype(np.float64) @ lips) >= 0:
        return assembly.faces
    turned: NDArray[np.int32] = np.ascontiguousarray(assembly.faces[:, ::-1])
    return turned

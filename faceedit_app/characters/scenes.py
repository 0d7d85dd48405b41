"""The table of formats that hold a character with the animation of a take.

Exports of takes need the table as well, so what writes scenes is imported when it is used: it
brings SciPy, trimesh and pygltflib, which take longer than the rest of an export.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from faceedit_app.core.clip import Clip
from faceedit_app.core.rig import Rig

if TYPE_CHECKING:
    from faceedit_app.characters.fitted import FittedCharacter
    from faceedit_app.characters.scene import Scene


@dataclass(frozen=True)
class SceneFormat:
    """A format of 3D programs.

    Attributes:
        key: the name on the command line.
        name: shown to the user.
        ending: of its files, in lower case with the dot.
        tools: the programs that read it.
        hints: by program, what to do there; `{rate}` stands for the frame rate.
        write: encodes a scene, given the animation's name and whether to store weights compactly.
        is_compact: whether it can store weights compactly.
        other_ending: another ending that its files may have; "" = none.
    """

    key: str
    name: str
    ending: str
    tools: str
    hints: tuple[tuple[str, str], ...]
    write: Callable[[Scene, str, bool], bytes]
    is_compact: bool = False
    other_ending: str = ""

    @property
    def endings(self) -> tuple[str, ...]:
        """All endings of its files, the usual one first."""
        return (self.ending, self.other_ending) if self.other_ending else (self.ending,)


def _glb(scene: Scene, name: str, compact: bool) -> bytes:
    from faceedit_app.characters.glb_animated import scene_glb

    return scene_glb(scene, name, compact)


def _fbx(scene: Scene, name: str, _compact: bool) -> bytes:
    from faceedit_app.characters.fbx_animated import scene_fbx

    return scene_fbx(scene, name)


def _usda(scene: Scene, name: str, _compact: bool) -> bytes:
    from faceedit_app.characters.usd_animated import scene_usda

    return scene_usda(scene, name)


def _usdz(scene: Scene, name: str, _compact: bool) -> bytes:
    from faceedit_app.characters.usd_animated import scene_usdz

    return scene_usdz(scene, name)


# fmt: off
SCENES: tuple[SceneFormat, ...] = (
    SceneFormat(
        "glb", "GLB with character", ".glb", "Blender, Unity, Unreal, Godot, the web",
        (
            ("Blender", "set Output > Frame Rate to {rate} first, because Blender places keys by "
             "the scene's rate; then File > Import > glTF 2.0"),
            ("Unity", "add the package glTFast, and drag the file into Assets"),
            ("Unreal", "drag the file into the Content Browser, with Import Morph Targets and "
             "Import Animations switched on"),
            ("Maya", "use FBX instead"),
        ),
        _glb, is_compact=True,
    ),
    SceneFormat(
        "fbx", "FBX with character", ".fbx", "Maya, Unreal, Unity, Blender, MotionBuilder",
        (
            ("Maya", "File > Import, with Animation and Blend Shapes (Deformed Models) switched "
             "on; the scene should run at {rate}"),
            ("Unreal", "drag the file into the Content Browser, with Import Morph Targets and "
             "Import Animations switched on"),
            ("Unity", "drag the file into Assets; in its Rig tab choose Generic"),
            ("Blender", "File > Import > FBX; the scene takes the file's frame rate"),
        ),
        _fbx,
    ),
    SceneFormat(
        "usd", "USD with character", ".usda", "Maya, Houdini, Omniverse, Blender, Unreal",
        (
            ("Maya", "File > Import > USD, with Animation Data switched on"),
            ("Unreal", "switch on the plug-in USD Importer; then File > Import Into Level"),
            ("Blender", "set Output > Frame Rate to {rate} first; then File > Import > Universal "
             "Scene Description"),
            ("Houdini", "load the file with a USD Character Import or a Reference"),
        ),
        _usda,
        other_ending=".usd",  # which may hold text as well
    ),
    SceneFormat(
        "usdz", "USD package with character", ".usdz", "Maya, Blender, Unreal, macOS",
        (
            ("Maya", "File > Import > USD, with Animation Data switched on"),
            ("Unreal", "switch on the plug-in USD Importer; then File > Import Into Level"),
            ("Blender", "set Output > Frame Rate to {rate} first; then File > Import > Universal "
             "Scene Description"),
        ),
        _usdz,
    ),
)
# fmt: on


def scene_content(
    form: SceneFormat,
    clip: Clip,
    character: Rig | FittedCharacter,
    name: str,
    compact: bool = False,
    follows_head: bool = False,
) -> bytes:
    """A take on a character, in a format.

    A GLB of another maker gets the animation added, and is otherwise unchanged. A VRM's shapes
    are behind its expressions, so what FaceEdit shows of it is written, as for FBX and OBJ.

    Args:
        form: the format.
        clip: the take.
        character: FaceEdit's own, or one of another maker.
        name: of the animation.
        compact: store weights compactly, if the format can.
        follows_head: turn the head as it was recorded, as the viewport does.

    Raises:
        FileError: the character's file cannot be read.
    """
    from faceedit_app.characters.glb_animated import animate_glb, is_glb
    from faceedit_app.characters.glb_gaze import eye_turns
    from faceedit_app.characters.glb_turning import HeadTurns
    from faceedit_app.characters.scene import make_scene, shape_weights

    if isinstance(character, Rig):
        scene = make_scene(character, clip, follows_head=follows_head)
        return form.write(scene, name, compact)
    path, shares = character.character.path, character.shares
    is_vrm = character.character.format.startswith("VRM")
    if form.ending == ".glb" and is_glb(path) and not is_vrm:
        weights = shape_weights(clip, shares, character.rig.levels)
        turns = None
        if follows_head and clip.rotations is not None:
            turns = HeadTurns.of(character.frame, character.rig, clip.rotations)
        alike, eyes = character.match.alike, eye_turns(character, clip)
        return animate_glb(path, weights, alike, clip.times, name, compact, turns, eyes)
    # The expressions of a VRM are no shapes of its meshes: nothing elsewhere goes by their names,
    # and takes do not know all of them.
    named = None if is_vrm else shares
    return form.write(make_scene(character.rig, clip, named, follows_head), name, compact)

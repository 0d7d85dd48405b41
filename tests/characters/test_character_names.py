"""Names of shapes are matched to ARKit's channels, however they are spelt."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.chance import CHARACTERS

from faceedit_app.characters.matches import Half, Share
from faceedit_app.characters.names import match_channels
from faceedit_app.core.arkit import ARKIT_CHANNELS


def snake(name: str) -> str:
    return "".join(f"_{c.lower()}" if c.isupper() else c for c in name)


def cut(name: str, left: str, right: str) -> str:
    """The side at the end in other letters; jawLeft and mouthRight have none."""
    if name in ("jawLeft", "jawRight", "mouthLeft", "mouthRight"):
        return name
    return (
        name.removesuffix("Left") + left
        if name.endswith("Left")
        else (name.removesuffix("Right") + right if name.endswith("Right") else name)
    )


def side_first(name: str) -> str:
    for side in ("Left", "Right"):
        if name.endswith(side) and name != f"jaw{side}" and name != f"mouth{side}":
            return f"{side[0]}_{name.removesuffix(side)}"
    return name


SCHEMES: dict[str, Callable[[str], str]] = {
    "as ARKit": lambda n: n,
    "capital first": lambda n: n[0].upper() + n[1:],
    "lower case": str.lower,
    "upper snake case": lambda n: snake(n).upper(),
    "snake case": snake,
    "words": lambda n: snake(n).replace("_", " ").title(),
    "dashes": lambda n: snake(n).replace("_", "-"),
    "_L and _R": lambda n: cut(n, "_L", "_R"),
    "L and R": lambda n: cut(n, "L", "R"),
    "_Left and _Right": lambda n: cut(n, "_Left", "_Right"),
    "Blender's .L and .R": lambda n: cut(n, ".L", ".R"),
    "numbered": lambda n: f"A{ARKIT_CHANNELS.index(n) + 1:02}_{snake(n).title()}",
    "Maya's node": lambda n: "blendShape1." + cut(n, "_L", "_R"),
    "namespace": lambda n: f"head:face|{n}",
    "ARKit_ before": lambda n: f"ARKit_{n}",
    "its own name before": lambda n: f"Emma_Head_{n}",
    "its own name and ARKit": lambda n: f"emma_ARKit_{n}",
    "side first": side_first,
    "control names": lambda n: f"CTRL_expressions_{n}",
    "facs_bs_": lambda n: f"facs_bs_{n[0].upper() + n[1:]}",
    "_shape after": lambda n: f"{n}_shape",
    ".shape after": lambda n: f"{n}.shape",
    "a copy in Blender": lambda n: f"{n}.001",
    "Unity's": lambda n: f"blendShape2.{n[0].upper() + n[1:]}",
}


@pytest.mark.parametrize("scheme", SCHEMES)
def test_every_channel_is_found_in_every_spelling(scheme: str) -> None:
    names = [SCHEMES[scheme](channel) for channel in ARKIT_CHANNELS]
    match = match_channels(names)
    assert match.matched == {c: (n,) for c, n in zip(ARKIT_CHANNELS, names, strict=True)}
    assert match.missing == match.unknown == match.lost == ()


@pytest.mark.parametrize(
    ("name", "channel"),
    [
        ("Mouth_L", "mouthLeft"),
        ("mouth_right", "mouthRight"),
        ("Jaw_Left", "jawLeft"),
        ("left_eye_blink", "eyeBlinkLeft"),
        ("eye_left_blink", "eyeBlinkLeft"),
        ("Brow_Drop_R", "browDownRight"),
        ("Brow_Raise_Outer_L", "browOuterUpLeft"),
        ("EyesClosed_L", "eyeBlinkLeft"),
        ("Nose_Wrinkle_Right", "noseSneerRight"),
    ],
)
def test_single_spellings(name: str, channel: str) -> None:
    assert match_channels([name]).matched == {channel: (name,)}


def test_two_halves_make_one() -> None:
    match = match_channels(["browInnerUp_L", "browInnerUp_R", "Brow_Drop_L"])
    assert match.several == {"browInnerUp": ("browInnerUp_L", "browInnerUp_R")}
    assert match.matched["browDownLeft"] == ("Brow_Drop_L",)


def test_the_whole_wins_over_its_halves() -> None:
    match = match_channels(["cheekPuff_L", "cheekPuff", "cheekPuff_R"])
    assert match.matched == {"cheekPuff": ("cheekPuff",)}
    assert match.unknown == ("cheekPuff_L", "cheekPuff_R")


def test_a_shape_of_both_sides_is_cut_in_two() -> None:
    match = match_channels(["eyeBlink", "mouthSmile"])
    (left,), (right,) = match.shares["eyeBlinkLeft"], match.shares["eyeBlinkRight"]
    assert (left.name, left.half) == ("eyeBlink", Half.LEFT)
    assert (right.name, right.half) == ("eyeBlink", Half.RIGHT)
    assert set(match.matched) == {
        *("eyeBlinkLeft", "eyeBlinkRight", "mouthSmileLeft", "mouthSmileRight")
    }


def test_a_shape_of_both_sides_is_left_where_each_side_has_its_own() -> None:
    match = match_channels(["eyesClosed", "eyeBlinkLeft", "eyeBlinkRight"])
    assert match.matched["eyeBlinkLeft"] == ("eyeBlinkLeft",)
    assert match.unknown == ("eyesClosed",)


def test_other_spellings_of_one_shape_are_not_added_to_it() -> None:
    match = match_channels(["head.jawOpen", "jawOpen", "teeth.jawOpen"])
    assert match.matched == {"jawOpen": ("jawOpen",)}
    assert match.alike == {"jawOpen": ("head.jawOpen", "teeth.jawOpen")}
    assert match.unknown == ()


VRM_0 = (
    "neutral a i u e o blink joy angry sorrow fun "
    "lookup lookdown lookleft lookright blink_l blink_r"
)


def test_presets_of_vrm_stand_for_channels_and_say_so() -> None:
    match = match_channels(VRM_0.split())
    assert match.matched["jawOpen"] == ("a",)
    assert match.matched["eyeBlinkLeft"] == ("blink_l",)
    assert match.matched["eyeLookOutLeft"] == match.matched["eyeLookInRight"] == ("lookleft",)
    assert match.shares["browDownRight"][0].half is Half.UPPER_RIGHT
    assert "mouthClose" in match.missing
    assert "a stands for jawOpen" in match.lost
    assert set(match.unknown) == {"neutral", "blink", "joy"}


def test_visemes_are_used_only_where_nothing_better_is() -> None:
    match = match_channels(["viseme_aa", "viseme_E", "viseme_PP", "jawOpen"])
    assert match.matched["jawOpen"] == ("jawOpen",)
    assert match.matched["mouthLowerDownLeft"] == ("viseme_E",)
    assert "viseme_aa" in match.unknown


def test_japanese_names_of_mikumikudance() -> None:
    match = match_channels(["あ", "い", "う", "お", "まばたき", "まゆげ"])
    assert match.matched["jawOpen"] == ("あ",)
    assert match.matched["eyeBlinkRight"] == ("まばたき",)
    assert match.unknown == ("まゆげ",)


@pytest.mark.parametrize(
    "name",
    ["", "Basis", "jawOpenCorrective2x", "mouthJaw", "ear_L", "smile_eye", "眉", "Left", "l_r"],
)
def test_what_is_no_channel_is_not_taken_for_one(name: str) -> None:
    match = match_channels([name])
    assert match.matched == {}
    assert match.unknown == (name,)


@given(
    st.lists(
        st.text(CHARACTERS, max_size=20) | st.sampled_from(["jawOpen", "JAW_OPEN", "Blink", "a_L"])
    )
)
def test_each_name_is_accounted_for_once(names: list[str]) -> None:
    match = match_channels(names)
    used = {name for parts in match.matched.values() for name in parts}
    alike = {name for others in match.alike.values() for name in others}
    assert used | alike | set(match.unknown) == set(names)
    assert len(used) + len(alike) + len(match.unknown) == len(set(names))


def test_the_quarters_of_character_creator_make_whole_shapes() -> None:
    quarters = {
        channel: [f"{stem}_{side}" for stem in stems for side in "LR"]
        for channel, stems in {
            "mouthPucker": ("Mouth_Pucker_Up", "Mouth_Pucker_Down"),
            "mouthFunnel": ("Mouth_Funnel_Up", "Mouth_Funnel_Down"),
            "mouthRollUpper": ("Mouth_Roll_In_Upper",),
            "browInnerUp": ("Brow_Raise_Inner",),
        }.items()
    }
    looks = {
        "eyeLookOutLeft": "Eye_L_Look_L",
        "eyeLookInLeft": "Eye_L_Look_R",
        "eyeLookInRight": "Eye_R_Look_L",
        "eyeLookOutRight": "Eye_R_Look_R",
        "eyeLookUpRight": "Eye_R_Look_Up",
    }
    match = match_channels([n for names in (*quarters.values(), looks.values()) for n in names])
    assert match.matched == {
        channel: tuple(quarters.get(channel, [looks.get(channel, "")])) for channel in match.matched
    }
    assert set(match.matched) == {*quarters, *looks}
    assert match.unknown == ()


def test_one_whole_shape_is_used_instead_of_its_quarters() -> None:
    match = match_channels(["mouthPucker", "Mouth_Pucker_Up_L", "Mouth_Pucker_Down_L"])
    assert match.matched == {"mouthPucker": ("mouthPucker",)}


@pytest.mark.parametrize("ending", ["_faceit", "_div2", " (copy)"])
def test_a_word_that_all_names_end_with_says_nothing(ending: str) -> None:
    match = match_channels([f"{channel}{ending}" for channel in ARKIT_CHANNELS])
    assert tuple(match.matched) == ARKIT_CHANNELS


# By maker: a channel, and all the shapes that make it.
MAKERS: dict[str, dict[str, str]] = {
    "MetaHuman": {
        "eyeLookOutLeft": "CTRL_expressions_eyeLookLeftL",
        "eyeLookInRight": "CTRL_expressions_eyeLookLeftR",
        "eyeSquintLeft": "CTRL_expressions_eyeSquintInnerL",
        "cheekSquintRight": "CTRL_expressions_eyeCheekRaiseR",
        "mouthSmileLeft": "CTRL_expressions_mouthCornerPullL",
        "mouthFrownRight": "CTRL_expressions_mouthCornerDepressR",
        "mouthUpperUpLeft": "CTRL_expressions_mouthUpperLipRaiseL",
        "mouthPressLeft": "CTRL_expressions_mouthPressUL CTRL_expressions_mouthPressDL",
        "mouthPucker": "CTRL_expressions_mouthLipsPurseUL CTRL_expressions_mouthLipsPurseUR "
        "CTRL_expressions_mouthLipsPurseDL CTRL_expressions_mouthLipsPurseDR",
        "mouthClose": "CTRL_expressions_mouthLipsTogetherUL CTRL_expressions_mouthLipsTogetherDR",
        "mouthRollLower": "CTRL_expressions_mouthLowerLipRollInL "
        "CTRL_expressions_mouthLowerLipRollInR",
        "mouthShrugLower": "CTRL_expressions_jawChinRaiseDL CTRL_expressions_jawChinRaiseDR",
        "browInnerUp": "CTRL_expressions_browRaiseInL CTRL_expressions_browRaiseInR",
    },
    "a mesh of MetaHuman": {
        "eyeBlinkLeft": "head_lod0_mesh__eye_blink_L",
        "eyeLookInLeft": "head_lod0_mesh__eye_lookRight_L",
        "mouthSmileRight": "head_lod0_mesh__mouth_cornerPull_R",
    },
    "Rocketbox": {
        "jawOpen": "AU_26_JawDrop",
        "mouthSmileLeft": "AU_12_LipCornerPuller_L",
        "mouthSmileRight": "AU_12_LipCornerPuller_Right",
        "browInnerUp": "AU_01_InnerBrowRaiser_L AU_01_InnerBrowRaiser_R",
        "mouthUpperUpRight": "AU_10_UpperLipRaiser_R",
    },
    "FACS": {
        "jawOpen": "AU26",
        "eyeBlinkLeft": "AU45_L",
        "eyeBlinkRight": "head.AU45R",
        "mouthFunnel": "AU_022",
    },
    "Meta": {
        "eyeBlinkLeft": "eyesClosedL",
        "eyeLookOutRight": "eyesLookRightR",
        "jawLeft": "jawSidewaysLeft",
        "mouthFunnel": "lipFunnelerLB lipFunnelerLT lipFunnelerRB lipFunnelerRT",
        "mouthRollLower": "lipSuckLB lipSuckRB",
        "mouthRollUpper": "lipSuckLT lipSuckRT",
        "mouthClose": "lipsToward",
    },
    "Daz": {
        "eyeBlinkLeft": "head__facs_jnt_EyeBlinkLeft",
        "mouthPucker": "head__facs_bs_MouthPucker_div2",
        "mouthClose": "Genesis9_facs_bs_MouthCloseUpper Genesis9_facs_bs_MouthCloseLower",
        "browOuterUpLeft": "Genesis8Female__eCTRLBrowOuterUp-DownL",
    },
    "VRChat": {
        "mouthRollLower": "LipSuckLowerLeft LipSuckLowerRight",
        "mouthShrugUpper": "MouthRaiserUpper",
        "eyeLookDownLeft": "Eye_Left_Down",
        "eyeLookInRight": "Eye_Right_Left",
        "mouthFrownLeft": "Mouth_Sad_Left",
    },
    "MakeHuman": {
        "browInnerUp": "eyebrows-left-inner-up eyebrows-right-inner-up",
        "browOuterUpLeft": "eyebrows-left-extern-up",
        "browDownRight": "eyebrows-right-down",
        "eyeBlinkLeft": "eye-left-closure",
        "eyeWideLeft": "eye-left-opened-up",
        "eyeSquintRight": "eye-right-slit",
        "noseSneerLeft": "nose-left-elevation",
        "mouthPucker": "mouth-pursing",
        "mouthFunnel": "mouth-protusion",
        "mouthShrugLower": "mouth-eversion",
    },
}


@pytest.mark.parametrize("maker", MAKERS)
def test_shapes_that_makers_call_by_other_names(maker: str) -> None:
    wanted = {channel: tuple(names.split()) for channel, names in MAKERS[maker].items()}
    match = match_channels([name for names in wanted.values() for name in names])
    assert match.matched == {channel: wanted[channel] for channel in match.matched}
    assert set(match.matched) == set(wanted)
    assert match.unknown == match.lost == ()


def test_a_unit_of_facs_that_moves_both_sides_is_cut_in_two() -> None:
    match = match_channels(["AU12", "AU_27_MouthStretch"])
    assert [share.half for share in match.shares["mouthSmileRight"]] == [Half.RIGHT]
    assert match.matched["jawOpen"] == ("AU_27_MouthStretch",)
    assert "mouthStretchLeft" in match.missing


def test_units_of_makehuman_that_move_both_sides_are_cut_in_two() -> None:
    match = match_channels(["mouth-corner-puller", "mouth-depression", "mouth-elevation"])
    assert match.matched["mouthSmileLeft"] == match.matched["mouthSmileRight"]
    assert match.shares["mouthFrownLeft"] == (Share("mouth-depression", half=Half.LEFT),)
    assert match.shares["mouthUpperUpRight"] == (Share("mouth-elevation", half=Half.RIGHT),)
    lower = match_channels(["mouth-depression-retraction"])
    assert [share.half for share in lower.shares["mouthLowerDownLeft"]] == [Half.LOWER_LEFT]


def test_mikumikudance_laughs_with_its_eyes() -> None:
    """笑い shuts the eyes, and びっくり opens them; half-width kana are the same words."""
    match = match_channels(["笑い", "ﾋﾞｯｸﾘ", "びっくり", "口角上げ", "口角下げ", "ｳｨﾝｸ２右"])
    assert match.matched["eyeBlinkLeft"] == ("笑い",)
    assert match.matched["eyeWideLeft"] == ("びっくり",)
    assert match.matched["mouthSmileLeft"] == ("口角上げ",)
    assert match.matched["mouthFrownRight"] == ("口角下げ",)
    assert match_channels(["ｳｨﾝｸ２右"]).matched == {"eyeBlinkRight": ("ｳｨﾝｸ２右",)}


@pytest.mark.parametrize("form", ["{mesh}_{name}", "{name}_{mesh}", "{mesh}.{name}"])
def test_shapes_of_several_meshes_may_have_their_names(form: str) -> None:
    """Also those that stand for two channels: lashes blink with the lids."""
    meshes = {
        form.format(mesh=mesh, name=name): mesh
        for mesh in ("Face", "Upper_Lashes")
        for name in ("jawOpen", "mouthSmileLeft", "Blink", "x")
    }
    match = match_channels(meshes, meshes)
    assert set(match.matched) == {"jawOpen", "mouthSmileLeft", "eyeBlinkLeft", "eyeBlinkRight"}
    for shape in {name for names in match.matched.values() for name in names}:
        (other,) = match.alike[shape]
        assert {meshes[shape], meshes[other]} == {"Face", "Upper_Lashes"}

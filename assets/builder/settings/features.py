"""Tuned numbers of what the base mesh lacks: hair, brows, lashes, eyes and teeth."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Hair:
    """Hair combed back from the hairline to a bun."""

    color: str = "3d2a21"
    columns: int = 48  # of the hairline, around the head
    cap_columns: int = 72  # of the cap
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
    rings: tuple[float, ...] = (
        *(0, 0.035, 0.07, 0.12, 0.19, 0.25, 0.32, 0.4),
        *(0.48, 0.56, 0.64, 0.72, 0.8, 0.88, 0.94),
    )
    # Thickness over the skull (mm) at shares of that way.
    thickness: tuple[tuple[float, float], ...] = (
        (0, 0.5),
        (0.035, 1.5),
        (0.07, 3.4),
        (0.12, 6.8),
        (0.19, 9.0),
        (0.7, 9.3),
        (1, 5),
    )
    # How much it hides of the scalp at shares of that way, 0..1.
    cover: tuple[tuple[float, float], ...] = ((0, 0.0), (0.035, 0.6), (0.07, 1))
    cover_span: tuple[float, float] = (176.0, 180.0)  # azimuths beyond which it hides all: from, to
    smoothing: int = 5  # rounds of averaging around the head
    # Scalp that shows between the roots at shares of that way, 0..1.
    scalp: tuple[tuple[float, float], ...] = ((0, 0.3), (0.035, 0.18), (0.09, 0))
    # Locks: how many waves go around the head, and how high each stands (mm).
    locks: tuple[tuple[int, float], ...] = ((9, 0.7), (14, 0.6), (23, 0.45))
    locks_from: tuple[float, float] = (0.04, 0.3)  # share of the way where they rise
    lock_shade: float = 0.16  # brightness of a lock that stands 1 mm high
    shade: tuple[float, float] = (0.80, 1.22)  # random brightness of a column, from and to
    middle_shade: tuple[float, float] = (1.12, 0.25)  # brightness half way, and its decrease
    moves_from: float = 1.6  # mm: what the skin moves less stands still
    move_fade: float = 0.06  # share of the way over which the skin's motion fades out
    bun_radius: float = 23.0
    bun_out: float = 15.0  # how far its centre stands off the pole
    bun_flat: float = 0.8
    bun_columns: int = 36
    bun_rows: int = 13
    bun_grooves: int = 9  # they wind around it
    bun_groove: float = 0.045  # share of its radius
    bun_shade: float = 0.22
    bun_front: tuple[float, float, float] = (0.64, 1.1, 0.75)  # share of the rows, shades
    # Fine strands that soften the hairline.
    wisps: int = 116
    wisp_length: tuple[float, float] = (5.0, 24.0)
    wisp_width: tuple[float, float] = (0.16, 0.36)
    wisp_before: tuple[float, float] = (-3.0, 6.0)  # how far they root in front of the line
    wisp_span: float = 84.0  # azimuths to either side that have them
    wisp_jitter: float = 1.5  # degrees
    wisp_shade: tuple[float, float] = (0.85, 1.45)
    wisp_scalp: tuple[float, float, float] = (0.42, 0.12, 0.0)  # skin in root, middle and tip
    wisp_cover: tuple[float, ...] = (0.15, 0.75, 0.75, 0.35)  # of root, middle (twice) and tip
    wisp_root_lift: float = 0.2  # over the skin
    # Height of the tips over the skull at a distance behind the hairline.
    wisp_tip_lift: tuple[tuple[float, float], ...] = (
        (-3, 0.4),
        (0, 0.5),
        (5, 1.4),
        (12, 3.2),
        (22, 5.9),
    )
    wisp_bulge: float = 0.5  # how far the middle stands off the straight line
    wisp_lean: float = 0.2  # slope by which a tip lies aside
    # How much of the skin's motion the middle and the tip follow.
    wisp_follow: tuple[float, float] = (0.7, 0.3)
    seed: int = 4


@dataclass(frozen=True)
class Brows:
    """One-triangle strands along an arch of skin vertices."""

    color: str = "5b4233"
    path: tuple[int, ...] = (6984, 6983, 6980, 6979, 6981, 6982)  # left, base mesh, from inside
    raise_path: tuple[float, ...] = (3.0, 3.0, 3.5, 5.0, 5.0, 1.0)
    inner_end: float = 10.5  # x of the inner end
    inner_drop: float = 1.2  # how far the inner end lies below its neighbour
    outer_extra: float = 1.0
    strands: int = 132
    width: float = 0.36
    scatter: float = 0.02  # along the brow, so that its inner end is no straight line
    widest_at: float = 0.4  # share of a strand
    thickness: float = 4.6
    # Along the brow it swells from this share of the thickness as a sine of this pace, and
    # tapers by this share between two points.
    ends: float = 0.62
    swell: float = 1.3
    taper: float = 0.86
    taper_between: tuple[float, float] = (0.5, 1.02)
    # Over the skin:
    root_lift: float = 0.3
    widest_lift: float = 0.5
    tip_lift: float = 0.8
    # Along the brow (0 inside, 1 outside): angle of the strands, and their length.
    angles: tuple[tuple[float, float], ...] = ((0, 74), (0.12, 52), (0.4, 16), (1, -26))
    lengths: tuple[tuple[float, float], ...] = ((0, 4.2), (0.3, 6.2), (1, 5.0))
    lean: tuple[float, float] = (11.0, -9.0)  # strands of the lower, the upper half
    angle_spread: float = 6.0
    length_spread: tuple[float, float] = (0.8, 1.15)
    brightness: tuple[float, float] = (0.75, 1.35)
    cover: tuple[float, ...] = (0.7, 1.0, 0.25)  # of the root, the widest place and the tip
    # The band of fine hair under them. Along the brow: from, to and in how many columns. Rows:
    # place across, as a share of half the thickness, and cover. Cover along the brow.
    down_along: tuple[float, float, int] = (-0.06, 1.02, 15)
    down_rows: tuple[tuple[float, float], ...] = (
        *((1.2, 0.0), (0.6, 0.85), (0.0, 1.0)),
        *((-0.6, 0.85), (-1.2, 0.0)),
    )
    down_cover: tuple[tuple[float, float], ...] = (
        (-0.06, 0),
        (0.1, 0.5),
        (0.35, 0.85),
        (0.8, 0.6),
        (1.02, 0),
    )
    # It narrows at its ends, and skin shows through it: other programs may draw it without cover.
    down_taper: tuple[tuple[float, float], ...] = ((-0.06, 0.3), (0.1, 0.9), (0.4, 1), (1.02, 0.7))
    down_skin: float = 0.15
    down_lift: float = 0.25  # over the skin
    seed: int = 3


@dataclass(frozen=True)
class LashRow:
    """One row of lashes."""

    strands: int
    length: float  # share of the helper lashes' length
    width: float  # at the root
    bend: float  # how far the middle hangs, downwards
    liner: float  # width of the dark line at the root, share of the helper's next row
    clump: int  # strands whose tips lean together
    color: str
    liner_color: str
    down_cover: tuple[float, float, float]  # of the fine hair: at root, middle and tip


@dataclass(frozen=True)
class Lashes:
    """Lashes and the line at their roots."""

    upper: LashRow = LashRow(66, 0.78, 0.58, 0.35, 0.38, 3, "2e211b", "35251e", (0.85, 0.45, 0.0))
    lower: LashRow = LashRow(28, 0.46, 0.28, -0.25, 0.16, 2, "5a4034", "9a6656", (0.3, 0.12, 0.0))
    root_lift: float = 0.1  # over the skin
    sweep: float = 0.25  # helper columns by which a tip leans outwards
    ends: tuple[float, float] = (0.4, 1.15)  # helper columns left bare: inside, outside
    jitter: float = 0.15  # helper columns
    length_spread: tuple[float, float] = (0.85, 1.1)
    brightness: tuple[float, float] = (0.85, 1.25)  # of a strand, from and to
    cover: tuple[float, ...] = (1.0, 1.0, 0.9, 0.9, 0.25)  # of root, middle (twice each) and tip
    line_cover: tuple[float, float] = (0.95, 0.6)  # of the line: at the lid's edge, at the skin
    # The fine hair between the strands: columns, its length as a share of the strands', and over
    # how many helper columns it begins at either end.
    down_columns: int = 15
    down_length: float = 0.9
    down_fade: float = 1.5
    clumping: float = 0.45  # share of the way by which a tip leans to the middle of its clump
    middle_width: float = 0.42  # share of the width at the root
    bend_at: float = 0.55  # where along the strand the middle lies
    bend_forward: float = 0.4
    # Direction of the upper lashes when the lid is closed: outwards, and downwards.
    closed_out: float = 0.92
    closed_down: float = 0.36
    # Share of their width that the upper lashes lose when the lid is closed. Half-way they point
    # at the viewer, and what is wide then looks like teeth over the iris.
    closed_slimming: float = 0.65
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

    columns: int = 30
    radius: float = 0.992  # share of the sphere that fits the helper eye
    moves_from: float = 0.4  # mm: shapes that move the helper less do not turn the eye
    streaks: tuple[float, float] = (0.72, 1.22)  # brightness, from and to
    # Light that the cornea gathers on the side away from the lamp: brightness, and its direction.
    glow: float = 0.55
    glow_from: tuple[float, float] = (0.62, -0.78)
    # Painted shade of the upper lid: sine of the elevation from which, at which it is full.
    lid_shade: float = 0.46
    lid_shade_from: tuple[float, float] = (0.0, 0.38)
    # Painted shade of the corners, likewise.
    corner_shade: float = 0.34
    corner_shade_from: tuple[float, float] = (0.44, 0.84)
    shade_tint: tuple[float, float, float] = (0.7, 1.0, 1.08)  # of both: warm
    rings: tuple[Ring, ...] = (
        Ring(0.0, "050505", "pupil"),
        Ring(5.2, "050505", "pupil"),
        Ring(9.3, "070606", "pupil"),
        Ring(10.8, "4b4a3e", "iris", 0.6),
        Ring(13.0, "7b765d", "iris", 1.0),
        Ring(17.2, "5f8190", "iris", 1.0),
        Ring(21.0, "46626f", "iris", 0.8),
        Ring(23.0, "2c3e47", "iris", 0.3),
        Ring(24.6, "2b363e", "iris"),
        Ring(26.6, "a59f9e", "sclera"),
        Ring(30.5, "e3ddd7", "sclera"),
        Ring(41.0, "e2d8d1", "sclera"),
        Ring(56.0, "d6c1b8", "sclera"),
        Ring(74.0, "c6a39a", "sclera"),
    )
    # The wet edge of the lower lid: colour, how far it climbs the eyeball and its lift over it,
    # and its width as a share of the lid's.
    tear_color: str = "e0a496"
    tear_climb: float = 0.45
    tear_lift: float = 0.12
    tear_width: float = 0.55
    # The pink flesh in the inner corner: an ellipsoid, its centre relative to the corner.
    caruncle_color: str = "cf8479"
    caruncle_radii: tuple[float, float, float] = (1.6, 0.9, 1.0)
    caruncle_shift: tuple[float, float, float] = (1.5, 0.8, -2.3)  # outwards, up, to the front
    caruncle_grid: tuple[int, int] = (5, 8)  # rows, columns
    seed: int = 11


@dataclass(frozen=True)
class Jaw:
    """One row of teeth: six on either side, from the middle outwards."""

    widths: tuple[float, ...]  # relative
    heights: tuple[float, ...]  # mm
    back: float  # how far the arch is set back behind the helper's
    tip_drop: float  # how far below the helper's edge the teeth end
    second_short: float  # how far the second tooth ends above the first
    back_faces: float  # faces that look further back than this cosine are dropped


@dataclass(frozen=True)
class Teeth:
    """Teeth and gums along the arch of the helper teeth; the tongue is the helper's."""

    upper: Jaw = Jaw(
        (8.6, 6.6, 7.6, 7.0, 6.8, 9.0), (10.0, 9.4, 10.7, 10.2, 9.8, 9.2), 1.5, 4.3, 0.7, -0.35
    )
    lower: Jaw = Jaw(
        (5.4, 6.0, 7.0, 7.0, 7.0, 9.6), (8.2, 8.4, 9.0, 8.0, 7.6, 7.2), 3.3, 0.6, 0.0, -1.0
    )
    narrow: float = 0.92  # the arch's width as a share of the helper's
    filled: float = 0.86  # share of the arch that bears teeth
    depths: tuple[float, ...] = (3.5, 3.5, 4.5, 6.0, 6.0, 7.0)
    sides: int = 10  # corners of a tooth's cross-section
    # Levels of a tooth: share of its height from the root, of its width, of its depth.
    levels: tuple[tuple[float, float, float], ...] = (
        (0, 0.78, 0.92),
        (0.30, 0.93, 1.0),
        (0.72, 1.0, 0.86),
        (0.93, 0.97, 0.60),
        (1.0, 0.86, 0.34),
    )
    squareness: tuple[float, float] = (0.52, 0.66)  # exponents of the cross-section: x, z
    touching: float = 0.9  # walls between corners farther out than this are left out
    color: str = "fbf3e6"
    # Colour of each level of a tooth as a factor: warm at the gum, clear at the edge.
    level_tints: tuple[tuple[float, float, float], ...] = (
        (0.93, 0.85, 0.76),
        (0.98, 0.95, 0.90),
        (1.0, 1.0, 0.99),
        (0.97, 0.98, 1.0),
        (0.93, 0.95, 0.99),
    )
    between_shade: tuple[float, float, float] = (
        0.26,
        0.34,
        0.38,
    )  # how dark a tooth is where it meets its neighbour
    gum_color: str = "c4746f"
    gum_edge_color: str = "d58d86"
    gum_columns: int = 4  # of each tooth
    gum_over: float = 0.7  # how much of a tooth's root end its gum covers,
    gum_between: float = 2.3  # and how much farther the gum reaches between two teeth
    # Rows of the gum, from its edge: distance from the edge, how far in front of the arch in the
    # middle of a tooth and between two.
    gum_rows: tuple[tuple[float, float, float], ...] = (
        (0.0, 0.05, -1.3),
        (0.5, 0.6, -0.5),
        (2.6, 0.9, 0.2),
        (8.6, -3.4, -3.4),
    )
    tongue_color: str = "cd7f7a"
    tongue_groove_color: str = "b5625f"
    tongue_narrow: float = 0.94  # share of the helper's width
    tongue_shift: tuple[float, float, float] = (0.0, -1.2, -3.0)
    # The helper's tongue fills the mouth: how far its back is lowered, between which depths.
    tongue_lower: float = 8.5
    tongue_lower_between: tuple[float, float] = (116.0, 78.0)
    tongue_groove: tuple[float, float] = (1.9, 4.0)  # depth and width of the furrow on its back
    tongue_round: float = 3.4  # how far its edges lie below its middle
    moves_from: float = 0.3  # mm: shapes that move the helper less do not move the teeth

"""Tuned numbers of the colours."""

from __future__ import annotations

from dataclasses import dataclass


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
    mouth: str = "8f3f3c"
    # Strengths, 0..1, and radii, mm.
    blush_amount: float = 0.42
    blush_radius: float = 26.0
    blush_below_eyes: float = 28.0
    blush_out: float = 1.05  # x, as a multiple of where a squint raises the cheek most
    nose_amount: float = 0.35
    nose_radius: float = 16.0
    nose_search: float = 60.0  # the tip is looked for from the eyes down to here
    ears_amount: float = 0.45
    lids_amount: float = 0.45
    lid_edge_amount: float = 0.30
    lid_edge_width: float = 5.0
    lid_edge_reach: float = 30.0  # above and below the eyes at most
    lips_amount: float = 0.85
    brow_amount: float = 0.60  # painted under the strands
    brow_width: float = 2.4
    brow_from: float = -0.05  # share of the brow where the paint begins
    brow_fade: tuple[float, float] = (0.45, 0.8)  # share of the brow where the paint fades
    hairline_amount: float = 0.45  # hair colour painted at the roots
    hairline_between: tuple[float, float] = (-0.10, 0.02)  # radians above the hairline
    # Skin texture: octaves of smooth noise (size in mm, share of brightness, share of redness).
    texture: tuple[tuple[float, float, float], ...] = (
        (26.0, 0.010, 0.014),
        (11.0, 0.014, 0.016),
        (5.0, 0.014, 0.010),
    )
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
    sky_smoothing: float = 0.5  # strength of the smoothing over neighbours, and its
    sky_rounds: int = 4
    sky_full: float = 0.80  # the share of the skin's vertices that count as shaded at all
    darkest: float = 0.50  # of the skin and the hair
    darkest_lips: float = 0.80
    shade_tint: tuple[float, float, float] = (0.80, 1.05, 1.12)  # exponents: warm shadows
    depth_tint: tuple[float, float, float] = (0.62, 1.15, 1.25)  # exponents: dark red
    # The mouth darkens with the depth behind the lips: from, to (mm), and how much.
    depth_mouth: tuple[float, float, float] = (16.0, 84.0, 0.72)
    depth_tongue: tuple[float, float, float] = (20.0, 66.0, 0.80)
    depth_teeth: tuple[float, float, float] = (21.0, 48.0, 0.66)

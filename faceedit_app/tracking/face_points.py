"""What the tracker's landmarks are on a face, by their numbers (MediaPipe's face mesh).

Left and right are the person's own.
"""

from __future__ import annotations

from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS

# The landmark at each control point.
_LANDMARKS = {
    "inner_upper_lip": 13,
    "inner_lower_lip": 14,
    "left_mouth_corner": 291,
    "right_mouth_corner": 61,
    "upper_lip": 0,
    "lower_lip": 17,
    "nose_bridge": 168,
    "chin": 199,
    "left_upper_lid": 386,
    "left_lower_lid": 374,
    "right_upper_lid": 159,
    "right_lower_lid": 145,
}
CONTROL_PAIRS: dict[int, tuple[int, int]] = {
    CONTROL_INDEX[control.id]: (_LANDMARKS[control.between[0]], _LANDMARKS[control.between[1]])
    for control in CONTROLS
    if control.between is not None and set(control.between) <= _LANDMARKS.keys()
}
"""For each control the two landmarks between which it is seen, in the order of its points."""

CONTROL_LANDMARKS: dict[int, tuple[int, int]] = {
    landmark: (control, end)
    for control, pair in CONTROL_PAIRS.items()
    for end, landmark in enumerate(pair)
}
"""For each landmark at a control point: a control and which of its two points it is."""

IRISES = (468, 473)  # right, left

# fmt: off
OUTER_LIPS = (
    61, 185, 40, 39, 37, 0, 267, 269, 270, 409, 291, 375, 321, 405, 314, 17, 84, 181, 91, 146,
)
INNER_LIPS = (
    78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308, 324, 318, 402, 317, 14, 87, 178, 88, 95,
)
LIDS = (
    33, 246, 161, 160, 159, 158, 157, 173, 133, 155, 154, 153, 145, 144, 163, 7,
    263, 466, 388, 387, 386, 385, 384, 398, 362, 382, 381, 380, 374, 373, 390, 249,
)
# Bone under thin skin: forehead, bridge and tip of the nose, corners of the eyes.
STEADY = (9, 8, 168, 6, 197, 195, 5, 4, 1, 151, 33, 263, 133, 362, 10, 109, 338, 67, 297, 103, 332)
OUTLINE = (
    10, 338, 297, 332, 284, 251, 389, 356, 454, 323, 361, 288, 397, 365, 379, 378, 400, 377, 152,
    148, 176, 149, 150, 136, 172, 58, 132, 93, 234, 127, 162, 21, 54, 103, 67, 109,
)

# Lines to draw, each a run of landmarks; the last landmark of a closed one is its first.
UPPER_OUTER_LIP = (61, 185, 40, 39, 37, 0, 267, 269, 270, 409, 291)
LOWER_OUTER_LIP = (61, 146, 91, 181, 84, 17, 314, 405, 321, 375, 291)
UPPER_INNER_LIP = (78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308)
LOWER_INNER_LIP = (78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308)
RIGHT_LIDS = (33, 246, 161, 160, 159, 158, 157, 173, 133, 155, 154, 153, 145, 144, 163, 7, 33)
LEFT_LIDS = (
    263, 466, 388, 387, 386, 385, 384, 398, 362, 382, 381, 380, 374, 373, 390, 249, 263,
)
RIGHT_BROW = (70, 63, 105, 66, 107)
LEFT_BROW = (300, 293, 334, 296, 336)
NOSE = (168, 6, 197, 195, 5, 4)
# fmt: on

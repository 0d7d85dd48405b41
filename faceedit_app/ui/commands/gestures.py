"""What mouse and held keys do in the window, for the list of shortcuts."""

from __future__ import annotations

# Where, the gesture, what it does.
GESTURES: tuple[tuple[str, str, str], ...] = (
    ("Curves", "Drag a curve up or down", "Edit it, with the falloff to either side"),
    ("Curves", "Shift while dragging", "Ten times finer"),
    ("Curves", "Ctrl while dragging", "Snap: to the tracked curve, to 0 (touching), to frames"),
    ("Curves", "Alt and drag", "Edit this side of the face only"),
    ("Curves", "Wheel while dragging", "Change the falloff; with Alt on this side of it only"),
    ("Curves", "Drag an edge of the selection", "Change the range or its falloffs"),
    ("Curves", "Ctrl and click a name", "Choose several curves, to edit them together"),
    ("Curves", "Esc or right button while dragging", "Drop the edit"),
    ("Curves", "Click", "Move the playhead"),
    ("Curves", "Wheel", "Zoom the time; with Shift pan, with Ctrl zoom the millimetres"),
    ("Curves", "Middle drag", "Pan the time"),
    ("Curves", "Right drag", "Zoom: sideways the time, up and down the millimetres"),
    ("Curves", "Wheel or drag on the numbers", "Zoom or move the millimetres of this curve"),
    ("Curves", "Right click", "What can be done there, and on a name with the curve"),
    ("Curves", "Double click a name", "Show small movements large"),
    ("Time ruler", "Drag", "Move the playhead"),
    ("Time ruler", "Shift and drag", "Select a range of time"),
    ("Time ruler", "Double click", "Drop the selection"),
    ("Time ruler", "Right click", "What can be done with the selection, the view and the units"),
    ("Selection bar", "Drag", "Select a range of time, move it, or change it by its handles"),
    ("Selection bar", "Wheel", "Change both falloffs"),
    ("Face", "Drag", "Turn around the face"),
    ("Face", "Middle or right drag", "Move the view"),
    ("Face", "Right click", "What can be done with the face"),
    ("Face", "Wheel", "Zoom"),
    ("Face", "Double click", "Reset the camera"),
    ("Face", "Arrows, after 9", "Turn around the face; with Shift move the view"),
    ("Face", "+ and −, after 9", "Zoom; 0 looks from the front again"),
    ("Face", "Hold B", "See the face as tracked"),
    ("Sound", "Drag", "Scrub, and hear it"),
    ("Sound", "Alt and drag", "Move the sound in time; with Shift ten times finer"),
    ("Window", "Drop a file", "Open a take, load edits, or add sound or film"),
)

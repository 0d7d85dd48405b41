"""Mouse gestures and held keys, for the list of shortcuts."""

from __future__ import annotations

# Place, gesture, effect.
GESTURES: tuple[tuple[str, str, str], ...] = (
    ("Curves", "Drag a curve up or down", "Edit it, with falloff on either side"),
    ("Curves", "Shift while dragging", "Move ten times finer"),
    ("Curves", "Ctrl while dragging", "Snap to the tracked curve, to 0 (touching) or to frames"),
    ("Curves", "Alt, or Ctrl and Shift, while dragging", "Edit this side of the face only"),
    ("Curves", "Wheel while dragging", "Change the falloff; with Alt, on this side only"),
    ("Curves", "Drag an edge of the selection", "Change the selection or its falloffs"),
    ("Curves", "Ctrl and click a name", "Choose several curves to edit together"),
    ("Curves", "Esc or right button while dragging", "Cancel the drag"),
    ("Curves", "Click", "Move the playhead"),
    ("Curves", "Wheel", "Zoom in time; with Shift, pan; with Ctrl, zoom the millimetres"),
    ("Curves", "Middle drag", "Pan in time"),
    ("Curves", "Right drag", "Zoom: sideways in time, up and down the millimetres"),
    ("Curves", "Wheel or drag on the numbers", "Zoom or pan the millimetres of this curve"),
    ("Curves", "Right click", "Open the menu; on a name, that of the curve"),
    ("Curves", "Double click a name", "Enlarge small movements"),
    ("Time ruler", "Drag", "Move the playhead"),
    ("Time ruler", "Shift and drag", "Select a time range"),
    ("Time ruler", "Double click", "Clear the selection"),
    ("Time ruler", "Right click", "Open the menu"),
    ("Selection bar", "Drag", "Select a time range, move it, or change it by its handles"),
    ("Selection bar", "Wheel", "Change both falloffs"),
    ("Face", "Drag", "Orbit the face"),
    ("Face", "Middle or right drag", "Pan the camera"),
    ("Face", "Right click", "Open the menu"),
    ("Face", "Wheel", "Zoom"),
    ("Face", "Double click", "Reset the camera"),
    ("Face", "Arrows, after 9", "Orbit the face; with Shift, pan the camera"),
    ("Face", "+ and −, after 9", "Zoom; 0 resets the camera"),
    ("Face", "Hold B", "Show the tracked face"),
    ("Sound", "Drag", "Scrub with sound"),
    ("Sound", "Alt and drag", "Move the sound in time; with Shift, ten times finer"),
    ("Window", "Drop a file", "Open a take, load edits, or add sound or film"),
)

"""The vocabulary and the arithmetic of FaceEdit: clip, rig, controls (numpy only)."""

"""Presets, fixes, problems, and copy and paste."""

"""What helps to edit: presets, fixes, problems, copy and paste."""

"""Edits, the settings that they are answered by, and the sound and film of a take."""

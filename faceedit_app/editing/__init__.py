"""Edits, and what they do to a take. Works without Qt and OpenGL."""

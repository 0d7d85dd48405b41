"""Edits and what they do to a take: no Qt, no GL."""

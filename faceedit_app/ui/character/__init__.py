"""The user's character: its checklist, and its control points on the face."""

"""The picture of the face."""

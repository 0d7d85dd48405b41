"""The take's sound and film in the window."""

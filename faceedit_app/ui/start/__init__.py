"""How FaceEdit starts: the application, the main window, and running without a display."""

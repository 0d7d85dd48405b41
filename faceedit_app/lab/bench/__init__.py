"""`faceedit bench`: how long the window takes from the mouse to the picture, on this machine."""

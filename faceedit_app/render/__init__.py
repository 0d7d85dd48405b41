"""Drawing the character offscreen (pyrender)."""

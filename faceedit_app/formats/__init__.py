"""One module per file format: what a user opens and exports, and the character."""

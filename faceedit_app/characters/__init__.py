"""Characters: their files, and the one that ships."""

"""Characters: their files, their rigs, and blendshapes for heads without any."""

"""From a film to a take: landmarks of a face, fitted to the character's blendshapes, without Qt."""

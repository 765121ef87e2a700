"""From several meshes to one value and its error."""

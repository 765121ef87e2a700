"""The bodies of a scene: shapes, distances, symmetry, and which conductor each belongs to."""

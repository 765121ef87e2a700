"""The bodies of a scene: shapes, distances, planes of symmetry, and the conductors that the bodies make up."""

"""Meshes the bodies of a scene: OpenCASCADE geometry, sizes of the tetrahedra, quarter-point elements."""

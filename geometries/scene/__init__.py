"""Scenes: shapes, poses, meshes, motions, and the reader and writer of their files."""

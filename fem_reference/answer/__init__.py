"""Combines the solutions on successive meshes into one Maxwell matrix with an error for every entry."""

"""Compares boundary elements with the field solver, which share nothing but the scene file."""

"""Units in which people read the answers."""

PICOFARAD = 1e-12
"""Farads."""

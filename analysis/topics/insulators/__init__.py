"""Experiment VIII: what insulators before a sensor do to its reading."""

"""Verifies the reference: known capacitances, properties, run time against error."""

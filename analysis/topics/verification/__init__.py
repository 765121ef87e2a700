"""Verifies the reference: known capacitances, run time against error."""

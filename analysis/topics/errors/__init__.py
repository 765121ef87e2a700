"""Splits the model's error into named parts that add up, and maps it: ERRORS.md."""

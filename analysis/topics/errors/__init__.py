"""The model's error taken apart into named parts that add up, and maps of it: ERRORS.md."""

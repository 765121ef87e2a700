"""The thesis' experiments (chapter 6), with the field reference in the place of the physical sensor: EXPERIMENTS.md."""

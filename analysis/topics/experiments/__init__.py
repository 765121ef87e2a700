"""The thesis' experiments (chapter 6), with the field reference instead of the physical sensor: EXPERIMENTS.md."""

"""Corrections of the model against the truth by boundary elements: set-ups, truths, evaluation, the report's section."""

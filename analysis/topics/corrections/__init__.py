"""Corrections of the model, compared with boundary elements: set-ups, truths, evaluation, and the report's section."""

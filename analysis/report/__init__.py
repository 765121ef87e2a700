"""The parts of every report: the frame of a page, tables, plots, and sections on the study and the measurements."""

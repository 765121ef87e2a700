"""Run time against error of all methods, compared with one truth."""

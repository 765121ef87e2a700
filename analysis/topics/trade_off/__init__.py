"""The plot that the project is about: run time against error of everything that answers, with one truth."""

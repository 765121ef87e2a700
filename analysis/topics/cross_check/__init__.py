"""Two independent answers side by side: boundary elements and the field solver, which share nothing but the scene."""

"""A page on the readings over the frames of a motion."""

"""A page on which a scene can be moved, with the library in it."""

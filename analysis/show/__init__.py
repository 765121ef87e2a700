"""Shows a scene and its motion on one page."""

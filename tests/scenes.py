"""Scenes that tests of several folders share."""

SENSOR = """
[[sensor]]
name = "front"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]
"""
"""A square sensor of 10 cm."""
GUARDED_SENSOR = (
    SENSOR
    + """
[[object]]
name = "guard"
shape = { type = "plate", size = [0.12, 0.12] }
translation = [0, 0, -0.03]
potential = "electrode"
"""
)
"""A square sensor before a larger guard, an electrode."""

"""Collisions and distance sensors from Python.

`Scene.sense` gives the closest point that each distance sensor of a scene sees, `Scene.collide` the pairs of objects that collide. The
functions beneath them take NumPy arrays: `gjk_distance` two sets of vertices, `cone_closest` triangles and a cone.

Run it:  PYTHONPATH=build/python python3 model/examples/distances_in_python.py
Expect:  the eye sees the point of the hand that is nearest. Raised by 100 mm, the hand is 96 mm farther away: another point is nearest then.

Output:
  raised by 0 mm: eye sees hand at 25.70 mm
  raised by 100 mm: eye sees hand at 121.77 mm
  two cubes: 2.0 apart, nearest point of the first at x = 1.0
"""

from pathlib import Path

import numpy as np

import fringe

scene = fringe.Scene.load(str(Path(__file__).with_name("hand.toml")))
for height in (0.0, 0.1):
    scene.set_pose("arm", [0, 0, height], np.eye(3))
    eye = scene.sense()["distance_sensors"][0]
    print(
        f"raised by {1000 * height:.0f} mm: {eye['name']} sees {eye['object']} at {1000 * eye['distance']:.2f} mm"
    )

cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
distance, nearest, _ = fringe.gjk_distance(cube, cube + [3, 0, 0])
print(f"two cubes: {distance:.1f} apart, nearest point of the first at x = {nearest[0]:.1f}")

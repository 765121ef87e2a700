"""The potential in a vertical plane through a scene, for pictures: solved on the coarsest mesh, without an error estimate."""

from __future__ import annotations

from typing import Any

import dolfinx
import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from fem_reference.output.driven_sensor import driven_sensor
from fem_reference.bodies.conductors import Conductors, conductors
from geometries.scene.scene import Scene

Array = NDArray[np.float64]

POINTS = 121
"""Number of points along each side of the picture."""
REACH = 1.6
"""Half the width of the picture over the radius of the conductors' bounding sphere."""
SAME_PLACE = 0.02
"""Largest horizontal distance of two centres, over the radius of the bounding sphere, at which they count as lying above each other."""


def potential_slice(scene: Scene, source: str = "scene") -> dict[str, Any]:
    """{"origin": (2,), "direction": (2,), "along": (k,), "z": (k,), "potential": (k, k)}: metres, volts.

    The vertical plane goes through the centre of the first sensor and the common centre of all other bodies; it is parallel to x when
    these lie above each other. Its points have the horizontal coordinates origin + along·direction and the height z; the rows of
    `potential` follow z. The first sensor is at 1 V, every other conductor grounded or, if it is floating, uncharged. Raises
    InputError as `conductors` does.
    """
    problem = conductors(scene, source)
    potential = driven_sensor(problem)[1]
    origin, direction = _vertical_plane(problem)
    offsets = np.linspace(-REACH, REACH, POINTS)
    along, z = np.meshgrid(offsets, offsets)
    horizontal = origin + along.reshape(-1, 1) * direction
    values = _evaluate(potential, np.column_stack([horizontal, z.ravel()])).reshape(along.shape)
    return {
        "origin": (problem.centre[:2] + problem.unit * origin).tolist(),
        "direction": direction.tolist(),
        "along": (problem.unit * offsets).tolist(),
        "z": (problem.centre[2] + problem.unit * offsets).tolist(),
        "potential": np.round(values, 5).tolist(),
    }


def _vertical_plane(problem: Conductors) -> tuple[Array, Array]:
    """The point (2,) halfway between the two centres, and the plane's horizontal unit vector (2,) with x ≥ 0, in the scaled frame."""
    centres = [body.corners.mean(axis=0)[:2] for body in problem.bodies]
    sensor = np.mean([centres[k] for k in problem.bodies_of(0)], axis=0)
    elsewhere = [centre for centre, owner in zip(centres, problem.owner) if owner != 0]
    others = np.mean(elsewhere, axis=0) if elsewhere else sensor
    difference = others - sensor
    length = float(np.linalg.norm(difference))
    direction = difference / length if length > SAME_PLACE else np.array([1.0, 0.0])
    turned = direction[0] < 0 or (direction[0] == 0 and direction[1] < 0)
    return (sensor + others) / 2, -direction if turned else direction


def _evaluate(function: fem.Function, points: Array) -> Array:
    """Values (n,) of a function at points (n, 3); 0 outside of its mesh, that is behind the walls of a room."""
    mesh = function.function_space.mesh
    tree = dolfinx.geometry.BoundingBoxTree(mesh, mesh.topology.dim)
    candidates = dolfinx.geometry.compute_collisions(tree, points)
    cells = dolfinx.geometry.compute_colliding_cells(mesh, candidates, points)
    found = [k for k in range(len(points)) if len(cells.links(k))]
    values = np.zeros(len(points))
    values[found] = function.eval(points[found], [cells.links(k)[0] for k in found])[:, 0]
    return values

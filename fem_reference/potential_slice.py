"""The potential in a plane through a scene, to look at: solved on the coarsest level, a picture rather than a figure."""

from __future__ import annotations

from typing import Any

import dolfinx
import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from fem_reference.driven_sensor import driven_sensor
from fem_reference.scene_bodies import Conductors, conductors
from geometries.scene.scene import Scene

Array = NDArray[np.float64]

POINTS = 121
REACH = 1.6
"""Half the width of the picture over the radius of the conductors' bounding sphere."""
SAME_PLACE = 0.02
"""Centres closer than this, in radii of the bounding sphere, give no direction to cut along."""


def potential_slice(scene: Scene, source: str = "scene") -> dict[str, Any]:
    """{"origin": (2,), "direction": (2,), "along": (k,), "z": (k,), "potential": (k, k)}: metres, volts.

    The plane is vertical and goes through the centre of the first sensor and that of all other conductors; along x when
    they stand above each other. A point of it is origin + along·direction horizontally, z upwards; rows of `potential`
    follow z. The first sensor is at 1 V, every other conductor grounded or, if floating, without charge. Raises InputError as `conductors` does.
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
    """A point (2,), halfway between the two centres, and a unit direction (2,) in the scaled frame, x ≥ 0."""
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
    """Values (n,) of a function at points (n, 3); 0 outside of its mesh, behind the walls of a room."""
    mesh = function.function_space.mesh
    tree = dolfinx.geometry.BoundingBoxTree(mesh, mesh.topology.dim)
    candidates = dolfinx.geometry.compute_collisions(tree, points)
    cells = dolfinx.geometry.compute_colliding_cells(mesh, candidates, points)
    found = [k for k in range(len(points)) if len(cells.links(k))]
    values = np.zeros(len(points))
    values[found] = function.eval(points[found], [cells.links(k)[0] for k in found])[:, 0]
    return values

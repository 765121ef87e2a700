"""The charges on the single bodies of each conductor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mpi4py import MPI
from scipy.spatial import cKDTree

from fem_reference.bodies.conductors import Conductors
from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.shapes import Body
from fem_reference.bodies.symmetry import Plane, orbits
from fem_reference.bodies.wrapping import Wrap, member_names, spread_points
from fem_reference.mesh.body_distances import surface_distance
from fem_reference.solve.field_problem import FieldProblem, with_floating
from geometries.common.arrays import Array

AS_NEAR = 1e-6
"""Difference of the distances, over the scene's unit of length, up to which a place is as near to one body as to another."""


def body_charges(
    problem: Conductors, system: FieldProblem, potentials: Sequence[Array], planes: Sequence[Plane] = ()
) -> tuple[Array, ...]:
    """For each conductor with a row the charges (members, n) on its bodies, per volt on each of these conductors (ε = 1).

    The charge on a place of the surface is the reaction K·u of the unknown there. It belongs to the body nearest to it, in equal parts
    if several are: along the seams of bodies, charges are uncertain by those in a cell. `planes` are the planes of symmetry of which
    one side is meshed. The sum over the members is the conductor's row, except for the error of the linear solver.
    """
    rows, members = len(problem.names), problem.members
    if all(len(names) == 1 for names in members[:rows]):
        return ()
    floating = len(potentials) - rows
    maxwell = system.energies(potentials) if floating else np.empty((0, 0))
    driven = with_floating(np.array(potentials), maxwell, floating, system.to_ground)
    reactions = system.reactions(driven)
    coordinates = system.space.tabulate_dof_coordinates()
    images = orbits(problem.bodies, problem.owner, planes)
    found = []
    for row in range(rows):
        dofs, names = system.dofs[row], members[row]
        shares = np.ones((1, len(dofs)))
        if len(names) > 1:
            bodies = [problem.bodies[k] for k in problem.parts[row]]
            shares = _shares(coordinates[dofs], bodies, names)
        own = MPI.COMM_WORLD.allreduce(shares @ reactions[:, dofs].T)
        found.append(_mean_over_images(np.asarray(own), problem, row, images))
    return tuple(found)


def _shares(points: Array, bodies: Sequence[Body], names: Sequence[str]) -> Array:
    """The share (members, n) of each member in the places (n, 3) on the surface of a conductor."""
    distances = np.full((len(names), len(points)), np.inf)
    for body in bodies:
        for name, distance in zip(member_names(body), _distances(points, body)):
            k = names.index(name)
            distances[k] = np.minimum(distances[k], distance)
    nearest = distances <= distances.min(axis=0, initial=np.inf) + AS_NEAR
    return np.asarray(nearest / np.maximum(nearest.sum(axis=0), 1))


def _distances(points: Array, body: Body) -> list[Array]:
    """The distances (n,) of points from the surface of each body that a body stands for; those from triangles are sampled."""
    if isinstance(body, Wrap):
        groups = [body.samples[body.labels == k] for k in range(len(body.members))]
    elif isinstance(body, Polyhedron):
        groups = [spread_points([body.vertices[body.triangles]])[0]]
    else:
        return [np.asarray(surface_distance(body, points.T))]
    return [np.asarray(cKDTree(group).query(points)[0]) for group in groups]


def _mean_over_images(
    charges: Array, problem: Conductors, row: int, images: Sequence[frozenset[int]]
) -> Array:
    """The charges (members, n) of bodies that the planes of symmetry map to each other, made equal: only a part of them is meshed."""
    names = problem.members[row]
    mean = charges.copy()
    for orbit in images:
        own = [problem.bodies[k].name for k in orbit if problem.owner[k] == row]
        numbers = sorted({names.index(name) for name in own if name in names})
        if len(numbers) > 1:
            mean[numbers] = charges[numbers].mean(axis=0)
    return mean

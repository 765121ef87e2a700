"""What it costs that cells follow curved surfaces only nearly: measured on meshes so coarse that it is most of the error."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.constants import epsilon_0
from scipy.special import elliprf

from fem_reference.bodies.conductors import normalised
from fem_reference.bodies.round_bodies import Arc, Ellipsoid, Sphere
from fem_reference.bodies.shapes import Disc
from fem_reference.bodies.symmetry import mirror_planes
from fem_reference.mesh.body_distances import distance_from_surface
from fem_reference.mesh.curved_surfaces import curved_faces, rim_errors
from fem_reference.mesh.quarter_points import straighten
from fem_reference.mesh.size_rules import Sizing
from fem_reference.mesh.tagged_mesh import tagged_mesh
from fem_reference.solve.level import solve_level

COARSE = Sizing(growth=0.6, curvature=1.0)
AT_ORIGIN = np.zeros(3)


@pytest.mark.parametrize("semi_axes", [(1.0, 1.0, 0.2), (1.0, 0.6, 0.25)], ids=str)
def test_the_interval_of_an_ellipsoid_holds_the_closed_form(semi_axes: tuple[float, float, float]) -> None:
    """1/R_F(a², b², c²), with R_F as Carlson defined it."""
    body = Ellipsoid("ellipsoid", AT_ORIGIN, np.eye(3), semi_axes)
    problem = normalised(["ellipsoid"], 0, [body], [0])
    planes = mirror_planes(problem.bodies, problem.owner, problem.room)
    found = solve_level(problem, 1.0, COARSE, "estimate", planes)
    truth = 4 * np.pi * epsilon_0 / elliprf(*np.square(semi_axes))
    assert found.bounds is not None and found.estimated is not None
    assert found.bounds.interval.lower[0, 0] <= truth <= found.bounds.interval.upper[0, 0]
    value, error = (float(part[0, 0]) for part in found.estimated)
    assert abs(value - truth) <= error < 0.1 * truth


def test_distances_from_surfaces_are_measured_on_straight_faces_too() -> None:
    """A ball whose cells have straight sides, as where bent ones would be turned inside out: the faces are chords."""
    ball = Sphere("ball", AT_ORIGIN, 0.5)
    mesh = tagged_mesh([ball], [0], COARSE)
    bent = mesh.curved_faces.deviations.max()
    nodes = mesh.mesh.geometry.x
    straighten(nodes, mesh.mesh.geometry.dofmap.array.reshape(mesh.local_cells, -1))
    faces = curved_faces(mesh.mesh, mesh.cells, [ball])
    cells = mesh.mesh.geometry.dofmap.array.reshape(mesh.local_cells, -1)[faces.cells]
    longest = max(
        float(np.linalg.norm(nodes[cells[:, i]] - nodes[cells[:, j]], axis=1).max())
        for i in range(4)
        for j in range(i)
    )
    assert 5 * bent < faces.deviations.max() < longest**2 / (2 * ball.radius)
    # Every face is there from both sides.
    assert sorted(zip(faces.cells, faces.others)) == sorted(zip(faces.others, faces.cells))


def test_the_distance_from_an_arc_is_known_inside_of_it_too() -> None:
    arc = Arc("arc", AT_ORIGIN, np.eye(3), 1.0, 2.0, 1.0, np.pi / 2)
    points = np.array([[1.9, 0, 0], [2.1, 0, 0], [1.1, 0, 0], [0.9, 0, 0], [1.5, 0, 0.45], [0.05, 1.5, 0]])
    np.testing.assert_allclose(
        distance_from_surface(arc, points.T), [0.1, 0.1, 0.1, 0.1, 0.05, 0.05], atol=1e-12
    )


def test_the_rim_of_a_disc_that_is_a_polygon_has_the_error_of_its_chords() -> None:
    disc = Disc("disc", AT_ORIGIN, np.eye(3), 0.5)
    mesh = tagged_mesh([disc], [0], COARSE)
    assert 0 < mesh.mean_rim_error <= mesh.rim_error < 1e-3
    nodes, cells = mesh.mesh.geometry.x, mesh.mesh.geometry.dofmap.array.reshape(mesh.local_cells, -1)
    straighten(nodes, cells)
    errors, lengths = rim_errors([disc], nodes, cells)
    sagitta = disc.radius - np.sqrt(disc.radius**2 - lengths**2 / 4)
    np.testing.assert_allclose(errors, 2 * sagitta * (1 / disc.radius + 1 / lengths), rtol=1e-6)

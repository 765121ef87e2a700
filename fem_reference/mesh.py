"""From bodies to a tagged tetrahedral mesh: OpenCASCADE geometry, graded mesh, quarter-point elements at plate edges."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import dolfinx
import gmsh
import numpy as np
from dolfinx.io import gmshio
from mpi4py import MPI
from numpy.typing import NDArray

from fem_reference.bodies import Body, Cuboid, Disc, Rectangle
from fem_reference.sizing import Sizing, set_size_field

OUTER_SURFACE = 1
FREE_SPACE = 1
FIRST_BODY = 10
"""Body k carries the tag FIRST_BODY + k: on its facets when it is a plate, on its cells when it is solid."""

AWAY_FROM_EDGES, NEAR_EDGE = 0, 1
"""Values of `TaggedMesh.near_edge`: the quarter-point elements need a quadrature of higher degree."""

OUTER_RADIUS = 100.0
"""Radius of the outer sphere over the radius of the conductors' bounding sphere. The mesh grows geometrically, so that
100 costs few unknowns more than 10, and what the boundary condition neglects falls as its third power."""

TETRAHEDRON_EDGES = np.array([[2, 3], [1, 3], [1, 2], [0, 3], [0, 2], [0, 1]])
"""Vertices of the edges that carry nodes 4 … 9 of a second-order tetrahedron, in the order of basix."""


@dataclass(frozen=True)
class TaggedMesh:
    """A tetrahedral mesh with the conductors' tags, and the outer sphere it ends at."""

    mesh: dolfinx.mesh.Mesh
    cells: dolfinx.mesh.MeshTagsMetaClass
    facets: dolfinx.mesh.MeshTagsMetaClass
    near_edge: dolfinx.mesh.MeshTagsMetaClass
    centre: NDArray[np.float64]
    radius: float

    @property
    def cell_count(self) -> int:
        return int(self.mesh.topology.index_map(3).size_global)


def bounding_sphere(bodies: Sequence[Body]) -> tuple[NDArray[np.float64], float]:
    """Centre (3,) and radius (m) of a sphere around all bodies: the middle of their bounding box, and what it takes."""
    corners = np.concatenate([body.corners for body in bodies])
    centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return centre, float(np.linalg.norm(corners - centre, axis=1).max())


def tagged_mesh(
    bodies: Sequence[Body], owner: Sequence[int], sizing: Sizing, straight: bool = False
) -> TaggedMesh:
    """Mesh the space around (and inside) the bodies out to a sphere of OUTER_RADIUS bounding radii.

    `owner[k]` is the conductor that body k belongs to. With `straight` the tetrahedra are of first order and there are no
    quarter-point elements: less exact, but a point finds its cell without an iteration.
    Solids are meshed inside as well: the field without them is solved on the same mesh. Raises RuntimeError when gmsh
    fails.
    """
    centre, extent = bounding_sphere(bodies)
    radius = OUTER_RADIUS * extent
    with _gmsh_model():
        _build_geometry(bodies, centre, radius)
        set_size_field(bodies, owner, sizing)
        try:
            gmsh.model.mesh.generate(3)
            gmsh.model.mesh.setOrder(1 if straight else 2)
        except Exception as failure:
            raise RuntimeError(f"gmsh could not mesh the scene: {failure}") from failure
        mesh, cells, facets = gmshio.model_to_mesh(gmsh.model, MPI.COMM_SELF, 0, gdim=3)
    pulled = np.zeros(len(cells.indices), bool) if straight else _pull_to_quarter_points(mesh, bodies)
    every_cell = np.arange(len(pulled), dtype=np.int32)
    near_edge = dolfinx.mesh.meshtags(
        mesh, 3, every_cell, np.where(pulled, NEAR_EDGE, AWAY_FROM_EDGES).astype(np.int32)
    )
    return TaggedMesh(mesh, cells, facets, near_edge, centre, radius)


@contextmanager
def _gmsh_model() -> Iterator[None]:
    gmsh.initialize(readConfigFiles=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        for source in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
            gmsh.option.setNumber(f"Mesh.MeshSize{source}", 0)
        gmsh.model.add("scene")
        yield
    finally:
        gmsh.finalize()


def _build_geometry(bodies: Sequence[Body], centre: NDArray[np.float64], radius: float) -> None:
    occ = gmsh.model.occ
    sphere = (3, occ.addSphere(*centre, radius))
    shapes = [_add_body(body) for body in bodies]
    _, parts = occ.fragment([sphere], shapes)
    occ.synchronize()
    solid_cells = {tag for body, part in zip(bodies, parts[1:]) if body.is_solid for _, tag in part}
    free_space = [tag for _, tag in parts[0] if tag not in solid_cells]
    gmsh.model.addPhysicalGroup(3, free_space, FREE_SPACE)
    for k, (body, part) in enumerate(zip(bodies, parts[1:])):
        gmsh.model.addPhysicalGroup(3 if body.is_solid else 2, [tag for _, tag in part], FIRST_BODY + k)
    boundary = gmsh.model.getBoundary(gmsh.model.getEntities(3), combined=True, oriented=False)
    outer = [tag for _, tag in boundary if np.max(np.abs(gmsh.model.getBoundingBox(2, tag))) > 0.5 * radius]
    gmsh.model.addPhysicalGroup(2, outer, OUTER_SURFACE)


def _add_body(body: Body) -> tuple[int, int]:
    """Add one body to the geometry; returns its (dimension, tag)."""
    occ = gmsh.model.occ
    if isinstance(body, Disc):
        disc = (2, occ.addDisk(0, 0, 0, body.radius, body.radius))
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = body.axes.T, body.centre
        occ.affineTransform([disc], matrix.ravel().tolist())
        return disc
    points = [occ.addPoint(*corner) for corner in body.corners]
    if isinstance(body, Rectangle):
        return (2, _add_polygon(points))
    quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    lines: dict[frozenset[int], int] = {}
    faces = [_add_polygon([points[k] for k in quad], lines) for quad in quads]
    return (3, occ.addVolume([occ.addSurfaceLoop(faces)]))


def _add_polygon(points: Sequence[int], lines: dict[frozenset[int], int] | None = None) -> int:
    """A plane face through the points; edges found in `lines` are shared."""
    occ = gmsh.model.occ
    known = {} if lines is None else lines
    loop = []
    for start, end in zip(points, [*points[1:], points[0]]):
        key = frozenset((start, end))
        if key not in known:
            known[key] = occ.addLine(start, end)
        loop.append(known[key])
    face: int = occ.addPlaneSurface([occ.addCurveLoop(loop)])
    return face


def _pull_to_quarter_points(mesh: dolfinx.mesh.Mesh, bodies: Sequence[Body]) -> NDArray[np.bool_]:
    """Move mid-edge nodes next to the edges of plates to the quarter point; returns which cells (n,) touch such an edge.

    At the edge of a plate without thickness the potential behaves as the square root of the distance. A second-order
    element whose mid-side node stands at a quarter of the side maps its reference coordinate to exactly that
    (Henshell & Shaw 1975, Barsoum 1976). Solids' right-angled edges (power 2/3) are left to the grading.
    """
    nodes = mesh.geometry.x
    cells = mesh.geometry.dofmap.array.reshape(-1, 10)
    vertices = np.unique(cells[:, :4])
    on_edge = np.zeros(len(nodes), dtype=bool)
    for body in bodies:
        if not isinstance(body, Cuboid):
            on_edge[vertices] |= body.edge_distance(nodes[vertices]) < 1e-7 * body.size
    straight = nodes.copy()
    for k, (i, j) in enumerate(TETRAHEDRON_EDGES):
        for near, far in ((cells[:, i], cells[:, j]), (cells[:, j], cells[:, i])):
            pulled = on_edge[near] & ~on_edge[far]
            nodes[cells[pulled, 4 + k]] = 0.75 * straight[near[pulled]] + 0.25 * straight[far[pulled]]
    return np.asarray(on_edge[cells[:, :4]].any(axis=1))

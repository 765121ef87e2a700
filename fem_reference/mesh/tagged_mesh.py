"""Makes a graded tetrahedral mesh around the bodies, with tags that tell them apart and quarter-point elements at plate edges."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import dolfinx
import gmsh
import numpy as np
from dolfinx.io import gmshio
from mpi4py import MPI

from fem_reference.bodies.conductors import Conductors
from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.shapes import SHEETS, Cuboid, bounding_sphere
from fem_reference.mesh.distributed import gathered, whole_numbers
from fem_reference.mesh.quarter_points import is_pulled, on_edges, pull, straighten
from fem_reference.mesh.curved_surfaces import (
    CurvedFaces,
    curved_cells,
    curved_faces,
    rim_errors,
    straighten_inverted,
)
from fem_reference.mesh.occ_shapes import add_ball, add_body, cut_to, united
from fem_reference.mesh.sizing import Sizing, size_function
from fem_reference.common.limits import stage
from fem_reference.bodies.symmetry import Plane
from geometries.common.arrays import Array, Flags, Integers

OUTER_SURFACE = 1
"""Tag of the facets at which the mesh ends: the outer sphere or the walls of a room."""
FREE_SPACE = 1
"""Tag of the cells outside all bodies."""
FIRST_BODY = 10
"""Tag of body 0. Body k has the tag FIRST_BODY + k: on its facets when it is a plate, on its cells when it is solid."""

AWAY_FROM_EDGES, NEAR_EDGE = 0, 1
"""Values of `TaggedMesh.near_edge`. Quarter-point elements and cells on curved surfaces, which need a quadrature of higher degree,
have NEAR_EDGE; all other cells have AWAY_FROM_EDGES."""

OUTER_RADIUS = 100.0
"""Radius of the outer sphere over the radius of the conductors' bounding sphere. The cells grow geometrically, so that 100 takes few
unknowns more than 10, and the error of the boundary condition falls with the third power of this radius."""

ROOM_REACH = 2.0
"""Radius that takes the place of the outer sphere's in a room, over the distance of the room's corners. Any factor above 1 is right:
nothing in the room is farther away."""

WALL = 1e-9
"""Largest distance of a corner from the wall it lies in, over the room's half width: rounding of OpenCASCADE."""

OUTER_AREA_TOLERANCE = 1e-6
"""Relative tolerance on the area of the outer surface. OpenCASCADE integrates areas to 1e-12; one face too many or too few changes
the area by a twelfth or more."""

MESH_ADAPT = 1
"""gmsh's number of its most robust surface mesher, which is half as fast as the default."""

TETRAHEDRON = 4
"""gmsh's number of the element type tetrahedron with four nodes."""

GO_ON, RAISE = 0, 2
"""Values of gmsh's option General.AbortOnError: continue after an error, or raise an exception."""

SIZE_PRECISION = 1e-5
"""Relative precision to which gmsh integrates sizes along the edges of polyhedra. Its default, 1e-9, takes nine tenths of the time of
meshing a wrap of 5000 triangles."""

FLAT = 1e-9
"""Largest ratio of six times the volume to the cube of the longest side at which a tetrahedron counts as flat. The flattest usable
cells met have 1e-5."""


@dataclass(frozen=True)
class TaggedMesh:
    """A tetrahedral mesh with tags for bodies, free space and the outer surface."""

    mesh: dolfinx.mesh.Mesh
    cells: dolfinx.mesh.MeshTagsMetaClass
    facets: dolfinx.mesh.MeshTagsMetaClass
    near_edge: dolfinx.mesh.MeshTagsMetaClass
    on_edge: Flags
    """(cells, 4): which vertices of each cell lie on the edge of a plate."""
    curved: Flags
    """(cells,): which cells follow a curved surface. The other cells have straight sides; some of them are quarter-point elements."""
    curved_faces: CurvedFaces
    """The faces on curved surfaces, and how far they are from these."""
    rim_error: float
    """Relative error of capacitances due to the difference between the cells' sides along the rims of discs and these: as if it were
    everywhere that of the worst side."""
    mean_rim_error: float
    """The same for the mean over the sides, for errors that are estimates."""
    centre: Array
    """Centre of the outer sphere."""
    radius: float
    """Radius of the outer sphere."""
    copies: int
    """Number of mirror images of the mesh, itself included, that make up the whole of space."""
    in_room: bool = False
    """Whether the outer surface is the grounded walls of a room rather than the sphere."""

    @property
    def cell_count(self) -> int:
        return int(self.mesh.topology.index_map(3).size_global)

    @property
    def local_cells(self) -> int:
        """Number of cells on this process: all of them if there is only one process."""
        return local_count(self.mesh, 3)

    @property
    def owned_cells(self) -> int:
        """Number of the process's own ones, which come first; the others are ghosts."""
        return int(self.mesh.topology.index_map(3).size_local)

    def corners(self) -> tuple[Array, Integers]:
        """The nodes (n, 3) of the whole mesh, and the numbers (cells, 4) of those at the corners of its cells, on every process."""
        geometry = self.mesh.geometry
        own = geometry.x[: geometry.index_map().size_local]
        numbers = whole_numbers(geometry.index_map())[
            geometry.dofmap.array.reshape(self.local_cells, -1)[: self.owned_cells, :4]
        ]
        return gathered(self.mesh.comm, own), gathered(self.mesh.comm, numbers.astype(np.int32))


def local_count(mesh: dolfinx.mesh.Mesh, dimension: int) -> int:
    """Number of the mesh's entities of a dimension on this process, ghosts included."""
    index_map = mesh.topology.index_map(dimension)
    return int(index_map.size_local + index_map.num_ghosts)


def on_first_process(comm: MPI.Comm, action: Callable[[], None]) -> None:
    """Run an action on the first process only; raises RuntimeError on all processes when it fails there."""
    failure = None
    if comm.rank == 0:
        try:
            action()
        except Exception as caught:
            failure = str(caught)
    failure = comm.bcast(failure)
    if failure is not None:
        raise RuntimeError(failure)


def tagged_mesh(
    problem: Conductors, sizing: Sizing, planes: Sequence[Plane] = (), straight: bool = False
) -> TaggedMesh:
    """Mesh the space around and inside the bodies, out to a sphere of OUTER_RADIUS bounding radii or to the walls of a room.

    Only the side of each of `planes`, planes of symmetry at right angles, that its normal points to is meshed. All solids are meshed
    inside, since the field without them is solved on the same mesh. With `straight` the tetrahedra are of first order and none is a
    quarter-point element: this is less accurate, but the cell of a point is found without an iteration. Raises RuntimeError when gmsh fails.
    """
    bodies, room = problem.bodies, problem.room
    centre = bounding_sphere(bodies)[0]
    for plane in planes:
        centre = (centre + plane.mirrored(centre)) / 2
    corners = np.concatenate([body.corners for body in bodies])
    if room is None:
        radius = OUTER_RADIUS * float(np.linalg.norm(corners - centre, axis=1).max())
    else:
        radius = ROOM_REACH * float(np.linalg.norm(room.corners - centre, axis=1).max())

    def build() -> None:
        with stage("building the geometry"):
            _build_geometry(problem, centre, radius, planes)
        with stage("meshing"):
            size = size_function(problem, sizing)
            size.set_in_gmsh()
            if any(isinstance(body, Polyhedron) for body in bodies):
                gmsh.option.setNumber("Mesh.LcIntegrationPrecision", SIZE_PRECISION)
            _generate()
            gmsh.model.mesh.setOrder(1 if straight else 2)

    comm = MPI.COMM_WORLD
    with _gmsh_model():
        on_first_process(comm, build)
        mesh, cells, facets = gmshio.model_to_mesh(gmsh.model, comm, 0, gdim=3)
    nodes = mesh.geometry.x
    node_numbers = mesh.geometry.dofmap.array.reshape(local_count(mesh, 3), -1)
    on_edge = np.zeros((len(node_numbers), 4), dtype=bool)
    curved = np.zeros(len(node_numbers), dtype=bool)
    error, mean = 0.0, 0.0
    if not straight:
        curved = curved_cells(nodes, node_numbers, centre, radius if room is None else np.inf)
        straighten_inverted(nodes, node_numbers[curved], mesh.geometry.index_map(), comm)
        straighten(nodes, node_numbers[~curved])
        own, weights = rim_errors(bodies, nodes, node_numbers[curved])
        error = comm.allreduce(float(own.max(initial=0.0)), op=MPI.MAX)
        whole = comm.allreduce(float(weights.sum()))
        mean = comm.allreduce(float(own @ weights)) / whole if whole else 0.0
        # The edges of solids, where the potential behaves as the power 2/3 of the distance, are resolved by the grading of the mesh alone.
        sheets = [body for body in bodies if isinstance(body, SHEETS)]
        on_edge = on_edges(sheets, nodes, np.unique(node_numbers[:, :4]))[node_numbers[:, :4]]
        pull(nodes, node_numbers, on_edge)
    _refuse_flat_cells(nodes[node_numbers[:, :4]])
    faces = curved_faces(mesh, cells, () if straight else bodies)
    near = np.where(curved | is_pulled(on_edge), NEAR_EDGE, AWAY_FROM_EDGES).astype(np.int32)
    near_edge = dolfinx.mesh.meshtags(mesh, 3, np.arange(len(near), dtype=np.int32), near)
    return TaggedMesh(
        mesh,
        cells,
        facets,
        near_edge,
        on_edge,
        curved,
        faces,
        error,
        mean,
        centre,
        radius,
        2 ** len(planes),
        room is not None,
    )


def _generate() -> None:
    """Mesh the current gmsh model; if that fails, try again with another surface mesher.

    Other surface triangles help where the triangles of two surfaces cross each other, and where a tetrahedron in a narrow gap has all
    of its corners in a plane of symmetry.
    """
    if _errors_of_meshing():
        gmsh.model.mesh.clear()
        gmsh.option.setNumber("Mesh.Algorithm", MESH_ADAPT)
        errors = _errors_of_meshing()
        if errors:
            raise RuntimeError(errors[0].removeprefix("Error: "))


def _errors_of_meshing() -> list[str]:
    """Mesh the current gmsh model and return gmsh's error messages.

    Exceptions are switched off meanwhile: raised inside of gmsh, one would leave it locked, and the next try would have no effect.
    """
    gmsh.option.setNumber("General.AbortOnError", GO_ON)
    gmsh.logger.start()
    try:
        gmsh.model.mesh.generate(3)
        errors = [line for line in gmsh.logger.get() if line.startswith("Error")]
    finally:
        gmsh.logger.stop()
        gmsh.option.setNumber("General.AbortOnError", RAISE)
    return errors or _without_volume(_corners())


def _corners() -> Array:
    """The corners (n, 4, 3) of the tetrahedra of the current gmsh model."""
    tags, points, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags] = np.arange(len(tags))
    _, nodes = gmsh.model.mesh.getElementsByType(TETRAHEDRON)
    return np.asarray(points.reshape(-1, 3)[place[nodes]].reshape(-1, 4, 3))


def _without_volume(corners: Array) -> list[str]:
    """Error messages about flat cells among those with corners (n, 4, 3): none, or one that says where they are."""
    edges = corners[:, 1:] - corners[:, :1]
    volume = np.abs(np.linalg.det(edges))
    flat = volume < FLAT * np.linalg.norm(edges, axis=2).max(axis=1) ** 3
    if not flat.any():
        return []
    places = np.round(corners[flat].mean(axis=1), 3).tolist()
    return [f"tetrahedra without volume at {places[:3]}"]


def _refuse_flat_cells(corners: Array) -> None:
    """Raise RuntimeError when one of the cells (n, 4, 3) has no volume, since the equations would be meaningless."""
    errors = _without_volume(corners)
    if MPI.COMM_WORLD.allreduce(bool(errors), op=MPI.LOR):
        raise RuntimeError(f"meshing failed: {''.join(errors)}")


@contextmanager
def _gmsh_model() -> Iterator[None]:
    """Start gmsh with an empty model, in which only the size field determines the size of the cells, and stop it afterwards."""
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


def _build_geometry(problem: Conductors, centre: Array, radius: float, planes: Sequence[Plane]) -> None:
    """Build the geometry in the current gmsh model and tag it.

    The solid bodies of one conductor are united: its cells have the tag of the first of them. What several dielectric bodies have in common
    belongs to the last of them.
    """
    occ = gmsh.model.occ
    bodies, owner, room, dielectrics = problem.bodies, problem.owner, problem.room, problem.permittivities
    shapes = [add_body(body) for body in bodies]
    solids = [k for k, body in enumerate(bodies) if body.is_solid]
    first = {k: next(j for j in solids if owner[j] == owner[k]) for k in solids}
    for k in dict.fromkeys(first.values()):
        others = [j for j in solids if first[j] == k and j != k]
        if others:
            shapes[k] = united(shapes[k], [entity for j in others for entity in shapes[j]])
            for j in others:
                shapes[j] = []
    if room is not None:
        shapes.append(add_body(room))
    if planes:
        shapes = cut_to(shapes, centre, radius, planes)
    (space,) = [add_ball(centre, radius, planes)] if room is None else shapes.pop()
    _, pieces = occ.fragment([space], [entity for shape in shapes for entity in shape])
    occ.synchronize()
    rest = iter(pieces[1:])
    parts = [pieces[0], *([entity for _ in shape for entity in next(rest)] for shape in shapes)]
    solid_cells = {tag for body, part in zip(bodies, parts[1:]) if body.is_solid for _, tag in part}
    free_space = [tag for _, tag in parts[0] if tag not in solid_cells]
    gmsh.model.addPhysicalGroup(3, free_space, FREE_SPACE)
    tagged: set[tuple[int, int]] = set()
    conducting = [k for k in range(len(bodies)) if k not in dielectrics]
    for k in (*conducting, *sorted(dielectrics, reverse=True)):
        part = parts[1 + k]
        # Plates of one conductor may overlap, and so may parts of a wrap: each piece belongs to the first one that it is a part of.
        own = [entity for entity in dict.fromkeys(part) if entity not in tagged]
        tagged.update(own)
        if own:
            gmsh.model.addPhysicalGroup(own[0][0], [tag for _, tag in own], FIRST_BODY + k)
    boundary = gmsh.model.getBoundary(gmsh.model.getEntities(3), combined=True, oriented=False)
    outer = [tag for _, tag in boundary if _is_outer(tag, radius, room)]
    _require_outer_area(outer, radius, room, 2 ** len(planes))
    gmsh.model.addPhysicalGroup(2, outer, OUTER_SURFACE)


def _require_outer_area(faces: Sequence[int], radius: float, room: Cuboid | None, copies: int) -> None:
    """Raise RuntimeError unless the mirror images of these faces make up the whole sphere, or all walls of the room."""
    if room is None:
        whole = 4 * np.pi * radius**2
    else:
        a, b, c = room.half_widths
        whole = 8 * (a * b + b * c + c * a)
    found = copies * sum(gmsh.model.occ.getMass(2, face) for face in faces)
    if abs(found - whole) > OUTER_AREA_TOLERANCE * whole:
        raise RuntimeError(f"the outer surface has {found / whole:.6g} of its area: the geometry is at fault")


def _is_outer(face: int, radius: float, room: Cuboid | None) -> bool:
    """Whether a face is a part of the outer sphere or, in a room, of a wall."""
    if room is not None:
        return _is_wall(face, room)
    far = np.max(np.abs(gmsh.model.getBoundingBox(2, face))) > 0.5 * radius
    return bool(far and gmsh.model.getType(2, face) == "Sphere")


def _is_wall(face: int, room: Cuboid) -> bool:
    """Whether all corners of a plane face lie in the same wall of the room."""
    points = gmsh.model.getBoundary([(2, face)], combined=False, oriented=False, recursive=True)
    corners = np.array([gmsh.model.getValue(0, tag, []) for _, tag in points])
    offsets = (corners - room.centre) @ room.axes.T
    # The signs tell opposite walls apart: a face in a plane of symmetry may have corners in both, and is no part of either.
    beyond = np.concatenate([offsets, -offsets], axis=1) - np.tile(room.half_widths, 2)
    return bool((np.abs(beyond) < WALL * max(room.half_widths)).all(axis=0).any())

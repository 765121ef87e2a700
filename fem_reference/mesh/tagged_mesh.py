"""From bodies to a tagged tetrahedral mesh: OpenCASCADE geometry, graded mesh, quarter-point elements at plate edges."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import dolfinx
import gmsh
import numpy as np
from dolfinx.io import gmshio
from mpi4py import MPI
from numpy.typing import NDArray

from fem_reference.bodies.shapes import Body, Cuboid, bounding_sphere
from fem_reference.mesh.curved_cells import curved_cells, shape_error, straighten_inverted
from fem_reference.mesh.occ_shapes import add_ball, add_body, cut_to
from fem_reference.mesh.quarter_points import is_pulled, pull, straighten, vertices_on_edges
from fem_reference.mesh.sizing import Sizing, set_size_field
from fem_reference.common.stages import stage
from fem_reference.bodies.symmetry import Plane

OUTER_SURFACE = 1
FREE_SPACE = 1
FIRST_BODY = 10
"""Body k carries the tag FIRST_BODY + k: on its facets when it is a plate, on its cells when it is solid."""

AWAY_FROM_EDGES, NEAR_EDGE = 0, 1
"""Values of `TaggedMesh.near_edge`: quarter-point elements and those on curved surfaces, which count as near an edge,
need a quadrature of higher degree."""

OUTER_RADIUS = 100.0
"""Radius of the outer sphere over the radius of the conductors' bounding sphere. The mesh grows geometrically, so that
100 costs few unknowns more than 10, and what the boundary condition neglects falls as its third power."""

ROOM_REACH = 2.0
"""Any factor above 1: what is farther than this from the middle is out of the room."""

WALL = 1e-9
"""Distance from a wall, over the room's half width, within which corners lie in it: rounding of OpenCASCADE."""

OUTER_AREA_TOLERANCE = 1e-6
"""Relative: what OpenCASCADE's integration of areas leaves is 1e-12, a face too many or too few is a twelfth or more."""

MESH_ADAPT = 1
"""gmsh's most robust way to mesh a surface, twice as slow as the one it takes by itself."""

TETRAHEDRON = 4
"""gmsh's number of the straight one."""

GO_ON, RAISE = 0, 2
"""gmsh's General.AbortOnError."""

FLAT = 1e-9
"""Six times the volume over the cube of the longest side of what counts as none; the flattest usable cells met have 1e-5."""


@dataclass(frozen=True)
class TaggedMesh:
    """A tetrahedral mesh with the conductors' tags, and the outer sphere it ends at."""

    mesh: dolfinx.mesh.Mesh
    cells: dolfinx.mesh.MeshTagsMetaClass
    facets: dolfinx.mesh.MeshTagsMetaClass
    near_edge: dolfinx.mesh.MeshTagsMetaClass
    on_edge: NDArray[np.bool_]
    """(cells, 4): which vertices lie on the edge of a plate."""
    curved: NDArray[np.bool_]
    """(cells,): which follow a curved surface. The others are straight, but for quarter points."""
    shape_error: float
    """What following the surfaces only nearly may do to capacitances, relatively (`curved_cells`)."""
    centre: NDArray[np.float64]
    radius: float
    copies: int
    """How many mirror images of the mesh make up the whole of space."""
    in_room: bool = False
    """Whether the outer surface is a room's walls, grounded; else it is the sphere."""

    @property
    def cell_count(self) -> int:
        return int(self.mesh.topology.index_map(3).size_global)

    @property
    def local_cells(self) -> int:
        """The cells that this process knows: all, when it is the only one."""
        return local_count(self.mesh, 3)


def local_count(mesh: dolfinx.mesh.Mesh, dimension: int) -> int:
    """The entities of a dimension that this process knows."""
    index_map = mesh.topology.index_map(dimension)
    return int(index_map.size_local + index_map.num_ghosts)


def on_first_process(comm: MPI.Comm, action: Callable[[], None]) -> None:
    """Do something on the first process only; RuntimeError on all of them when it fails there."""
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
    bodies: Sequence[Body],
    owner: Sequence[int],
    sizing: Sizing,
    straight: bool = False,
    dielectrics: Collection[int] = (),
    planes: Sequence[Plane] = (),
    room: Cuboid | None = None,
) -> TaggedMesh:
    """Mesh the space around (and inside) the bodies out to a sphere of OUTER_RADIUS bounding radii, or to a room's walls.

    Of `planes`, planes of symmetry at right angles, only the side that their normals point to is meshed. `owner[k]` is the
    conductor that body k belongs to; `dielectrics` are the bodies whose inside has a field. Solids are meshed inside as
    well: the field without them is solved on the same mesh. With `straight` the tetrahedra are of first order and there
    are no quarter-point elements: less exact, but a point finds its cell without an iteration. Raises RuntimeError when
    gmsh fails.
    """
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
            volumes = _build_geometry(bodies, centre, radius, planes, room)
        with stage("meshing"):
            set_size_field(bodies, owner, sizing, volumes, dielectrics, room)
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
    error = 0.0
    if not straight:
        curved = curved_cells(nodes, node_numbers, centre, radius if room is None else np.inf)
        straighten_inverted(nodes, node_numbers[curved])
        straighten(nodes, node_numbers[~curved])
        error = comm.allreduce(shape_error(nodes, node_numbers[curved]), op=MPI.MAX)
        on_edge = vertices_on_edges(nodes, node_numbers, bodies)
        pull(nodes, node_numbers, on_edge)
    _refuse_flat_cells(nodes[node_numbers[:, :4]])
    near = np.where(curved | is_pulled(on_edge), NEAR_EDGE, AWAY_FROM_EDGES).astype(np.int32)
    near_edge = dolfinx.mesh.meshtags(mesh, 3, np.arange(len(near), dtype=np.int32), near)
    return TaggedMesh(
        mesh,
        cells,
        facets,
        near_edge,
        on_edge,
        curved,
        error,
        centre,
        radius,
        2 ** len(planes),
        room is not None,
    )


def _generate() -> None:
    """Tetrahedra for the current gmsh model, with a second try where the triangles of two surfaces cross each other.

    Other triangles help too where a tetrahedron has all of its corners in a plane of symmetry, in a narrow gap.
    """
    if _errors_of_meshing():
        gmsh.model.mesh.clear()
        gmsh.option.setNumber("Mesh.Algorithm", MESH_ADAPT)
        errors = _errors_of_meshing()
        if errors:
            raise RuntimeError(errors[0].removeprefix("Error: "))


def _errors_of_meshing() -> list[str]:
    """Mesh; what gmsh says went wrong. An exception in its midst would leave it locked, and the next try without effect."""
    gmsh.option.setNumber("General.AbortOnError", GO_ON)
    gmsh.logger.start()
    try:
        gmsh.model.mesh.generate(3)
        errors = [line for line in gmsh.logger.get() if line.startswith("Error")]
    finally:
        gmsh.logger.stop()
        gmsh.option.setNumber("General.AbortOnError", RAISE)
    return errors or _without_volume(_corners())


def _corners() -> NDArray[np.float64]:
    """The corners (n, 4, 3) of the tetrahedra of the current gmsh model."""
    tags, points, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags] = np.arange(len(tags))
    _, nodes = gmsh.model.mesh.getElementsByType(TETRAHEDRON)
    return np.asarray(points.reshape(-1, 3)[place[nodes]].reshape(-1, 4, 3))


def _without_volume(corners: NDArray[np.float64]) -> list[str]:
    """What is wrong with cells (n, 4, 3), in words: nothing, or that some have no volume and where."""
    edges = corners[:, 1:] - corners[:, :1]
    volume = np.abs(np.linalg.det(edges))
    flat = volume < FLAT * np.linalg.norm(edges, axis=2).max(axis=1) ** 3
    if not flat.any():
        return []
    places = np.round(corners[flat].mean(axis=1), 3).tolist()
    return [f"tetrahedra without volume at {places[:3]}"]


def _refuse_flat_cells(corners: NDArray[np.float64]) -> None:
    """Raise RuntimeError when one of the cells (n, 4, 3) has no volume: the equations would make no sense."""
    errors = _without_volume(corners)
    if MPI.COMM_WORLD.allreduce(bool(errors), op=MPI.LOR):
        raise RuntimeError(f"meshing failed: {''.join(errors)}")


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


def _build_geometry(
    bodies: Sequence[Body],
    centre: NDArray[np.float64],
    radius: float,
    planes: Sequence[Plane],
    room: Cuboid | None,
) -> dict[int, list[int]]:
    """Build the current gmsh model; returns the tags of the volumes that each solid body consists of."""
    occ = gmsh.model.occ
    shapes = [add_body(body) for body in bodies]
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
    for k, part in enumerate(parts[1:]):
        # Plates of one conductor may overlap: each piece belongs to the first.
        own = [entity for entity in part if entity not in tagged]
        tagged.update(own)
        if own:
            gmsh.model.addPhysicalGroup(own[0][0], [tag for _, tag in own], FIRST_BODY + k)
    boundary = gmsh.model.getBoundary(gmsh.model.getEntities(3), combined=True, oriented=False)
    outer = [tag for _, tag in boundary if _is_outer(tag, radius, room)]
    _require_outer_area(outer, radius, room, 2 ** len(planes))
    gmsh.model.addPhysicalGroup(2, outer, OUTER_SURFACE)
    solids = [k for k, body in enumerate(bodies) if body.is_solid]
    return {k: [tag for _, tag in parts[k + 1]] for k in solids}


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
    if room is not None:
        return _is_wall(face, room)
    far = np.max(np.abs(gmsh.model.getBoundingBox(2, face))) > 0.5 * radius
    return bool(far and gmsh.model.getType(2, face) == "Sphere")


def _is_wall(face: int, room: Cuboid) -> bool:
    """Whether all corners of a plane face lie in one wall."""
    points = gmsh.model.getBoundary([(2, face)], combined=False, oriented=False, recursive=True)
    corners = np.array([gmsh.model.getValue(0, tag, []) for _, tag in points])
    offsets = (corners - room.centre) @ room.axes.T
    # The sign tells opposite walls apart: a plane of symmetry has corners in both, and is a wall of neither.
    beyond = np.concatenate([offsets, -offsets], axis=1) - np.tile(room.half_widths, 2)
    return bool((np.abs(beyond) < WALL * max(room.half_widths)).all(axis=0).any())

"""Bodies as shapes of OpenCASCADE, in the current gmsh model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import gmsh
import numpy as np
from scipy.spatial.transform import Rotation

from fem_reference.bodies.distances import CUBOID_FACES
from fem_reference.bodies.shapes import Body, Cuboid, Disc, PlanePolygon, Rectangle
from fem_reference.bodies.plane_faces import plane_faces
from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Ellipsoid, RoundBody, Sphere, Swept
from fem_reference.bodies.symmetry import Plane
from geometries.common.arrays import Array

Entity = tuple[int, int]
"""(dimension, tag)."""

CONE_SECTORS = 4
"""Number of sectors in which a cone is built."""


def add_body(body: Body) -> list[Entity]:
    """Add one body to the geometry; returns the entities that it consists of."""
    if isinstance(body, Disc):
        return [_disc(body)]
    if isinstance(body, Polyhedron):
        return _polyhedron(body)
    if isinstance(body, PlanePolygon):
        points = [gmsh.model.occ.addPoint(*corner) for corner in body.corners]
        return [(2, _polygon([points], {}))]
    if isinstance(body, Rectangle | Cuboid):
        return [_parallelotope(body)]
    return _round(body)


def add_ball(centre: Array, radius: float, planes: Sequence[Plane]) -> Entity:
    """Add the part of a ball that lies on the side of all planes to which their normals point.

    The planes go through the centre at right angles. The part is built as a sector with flat faces of its own, since OpenCASCADE fails
    to cut a whole ball along its seam.
    """
    occ = gmsh.model.occ
    lowest = 0.0 if len(planes) % 2 else -math.pi / 2
    opening = 2 * math.pi if len(planes) < 2 else math.pi / 2
    ball = (3, occ.addSphere(0, 0, 0, radius, -1, lowest, math.pi / 2, opening))
    _place([ball], _frame(planes), centre)
    return ball


def cut_to(
    shapes: Sequence[Sequence[Entity]], centre: Array, size: float, planes: Sequence[Plane]
) -> list[list[Entity]]:
    """Cut each shape to the part that lies on the side of all planes to which their normals point.

    The planes go through the centre at right angles. No shape reaches as far as `size` from the centre.
    """
    occ = gmsh.model.occ
    low = [
        0.0 if given else -size
        for given in ((False, False, True), (True, True, False), (True, True, True))[len(planes) - 1]
    ]
    box = (3, occ.addBox(*low, *(size - corner for corner in low)))
    _place([box], _frame(planes), centre)
    kept = []
    for shape in shapes:
        inside = occ.intersect(list(shape), [box], removeObject=True, removeTool=False)[0] if shape else []
        kept.append([(int(dimension), int(tag)) for dimension, tag in inside])
    occ.remove([box], recursive=True)
    return kept


def united(first: Sequence[Entity], others: Sequence[Entity]) -> list[Entity]:
    """Unite volumes that touch or overlap. The faces of each stay faces of their own; what was inside of another one is gone."""
    gmsh.option.setNumber("Geometry.OCCUnionUnify", 0)
    union, _ = gmsh.model.occ.fuse(list(first), list(others))
    return [(int(dimension), int(tag)) for dimension, tag in union]


def _frame(planes: Sequence[Plane]) -> Array:
    """Right-handed axes (3, 3), as rows, that include the planes' normals.

    The normal of a single plane is the third axis, those of two planes are the first two, and those of three are all axes.
    """
    normals = np.array([plane.normal for plane in planes]).reshape(-1, 3)
    rest = np.linalg.svd(normals, full_matrices=True)[2][len(planes) :] if len(planes) else np.eye(3)
    axes = np.vstack([rest, normals]) if len(planes) == 1 else np.vstack([normals, rest])
    # Exchanging the first two axes makes the frame right-handed and keeps the side.
    return axes if np.linalg.det(axes) > 0 else axes[[1, 0, 2]]


def _place(entities: list[Entity], axes: Array, centre: Array) -> None:
    """Rotate entities so that x, y and z become the axes, then move them to `centre`; spheres, cylinders … stay of their kind."""
    turn = Rotation.from_matrix(axes.T).as_rotvec()
    angle = float(np.linalg.norm(turn))
    if angle > 0:
        gmsh.model.occ.rotate(entities, 0, 0, 0, *(turn / angle), angle)
    gmsh.model.occ.translate(entities, *centre)


def _disc(disc: Disc) -> Entity:
    occ = gmsh.model.occ
    entity = (2, occ.addDisk(0, 0, 0, disc.radius, disc.radius))
    _place([entity], disc.axes, disc.centre)
    return entity


def _parallelotope(body: Rectangle | Cuboid) -> Entity:
    occ = gmsh.model.occ
    points = [occ.addPoint(*corner) for corner in body.corners]
    lines: dict[frozenset[int], int] = {}
    if isinstance(body, Rectangle):
        return (2, _polygon([points], lines))
    faces = [_polygon([[points[k] for k in quad]], lines) for quad in CUBOID_FACES]
    return (3, occ.addVolume([occ.addSurfaceLoop(faces)]))


def _polyhedron(body: Polyhedron) -> list[Entity]:
    """Add one volume for each part of a polyhedron, with plane faces that share edges with their neighbours."""
    occ = gmsh.model.occ
    parts = plane_faces(body)
    used = sorted({vertex for part in parts for face in part for loop in face for vertex in loop})
    points = {vertex: occ.addPoint(*body.vertices[vertex]) for vertex in used}
    lines: dict[frozenset[int], int] = {}
    volumes = []
    for part in parts:
        faces = [_polygon([[points[k] for k in loop] for loop in face], lines) for face in part]
        volumes.append((3, occ.addVolume([occ.addSurfaceLoop(faces)])))
    return volumes


def _round(body: RoundBody) -> list[Entity]:
    """Add a round body: OpenCASCADE's primitives around the z axis, rotated and moved to their place."""
    occ = gmsh.model.occ
    if isinstance(body, Sphere):
        return [(3, occ.addSphere(*body.centre, body.radius))]
    if isinstance(body, Ellipsoid | Swept):
        entities = _swept(body) if isinstance(body, Swept) else _ellipsoid(body)
        _place(entities, body.axes, body.centre)
        return entities
    bottom = (0, 0, -body.height / 2, 0, 0, body.height)
    if isinstance(body, Cylinder):
        entities = [(3, occ.addCylinder(*bottom, body.radius))]
    elif isinstance(body, Cone):
        entities = _cone_in_sectors(body)
    else:
        entities = [_sector(body)]
    _place(entities, body.axes, body.centre)
    return entities


def _ellipsoid(body: Ellipsoid) -> list[Entity]:
    """Add an ellipsoid around the origin: the octants of a ball, stretched."""
    octants = [_octant(signs, 1.0) for signs in product((-1, 1), repeat=3)]
    gmsh.model.occ.dilate(octants, 0, 0, 0, *body.semi_axes)
    return united(octants[:1], octants[1:])


def _swept(body: Swept) -> list[Entity]:
    """Add a box around the origin swept by a ball: octants of the ball, quarters of cylinders, slabs and the box."""
    occ = gmsh.model.occ
    radius, core = body.radius, np.array(body.core)
    pieces = []
    for signs in product((-1, 0, 1), repeat=3):
        flat = [k for k in range(3) if signs[k] == 0]
        if any(core[k] == 0 for k in flat):
            continue
        low = [-core[k] if k in flat else min(signs[k], 0) * radius for k in range(3)]
        corner = [signs[k] * core[k] for k in range(3)]
        if len(flat) == 0:
            piece = _octant(signs, radius)
        elif len(flat) == 1:
            piece = _quarter_cylinder(signs, flat[0], radius, float(core[flat[0]]))
        else:
            piece = (3, occ.addBox(*low, *(2 * core[k] if k in flat else radius for k in range(3))))
        occ.translate([piece], *corner)
        pieces.append(piece)
    return united(pieces[:1], pieces[1:])


def _octant(signs: Sequence[int], radius: float) -> Entity:
    """Add the part of a ball around the origin whose coordinates have these signs."""
    occ = gmsh.model.occ
    lowest = 0.0 if signs[2] > 0 else -math.pi / 2
    octant = (3, occ.addSphere(0, 0, 0, radius, -1, lowest, lowest + math.pi / 2, math.pi / 2))
    occ.rotate([octant], 0, 0, 0, 0, 0, 1, _quadrant(signs[0], signs[1]) * math.pi / 2)
    return octant


def _quarter_cylinder(signs: Sequence[int], along: int, radius: float, half_height: float) -> Entity:
    """Add a quarter of a cylinder around a coordinate axis through the origin; its other two coordinates have these signs."""
    occ = gmsh.model.occ
    first, second = (along + 1) % 3, (along + 2) % 3
    quarter = (3, occ.addCylinder(0, 0, -half_height, 0, 0, 2 * half_height, radius, angle=math.pi / 2))
    occ.rotate([quarter], 0, 0, 0, 0, 0, 1, _quadrant(signs[first], signs[second]) * math.pi / 2)
    # A third of a turn about the diagonal takes z to x, and y to z.
    occ.rotate([quarter], 0, 0, 0, 1, 1, 1, 2 * math.pi / 3 * ((along + 1) % 3))
    return quarter


def _quadrant(first: int, second: int) -> int:
    """The number, from 0, of the quadrant of points whose coordinates have these signs."""
    return {(1, 1): 0, (-1, 1): 1, (-1, -1): 2, (1, -1): 3}[first, second]


def _cone_in_sectors(cone: Cone) -> list[Entity]:
    """Add a cone as several sectors: gmsh's surface mesher stalls at the apex of a whole cone, where its surface closes on itself."""
    occ = gmsh.model.occ
    sectors = []
    for k in range(CONE_SECTORS):
        angle = 2 * math.pi / CONE_SECTORS
        sector = occ.addCone(0, 0, -cone.height / 2, 0, 0, cone.height, cone.radius, 0, angle=angle)
        occ.rotate([(3, sector)], 0, 0, 0, 0, 0, 1, k * angle)
        sectors.append((3, sector))
    return sectors


def _sector(arc: Arc) -> Entity:
    """Add an arc around the z axis: a sector of the outer cylinder without the inner one."""
    occ = gmsh.model.occ
    bottom = (0, 0, -arc.height / 2, 0, 0, arc.height)
    opening = {"angle": 2 * math.pi if arc.is_ring else 2 * arc.half_angle}
    outer = (3, occ.addCylinder(*bottom, arc.outer_radius, **opening))
    inner = (3, occ.addCylinder(*bottom, arc.inner_radius))
    (entity,), _ = occ.cut([outer], [inner])
    if not arc.is_ring:
        occ.rotate([entity], 0, 0, 0, 0, 0, 1, -arc.half_angle)
    return (int(entity[0]), int(entity[1]))


def _polygon(loops: Sequence[Sequence[int]], lines: dict[frozenset[int], int]) -> int:
    """Add a plane face bounded by loops of points, the outline first; edges in `lines` are reused, new ones are added to it."""
    occ = gmsh.model.occ
    curves = []
    for points in loops:
        loop = []
        for start, end in zip(points, [*points[1:], points[0]]):
            key = frozenset((start, end))
            if key not in lines:
                lines[key] = occ.addLine(start, end)
            loop.append(lines[key])
        curves.append(occ.addCurveLoop(loop))
    face: int = occ.addPlaneSurface(curves)
    return face

"""From the objects of a scene to bodies that can be meshed: grounded bodies that touch are merged, and what is not clean is wrapped."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from fem_reference.bodies.plane_faces import cuboid_of
from fem_reference.bodies.contacts import SMALLEST_GAP, groups, meet, refuse_contact
from fem_reference.bodies.distances import triangles_of
from fem_reference.bodies.polyhedron import NotASolid, Polyhedron, polyhedron
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Ellipsoid, Sphere, Swept
from fem_reference.bodies.shapes import SHEETS, Body, Cuboid, Disc, PlanePolygon, Rectangle, Soup, Surface
from fem_reference.bodies.wrapping import ALPHA_OF_EXTENT, Geometry, containing_triangles, wrap
from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.scene import polygons, shapes
from geometries.scene.person import Person
from geometries.scene.scene import Object, Scene
from geometries.scene.shapes import MeshShape, PlateShape

ClosedFormShape = PlateShape | shapes.Polygon | shapes.Cuboid | shapes.RoundShape

MOST_TRIANGLES = 5000
"""Largest number of triangles of a clean mesh that is meshed as it is unless `exact` is asked for. Every triangle of a round surface
becomes a face of the geometry; NUMERICS.md section 8 has the times that meshing these takes."""
MOST_TRIANGLES_UNITED = 300
"""Largest number of triangles of clean meshes whose union OpenCASCADE is asked for unless `exact` is asked for."""
BRIDGED = 5e-2
"""Widest gap between bodies of one potential that is bridged if they would be wrapped where they touched, over the smaller of their sizes:
no field gets into it. A gap that is too narrow to mesh is bridged beside any triangle mesh."""
ROUNDNESS = 1e-3
"""Largest distance of the triangles of a round body that is wrapped from its surface, over the size of the body."""

MOST_SIZE_RATIO = 1e6
"""Largest ratio between the extents of a mesh and of the largest plate: OpenCASCADE resolves 1e-7, and no mesh of cells could span more."""


_KEY_OF_SIZE: dict[type, str] = {MeshShape: "file", Person: "height"}
"""The key of a shape that messages on its size name."""


@dataclass(frozen=True)
class Part:
    """A body and the conductor it is a part of, by name; the name of a dielectric body itself."""

    conductor: str
    surface: Surface
    cluster: str
    """The name of the first of the bodies of one conductor that touch or nearly touch each other, among which this one is."""
    dielectric: bool = False
    bridged: bool = False
    """Whether it nearly touches a body of its cluster, so that the gap has to be bridged by a wrap."""

    @property
    def body(self) -> Body:
        """The surface of a part that can be meshed."""
        assert not isinstance(self.surface, Soup)
        return self.surface


def object_part(scene: Scene, body: Object, geometry: Geometry, source: str) -> Part:
    """The part that an object is by itself, in the world frame.

    Raises InputError for a dielectric plate, for a dielectric mesh that bounds no solid, and for a mesh without area or of a size that
    cannot be meshed beside the sensors.
    """
    key = f'object "{body.name}"'
    dielectric = body.relative_permittivity is not None
    if dielectric and isinstance(body.shape, shapes.SHEETS):
        raise InputError(source, f"{key}: shape.type", "a sheet has no volume that could be dielectric")
    rotation, translation = scene.pose_of_object(body.name)
    surface: Surface
    if isinstance(body.shape, MeshShape | Person):
        own = body.shape.triangles()
        label = body.shape.file if isinstance(body.shape, MeshShape) else "a person"
        _refuse_size(scene, own, f"{key}: shape.{_KEY_OF_SIZE[type(body.shape)]}", label, source)
        triangles = own @ rotation.T + translation
        most = None if dielectric or geometry.kind == "exact" else MOST_TRIANGLES
        surface = _surface_of_mesh(body.name, triangles, label, most)
        if isinstance(surface, Soup) and dielectric:
            raise InputError(source, f"{key}: shape.file", surface.defect)
    else:
        surface = _body_of_shape(body.name, body.shape, rotation.T, translation)
    return Part(body.name, surface, body.name, dielectric)


def _refuse_size(scene: Scene, triangles: Array, key: str, file: str, source: str) -> None:
    """Raise InputError for a mesh without area, or one that is too large or too small to be meshed beside the plates of the sensors."""
    extent = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    unit = triangles / extent if extent > 0 else triangles
    cross = np.cross(unit[:, 1] - unit[:, 0], unit[:, 2] - unit[:, 0])
    if not np.any(cross):
        raise InputError(source, key, f"{file} has no triangle with an area")
    edges = [
        edge for sensor in scene.sensors for plate in sensor.plates for edge in (plate.edge_u, plate.edge_v)
    ]
    largest = max((float(np.linalg.norm(edge)) for edge in edges), default=extent)
    if not 1 / MOST_SIZE_RATIO <= extent / largest <= MOST_SIZE_RATIO:
        reason = f"{file} extends over {extent:.3g} m beside plates of {largest:.3g} m: the largest ratio is {MOST_SIZE_RATIO:.0e}"
        raise InputError(source, key, reason)


def _surface_of_mesh(name: str, triangles: Array, file: str, most: int | None) -> Surface:
    """The solid that triangles bound, a cuboid where it is one; the triangles themselves if they bound none or are more than `most`."""
    if most is not None and len(triangles) > most:
        return Soup(name, triangles, f"{file} has {len(triangles)} triangles, more than {most}")
    try:
        solid = polyhedron(name, triangles)
    except NotASolid as reason:
        return Soup(name, triangles, f"{file} {reason}")
    return cuboid_of(solid) or solid


def merged(
    parts: Sequence[Part], objects: Sequence[Object], comes: Sequence[bool], geometry: Geometry
) -> list[Part]:
    """The parts that these objects are, with those made one conductor that have the same `conductor`, or are grounded and touch.

    Such a conductor has the first name that an object in it gives it, else that of its first object. Bodies touch as well if they overlap
    or contain one another, or if the gap between them is bridged; that is not done between a target, which `comes` and goes, and what stays.
    """
    pairs = list(combinations(range(len(parts)), 2))
    told = [(i, j) for i, j in pairs if objects[i].conductor is not None]
    told = [(i, j) for i, j in told if objects[i].conductor == objects[j].conductor]
    grounded = [k for k, body in enumerate(objects) if body.potential == "grounded"]
    candidates = sorted({*told, *combinations(grounded, 2)})
    touching = [(i, j) for i, j in candidates if meet(parts[i].surface, parts[j].surface)]
    near = []
    if geometry.kind != "exact":
        near = [(i, j) for i, j in candidates if (i, j) not in touching and comes[i] == comes[j]]
        near = [(i, j) for i, j in near if _nearly_touch(parts[i].surface, parts[j].surface)]
    bridged = {k for pair in near for k in pair}
    conductor = groups(len(parts), told + touching + near)
    cluster = groups(len(parts), touching + near)
    result = []
    for k, part in enumerate(parts):
        own = [body for body, number in zip(objects, conductor) if number == conductor[k]]
        name = next((body.conductor for body in own if body.conductor is not None), own[0].name)
        first = parts[cluster.index(cluster[k])].surface.name
        result.append(replace(part, conductor=name, cluster=first, bridged=k in bridged))
    return result


def of_one_potential(
    parts: Sequence[Part],
    objects: Sequence[Object],
    comes: Sequence[bool],
    columns: Sequence[str],
    geometry: Geometry,
    source: str,
) -> list[Part]:
    """The parts that these objects are, with those made one conductor that are wrapped, have no column of their own among `columns`, and have
    gaps that a common wrap bridges.

    All of these are grounded whatever is asked. What `comes` and goes stays apart from the rest.
    """
    quiet = [
        k
        for k, (part, body) in enumerate(zip(parts, objects))
        if columns and body.potential == "grounded" and part.conductor not in columns
        if _needs_wrap([other for other in parts if other.cluster == part.cluster], geometry, source)
    ]
    if not quiet:
        return list(parts)
    corners = np.concatenate([parts[k].surface.corners for k in quiet])
    bridged = ALPHA_OF_EXTENT * float(np.linalg.norm(np.ptp(corners, axis=0)))

    def are_one(first: Part, second: Part) -> bool:
        margin = bridged / min(first.surface.size, second.surface.size)
        return first.cluster == second.cluster or meet(first.surface, second.surface, margin)

    pairs = [(i, j) for i, j in combinations(quiet, 2) if comes[i] == comes[j]]
    group = groups(len(parts), [(i, j) for i, j in pairs if are_one(parts[i], parts[j])])
    leads = {k: parts[group.index(group[k])] for k in quiet}
    return [
        replace(part, conductor=leads[k].conductor, cluster=leads[k].cluster) if k in leads else part
        for k, part in enumerate(parts)
    ]


def _nearly_touch(first: Surface, second: Surface) -> bool:
    """Whether the gap between two bodies of one potential is bridged."""
    meshes = [surface for surface in (first, second) if isinstance(surface, Polyhedron | Soup)]
    if not meshes:
        return False
    return meet(first, second, BRIDGED if _cannot_be_united(meshes) else SMALLEST_GAP)


def _cannot_be_united(meshes: Sequence[Polyhedron | Soup]) -> bool:
    """Whether meshes that touch have to be wrapped."""
    count = sum(len(surface.triangles) for surface in meshes)
    return count > MOST_TRIANGLES_UNITED or any(isinstance(surface, Soup) for surface in meshes)


def meshable(
    scene: Scene, parts: Sequence[Part], room: Cuboid | None, geometry: Geometry, source: str
) -> list[Part]:
    """The parts with those that cannot be meshed as they are wrapped, those that touch together.

    Raises InputError where that is needed and `exact` was asked for, or where a wrap reaches another conductor.
    """
    sensors = {sensor.name for sensor in scene.sensors}
    found: list[Part] = []
    for cluster in dict.fromkeys(part.cluster for part in parts):
        own = [part for part in parts if part.cluster == cluster]
        if own[0].dielectric or own[0].conductor in sensors or not _needs_wrap(own, geometry, source):
            found += own
        else:
            rest = [part for part in parts if part.cluster != cluster]
            found.append(_wrapped(scene, own, rest, room, geometry, source))
    return found


def _needs_wrap(own: Sequence[Part], geometry: Geometry, source: str) -> bool:
    """Whether bodies that touch have to be wrapped. Raises InputError if they have to, but must not be."""
    if geometry.kind == "wrapped":
        return any(not isinstance(part.surface, SHEETS) for part in own)
    for part in own:
        if isinstance(part.surface, Soup) and geometry.kind == "exact":
            raise InputError(
                source,
                f'object "{part.surface.name}": shape.file',
                f"{part.surface.defect}; without --geometry exact it would be wrapped",
            )
    if geometry.kind == "exact":
        return False
    meshes = [part.surface for part in own if isinstance(part.surface, Polyhedron | Soup)]
    if len(own) == 1 and meshes:
        return isinstance(meshes[0], Soup)
    return _cannot_be_united(meshes) or any(part.bridged for part in own)


def _wrapped(
    scene: Scene,
    own: Sequence[Part],
    rest: Sequence[Part],
    room: Cuboid | None,
    geometry: Geometry,
    source: str,
) -> Part:
    """The wrap of bodies that touch. Raises InputError when it meets another conductor or the walls."""
    members = [(part.surface.name, _triangles(scene, part.surface)) for part in own]
    others = [_triangles(scene, part.surface) for part in rest]
    if room is not None:
        walls = triangles_of(room)
        assert walls is not None
        others.append(walls)
    # There may be nothing else: one conductor by itself.
    around = wrap(members, np.concatenate([np.empty((0, 3, 3)), *others]), geometry)
    result = replace(own[0], surface=around)
    remedy = f'; "{around.name}" is wrapped, which fills cavities and closes hollows narrower than {2 * around.alpha:.3g} m'
    for part in rest:
        if part.conductor != result.conductor:
            refuse_contact(around, part.surface, part.dielectric, source, remedy)
    return result


def _triangles(scene: Scene, surface: Surface) -> Array:
    """Triangles that bound a body; those of a round one contain it."""
    found = triangles_of(surface)
    if found is not None:
        return found
    body = next(body for body in scene.objects if body.name == surface.name)
    rotation, translation = scene.pose_of_object(body.name)
    return np.asarray(containing_triangles(body.shape, ROUNDNESS * surface.size) @ rotation.T + translation)


def _body_of_shape(name: str, shape: ClosedFormShape, axes: Array, centre: Array) -> Body:
    """The body of a shape whose own frame has these axes (rows) and this origin in the world."""
    match shape:
        case PlateShape():
            x, y = shape.size
            return Rectangle(name, centre, axes, (x / 2, y / 2))
        case shapes.Cuboid():
            x, y, z = shape.size
            return Cuboid(name, centre, axes, (x / 2, y / 2, z / 2))
        case shapes.Sphere():
            return Sphere(name, centre, shape.radius)
        case shapes.Cylinder():
            return Cylinder(name, centre, axes, shape.radius, shape.height)
        case shapes.Cone():
            return Cone(name, centre, axes, shape.radius, shape.height)
        case shapes.Arc():
            half_angle = np.radians(shape.degrees) / 2
            return Arc(name, centre, axes, shape.inner_radius, shape.outer_radius, shape.height, half_angle)
        case shapes.Ellipsoid():
            return Ellipsoid(name, centre, axes, shape.semi_axes)
        case shapes.Capsule():
            return Swept(name, centre, axes, shape.core, shape.radius)
        case shapes.RoundedCuboid():
            return Swept(name, centre, axes, shape.core, shape.rounding)
        case shapes.Disc():
            return Disc(name, centre, axes, shape.radius)
        case shapes.Polygon():
            outline = polygons.anticlockwise(shape.vertices)
            return PlanePolygon(name, centre, axes, np.array(outline), np.array(polygons.ears(outline)))

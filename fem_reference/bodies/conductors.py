"""Converts a scene to the bodies of the field problem, grouped into conductors, and refuses scenes that cannot be solved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from fem_reference.bodies.shapes import Body, Cuboid, Rectangle, bounding_sphere
from fem_reference.bodies.boxes import cuboid_of
from fem_reference.bodies.distances import TOUCHING, distance, gap_to_walls, holds, touch_with_faces
from fem_reference.bodies.polyhedron import NotASolid, Polyhedron, polyhedron
from fem_reference.bodies.round_bodies import Arc, Cone, Cylinder, Sphere
from fem_reference.bodies.symmetry import Plane
from geometries.common.errors import InputError
from geometries.scene import shapes
from geometries.scene.scene import Object, Scene
from geometries.scene.shapes import MeshShape, PlateShape

Array = NDArray[np.float64]
ClosedFormShape = PlateShape | shapes.Cuboid | shapes.Sphere | shapes.Cylinder | shapes.Cone | shapes.Arc

SMALLEST_GAP = 1e-3
"""Smallest gap that is meshed, over the smaller of the two bodies' sizes. The mesh resolves every gap, and the number of its cells is
proportional to the square of size over gap: with a smaller gap it would not fit into memory."""


@dataclass(frozen=True)
class Dielectric:
    """A dielectric body, which carries no free charge; `contrast` is its relative permittivity over the medium's."""

    name: str
    relative_permittivity: float
    contrast: float


@dataclass(frozen=True)
class Conductors:
    """The conductors and dielectric bodies of a scene, with all lengths divided by `unit`.

    Conductors and dielectric bodies are numbered: first the conductors of the Maxwell matrix (sensors first), then the floating
    conductors, then the conductors that are only grounded, then the dielectric bodies. `bodies[k]` is a part of number `owner[k]`.
    """

    names: tuple[str, ...]
    """The conductors that have a row in the Maxwell matrix."""
    sensors: int
    """Number of sensors among `names`."""
    bodies: tuple[Body, ...]
    owner: tuple[int, ...]
    centre: Array
    """Origin of the scaled scene, in metres."""
    unit: float
    """Unit of length of the scaled scene, in metres."""
    floating: tuple[str, ...] = ()
    dielectrics: tuple[Dielectric, ...] = ()
    grounded: tuple[str, ...] = ()
    """Conductors that are present but never driven, because their columns were not asked for. Sensors first."""
    grounded_sensors: int = 0
    """Number of sensors among `grounded`."""
    room: Cuboid | None = None
    """The grounded walls around everything; None in free space."""

    def bodies_of(self, conductor: int) -> list[int]:
        """Indices of the bodies that make up one conductor or dielectric body."""
        return [k for k, owner in enumerate(self.owner) if owner == conductor]

    @property
    def driven(self) -> int:
        """Number of conductors that are driven, floating ones included; they come first in the numbering."""
        return len(self.names) + len(self.floating)

    @property
    def parts(self) -> list[list[int]]:
        """Indices of the bodies of each conductor."""
        return [self.bodies_of(k) for k in range(self.driven + len(self.grounded))]

    def in_metres(self, plane: Plane) -> Plane:
        """Convert a plane of the scaled scene to the world frame, in metres."""
        return Plane(plane.normal, float(self.unit * plane.offset + plane.normal @ self.centre))

    @property
    def curved(self) -> tuple[str, ...]:
        """Names of the bodies with curved surfaces."""
        return tuple(
            body.name for body in self.bodies if not isinstance(body, Rectangle | Cuboid | Polyhedron)
        )

    @property
    def permittivities(self) -> dict[int, float]:
        """The permittivity of each dielectric body, by its index in `bodies`, relative to the medium's."""
        first = self.driven + len(self.grounded)
        return {
            body: dielectric.contrast
            for k, dielectric in enumerate(self.dielectrics)
            for body in self.bodies_of(first + k)
        }

    @property
    def most_charge(self) -> float:
        """Bound on the sum of |charge| in the scene over twice the charge of the one driven conductor, the others being grounded.

        Every field line starts on the driven conductor. It ends and starts again at most once on each floating conductor; at each
        dielectric body, which it is assumed to cross once, a share |1 − 1/ε| of it does so.
        """
        return 1 + len(self.floating) + sum(abs(1 - 1 / body.contrast) for body in self.dielectrics)


def conductors(scene: Scene, source: str = "scene", columns: Sequence[str] = ()) -> Conductors:
    """The conductors and dielectric bodies of a scene, moved to the origin and scaled by their bounding sphere's radius.

    Scaled, a scene of twice the size or in another place gives the same mesh and the same numbers, except for the unit. With
    `columns` only the conductors named there have a row, and the others are grounded. Raises InputError for scenes that cannot be
    solved: without a sensor, with a column that names no conductor, with a shape or material unknown to the solver, or with
    conductors that touch.
    """
    if not scene.sensors:
        raise InputError(source, "sensor", "nothing to solve: the scene has no capacitive sensor")
    _refuse_unsupported(scene, source)
    solid = [body for body in scene.objects if body.relative_permittivity is None]
    grounded = [body for body in solid if body.potential == "grounded"]
    floating = [body for body in solid if body.potential == "floating"]
    dielectric = [body for body in scene.objects if body.relative_permittivity is not None]
    sensors = [sensor.name for sensor in scene.sensors]
    rows = [*sensors, *(body.name for body in grounded)]
    _refuse_unknown(columns, rows, source)
    asked = [name for name in rows if not columns or name in columns]
    others = [name for name in rows if name not in asked]
    numbered = [*asked, *(body.name for body in floating), *others, *(body.name for body in dielectric)]
    number = {name: k for k, name in enumerate(numbered)}
    bodies: list[Body] = []
    owner: list[int] = []
    for sensor in sensors:
        for corner, edge_u, edge_v in scene.sensor_rectangles(sensor):
            owner.append(number[sensor])
            bodies.append(rectangle(sensor, corner, edge_u, edge_v))
    for body in [*grounded, *floating, *dielectric]:
        owner.append(number[body.name])
        bodies.append(_object_body(scene, body, source))
    for first, second in combinations(range(len(bodies)), 2):
        if owner[first] != owner[second]:
            # Dielectric bodies come last, so that the second of two bodies is dielectric when either is.
            any_dielectric = owner[second] >= len(scene.sensors) + len(solid)
            _refuse_contact(bodies[first], bodies[second], any_dielectric, source)
    return normalised(
        asked,
        sum(name in asked for name in sensors),
        bodies,
        owner,
        [body.name for body in floating],
        [_dielectric(body, scene) for body in dielectric],
        others,
        sum(name in others for name in sensors),
        _room(scene, bodies, source),
    )


def _room(scene: Scene, bodies: Sequence[Body], source: str) -> Cuboid | None:
    """The walls of the scene's room, if it has one. Raises InputError when a body is outside or too close to them."""
    if scene.room is None:
        return None
    pose = scene.room.pose.transform()
    x, y, z = scene.room.size
    room = Cuboid("room", pose.translation, pose.rotation.T, (x / 2, y / 2, z / 2))
    for body in bodies:
        if gap_to_walls(body, room) < SMALLEST_GAP * body.size:
            raise InputError(
                source, "room", f'"{body.name}" is not inside, {SMALLEST_GAP:g} of its size off the walls'
            )
    return room


def _refuse_unsupported(scene: Scene, source: str) -> None:
    """Raise InputError for electrodes and for conductors of several objects."""
    for body in scene.objects:
        if body.potential == "electrode":
            raise InputError(
                source, f'object "{body.name}": potential', "the field solver knows no electrodes"
            )
        if body.conductor is not None:
            raise InputError(
                source,
                f'object "{body.name}": conductor',
                "the field solver knows conductors of one object each",
            )


def _refuse_unknown(columns: Sequence[str], rows: Sequence[str], source: str) -> None:
    """Raise InputError when one of the columns asked for is not that of a conductor."""
    unknown = [name for name in columns if name not in rows]
    if unknown:
        known = ", ".join(f'"{name}"' for name in rows)
        raise InputError(
            source, "columns", f'"{unknown[0]}" is not a conductor with a column: these are {known}'
        )


def normalised(
    names: Sequence[str],
    sensors: int,
    bodies: Sequence[Body],
    owner: Sequence[int],
    floating: Sequence[str] = (),
    dielectrics: Sequence[Dielectric] = (),
    grounded: Sequence[str] = (),
    grounded_sensors: int = 0,
    room: Cuboid | None = None,
) -> Conductors:
    """Scale bodies given in metres to `Conductors`, whose attributes the arguments are."""
    centre, unit = bounding_sphere(bodies)
    scaled = tuple(moved(body, centre, unit) for body in bodies)
    return Conductors(
        tuple(names),
        sensors,
        scaled,
        tuple(owner),
        centre,
        unit,
        tuple(floating),
        tuple(dielectrics),
        tuple(grounded),
        grounded_sensors,
        None if room is None else moved_cuboid(room, centre, unit),
    )


def rectangle(name: str, corner: Array, edge_u: Array, edge_v: Array) -> Rectangle:
    """The rectangle corner + a·edge_u + b·edge_v with a and b in [0, 1]; the edges are at right angles, lengths in metres."""
    widths = float(np.linalg.norm(edge_u)), float(np.linalg.norm(edge_v))
    first, second = edge_u / widths[0], edge_v / widths[1]
    axes = np.array([first, second, np.cross(first, second)])
    return Rectangle(name, corner + (edge_u + edge_v) / 2, axes, (widths[0] / 2, widths[1] / 2))


def _dielectric(body: Object, scene: Scene) -> Dielectric:
    assert body.relative_permittivity is not None
    contrast = body.relative_permittivity / scene.medium.relative_permittivity
    return Dielectric(body.name, body.relative_permittivity, contrast)


def _object_body(scene: Scene, body: Object, source: str) -> Body:
    """The body of an object in the world frame. Raises InputError for a dielectric plate and for a mesh that bounds no solid."""
    key = f'object "{body.name}"'
    if body.relative_permittivity is not None and isinstance(body.shape, PlateShape):
        raise InputError(source, f"{key}: shape.type", "a plate has no volume that could be dielectric")
    rotation, translation = scene.pose_of_object(body.name)
    if isinstance(body.shape, MeshShape):
        try:
            solid = polyhedron(body.name, body.shape.triangles() @ rotation.T + translation)
        except NotASolid as reason:
            raise InputError(source, f"{key}: shape.file", f"{body.shape.file} {reason}") from reason
        return cuboid_of(solid) or solid
    return _body_of_shape(body.name, body.shape, rotation.T, translation)


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


def _refuse_contact(first: Body, second: Body, dielectric: bool, source: str) -> None:
    """Raise InputError when two bodies meet, or are too close to mesh; a `dielectric` second body may touch the first with a face."""
    key = f'"{first.name}" and "{second.name}"'
    gap = distance(first, second)
    size = min(first.size, second.size)
    if dielectric and gap <= TOUCHING * size and touch_with_faces(first, second):
        return
    for outer, inner in ((first, second), (second, first)):
        if holds(outer, inner):
            raise InputError(source, key, f'"{inner.name}" is inside "{outer.name}"')
    if gap <= TOUCHING * size and dielectric:
        raise InputError(
            source,
            key,
            "overlap, or touch elsewhere than with plane faces; a dielectric body may touch with plane faces of "
            "plates, cuboids, cylinders and cones only",
        )
    if gap <= TOUCHING * size:
        raise InputError(
            source, key, "the conductors touch or cross: their capacitance is infinite or meaningless"
        )
    if gap < SMALLEST_GAP * size:
        raise InputError(
            source,
            key,
            f"the gap of {gap:.3g} m is below {SMALLEST_GAP:g} of the smaller size, too narrow to mesh",
        )


def moved(body: Body, centre: Array, unit: float) -> Body:
    """The body with `centre` as the origin and with lengths divided by `unit`."""
    if isinstance(body, Polyhedron):
        return replace(body, vertices=(body.vertices - centre) / unit, size=body.size / unit)
    origin = (body.centre - centre) / unit
    if isinstance(body, Rectangle):
        a, b = body.half_widths
        return replace(body, centre=origin, half_widths=(a / unit, b / unit))
    if isinstance(body, Cuboid):
        return moved_cuboid(body, centre, unit)
    lengths = ("radius", "height", "inner_radius", "outer_radius")
    scaled = {name: getattr(body, name) / unit for name in lengths if hasattr(body, name)}
    return replace(body, centre=origin, **scaled)


def moved_cuboid(body: Cuboid, centre: Array, unit: float) -> Cuboid:
    """The cuboid with `centre` as the origin and with lengths divided by `unit`."""
    a, b, c = body.half_widths
    return replace(body, centre=(body.centre - centre) / unit, half_widths=(a / unit, b / unit, c / unit))

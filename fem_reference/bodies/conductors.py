"""Converts a scene to the bodies of the field problem, grouped into conductors, and refuses scenes that cannot be solved."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import TypeVar

import numpy as np
from scipy.constants import epsilon_0

from fem_reference.bodies.contacts import refuse_contact, refuse_outside
from fem_reference.bodies.distances import overlap
from fem_reference.bodies.parts import Part, merged, meshable, object_part, of_one_potential
from fem_reference.bodies.polyhedron import Polyhedron
from fem_reference.bodies.shapes import Body, Cuboid, PlanePolygon, Rectangle, bounding_sphere, rectangle
from fem_reference.bodies.symmetry import Plane, mirror_planes
from fem_reference.bodies.wrapping import Geometry, Wrap, member_names
from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.scene.readings import readings, targets
from geometries.scene.scene import Object, Scene

AnyBody = TypeVar("AnyBody", bound=Body)
POINTS = frozenset(("centre", "vertices", "samples"))
"""The attributes of bodies that are points."""
LENGTHS = frozenset(
    "half_widths outline ears radius height inner_radius outer_radius core semi_axes size".split()
)
"""Those that are lengths, or coordinates in the frame of a body."""


@dataclass(frozen=True)
class Dielectric:
    """A dielectric body, which carries no free charge; `contrast` is its relative permittivity over the medium's."""

    name: str
    relative_permittivity: float
    contrast: float


@dataclass(frozen=True)
class Measured:
    """A reading: the charge on the row `sense` of the Maxwell matrix with the rows `drive` at 1 V, as a positive number."""

    name: str
    sense: int
    drive: tuple[int, ...]

    @property
    def sign(self) -> float:
        """The factor on the charge: −1 where the charge is induced by others."""
        return 1.0 if self.sense in self.drive else -1.0


@dataclass(frozen=True)
class Conductors:
    """The conductors and dielectric bodies of a scene, with all lengths divided by `unit`.

    Conductors and dielectric bodies are numbered: first the conductors of the Maxwell matrix (sensors first), then the floating
    conductors, then the conductors that are only grounded, then the dielectric bodies. `bodies[k]` is a part of number `owner[k]`.
    """

    names: tuple[str, ...]
    """The conductors that have a row in the Maxwell matrix: sensors, then grounded objects and electrodes in their order."""
    sensors: int
    """Number of sensors among `names`."""
    bodies: tuple[Body, ...]
    owner: tuple[int, ...]
    centre: Array = field(default_factory=lambda: np.zeros(3))
    """Origin of the scaled scene, in metres."""
    unit: float = 1.0
    """Unit of length of the scaled scene, in metres."""
    floating: tuple[str, ...] = ()
    dielectrics: tuple[Dielectric, ...] = ()
    grounded: tuple[str, ...] = ()
    """Conductors that are present but never driven, because their columns were not asked for. Sensors first."""
    grounded_sensors: int = 0
    """Number of sensors among `grounded`."""
    room: Cuboid | None = None
    """The grounded walls around everything; None in free space."""
    to_ground: tuple[float, ...] = ()
    """For each floating conductor its capacitance to ground over the medium's permittivity; empty if none has one."""
    targets: frozenset[str] = frozenset()
    """The conductors and dielectric bodies without which readings have their background."""
    readings: tuple[Measured, ...] = ()
    """The readings whose conductors all have a row."""
    bounded_readings: bool = False
    """Whether the readings' background is enclosed as well, which takes as long as enclosing the matrix."""

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

    @property
    def grounded_bodies(self) -> list[int]:
        """Indices of the bodies that are at 0 V in every solution."""
        return [k for part in self.parts[self.driven :] for k in part]

    @property
    def members(self) -> tuple[tuple[str, ...], ...]:
        """The names of the bodies that make up each conductor."""
        return tuple(
            tuple(dict.fromkeys(name for k in bodies for name in member_names(self.bodies[k])))
            for bodies in self.parts
        )

    @property
    def wraps(self) -> tuple[Wrap, ...]:
        """The bodies that are wraps of others."""
        return tuple(body for body in self.bodies if isinstance(body, Wrap))

    @property
    def is_target(self) -> tuple[bool, ...]:
        """Whether each number, of a conductor or a dielectric body, is that of a target."""
        dielectrics = [body.name for body in self.dielectrics]
        numbered = [*self.names, *self.floating, *self.grounded, *dielectrics]
        return tuple(name in self.targets for name in numbered)

    @property
    def mirror_planes(self) -> tuple[Plane, ...]:
        """The planes of symmetry, of which one side is enough to be solved."""
        return mirror_planes(self.bodies, self.owner, self.room)

    def in_metres(self, plane: Plane) -> Plane:
        """Convert a plane of the scaled scene to the world frame, in metres."""
        return Plane(plane.normal, float(self.unit * plane.offset + plane.normal @ self.centre))

    @property
    def curved(self) -> tuple[str, ...]:
        """Names of the bodies with curved surfaces."""
        return tuple(
            body.name
            for body in self.bodies
            if not isinstance(body, Rectangle | PlanePolygon | Cuboid | Polyhedron)
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


@dataclass(frozen=True)
class Assembly:
    """The parts of a scene, told apart by their conductors, before those that need it are wrapped."""

    scene: Scene
    source: str
    parts: tuple[Part, ...]
    asked: tuple[str, ...]
    """The conductors that have a row."""
    floating: tuple[str, ...]
    others: tuple[str, ...]
    """The conductors that are only grounded."""
    targets: frozenset[str]
    to_ground: tuple[float, ...]
    """The capacitance to ground (F) of each floating conductor."""


def conductors(
    scene: Scene, source: str = "scene", columns: Sequence[str] = (), geometry: Geometry = Geometry()
) -> Conductors:
    """The conductors and dielectric bodies of a scene, moved to the origin and scaled by their bounding sphere's radius.

    Scaled, a scene of twice the size or in another place gives the same mesh and the same numbers, except for the unit. Raises InputError and
    RuntimeError as `assembly` and `wrapped` do.
    """
    return wrapped(assembly(scene, source, columns, geometry), geometry)


def assembly(scene: Scene, source: str, columns: Sequence[str], geometry: Geometry) -> Assembly:
    """The parts of a scene and the conductors that they make up.

    Grounded bodies that touch or overlap are one conductor, and so are objects with the same `conductor`. With `columns` only the conductors
    named there have a row, and the others are grounded. Raises InputError for scenes that cannot be solved: without a sensor or an
    electrode, with a column that names no conductor, with a shape or material unknown to the solver, or where bodies touch that may have
    different potentials.
    """
    if not scene.sensors and all(body.potential != "electrode" for body in scene.objects):
        raise InputError(
            source, "sensor", "nothing to solve: the scene has no capacitive sensor and no electrode"
        )
    solid = [body for body in scene.objects if body.relative_permittivity is None]
    dielectric = [body for body in scene.objects if body.relative_permittivity is not None]
    sensors = [sensor.name for sensor in scene.sensors]
    plates = [
        Part(sensor, rectangle(sensor, *sides), sensor)
        for sensor in sensors
        for sides in scene.sensor_rectangles(sensor)
    ]
    come = {body.name: comes for body, comes in zip(scene.objects, targets(scene))}
    comes = [come[body.name] for body in solid]
    conducting = merged(
        [object_part(scene, body, geometry, source) for body in solid], solid, comes, geometry
    )
    known = [part.conductor for part, body in zip(conducting, solid) if body.potential != "floating"]
    _refuse_unknown(columns, list(dict.fromkeys([*sensors, *known])), source)
    conducting = of_one_potential(conducting, solid, comes, columns, geometry, source)
    fixed = [part for part, body in zip(conducting, solid) if body.potential != "floating"]
    free = [part for part, body in zip(conducting, solid) if body.potential == "floating"]
    parts = [*plates, *fixed, *free, *(object_part(scene, body, geometry, source) for body in dielectric)]
    rows = list(dict.fromkeys(part.conductor for part in [*plates, *fixed]))
    floating = tuple(dict.fromkeys(part.conductor for part in free))
    asked = tuple(name for name in rows if not columns or name in columns)
    others = tuple(name for name in rows if name not in asked)
    comes_and_goes = _targets(come, dielectric, conducting, solid, source)
    _refuse_contacts(parts, sensors, source)
    to_ground = {part.conductor: body.to_ground for part, body in zip(conducting, solid)}
    return Assembly(
        scene,
        source,
        tuple(parts),
        asked,
        floating,
        others,
        comes_and_goes,
        tuple(to_ground[name] for name in floating),
    )


def wrapped(found: Assembly, geometry: Geometry) -> Conductors:
    """The conductors, where `geometry` says which bodies are wrapped, and how closely.

    Raises InputError where a wrap meets another body or the walls of a room, RuntimeError when a body cannot be wrapped.
    """
    scene, asked, others = found.scene, found.asked, found.others
    room = _room(scene)
    parts = meshable(scene, found.parts, room, geometry, found.source)
    if room is not None:
        for part in parts:
            refuse_outside(part.surface, room, found.source)
    medium = scene.medium.relative_permittivity
    dielectrics = tuple(
        Dielectric(body.name, body.relative_permittivity, body.relative_permittivity / medium)
        for body in scene.objects
        if body.relative_permittivity is not None
    )
    numbered = [*asked, *found.floating, *others, *(body.name for body in dielectrics)]
    sensors = [sensor.name for sensor in scene.sensors]
    problem = scaled(
        Conductors(
            asked,
            sum(name in asked for name in sensors),
            tuple(part.body for part in parts),
            tuple(numbered.index(part.conductor) for part in parts),
            floating=found.floating,
            dielectrics=dielectrics,
            grounded=others,
            grounded_sensors=sum(name in others for name in sensors),
            room=room,
        )
    )
    permittivity = epsilon_0 * medium
    return replace(
        problem,
        to_ground=tuple(capacitance / (permittivity * problem.unit) for capacitance in found.to_ground),
        targets=found.targets,
        readings=tuple(
            Measured(reading.name, asked.index(reading.sense), tuple(map(asked.index, reading.drive)))
            for reading in readings(scene)
            if {reading.sense, *reading.drive} <= {*asked}
        ),
        bounded_readings=bool(scene.readings) or any(body.target for body in scene.objects),
    )


def _targets(
    come: Mapping[str, bool],
    dielectric: Sequence[Object],
    parts: Sequence[Part],
    solid: Sequence[Object],
    source: str,
) -> frozenset[str]:
    """The names of the conductors, whose `parts` are the objects `solid`, and of the dielectric bodies that `come` and go.

    Raises InputError where only some bodies of a conductor do.
    """
    machine = {part.conductor: body.name for part, body in zip(parts, solid) if not come[body.name]}
    found = {body.name for body in dielectric if come[body.name]}
    for part, body in zip(parts, solid):
        if come[body.name]:
            if part.conductor in machine:
                reason = f'is one conductor with "{machine[part.conductor]}", which stays: the field is not solved without a part of it'
                raise InputError(source, f'object "{body.name}": target', reason)
            found.add(part.conductor)
    return frozenset(found)


def _refuse_contacts(parts: Sequence[Part], sensors: Collection[str], source: str) -> None:
    """Raise InputError when bodies of different conductors meet or are too close to mesh. Dielectric bodies may overlap."""
    for first, second in combinations(parts, 2):
        if first.dielectric and second.dielectric and overlap(first.surface, second.surface):
            continue
        if first.conductor != second.conductor:
            may_be_one = first.conductor not in sensors and not second.dielectric
            remedy = '; objects with the same key "conductor" may touch' if may_be_one else ""
            refuse_contact(first.surface, second.surface, second.dielectric, source, remedy)


def _room(scene: Scene) -> Cuboid | None:
    """The walls of the scene's room, if it has one."""
    if scene.room is None:
        return None
    pose = scene.room.pose.transform()
    x, y, z = scene.room.size
    return Cuboid("room", pose.translation, pose.rotation.T, (x / 2, y / 2, z / 2))


def _refuse_unknown(columns: Sequence[str], rows: Sequence[str], source: str) -> None:
    """Raise InputError when one of the columns asked for is not that of a conductor."""
    unknown = [name for name in columns if name not in rows]
    if unknown:
        known = ", ".join(f'"{name}"' for name in rows)
        raise InputError(
            source, "columns", f'"{unknown[0]}" is not a conductor with a column: these are {known}'
        )


def scaled(problem: Conductors) -> Conductors:
    """The same with the centre of the bodies' bounding sphere as the origin, and its radius as the unit of length."""
    centre, unit = bounding_sphere(problem.bodies)
    return replace(
        problem,
        bodies=tuple(_moved(body, centre, unit) for body in problem.bodies),
        centre=problem.centre + problem.unit * centre,
        unit=problem.unit * unit,
        room=None if problem.room is None else _moved(problem.room, centre, unit),
        to_ground=tuple(capacitance / unit for capacitance in problem.to_ground),
    )


def _moved(body: AnyBody, centre: Array, unit: float) -> AnyBody:
    """The body with `centre` as the origin and with lengths divided by `unit`."""
    changed = {name: (getattr(body, name) - centre) / unit for name in POINTS & vars(body).keys()}
    for name in LENGTHS & vars(body).keys():
        own = getattr(body, name)
        changed[name] = tuple(length / unit for length in own) if isinstance(own, tuple) else own / unit
    return replace(body, **changed)

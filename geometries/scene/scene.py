"""A scene in memory: a medium, links, sensors and objects, and where all of it stands in the world. SI units."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from geometries.common.arrays import Array
from geometries.scene.poses import Joint, Pose, Transform, Vector3
from geometries.scene.shapes import Shape


# Defaults of the sensor's electronics: thesis, section 5.3.5.
DEFAULT_INPUT_VOLTAGE = 2.5
DEFAULT_COUPLING_CAPACITANCE = 5e-12


@dataclass(frozen=True)
class Medium:
    """What fills the space around the conductors."""

    relative_permittivity: float = 1.0


@dataclass(frozen=True)
class Room:
    """A grounded box around everything, centred at the origin of its frame; metres, its pose relative to the world."""

    size: Vector3
    pose: Pose = Pose()


@dataclass(frozen=True)
class Link:
    """A rigid frame; its pose is relative to its parent, or to the world without one."""

    name: str
    parent: str | None = None
    pose: Pose = Pose()
    joint: Joint | None = None
    """What moves the link; `pose` is that at the joint's position."""


@dataclass(frozen=True)
class Plate:
    """The rectangle corner + a·edge_u + b·edge_v, a and b in [0, 1]; metres, in the frame of the sensor's link."""

    corner: Vector3
    edge_u: Vector3
    edge_v: Vector3


@dataclass(frozen=True)
class Sensor:
    """A capacitive sensor: one conductor made of rectangles. Volts and farads."""

    name: str
    plates: tuple[Plate, ...]
    link: str | None = None
    input_voltage: float = DEFAULT_INPUT_VOLTAGE
    coupling_capacitance: float = DEFAULT_COUPLING_CAPACITANCE


@dataclass(frozen=True)
class DistanceSensor:
    """A distance sensor that looks into a cone; metres, degrees."""

    name: str
    apex: Vector3
    direction: Vector3
    full_angle_degrees: float
    range: float
    link: str | None = None


@dataclass(frozen=True)
class Object:
    """A body: a conductor that is grounded, floating or an electrode, or a dielectric when `relative_permittivity` is given.

    Bodies with the same `conductor` are one conductor of that name; without it a body is a conductor of its own. An electrode may be
    driven and sensed, as a sensor may. A dielectric body with a `conductor` is the cover of the sensor of that name. A floating body is connected to the ground through the capacitance `to_ground` (F; 0: not at
    all). A `target` comes and goes, the other bodies belong to the machine; if none is marked, all are targets but electrodes.
    With `collides_with_parent` it is checked for collisions with the bodies of the link above its own.
    """

    name: str
    shape: Shape
    link: str | None = None
    pose: Pose = Pose()
    potential: str = "grounded"
    relative_permittivity: float | None = None
    collides: bool = True
    conductor: str | None = None
    to_ground: float = 0.0
    target: bool = False
    collides_with_parent: bool = False


@dataclass(frozen=True)
class Reading:
    """A measurement of the electronics: the charge on `sense` while `drive` is at 1 V and all else is grounded, but for floating bodies.

    Both hold names of sensors and of electrodes' conductors. `noise` is one standard deviation and `threshold` the change that is
    noticed, both in farads; without a threshold it is five times the noise.
    """

    name: str
    sense: str
    drive: tuple[str, ...]
    noise: float | None = None
    threshold: float | None = None


@dataclass(frozen=True)
class Scene:
    """A whole set-up. `reader.load` checks scenes from files; a scene made in Python is not checked."""

    medium: Medium = Medium()
    links: tuple[Link, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    distance_sensors: tuple[DistanceSensor, ...] = ()
    objects: tuple[Object, ...] = ()
    room: Room | None = None
    readings: tuple[Reading, ...] = ()
    changes: tuple[str, ...] = field(default=(), compare=False)
    """What the reader mended, in sentences."""

    def transform_of_link(self, name: str | None) -> Transform:
        """Returns the transform from a link's frame to the world; the identity for None, the world itself."""
        links = {link.name: link for link in self.links}
        transform = Transform.identity()
        while name is not None:
            link = links[name]
            transform = link.pose.transform().after(transform)
            name = link.parent
        return transform

    def pose_of_object(self, name: str) -> tuple[Array, Array]:
        """Returns R (3, 3) and t (3,) that map the frame of an object's shape to the world: p ↦ R·p + t. KeyError when unknown."""
        body = {body.name: body for body in self.objects}[name]
        transform = self.transform_of_link(body.link).after(body.pose.transform())
        return transform.rotation, transform.translation

    def sensor_rectangles(self, name: str) -> list[tuple[Array, Array, Array]]:
        """Returns (corner, edge_u, edge_v), each (3,), of a sensor's plates in the world frame. KeyError when unknown."""
        sensor = {sensor.name: sensor for sensor in self.sensors}[name]
        transform = self.transform_of_link(sensor.link)
        return [
            (
                transform.points(np.asarray(plate.corner)),
                transform.directions(np.asarray(plate.edge_u)),
                transform.directions(np.asarray(plate.edge_v)),
            )
            for plate in sensor.plates
        ]

    def conductors(self) -> dict[str, Array]:
        """Names → triangles (n, 3, 3) in the world frame: the sensors', then those of the objects that conduct.

        A sensor's rectangle is (c, c+u, c+u+v), (c, c+u+v, c+v). Dielectric bodies are left out.
        """
        conductors = {sensor.name: self._sensor_triangles(sensor.name) for sensor in self.sensors}
        for body in self.objects:
            if body.relative_permittivity is None:
                conductors[body.name] = Transform(*self.pose_of_object(body.name)).points(
                    body.shape.triangles()
                )
        return conductors

    def _sensor_triangles(self, name: str) -> Array:
        triangles = [
            [(c, c + u, c + u + v), (c, c + u + v, c + v)] for c, u, v in self.sensor_rectangles(name)
        ]
        return np.array(triangles).reshape(-1, 3, 3)

"""Describes a set-up of one sensor plate and one target plate by four numbers, the same for every family."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

from geometries.common.arrays import Array
from geometries.scene.readings import targets
from geometries.scene.scene import Scene
from geometries.scene.shapes import PlateShape


@dataclass(frozen=True, eq=False)
class Rectangle:
    """corner + a·edge_u + b·edge_v with a and b in [0, 1]; (3,) each, metres."""

    corner: Array
    edge_u: Array
    edge_v: Array

    @property
    def size(self) -> float:
        """The square root of the area (m)."""
        return math.sqrt(float(np.linalg.norm(np.cross(self.edge_u, self.edge_v))))

    @property
    def centre(self) -> Array:
        return np.asarray(self.corner + (self.edge_u + self.edge_v) / 2)

    @property
    def normal(self) -> Array:
        normal = np.cross(self.edge_u, self.edge_v)
        return np.asarray(normal / np.linalg.norm(normal))

    @property
    def vertices(self) -> Array:
        """The four corners (4, 3) in order around the rectangle."""
        u, v = self.edge_u, self.edge_v
        return np.asarray(self.corner + np.array([0 * u, u, u + v, v]))


@dataclass(frozen=True)
class SetUp:
    """Lengths in metres. `gap` is the shortest distance between the plates, `lateral_offset` the distance of their
    centres along the sensor's plane, `tilt_degrees` (0 … 90) the angle between their planes; a plate's size is the square
    root of its area."""

    gap: float
    tilt_degrees: float
    lateral_offset: float
    sensor_size: float
    target_size: float

    @property
    def gap_over_size(self) -> float:
        return self.gap / self.sensor_size

    @property
    def lateral_offset_over_size(self) -> float:
        return self.lateral_offset / self.sensor_size

    @property
    def size_ratio(self) -> float:
        """The target's size relative to the sensor's."""
        return self.target_size / self.sensor_size

    @property
    def words(self) -> str:
        """The four numbers in words."""
        return (
            f"Gap over sensor size {self.gap_over_size:.3g}, tilt {self.tilt_degrees:.3g}°, lateral offset over sensor size "
            f"{self.lateral_offset_over_size:.3g}, target over sensor size {self.size_ratio:.3g}"
        )


def rectangles(scene: Scene) -> tuple[Rectangle, Rectangle] | None:
    """Returns the sensor's and the target's rectangle in the world; None unless the scene is one of each."""
    if len(scene.sensors) != 1 or len(scene.objects) != 1 or len(scene.sensors[0].plates) != 1:
        return None
    target = scene.objects[0]
    if not isinstance(target.shape, PlateShape):
        return None
    rotation, translation = scene.pose_of_object(target.name)
    u, v = (rotation[:, axis] * side for axis, side in enumerate(target.shape.size))
    sensor = Rectangle(*scene.sensor_rectangles(scene.sensors[0].name)[0])
    return sensor, Rectangle(translation - (u + v) / 2, u, v)


def describe(scene: Scene) -> SetUp | None:
    """Returns the set-up's numbers; None unless the scene is one sensor plate and one target plate."""
    plates = rectangles(scene)
    if plates is None:
        return None
    sensor, target = plates
    cosine = min(1.0, abs(float(sensor.normal @ target.normal)))
    between = target.centre - sensor.centre
    lateral = between - (between @ sensor.normal) * sensor.normal
    tilt, offset = math.degrees(math.acos(cosine)), float(np.linalg.norm(lateral))
    return SetUp(distance(sensor, target), tilt, offset, sensor.size, target.size)


def distance(first: Rectangle, second: Rectangle) -> float:
    """Returns the shortest distance (m) between two rectangles: a least-squares problem with bounds on four edge parameters."""
    scale = first.size + second.size
    edges = np.column_stack([first.edge_u, first.edge_v, -second.edge_u, -second.edge_v]) / scale
    between = (second.corner - first.corner) / scale
    nearest = lsq_linear(edges, between, bounds=(0, 1), method="bvls", tol=1e-14)
    return float(np.linalg.norm(edges @ nearest.x - between) * scale)


def is_delta_self(scene: Scene) -> bool:
    """Tells whether the change of each sensor's reading is its delta_self: nothing stays but sensors, each driven by itself."""
    return not scene.readings and all(targets(scene))

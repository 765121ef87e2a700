"""Writes scenes as canonical TOML and computes their identity."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import tomli_w

from geometries.scene.covers import cover_of, is_cover
from geometries.scene.poses import AxisRotation, Joint, Pose
from geometries.scene.scene import DistanceSensor, Link, Medium, Object, Reading, Room, Scene, Sensor
from geometries.scene.person import Person
from geometries.scene.shapes import (
    Arc,
    Capsule,
    Cone,
    Cuboid,
    Cylinder,
    Disc,
    Ellipsoid,
    MeshShape,
    PlateShape,
    Polygon,
    RoundedCuboid,
    Shape,
)

MeshSource = Callable[[MeshShape], dict[str, str]]


def canonical(scene: Scene) -> str:
    """Returns the scene as a TOML text: fixed order of keys, defaults written out, floats by their shortest exact decimals.

    Loading the text gives an equal scene. A mesh is named by its absolute path, so that the text may be put anywhere.
    """
    return _text(scene, lambda mesh: {"file": mesh.file})


def identity(scene: Scene) -> str:
    """Computes sha256 (hexadecimal) of the canonical text in which the mesh files' bytes stand for their paths."""
    return hashlib.sha256(_text(scene, lambda mesh: {"sha256": mesh.digest}).encode()).hexdigest()


def canonical_and_identity(scene: Scene) -> tuple[str, str]:
    """Returns canonical text and identity; without a mesh, one text serves for both."""
    text = canonical(scene)
    if any(isinstance(body.shape, MeshShape) for body in scene.objects):
        return text, identity(scene)
    return text, hashlib.sha256(text.encode()).hexdigest()


def _text(scene: Scene, mesh_source: MeshSource) -> str:
    covers = tuple(cover_of(scene, sensor) for sensor in scene.sensors)
    around = (scene.medium, scene.room, scene.links, scene.sensors, covers, scene.distance_sensors)
    objects = [_object(body, mesh_source) for body in scene.objects if not is_cover(body)]
    readings = [_reading(reading) for reading in scene.readings]
    parts = [_text_around(*around, repr(around)), _dumps("object", objects), _dumps("reading", readings)]
    return "\n".join(filter(None, parts))


# In a sweep only the objects differ. `exactly` distinguishes 1 and 1.0, which are equal but have different texts.
@functools.lru_cache(maxsize=64)
def _text_around(
    medium: Medium,
    room: Room | None,
    links: tuple[Link, ...],
    sensors: tuple[Sensor, ...],
    covers: tuple[tuple[float, float] | None, ...],
    distance_sensors: tuple[DistanceSensor, ...],
    exactly: str,
) -> str:
    parts = [
        _dumps("medium", {"relative_permittivity": medium.relative_permittivity}),
        _dumps("room", {"size": room.size, **_pose(room.pose)} if room else None),
        _dumps("link", [_link(link) for link in links]),
        _dumps("sensor", [_sensor(*pair) for pair in zip(sensors, covers)]),
        _dumps("distance_sensor", [_distance_sensor(sensor) for sensor in distance_sensors]),
    ]
    return "\n".join(filter(None, parts))


def _dumps(key: str, value: Any) -> str:
    text: str = tomli_w.dumps({key: _plain(value)}) if value else ""
    return text


def _plain(value: Any) -> Any:
    """Returns the same value in TOML's types: no tuples, every -0.0 as 0.0, and nothing that is None."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items() if item is not None}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value + 0.0 if isinstance(value, float) else value


def _pose(pose: Pose) -> dict[str, Any]:
    if isinstance(pose.rotation, AxisRotation):
        rotation = {"axis": pose.rotation.axis, "degrees": pose.rotation.degrees}
        return {"translation": pose.translation, "rotation": rotation}
    return {"translation": pose.translation, "quaternion": pose.rotation.quaternion}


def _link(link: Link) -> dict[str, Any]:
    pose = link.joint.rest if link.joint else link.pose
    joint = _joint(link.joint) if link.joint else None
    return {"name": link.name, "parent": link.parent, **_pose(pose), "joint": joint}


def _joint(joint: Joint) -> dict[str, Any]:
    return {
        "name": joint.name,
        "type": joint.kind,
        "axis": joint.axis,
        "position": None if joint.mimic else joint.position,
        "lower": joint.lower,
        "upper": joint.upper,
        "mimic": asdict(joint.mimic) if joint.mimic else None,
    }


def _sensor(sensor: Sensor, cover: tuple[float, float] | None) -> dict[str, Any]:
    plates = [{"corner": p.corner, "edge_u": p.edge_u, "edge_v": p.edge_v} for p in sensor.plates]
    return {
        "name": sensor.name,
        "link": sensor.link,
        "input_voltage": sensor.input_voltage,
        "coupling_capacitance": sensor.coupling_capacitance,
        "cover": {"thickness": cover[0], "relative_permittivity": cover[1]} if cover else None,
        "plates": plates,
    }


def _distance_sensor(sensor: DistanceSensor) -> dict[str, Any]:
    return {
        "name": sensor.name,
        "link": sensor.link,
        "apex": sensor.apex,
        "direction": sensor.direction,
        "full_angle_degrees": sensor.full_angle_degrees,
        "range": sensor.range,
    }


def _object(body: Object, mesh_source: MeshSource) -> dict[str, Any]:
    dielectric = body.relative_permittivity is not None
    return {
        "name": body.name,
        "link": body.link,
        **_pose(body.pose),
        "potential": None if dielectric else body.potential,
        "to_ground": body.to_ground or None,
        "conductor": body.conductor,
        "target": body.target or None,
        "collides": body.collides,
        "collides_with_parent": body.collides_with_parent or None,
        "material": {"relative_permittivity": body.relative_permittivity} if dielectric else None,
        "shape": _shape(body.shape, mesh_source),
    }


def _reading(reading: Reading) -> dict[str, Any]:
    return {
        "name": reading.name,
        "sense": reading.sense,
        "drive": reading.drive,
        "noise": reading.noise,
        "threshold": reading.threshold,
    }


def _shape(shape: Shape, mesh_source: MeshSource) -> dict[str, Any]:
    if isinstance(shape, PlateShape):
        return {"type": "plate", "size": shape.size}
    if isinstance(shape, Cuboid):
        return {"type": "cuboid", "size": shape.size}
    if isinstance(shape, Cylinder):
        return {
            "type": "cylinder",
            "radius": shape.radius,
            "height": shape.height,
            "segments": shape.segments,
        }
    if isinstance(shape, Cone):
        return {"type": "cone", "radius": shape.radius, "height": shape.height, "segments": shape.segments}
    if isinstance(shape, Arc):
        return {
            "type": "arc",
            "inner_radius": shape.inner_radius,
            "outer_radius": shape.outer_radius,
            "height": shape.height,
            "degrees": shape.degrees,
            "segments": shape.segments,
        }
    if isinstance(shape, MeshShape):
        return {"type": "mesh", **mesh_source(shape), "scale": shape.scale}
    if isinstance(shape, Person):
        return {"type": "person", "height": shape.height, "age": shape.age, "posture": shape.posture}
    if isinstance(shape, Polygon):
        return {"type": "polygon", "vertices": shape.vertices}
    if isinstance(shape, RoundedCuboid):
        return {"type": "cuboid", "size": shape.size, "rounding": shape.rounding, "segments": shape.segments}
    if isinstance(shape, Ellipsoid):
        return {"type": "ellipsoid", "semi_axes": shape.semi_axes, "segments": shape.segments}
    if isinstance(shape, Capsule):
        return {
            "type": "capsule",
            "radius": shape.radius,
            "length": shape.length,
            "segments": shape.segments,
        }
    kind = "disc" if isinstance(shape, Disc) else "sphere"
    return {"type": kind, "radius": shape.radius, "segments": shape.segments}

"""Reads scene files. Anything that SCENE.md does not allow is an InputError that names file, key and reason."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np

from geometries.common.errors import InputError
from geometries.common.tables import LARGEST_NUMBER, Table, parse, read_text
from geometries.scene.conductor_checks import check_conductors, check_readings, check_targets
from geometries.scene import polygons
from geometries.scene.covers import read_cover
from geometries.scene.meshes import SCENE_FORMATS, read_surface
from geometries.scene.poses import (
    PRISMATIC,
    AxisRotation,
    Joint,
    Mimic,
    Pose,
    QuaternionRotation,
    Rotation,
    Vector3,
    resolved,
)
from geometries.scene.rectangles import (
    LARGEST_COSINE_OF_ROUNDING,
    LARGEST_COSINE_SQUARED,
    cosine_between_edges,
    squared,
)
from geometries.scene.scene import (
    DEFAULT_COUPLING_CAPACITANCE,
    DEFAULT_INPUT_VOLTAGE,
    DistanceSensor,
    Link,
    Medium,
    Object,
    Plate,
    Reading,
    Room,
    Scene,
    Sensor,
)
from geometries.scene.person import BUILDS, POSTURES, Person
from geometries.scene.shapes import (
    DEFAULT_SEGMENTS,
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
    Sphere,
)

# Largest number of triangles of a shape: a mesh of as many takes half a gigabyte.
_MOST_TRIANGLES = 10_000_000
_POTENTIALS = ("grounded", "floating", "electrode")
_JOINTS = ("revolute", PRISMATIC)


def load(path: Path | str) -> Scene:
    """Returns the scene in a file; InputError when the file cannot be used."""
    return loads(read_text(Path(path)), source=str(path))


def loads(text: str, source: str = "scene") -> Scene:
    """Returns the scene in a text; `source` stands for it in errors, and mesh files are relative to its folder."""
    root = parse(text, source)
    root.known_format()
    root.read_units()
    medium = root.table("medium", required=False)
    room = _room(root.table("room")) if root.has("room") else None
    changes: list[str] = []
    covers: list[Object] = []
    scene = Scene(
        medium=Medium(medium.positive("relative_permittivity", 1.0)),
        links=_placed(tuple(_link(table) for table in root.tables("link")), root),
        sensors=tuple(_sensor(table, changes, covers) for table in root.tables("sensor")),
        distance_sensors=tuple(_distance_sensor(table) for table in root.tables("distance_sensor")),
        objects=tuple(_object(table) for table in root.tables("object")),
        room=room,
        readings=tuple(_reading(table) for table in root.tables("reading")),
    )
    medium.finish()
    root.finish()
    changes += (
        f'object "{body.name}": {remark}'
        for body in scene.objects
        if isinstance(body.shape, MeshShape)
        for remark in body.shape.remarks
    )
    whole = replace(scene, changes=tuple(changes), objects=(*covers, *scene.objects))
    _check_names(whole, source)
    _check_links(scene, source)
    check_conductors(scene, source)
    check_targets(scene, source)
    check_readings(scene, source)
    if not scene.sensors and not scene.objects:
        raise InputError(source, "", "a scene needs at least one sensor or one object")
    return whole


def _room(table: Table) -> Room:
    room = Room(cast(Vector3, _size(table, 3)), _pose(table))
    table.finish()
    return room


def _link(table: Table) -> Link:
    name, pose = table.text("name"), _pose(table)
    joint = _joint(table.table("joint"), pose) if table.has("joint") else None
    link = Link(name, table.text("parent") if table.has("parent") else None, pose, joint)
    table.finish()
    return link


def _joint(table: Table, rest: Pose) -> Joint:
    name, kind = table.text("name"), table.text("type")
    if kind not in _JOINTS:
        raise table.error("type", f"must be one of {', '.join(_JOINTS)}, not {kind!r}")
    units = table.units_per_metre if kind == PRISMATIC else 1.0
    lower = table.number("lower") / units if table.has("lower") else None
    upper = table.number("upper") / units if table.has("upper") else None
    if lower is not None and upper is not None and upper < lower:
        raise table.error("upper", "must not be less than lower")
    mimic = None
    if table.has("mimic"):
        if table.has("position"):
            raise table.error("position", "excludes mimic")
        inner = table.table("mimic")
        mimic = Mimic(
            inner.text("joint"), inner.number("multiplier", 1.0), inner.number("offset", 0.0) / units
        )
        inner.finish()
    joint = Joint(
        name,
        kind,
        _direction(table, "axis"),
        rest,
        table.number("position", 0.0) / units,
        lower,
        upper,
        mimic,
    )
    table.finish()
    return joint


def _with_metric_multiplier(joint: Joint, joints: dict[str, Joint], units_per_metre: float) -> Joint:
    """Returns the joint with the multiplier in SI units: if it follows one of the other kind, it is in units of length per rad or the inverse."""
    if joint.mimic is None or joint.mimic.joint not in joints or joints[joint.mimic.joint].kind == joint.kind:
        return joint
    multiplier = joint.mimic.multiplier
    converted = multiplier / units_per_metre if joint.kind == PRISMATIC else multiplier * units_per_metre
    return replace(joint, mimic=replace(joint.mimic, multiplier=converted))


def _placed(links: tuple[Link, ...], root: Table) -> tuple[Link, ...]:
    """Returns the links in the poses of their joints' positions."""
    joints: dict[str, Joint] = {}
    for link in links:
        if link.joint and link.joint.name in joints:
            raise root.error(f'link "{link.name}": joint.name', f'"{link.joint.name}" is taken')
        if link.joint:
            joints[link.joint.name] = link.joint
    joints = {
        name: _with_metric_multiplier(joint, joints, root.units_per_metre) for name, joint in joints.items()
    }
    try:
        joints = resolved(joints)
    except ValueError as error:
        raise root.error("link", str(error)) from error
    placed = []
    for link in links:
        joint = joints[link.joint.name] if link.joint else None
        placed.append(replace(link, pose=joint.pose_at(joint.position), joint=joint) if joint else link)
    return tuple(placed)


def _sensor(table: Table, changes: list[str], covers: list[Object]) -> Sensor:
    name = table.text("name")
    squares = [
        _plate(plate, f'sensor "{name}": plates[{index}]')
        for index, plate in enumerate(table.tables("plates"))
    ]
    plates = tuple(plate for plate, _ in squares)
    changes += (sentence for _, sentences in squares for sentence in sentences)
    sensor = Sensor(
        name=name,
        plates=plates,
        link=_optional_link(table),
        input_voltage=table.positive("input_voltage", DEFAULT_INPUT_VOLTAGE),
        coupling_capacitance=table.positive("coupling_capacitance", DEFAULT_COUPLING_CAPACITANCE),
    )
    covers += read_cover(table, sensor)
    # First, because a plate may have been written with keys that belong into `plates`.
    table.finish()
    if not plates:
        raise table.error("plates", "a sensor needs at least one plate")
    return sensor


def _plate(table: Table, place: str) -> tuple[Plate, list[str]]:
    """Returns a plate, and a sentence about it if its edges were nearly at right angles and are now."""
    for key in ("corner", "edge_u", "edge_v"):
        if not table.has(key):
            raise table.error(
                key,
                "is missing: a plate is a rectangle with corner, edge_u and edge_v; an electrode of another shape is an object with "
                'potential = "electrode"',
            )
    plate = Plate(table.position("corner"), _edge(table, "edge_u"), _edge(table, "edge_v"))
    cosine = cosine_between_edges(plate)
    if abs(cosine) > LARGEST_COSINE_SQUARED:
        raise table.error(
            "edge_v",
            f"edge_u and edge_v are not at right angles: the angle between them is {math.degrees(math.acos(cosine)):.6g} degrees, "
            f"its cosine {cosine:.2g}, and at most {LARGEST_COSINE_SQUARED:g} is squared",
        )
    table.finish()
    if abs(cosine) <= LARGEST_COSINE_OF_ROUNDING:
        return plate, []
    off = math.degrees(math.asin(abs(cosine)))
    return squared(plate), [
        f"{place}: edge_u and edge_v are {off:.2g} degrees off the right angle and are squared"
    ]


def _edge(table: Table, name: str) -> Vector3:
    edge = table.position(name)
    if not any(edge):
        raise table.error(name, "must have a length greater than 0")
    return edge


def _distance_sensor(table: Table) -> DistanceSensor:
    sensor = DistanceSensor(
        name=table.text("name"),
        apex=table.position("apex"),
        direction=_direction(table, "direction"),
        full_angle_degrees=_angle(table, "full_angle_degrees", 180.0),
        range=table.positive_length("range"),
        link=_optional_link(table),
    )
    table.finish()
    return sensor


def _object(table: Table) -> Object:
    name = table.text("name")
    for key in ("potential", "conductor", "to_ground"):
        if table.has("material") and table.has(key):
            raise table.error("material", f"cannot be combined with {key}")
    potential = table.choice("potential", _POTENTIALS)
    if table.has("to_ground") and potential != "floating":
        raise table.error("to_ground", f"is a key of floating objects, and this one is {potential}")
    relative_permittivity = None
    if table.has("material"):
        material = table.table("material")
        relative_permittivity = material.positive("relative_permittivity")
        material.finish()
    body = Object(
        name=name,
        shape=_shape(table.table("shape")),
        link=_optional_link(table),
        pose=_pose(table),
        potential=potential,
        relative_permittivity=relative_permittivity,
        collides=table.boolean("collides", True),
        conductor=table.text("conductor") if table.has("conductor") else None,
        to_ground=table.positive("to_ground") if table.has("to_ground") else 0.0,
        target=table.boolean("target", False),
        collides_with_parent=table.boolean("collides_with_parent", False),
    )
    table.finish()
    return body


def _reading(table: Table) -> Reading:
    reading = Reading(
        name=table.text("name"),
        sense=table.text("sense"),
        drive=table.texts("drive"),
        noise=table.positive("noise") if table.has("noise") else None,
        threshold=table.positive("threshold") if table.has("threshold") else None,
    )
    table.finish()
    return reading


def _pose(table: Table) -> Pose:
    return Pose(table.position("translation", (0.0, 0.0, 0.0)), rotation(table))


def rotation(table: Table) -> Rotation:
    """Reads the rotation of a link, an object or a frame's pose from `rotation` or `quaternion`; none if both are absent."""
    if table.has("quaternion"):
        if table.has("rotation"):
            raise table.error("quaternion", "cannot be combined with rotation")
        return _quaternion(table)
    if not table.has("rotation"):
        return AxisRotation()
    inner = table.table("rotation")
    # Before a key is missed: other forms of a rotation have other keys.
    inner.allow_only(("axis", "degrees", "quaternion"))
    if inner.has("quaternion"):
        quaternion = _quaternion(inner)
        inner.finish()
        return quaternion
    turned = AxisRotation(_direction(inner, "axis"), inner.number("degrees"))
    inner.finish()
    return turned


def _quaternion(table: Table) -> QuaternionRotation:
    values = table.vector("quaternion", 4)
    if not any(values):
        raise table.error("quaternion", "must not be zero")
    return QuaternionRotation(cast(tuple[float, float, float, float], values))


def _direction(table: Table, name: str) -> Vector3:
    direction = table.vector3(name)
    if not any(direction):
        raise table.error(name, "must have a length greater than 0")
    return direction


def _angle(table: Table, name: str, largest: float) -> float:
    degrees = table.positive(name)
    if degrees > largest:
        raise table.error(name, f"must be at most {largest:g}, not {degrees!r}")
    return degrees


def _optional_link(table: Table) -> str | None:
    return table.text("link") if table.has("link") else None


def _shape(table: Table) -> Shape:
    kind = table.text("type")
    if kind not in _SHAPES:
        raise table.error("type", f"must be one of {', '.join(_SHAPES)}, not {kind!r}")
    shape = _SHAPES[kind](table)
    table.finish()
    return shape


def _size(table: Table, length: int, key: str = "size") -> tuple[float, ...]:
    size = table.lengths(key, length)
    for index, value in enumerate(size):
        if value <= 0:
            raise table.error(f"{key}[{index}]", f"must be greater than 0, not {value!r}")
    return size


def _segments(table: Table, most: int) -> int:
    return table.integer("segments", DEFAULT_SEGMENTS, at_least=3, at_most=most)


def _segments_of_grid(table: Table) -> int:
    """Reads the segments of a shape whose triangles are about as many as their square."""
    return _segments(table, math.isqrt(_MOST_TRIANGLES))


def _plate_shape(table: Table) -> PlateShape:
    return PlateShape(cast(tuple[float, float], _size(table, 2)))


def _cuboid(table: Table) -> Cuboid | RoundedCuboid:
    size = cast(Vector3, _size(table, 3))
    return _rounded(table, size) if table.has("rounding") else Cuboid(size)


def _rounded(table: Table, size: Vector3) -> Cuboid | RoundedCuboid:
    rounding, segments = table.length("rounding"), _segments_of_grid(table)
    if not 0 <= rounding <= min(size) / 2:
        raise table.error(
            "rounding", f"must be from 0 to half the smallest size, {min(size) / 2:g}, not {rounding!r}"
        )
    return RoundedCuboid(size, rounding, segments) if rounding > 0 else Cuboid(size)


def _cube(table: Table) -> Cuboid:
    side = table.positive_length("size")
    return Cuboid((side, side, side))


def _cylinder(table: Table) -> Cylinder:
    return Cylinder(
        table.positive_length("radius"),
        table.positive_length("height"),
        _segments(table, _MOST_TRIANGLES // 4),
    )


def _cone(table: Table) -> Cone:
    return Cone(
        table.positive_length("radius"),
        table.positive_length("height"),
        _segments(table, _MOST_TRIANGLES // 2),
    )


def _arc(table: Table) -> Arc:
    inner, outer = table.positive_length("inner_radius"), table.positive_length("outer_radius")
    if outer <= inner:
        raise table.error("outer_radius", "must be greater than inner_radius")
    segments = _segments(table, _MOST_TRIANGLES // 8)
    return Arc(inner, outer, table.positive_length("height"), _angle(table, "degrees", 360.0), segments)


def _sphere(table: Table) -> Sphere:
    return Sphere(table.positive_length("radius"), _segments_of_grid(table))


def _ellipsoid(table: Table) -> Ellipsoid:
    return Ellipsoid(cast(Vector3, _size(table, 3, "semi_axes")), _segments_of_grid(table))


def _capsule(table: Table) -> Capsule:
    return Capsule(table.positive_length("radius"), table.positive_length("length"), _segments_of_grid(table))


def _disc(table: Table) -> Disc:
    return Disc(table.positive_length("radius"), _segments(table, _MOST_TRIANGLES))


def _polygon(table: Table) -> Polygon:
    given = table.value("vertices")
    if not isinstance(given, list):
        raise table.error("vertices", f"must be a list of [x, y], not {given!r}")
    vertices = tuple(
        cast(polygons.Point, table.as_lengths(f"vertices[{k}]", vertex, 2)) for k, vertex in enumerate(given)
    )
    defect = polygons.defect(vertices)
    if defect:
        raise table.error("vertices", defect)
    return Polygon(vertices)


def _mesh(table: Table) -> MeshShape:
    file = Path(table.source).parent.absolute() / table.text("file")
    if file.suffix.lower() not in SCENE_FORMATS:
        raise table.error(
            "file", f"must end in one of {', '.join(SCENE_FORMATS)}; `geometries convert` makes one"
        )
    try:
        surface = read_surface(file)
    except InputError as error:
        raise table.error("file", f"{error.file}: {error.reason}") from error
    scale = table.positive("scale", 1.0 / table.units_per_metre)
    if np.abs(surface.triangles).max() * scale > LARGEST_NUMBER:
        raise table.error("file", f"{file}: the mesh is larger than {LARGEST_NUMBER:g}")
    digest = hashlib.sha256(file.read_bytes()).hexdigest()
    return MeshShape(str(file), digest, scale, surface.triangles, surface.remarks(scale))


def _person(table: Table) -> Person:
    height = table.positive_length("height")
    return Person(height, table.choice("age", tuple(BUILDS)), table.choice("posture", POSTURES))


_SHAPES: dict[str, Callable[[Table], Shape]] = {
    "plate": _plate_shape,
    "plane": _plate_shape,
    "cuboid": _cuboid,
    "box": _cuboid,
    "cube": _cube,
    "cylinder": _cylinder,
    "cone": _cone,
    "arc": _arc,
    "sphere": _sphere,
    "ellipsoid": _ellipsoid,
    "capsule": _capsule,
    "disc": _disc,
    "polygon": _polygon,
    "mesh": _mesh,
    "person": _person,
}


def _check_names(scene: Scene, source: str) -> None:
    groups: list[list[tuple[str, str]]] = [
        [("link", link.name) for link in scene.links],
        [("sensor", sensor.name) for sensor in scene.sensors]
        + [("distance_sensor", sensor.name) for sensor in scene.distance_sensors]
        + [("object", body.name) for body in scene.objects],
        [("reading", reading.name) for reading in scene.readings],
    ]
    for group in groups:
        seen: set[str] = set()
        for kind, name in group:
            if name in seen:
                raise InputError(source, f'{kind} "{name}": name', "is already used")
            seen.add(name)


def _check_links(scene: Scene, source: str) -> None:
    parents = {link.name: link.parent for link in scene.links}
    references = [(f'link "{link.name}": parent', link.parent) for link in scene.links]
    references += [(f'sensor "{sensor.name}": link', sensor.link) for sensor in scene.sensors]
    references += [
        (f'distance_sensor "{sensor.name}": link', sensor.link) for sensor in scene.distance_sensors
    ]
    references += [(f'object "{body.name}": link', body.link) for body in scene.objects]
    for key, name in references:
        if name is not None and name not in parents:
            known = f"there are {', '.join(sorted(parents))}" if parents else "the scene has none"
            raise InputError(source, key, f"there is no link {name!r}; {known}")
    rooted: set[str] = set()
    for start in parents:
        # A dictionary keeps the order and finds a name quickly.
        chain: dict[str, None] = {start: None}
        name = parents[start]
        while name is not None and name not in rooted:
            if name in chain:
                raise InputError(
                    source, f'link "{start}": parent', "the links make a cycle: " + " → ".join([*chain, name])
                )
            chain[name] = None
            name = parents[name]
        rooted |= chain.keys()

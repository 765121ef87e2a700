"""The values of a scene: nearly every key there is, each in turn missing, of the wrong type, not finite, out of its range, unknown; and
numbers that are allowed and far from any that a sensor needs."""

import math
import pathlib
import sys
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import tomli_w

from tests.bad_input.case import SENSOR, Case, body, from_text
from tests.geometries.schemas import WHOLE, changed

Path = tuple[str | int, ...]

OPTIONAL = {
    "medium", "relative_permittivity of medium", "room", "translation", "rotation", "quaternion", "parent", "link",
    "joint", "position", "lower", "upper", "mimic", "multiplier", "offset",
    "input_voltage", "coupling_capacitance", "distance_sensor", "potential", "conductor", "collides", "collides_with_parent", "material", "segments", "rounding", "units",
    "to_ground", "target", "reading", "noise", "threshold", "age", "posture", "cover",
}  # fmt: skip
# Those that have to be greater than 0; each number of a vector has.
POSITIVE = {
    "relative_permittivity", "size", "input_voltage", "coupling_capacitance", "full_angle_degrees", "range", "radius",
    "height", "length", "semi_axes", "inner_radius", "outer_radius", "segments", "to_ground", "noise", "threshold",
    "thickness",
}  # fmt: skip
NONZERO = {"axis", "quaternion", "edge_u", "edge_v", "direction"}


def cases() -> list[Case]:
    """A command for every eighth: all read with the same reader. The model refuses the dielectric body."""
    made = [
        from_text("every key", tomli_w.dumps(WHOLE), None),
        *_missing(),
        *_unknown(),
        *_wrong(),
        *_by_hand(),
        *related(),
    ]
    asked = {0: ("collide",), 4: ("sense",)}
    return [replace(case, commands=asked.get(at % 8, ())) for at, case in enumerate(made)]


def _places(value: Any, path: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Every key with its value, from the outside in."""
    for key, item in value.items():
        yield (*path, key), item
        inner = item if isinstance(item, list) and item and isinstance(item[0], dict) else []
        for index, table in enumerate(inner):
            yield from _places(table, (*path, key, index))
        if isinstance(item, dict):
            yield from _places(item, (*path, key))


def _changed(name: str, path: Path, value: Any, place: str | None) -> Case:
    """The scene with another value at a path; None takes the key away. It is written when it is asked for: there are many."""

    def make(folder: pathlib.Path) -> pathlib.Path:
        return from_text(name, tomli_w.dumps(changed(WHOLE, path, value)), place).make(folder)

    return Case(name, make, place)


def _told(path: Path) -> str:
    return ".".join(map(str, path))


def _missing() -> list[Case]:
    """Taking links, sensors or objects away leaves names that nothing bears."""
    needed: dict[Path, str | None] = {
        ("link",): "link",
        ("link", 0, "name"): "name",
        ("sensor",): "sense",
        ("object",): "drive",
        # Of the floating ball with its capacitance to ground, and of the electrode that is driven.
        ("object", 0, "potential"): "to_ground",
        ("object", 7, "potential"): "drive",
        ("object", 7, "conductor"): "drive",
    }
    needed[("object", 1, "rotation", "quaternion")] = "axis"
    # The joint that another one follows, and what names it there.
    needed[("link", 1, "joint")] = needed[("link", 2, "joint", "mimic", "joint")] = "joint"
    made = []
    for path, _ in _places(WHOLE):
        key = str(path[-1])
        optional = key in OPTIONAL or f"{key} of {path[0]}" in OPTIONAL
        place = needed.get(path, None if optional else key)
        made.append(_changed(f"without {_told(path)}", path, None, place))
    return made


def _unknown() -> list[Case]:
    tables: list[Path] = [()]
    for path, value in _places(WHOLE):
        if isinstance(value, dict):
            tables.append(path)
        if isinstance(value, list) and isinstance(value[0], dict):
            tables += [(*path, index) for index in range(len(value))]
    return [_changed(f"unknown key in {_told(path)}", (*path, "colour"), 1, "colour") for path in tables]


def _wrong() -> Iterator[Case]:
    for at, (path, value) in enumerate(_places(WHOLE)):
        types = _wrong_types(str(path[-1]), value)
        for name, wrong in [*types.items(), *_wrong_values(str(path[-1]), value)]:
            # The parser of C++ knows no such integer, and so no key either.
            place = "" if "64" in name else str(path[-1])
            made = _changed(f"{_told(path)}: {name}", path, wrong, place)
            # A reader that checks the type of a key refuses all others. Two of them, which differ from key to key, show that by day.
            by_day = [list(types)[(at + shift) % len(types)] for shift in (0, 1)]
            yield replace(made, by_night=name in types and name not in by_day)


def _wrong_types(key: str, value: Any) -> dict[str, Any]:
    other_types = {
        "text": "1",
        "number": 1.5,
        "boolean": True,
        "list": [1, "2"],
        "table": {"x": 1},
        "no list": [],
    }
    own = {str: "text", float: "number", bool: "boolean"}.get(type(value))
    if key in ("link", "sensor", "distance_sensor", "object", "reading") and isinstance(value, list):
        del other_types["no list"]
    return {name: wrong for name, wrong in other_types.items() if name != own}


def _wrong_values(key: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, str) and key not in ("name", "conductor"):
        yield "a name that nothing bears", "nobody"
    if isinstance(value, str):
        yield "no letters", ""
    if isinstance(value, float):
        yield from ((repr(wrong), wrong) for wrong in (math.nan, math.inf, -math.inf))
        yield "beyond 64 bits", 2**64
    if key in POSITIVE and not isinstance(value, list):
        yield from ((repr(wrong), wrong) for wrong in (0, -1))
    if key == "drive":
        yield "with a name that nothing bears", [*value, "nobody"]
        yield "with a name twice", [*value, value[0]]
    elif isinstance(value, list) and not isinstance(value[0], dict):
        yield "one number too few", value[:-1]
        yield "one number too many", [*value, 1]
        yield "with a number beyond 64 bits", [*value[:-1], 2**64]
        for wrong in (math.nan, math.inf, True, "1", [1]) + ((0, -1) if key in POSITIVE else ()):
            yield f"with {wrong!r}", [*value[:-1], wrong]
        if key in NONZERO:
            yield "zero", [0] * len(value)


def _by_hand() -> list[Case]:
    """What is wrong of two keys together, or of one in a way of its own."""
    two: dict[str, tuple[Path, Any, str | None]] = {
        "a joint's position and what it mimics": (("link", 2, "joint", "position"), 1.0, "position"),
        "a joint beyond its limits": (("link", 1, "joint", "position"), 3.0, None),
        "rotation and quaternion": (("link", 0, "quaternion"), [1, 0, 0, 0], "quaternion"),
        "axis and quaternion": (("link", 0, "rotation", "quaternion"), [1, 0, 0, 0], "axis"),
        "material and potential": (("object", 1, "potential"), "grounded", "material"),
        "material and conductor": (("object", 1, "conductor"), "mast", "material"),
        "an empty name of a conductor": (("object", 2, "conductor"), "", "conductor"),
        "a conductor with the name of one of its objects": (("object", 2, "conductor"), "post", None),
        "a part of a grounded conductor as a target": (("object", 2, "target"), True, None),
        "a dielectric target": (("object", 1, "target"), True, None),
        "an electrode as a target": (("object", 7, "target"), True, "target"),
        "a capacitance to ground of a grounded object": (("object", 4, "to_ground"), 1e-10, "to_ground"),
        "a capacitance to ground of an electrode": (("object", 7, "to_ground"), 1e-10, "to_ground"),
        "material and a capacitance to ground": (("object", 1, "to_ground"), 1e-10, "material"),
        "an electrode": (("object", 4, "potential"), "electrode", None),
        "no plates": (("sensor", 0, "plates"), [], "plates"),
        "a cone of 181 degrees": (("distance_sensor", 0, "full_angle_degrees"), 181, "full_angle_degrees"),
        "a ring of 361 degrees": (("object", 1, "shape", "degrees"), 361, "degrees"),
        "two segments": (("object", 0, "shape", "segments"), 2, "segments"),
        "segments of a plate": (("object", 4, "shape", "segments"), 8, "segments"),
    }
    return _spoiled(two)


def related() -> list[Case]:
    """What is wrong of two tables or of two numbers together, which no schema can say. More of it, of conductors and readings, is refused in
    tests/end_to_end/test_scene_readers_agree.py, where both readers have the same words."""
    two: dict[str, tuple[Path, Any, str | None]] = {
        "a link that is its own parent": (("link", 0, "parent"), "base", "parent"),
        "two links that are each other's parent": (("link", 0, "parent"), "arm", "parent"),
        "two links of one name": (("link", 1, "name"), "base", "name"),
        "two joints of one name": (("link", 2, "joint", "name"), "elbow", "name"),
        "a joint that mimics itself": (("link", 2, "joint", "mimic", "joint"), "knuckle", "joint"),
        "a joint's limits the wrong way round": (("link", 1, "joint", "upper"), -3.0, "upper"),
        "a sensor and an object of one name": (("object", 0, "name"), "front", "name"),
        "a distance sensor and an object of one name": (("object", 0, "name"), "eye", "name"),
        "a conductor with the name of a distance sensor": (("object", 2, "conductor"), "eye", "conductor"),
        "a reading of a distance sensor": (("reading", 0, "sense"), "eye", "sense"),
        "two readings of one name": (("reading",), 2 * WHOLE["reading"], "name"),
        "a plate that is no rectangle": (("sensor", 0, "plates", 0, "edge_v"), [0.01, 0.1, 0], "edge_v"),
        "a ring of equal radii": (("object", 1, "shape", "outer_radius"), 0.1, "outer_radius"),
    }
    return _spoiled(two)


def _spoiled(values: dict[str, tuple[Path, Any, str | None]]) -> list[Case]:
    return [_changed(name, *spoiled) for name, spoiled in values.items()]


DENORMAL, SMALLEST, LARGEST = "5e-324", repr(sys.float_info.min), repr(sys.float_info.max)


def numbers() -> list[Case]:
    """Numbers that are allowed and far from any that a sensor needs: denormal, tiny, huge, the largest of all."""
    return [*_sizes(), *_beyond(), *_distances(), *_directions(), *_sensors(), *_distance_sensors()]


def _sizes() -> list[Case]:
    made = []
    for size in (DENORMAL, SMALLEST, "1e-160", "1e-30", "1e30"):
        for shape in (
            f'cube", size = {size}',
            f'plate", size = [{size}, {size}]',
            f'sphere", radius = {size}',
            f'cylinder", radius = {size}, height = 1',
            f'cone", radius = 1, height = {size}',
            f'capsule", radius = {size}, length = 1',
            f'ellipsoid", semi_axes = [1, {size}, {size}]',
            f'disc", radius = {size}',
            f'person", height = {size}',
            f'polygon", vertices = [[0, 0], [{size}, 0], [0, {size}]]',
        ):
            kind = shape.split('"')[0]
            made.append(from_text(f"{kind} of {size}", SENSOR + body(f'type = "{shape}'), None))
    return made


def _beyond() -> list[Case]:
    """Numbers whose squares are none."""
    return (
        [
            from_text(f"a body of {size}", SENSOR + body(f'type = "cube", size = {size}'), "size")
            for size in ("1.1e30", "1e160", "1e300", LARGEST)
        ]
        + [
            # The parsers themselves know no such number, and so no key either.
            from_text(f"a body of {size}", SENSOR + body(f'type = "cube", size = {size}'), "")
            for size in ("1e309", "1e-400")
        ]
        + [
            from_text(f"a body at {far}", SENSOR + body(more=f"translation = [0, 0, {far}]"), "translation")
            for far in ("-1.1e30", "1e160", LARGEST)
        ]
    )


def _distances() -> list[Case]:
    return [
        from_text(f"a body at {far}", SENSOR + body(more=f"translation = [0, 0, {far}]"), None)
        for far in (DENORMAL, "1e-200", "1e30")
    ] + [
        from_text(
            f"turned by {angle} degrees",
            SENSOR
            + body(more=f"translation = [0, 0, 1]\nrotation = {{ axis = [1, 2, 3], degrees = {angle} }}"),
            None,
        )
        for angle in (DENORMAL, "1e22", "1e30")
    ]


def _directions() -> list[Case]:
    made = []
    for size in (DENORMAL, "1e-320", "1e-200", "1e30"):
        turned = f"translation = [0, 0, 1]\nrotation = {{ axis = [{size}, {size}, 0], degrees = 30 }}"
        made.append(from_text(f"an axis of {size}", SENSOR + body(more=turned), None))
        turned = f"translation = [0, 0, 1]\nquaternion = [{size}, 0, {size}, 0]"
        made.append(from_text(f"a quaternion of {size}", SENSOR + body(more=turned), None))
    return made


def _sensors() -> list[Case]:
    made = []
    for size in (DENORMAL, "1e-320", "1e-200", "1e-30", "1e30"):
        plate = SENSOR.replace("[0.1, 0, 0]", f"[{size}, 0, 0]").replace("[0, 0.1, 0]", f"[0, {size}, 0]")
        made.append(from_text(f"a plate of {size}", plate + body(), None))
    skew = SENSOR.replace("[0.1, 0, 0]", "[1e-200, 0, 0]").replace("[0, 0.1, 0]", "[1e-202, 1e-200, 0]")
    made.append(from_text("a tiny plate that is no rectangle", skew + body(), "edge_v"))
    skew = SENSOR.replace("[0.1, 0, 0]", "[1e29, 0, 0]").replace("[0, 0.1, 0]", "[1e27, 1e29, 0]")
    made.append(from_text("a huge plate that is no rectangle", skew + body(), "edge_v"))
    long = SENSOR.replace("[0.1, 0, 0]", f"[{LARGEST}, {LARGEST}, 0]").replace("[0, 0.1, 0]", "[0, 0, 1]")
    made.append(from_text("an edge longer than any number", long + body(), "edge_"))
    for key in ("input_voltage", "coupling_capacitance"):
        made += [
            from_text(f"{key} of {size}", SENSOR + f"{key} = {size}\n" + body(), None)
            for size in (DENORMAL, "1e30")
        ]
    return made


def _distance_sensors() -> list[Case]:
    made = []
    for size in (DENORMAL, "1e-200", "1e30"):
        eye = f'[[distance_sensor]]\nname = "eye"\napex = [0, 0, 0]\ndirection = [0, 0, {size}]\n'
        made.append(
            from_text(
                f"a direction of {size}", SENSOR + eye + "full_angle_degrees = 30\nrange = 1\n" + body(), None
            )
        )
        for key, other in (("range", "full_angle_degrees = 30"), ("full_angle_degrees", "range = 1")):
            if key == "range" or size == "1e-200":
                told = SENSOR + eye.replace(size, "1") + f"{other}\n{key} = {size}\n" + body()
                made.append(from_text(f"{key} of {size}", told, None))
    return made

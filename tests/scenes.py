"""Scenes that tests of several folders share, and the text of scenes and sweeps from their tables."""

import json
from typing import Any

_OF_SHAPES = set(
    "size radius height length segments rounding semi_axes inner_radius outer_radius degrees vertices file scale age posture".split()
)


def body(name: str, kind: str, **keys: Any) -> str:
    """The text of an object; which keys are those of its shape their names tell."""
    shape = {"type": kind} | {key: value for key, value in keys.items() if key in _OF_SHAPES}
    return table("object", name=name, shape=shape, **{k: v for k, v in keys.items() if k not in _OF_SHAPES})


def sensor(name: str, *plates: list[list[float]], **keys: Any) -> str:
    """The text of a sensor; each plate is given by its corner and its two edges."""
    described = [dict(zip(("corner", "edge_u", "edge_v"), plate, strict=True)) for plate in plates]
    return table("sensor", name=name, **keys, plates=described)


def eye(
    name: str, apex: list[float], direction: list[float], degrees: float, reach: float, **keys: Any
) -> str:
    """The text of a distance sensor."""
    keys |= {"apex": apex, "direction": direction, "full_angle_degrees": degrees, "range": reach}
    return table("distance_sensor", name=name, **keys)


def sweep(family: str, **keys: Any) -> str:
    """The text of a sweep of a study; of squares of 10 cm unless it says otherwise."""
    return table("sweep", family=family, **{"sensor_size": [0.1, 0.1], "target_size": [0.1, 0.1], **keys})


def link(name: str, **keys: Any) -> str:
    return table("link", name=name, **keys)


def table(kind: str, **keys: Any) -> str:
    """The text of a table of a scene file."""
    return f"[[{kind}]]\n" + "".join(f"{key} = {_value(value)}\n" for key, value in keys.items())


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_value(part)}" for key, part in value.items()) + " }"
    if isinstance(value, list):
        parts = ", ".join(map(_value, value))
        return f"[ {parts} ]" if value and isinstance(value[0], dict) else f"[{parts}]"
    return json.dumps(value, ensure_ascii=False)


def obj(triangles: Any) -> str:
    """The text of a mesh file of triangles, an array of the shape (n, 3, 3), each of which has its own corners."""
    corners = [f"v {x!r} {y!r} {z!r}\n" for x, y, z in triangles.reshape(-1, 3).tolist()]
    faces = [f"f {k} {k + 1} {k + 2}\n" for k in range(1, len(corners), 3)]
    return "".join(corners + faces)


SENSOR = sensor("front", [[-0.05, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]])
"""A square sensor of 10 cm."""
GUARDED_SENSOR = SENSOR + body(
    "guard", "plate", size=[0.12, 0.12], translation=[0, 0, -0.03], potential="electrode"
)
"""A square sensor before a larger guard, an electrode."""
HEAD = """
name = "synthetic"
title = "Synthetic answers"
[reference]
rtol = 1e-3
max_seconds = 60
[model]
methods = ["exact", "split:0", "split:4"]
"""
"""What a study has before its sweeps."""

"""The schemas beside the formats, and documents that hold every key there is."""

import copy
import json
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema

import geometries
from tests import scenes

FOLDER = Path(geometries.__file__).parent / "schemas"
Document = dict[str, Any]
Place = tuple[str | int, ...]

PLATE = {"corner": [0, 0, 0], "edge_u": [0.1, 0, 0], "edge_v": [0, 0.1, 0]}
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
WHOLE: Document = tomllib.loads(
    'units = "m"\n'
    "medium = { relative_permittivity = 2.0 }\n"
    "room = { size = [4.0, 3.0, 2.5], translation = [0.0, 0.0, 1.25] }\n"
    + scenes.link("base", translation=[0.1, 0.2, 0.3], rotation={"axis": [0, 0, 1], "degrees": 30.0})
    + scenes.link(
        "arm",
        parent="base",
        quaternion=[1.0, 0.0, 0.0, 0.5],
        joint={
            "name": "elbow",
            "type": "revolute",
            "axis": [0.0, 0.0, 1.0],
            "position": 0.5,
            "lower": -2.0,
            "upper": 2.0,
        },
    )
    + scenes.link(
        "finger",
        parent="arm",
        joint={
            "name": "knuckle",
            "type": "prismatic",
            "axis": [0.0, 1.0, 0.0],
            "mimic": {"joint": "elbow", "multiplier": 0.1, "offset": 0.01},
        },
    )
    + scenes.sensor(
        "front",
        [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]],
        link="arm",
        input_voltage=5.0,
        coupling_capacitance=1e-12,
        cover={"thickness": 0.001, "relative_permittivity": 3.0},
    )
    + scenes.table(
        "distance_sensor",
        name="eye",
        link="arm",
        apex=[0.0, 0.0, 0.0],
        direction=[0.0, 0.0, 1.0],
        full_angle_degrees=40.0,
        range=0.8,
    )
    + scenes.body(
        "ball",
        "sphere",
        radius=0.05,
        segments=8,
        link="base",
        translation=[0.5, 0.0, 0.02],
        potential="floating",
        to_ground=1e-10,
        target=True,
        collides=False,
        collides_with_parent=True,
    )
    + scenes.body(
        "ring",
        "arc",
        inner_radius=0.1,
        outer_radius=0.2,
        height=0.1,
        degrees=90.0,
        segments=8,
        rotation={"quaternion": [1.0, 0.0, 0.0, 0.5]},
        material={"relative_permittivity": 3.0},
    )
    + scenes.body("post", "cylinder", radius=0.1, height=0.5, segments=8, conductor="mast")
    + scenes.body("tip", "cone", radius=0.1, height=0.5, segments=8, conductor="mast")
    + scenes.body("sheet", "plate", size=[0.1, 0.2])
    + scenes.body("box", "cuboid", size=[0.1, 0.2, 0.3])
    + scenes.body("die", "cube", size=0.1)
    + scenes.body("guard", "cube", size=0.1, potential="electrode", conductor="shield")
    + scenes.body("limb", "capsule", radius=0.05, length=0.3, segments=8)
    + scenes.body("head", "ellipsoid", semi_axes=[0.1, 0.1, 0.2], segments=8)
    + scenes.body("soap", "box", size=[0.1, 0.1, 0.2], rounding=0.05)
    + scenes.body("nurse", "person", height=1.7, age="adult", posture="standing")
    + scenes.body("coin", "disc", radius=0.1, segments=8)
    + scenes.body("floor", "plane", size=[0.1, 0.2])
    + scenes.body("outline", "polygon", vertices=[[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]])
    + scenes.table(
        "reading", name="near", sense="front", drive=["front", "shield"], noise=1e-15, threshold=1e-14
    )
)
"""A scene that needs no file, with the keys that tests/bad_input spoils in turn."""
SCENE: Document = {
    "format": 1,
    **WHOLE,
    "object": [
        *WHOLE["object"],
        {"name": "scan", "shape": {"type": "mesh", "file": "body.obj", "scale": 0.5}},
    ],
}
"""Every key of the format at least once."""
MOTION: Document = {
    "format": 1,
    "units": "mm",
    "frame": [
        {
            "name": "lowering",
            "poses": [
                {"link": "arm", "translation": [0, 0, 0.4], "rotation": {"axis": [0, 1, 0], "degrees": 9}},
                {"link": "base", "quaternion": [1, 0, 0, 0]},
            ],
        },
        {"joints": [{"joint": "elbow", "position": 0.2}]},
    ],
}


def validator(name: str) -> Any:
    """The validator of a format, given by its name."""
    schema = json.loads((FOLDER / f"{name}-1.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def tables(document: Any, place: Place = ()) -> Iterator[Place]:
    """The places of all tables in a document."""
    if isinstance(document, dict):
        yield place
    for key, value in document.items() if isinstance(document, dict) else enumerate(document):
        if isinstance(value, (dict, list)):
            yield from tables(value, (*place, key))


def at(document: Any, place: Place) -> Any:
    for key in place:
        document = document[key]
    return document


def changed(document: Document, place: Place, value: Any) -> Document:
    """The document with another value at a place; without it where the value is None."""
    result = copy.deepcopy(document)
    table = at(result, place[:-1])
    if value is None:
        del table[place[-1]]
    else:
        table[place[-1]] = value
    return result


def with_wrong_types(document: Document) -> Iterator[tuple[Place, Document]]:
    """The document again and again, each time with a value of another type."""
    for table in tables(document):
        for key, value in at(document, table).items():
            wrong = "yes" if isinstance(value, bool) else True
            yield (*table, key), changed(document, (*table, key), wrong)


def with_unknown_keys(document: Document) -> Iterator[tuple[Place, Document]]:
    """The document again and again, each time with a key that no table has."""
    for table in tables(document):
        yield (*table, "unknown"), changed(document, (*table, "unknown"), 1)


# What other tables name.
NAMED: tuple[Place, ...] = (
    ("link",),
    ("link", 0, "name"),
    ("link", 1, "joint"),
    ("link", 1, "joint", "name"),
    ("sensor",),
    ("object",),
    ("object", 7, "potential"),
    ("object", 7, "conductor"),
)


def without_keys(document: Document) -> Iterator[tuple[Place, Document]]:
    """The document again and again, each time without one of its keys, but never without what others name."""
    for table in tables(document):
        for key in at(document, table):
            if (*table, key) not in NAMED:
                yield (*table, key), changed(document, (*table, key), None)

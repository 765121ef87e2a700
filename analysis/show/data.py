"""The data of a scene's page: bodies in the frames of their links, and poses and readings in every frame of a motion; the readings by quick methods in
every frame, by boundary elements in the frames of the motion file."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from analysis.results.store import Document
from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.scene import poses as scene_poses
from geometries.scene.motion import Frame, with_frames_between
from geometries.scene.poses import Transform
from geometries.scene.scene import Object, Scene, Sensor


_DIGITS = 5
"""Decimals of a coordinate in metres: hundredths of a millimetre are finer than any screen."""


def collect(path: Path, scene: Scene, frames: Sequence[Frame], model: Any, between: int = 0) -> Document:
    """Collects everything that the page needs, as JSON. `model` is the module fringe; InputError for what it refuses.

    `between` frames are added between every two of the motion.
    """
    frames = with_frames_between(frames, between)
    index = {link.name: number for number, link in enumerate(scene.links)}
    live = load(path, model)
    return {
        "links": [
            {"name": link.name, "parent": index.get(link.parent) if link.parent else None}
            for link in scene.links
        ],
        "objects": [
            {"name": body.name, "link": index.get(body.link or ""), **_body(body, model)}
            for body in scene.objects
        ],
        "sensors": [
            {
                "name": sensor.name,
                "link": index.get(sensor.link or ""),
                "input_voltage": sensor.input_voltage,
                **mesh(_plates(sensor)),
            }
            for sensor in scene.sensors
        ],
        "eyes": [
            {
                "name": eye.name,
                "link": index.get(eye.link or ""),
                "apex": list(eye.apex),
                "direction": (np.asarray(eye.direction) / np.linalg.norm(eye.direction)).tolist(),
                "half_angle": math.radians(eye.full_angle_degrees) / 2,
                "range": eye.range,
            }
            for eye in scene.distance_sensors
        ],
        "frames": [_frame(frame, scene, live, model) for frame in frames],
        "every": between + 1,
    }


def load(path: Path, model: Any) -> Any:
    """Returns the scene of the module fringe, `model`; InputError for what it refuses."""
    try:
        return model.Scene.load(str(path))
    except ValueError as error:
        # The message of the model's reader names file, key and reason.
        raise InputError("", "", str(error)) from error


def _body(body: Object, model: Any) -> Document:
    triangles = body.pose.transform().points(body.shape.triangles())
    return {**mesh(triangles), "obb": _box_corners(triangles, model)}


def _plates(sensor: Sensor) -> Array:
    triangles = []
    for plate in sensor.plates:
        c, u, v = np.array(plate.corner), np.array(plate.edge_u), np.array(plate.edge_v)
        triangles += [(c, c + u, c + u + v), (c, c + u + v, c + v)]
    return np.array(triangles)


def mesh(triangles: Array) -> Document:
    """Returns the distinct vertices, and the triangles as indices into them."""
    vertices, indices = np.unique(triangles.reshape(-1, 3).round(_DIGITS), axis=0, return_inverse=True)
    return {"vertices": vertices.tolist(), "faces": indices.reshape(-1, 3).tolist()}


def _box_corners(triangles: Array, model: Any) -> list[list[float]]:
    """Returns the corners of the oriented bounding box, from (−, −, −) on; the sign of the last axis changes fastest."""
    vertices = np.unique(triangles.reshape(-1, 3), axis=0)
    centre, axes, half_widths = model.obb(vertices, None, "tight")
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners: list[list[float]] = (centre + (signs * half_widths) @ axes).round(_DIGITS).tolist()
    return corners


def _frame(frame: Frame, scene: Scene, live: Any, model: Any) -> Document:
    for link, pose in frame.poses.items():
        live.set_pose(link, np.array(pose.translation), pose.rotation.matrix())
    conductors = live.conductors()
    bounds = [model.aabb(conductors[body.name].reshape(-1, 3)) for body in scene.objects]
    return {
        "name": frame.name,
        "links": [_matrix(transform) for transform in _transforms(frame, scene)],
        "aabb": [np.concatenate(box).round(_DIGITS).tolist() for box in bounds],
        "readings": [_reading(reading) for reading in live.sense()["distance_sensors"]],
        **_outputs(live),
        "collisions": _collisions(live),
    }


def _transforms(frame: Frame, scene: Scene) -> list[Transform]:
    """Returns the transform from every link's frame to the world."""
    links = tuple(replace(link, pose=frame.poses[link.name]) for link in scene.links)
    moved = replace(scene, links=links)
    return [moved.transform_of_link(link.name) for link in links]


def _matrix(transform: Transform) -> list[float]:
    """Returns the rows of (R | t)."""
    rows = np.column_stack([transform.rotation, transform.translation])
    numbers: list[float] = rows.round(_DIGITS + 3).ravel().tolist()
    return numbers


def _reading(reading: Document) -> Document | None:
    if reading["distance"] is None:
        return None
    point = np.asarray(reading["point"]).round(_DIGITS).tolist()
    return {"distance": reading["distance"], "point": point, "object": reading["object"]}


def _outputs(live: Any) -> Document:
    """Returns the outputs of the capacitive sensors, or why there are none: the model needs grounded conductors."""
    try:
        answer = live.capacitance()
    except ValueError as error:
        return {"outputs": None, "refused": str(error)}
    return {
        "outputs": [
            {
                "total": _finite(sensor["total"]),
                "delta_voltage": sensor["delta_voltage"],
                "objects": [
                    [body["name"], _finite(body["capacitance"])]
                    for body in sorted(
                        sensor["objects"], key=lambda body: float(body["capacitance"]), reverse=True
                    )[:3]
                ],
            }
            for sensor in answer["sensors"]
        ]
    }


def _finite(number: float) -> float | None:
    """Replaces infinity, the capacitance at contact, which JSON cannot express."""
    return number if math.isfinite(number) else None


def _collisions(live: Any) -> Document:
    """Returns the pairs that are not clear of each other, and how many tests were made."""
    answer = live.collide()
    pairs = answer["pairs"]
    return {
        "tests": answer["tests"],
        "pairs": [[pair["a"], pair["b"], pair["status"]] for pair in pairs if pair["status"] != "clear"],
    }


RTOL_OF_REDUCED = 0.1
"""Relative error asked of the reduced method, which mostly reaches a tenth of it, in milliseconds."""


@dataclass(frozen=True)
class Method:
    """A way to the changes of the readings; `options` are those of the module fringe."""

    name: str
    method: str
    options: Document


QUICK = (
    Method("model", "exact", {}),
    Method("formula", "formula", {}),
    Method("reduced", "reduced", {"rtol": RTOL_OF_REDUCED}),
)


@dataclass(frozen=True)
class Options:
    """`between`: frames that are shown between two of the motion file; `rtol`: the relative error asked of boundary elements."""

    between: int = 8
    rtol: float = 1e-2


def along(live: Any, frames: Sequence[Frame], options: Options) -> Document:
    """Returns the changes of all readings, F, with the errors that the methods state, for the page.

    `frames` are those of the motion file with `options.between` between every two, `live` is the scene of the module fringe. A frame
    that a method refuses has no value; if it refuses every frame, its reason stands in their place.
    """
    every = range(len(frames))
    key = every[:: options.between + 1]
    reference = Method("boundary elements", "boundary-elements", {"rtol": options.rtol})
    methods = [_series(live, frames, every, method) for method in QUICK]
    methods.append(_series(live, frames, key, reference))
    asked = live.roles()["readings"]
    return {
        "readings": [
            {"name": name, "threshold": reading.get("threshold")} for name, reading in asked.items()
        ],
        "methods": methods,
    }


def in_frame(live: Any, frame: Frame, method: str, **options: Any) -> dict[str, Any]:
    """Returns the readings in a frame, to which the links of a scene of the module fringe are taken; ValueError where the method refuses it."""
    for link, pose in frame.poses.items():
        live.set_pose(link, np.array(pose.translation), scene_poses.quaternion(pose.rotation))
    found: dict[str, Any] = live.readings(method, **options)
    return found


def _series(live: Any, frames: Sequence[Frame], asked: Sequence[int], method: Method) -> Document:
    """Returns where a method was asked, and for every reading its change and the error of that, F."""
    changes: dict[str, list[float | None]] = {}
    errors: dict[str, list[float | None]] = {}
    refused = ""
    for number, frame in enumerate(asked):
        if method.method == "boundary-elements":
            print(
                f"\ranalysis: readings {number + 1} of {len(asked)} by boundary elements",
                end="",
                file=sys.stderr,
            )
        try:
            found = in_frame(live, frames[frame], method.method, **method.options)
        except ValueError as error:
            found, refused = {}, str(error)
        for name, reading in found.items():
            changes.setdefault(name, [None] * len(asked))[number] = reading.change
            errors.setdefault(name, [None] * len(asked))[number] = reading.error["change"]
    if method.method == "boundary-elements":
        print(file=sys.stderr)
    known = any(value is not None for each in changes.values() for value in each)
    return {
        "name": method.name,
        "frames": list(asked),
        "changes": changes,
        "errors": errors,
        "refused": "" if known else refused or "it does not know the changes of these readings",
    }

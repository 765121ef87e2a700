"""`python3 -m analysis show SCENE`: makes one page that shows a scene and its motion: bodies in the frames of their links, and poses and readings in every frame of a
motion; the readings by quick methods in every frame, by boundary elements in the frames of the motion file."""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from analysis.pipeline import keys
from analysis.pipeline.model_stage import model_module
from analysis.report import page
from analysis.report.index_page import MOTION
from analysis.results.store import Document, finite, write_text
from fem_reference.bodies.remarks import remarks
from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.common.installation import ROOT, is_own, results_folder
from geometries.common.tables import is_file
from geometries.scene import motion, poses as scene_poses, reader
from geometries.scene.motion import Frame, with_frames_between
from geometries.scene.scene import Object, Scene, Sensor

_DIGITS = 5
"""Decimals of a coordinate in metres: hundredths of a millimetre are finer than any screen."""


def collect(path: Path, scene: Scene, frames: Sequence[Frame], model: Any, between: int = 0) -> Document:
    """Collects everything that the page needs, as JSON. `model` is the module fringe; InputError for what it refuses.
    `between` frames are added between every two of the motion."""
    frames = with_frames_between(frames, between)
    index = {link.name: number for number, link in enumerate(scene.links)}
    live = load(path, model)
    return {
        "links": [{"name": link.name, "parent": index.get(link.parent or "")} for link in scene.links],
        "objects": [_body(body, index.get(body.link or ""), model) for body in scene.objects],
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


def _body(body: Object, link: int | None, model: Any) -> Document:
    triangles = body.pose.transform().points(body.shape.triangles())
    return {"name": body.name, "link": link, **mesh(triangles), "obb": _box_corners(triangles, model)}


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
    conductors, answer = live.conductors(), live.collide()
    close = (pair for pair in answer["pairs"] if pair["status"] != "clear")
    pairs = [[pair["a"], pair["b"], pair["status"]] for pair in close]
    bounds = [model.aabb(conductors[body.name].reshape(-1, 3)) for body in scene.objects]
    links = tuple(replace(link, pose=frame.poses[link.name]) for link in scene.links)
    moved = replace(scene, links=links)
    places = (moved.transform_of_link(link.name) for link in links)
    # The rows of (R | t).
    matrices = (np.column_stack([each.rotation, each.translation]).round(_DIGITS + 3) for each in places)
    return {
        "name": frame.name,
        "links": [matrix.ravel().tolist() for matrix in matrices],
        "aabb": [np.concatenate(box).round(_DIGITS).tolist() for box in bounds],
        "readings": [_reading(reading) for reading in live.sense()["distance_sensors"]],
        **_outputs(live),
        "collisions": {"tests": answer["tests"], "pairs": pairs},
    }


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
    outputs = []
    for sensor in answer["sensors"]:
        largest = sorted(sensor["objects"], key=lambda body: -float(body["capacitance"]))[:3]
        # At contact a capacitance is infinite.
        named = [[body["name"], finite(body["capacitance"])] for body in largest]
        own = {"total": finite(sensor["total"]), "delta_voltage": sensor["delta_voltage"]}
        outputs.append(own | {"objects": named})
    return {"outputs": outputs}


RTOL_OF_REDUCED = 0.1
"""Relative error asked of the reduced method, which mostly reaches a tenth of it, in milliseconds."""


class Method(NamedTuple):
    """A way to the changes of the readings; `options` are those of the module fringe."""

    name: str
    method: str
    options: Document = {}


_REDUCED = Method("reduced", "reduced", {"rtol": RTOL_OF_REDUCED})
QUICK = (Method("model", "exact"), Method("formula", "formula"), _REDUCED)


@dataclass(frozen=True)
class Readings:
    """`between`: frames that are shown between two of the motion file; `rtol`: the relative error asked of boundary elements."""

    between: int = 8
    rtol: float = 1e-2


def along(live: Any, frames: Sequence[Frame], options: Readings) -> Document:
    """Returns the changes of all readings, F, with the errors that the methods state, for the page. `frames` are those of the motion
    file with `options.between` between every two, `live` is the scene of the module fringe. A frame that a method refuses has no
    value; if it refuses every frame, its reason stands in their place."""
    every = range(len(frames))
    reference = Method("boundary elements", "boundary-elements", {"rtol": options.rtol})
    methods = [_series(live, frames, every, method) for method in QUICK]
    methods.append(_series(live, frames, every[:: options.between + 1], reference))
    asked = live.roles()["readings"].items()
    told = [{"name": name, "threshold": reading.get("threshold")} for name, reading in asked]
    return {"readings": told, "methods": methods}


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
            told = f"\ranalysis: readings {number + 1} of {len(asked)} by boundary elements"
            print(told, end="", file=sys.stderr)
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


def document(title: str, inputs: str, data: Document, readings: Document | None) -> str:
    """Returns the whole page. `readings` are those along the motion, and `inputs` is the hash of what the page is made from."""
    body = page.filled(
        "show.html",
        style=page.static("show.css"),
        script=page.static("parts.js", "show.js"),
        readings=None if readings is None else page.json_in_page(readings, allow_nan=False),
        title=title,
        summary=_summary(data),
        data=page.json_in_page(data, allow_nan=False),
    )
    return page.document(title, inputs, [body])


def _summary(data: Document) -> str:
    parts = "objects", "links", "sensors", "eyes"
    counts = [*(len(data[part]) for part in parts), len(data["frames"][:: data["every"]])]
    nouns = "object", "link", "capacitive sensor", "distance sensor", "frame"
    told = [f"{count} {noun}{'s' * (count > 1)}" for count, noun in zip(counts, nouns) if count]
    return ", ".join(told) + ". Drag to turn, scroll to come closer, hover for names."


SCENES = ROOT / "geometries" / "scenes"
MOTION_SUFFIX = ".motion.toml"


def make(name: str, motion_file: Path | None, target: Path | None, readings: Readings | None = None) -> Path:
    """Writes the page of a scene, a file or a name in geometries/scenes; returns where it is.

    The page of a scene of the repository is in its results, of any other scene in the current folder, unless `target` names it. Without a motion file the one beside the
    scene is taken, SCENE.motion.toml for SCENE.toml, or else the scene as it stands. With `readings`, plots of the readings along the motion follow. A page that is up
    to date stays. Prints remarks on the scene on standard error. InputError for files that cannot be used."""
    path = find_scene(name)
    scene = reader.load(path)
    for remark in remarks(scene):
        print(f"analysis: remark: {remark}", file=sys.stderr)
    motion_file = motion_file or motion_beside(path)
    frames = motion.load(motion_file, scene) if motion_file else (motion.at_rest(scene),)
    model = model_module()
    data = collect(path, scene, frames, model, readings.between if readings else 0)
    place = target or (results_folder() / MOTION.folder if is_own(path) else Path.cwd()) / f"{path.stem}.html"
    inputs = keys.page_inputs(data, repr(readings), str(model.__version__))
    if page.is_current(place, inputs):
        return place
    told = None
    if readings:
        told = along(load(path, model), with_frames_between(frames, readings.between), readings)
    write_text(place, document(path.stem.replace("_", " "), inputs, data, told))
    return place


def motion_beside(scene: Path) -> Path | None:
    """Returns the motion file beside a scene, SCENE.motion.toml for SCENE.toml; None if there is none."""
    beside = scene.with_suffix("").with_suffix(MOTION_SUFFIX)
    return beside if is_file(beside) else None


def find_scene(name: str) -> Path:
    """Returns the file of a scene given by its path or by its name in geometries/scenes; InputError when there is none."""
    if Path(name).suffix == ".toml":
        return Path(name)
    path = SCENES / f"{name}.toml"
    if not is_file(path):
        known = sorted(file.stem for file in SCENES.glob("*.toml") if "." not in file.stem)
        raise InputError(name, "", f"is neither a TOML file nor one of {', '.join(known)}")
    return path

"""`python3 -m analysis live SCENE`: makes one page on which a scene can be moved, with the library in it as WebAssembly. Its paths are the motion beside the scene, and two
that the target takes before the first sensor; with reference readings."""

from __future__ import annotations

import base64
import os
import sys
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from analysis.pipeline import keys
from analysis.pipeline.model_stage import model_module
from analysis.report import page
from analysis.report.index_page import LIVE
from analysis.results.store import Document, write_text
from analysis.show import find_scene, in_frame, motion_beside
from fem_reference.bodies.remarks import remarks
from geometries.common.arrays import Array
from geometries.common.errors import InputError
from geometries.common.installation import ROOT, is_installed, is_own, page_library, results_folder
from geometries.scene import motion, reader
from geometries.scene.covers import is_cover
from geometries.scene.motion import Frame, at_rest
from geometries.scene.poses import Pose, quaternion
from geometries.scene.scene import Object, Scene
from geometries.scene.shapes import Cuboid, PlateShape

HEIGHTS = (0.3, 0.2, 0.15, 0.1, 0.07, 0.05, 0.03, 0.02, 0.01)
"""Distances (m) of the target from the sensor's plane on the approach."""
EDGE_HEIGHT = 0.03
"""Distance (m) of the target from the sensor's plane on the way over its edge."""
EDGE_FRAMES = 9
_BEYOND = 0.02
"""Gap (m) between the target and the sensor, seen from above, at both ends of the way over its edge."""


@dataclass(frozen=True)
class Way:
    """Frames through which the page moves; `said` tells in a sentence what moves."""

    name: str
    said: str
    frames: tuple[Frame, ...]


def of_scene(scene: Scene, motion: Sequence[Frame]) -> list[Way]:
    """Returns the paths of a scene; `motion` has the frames of the motion beside it, if any. The target that a link of its own carries
    approaches the first sensor, and slides over its edge."""
    paths = [Way("motion", "The frames of the motion file.", tuple(motion))] if motion else []
    target = _carried_target(scene)
    if target is None:
        return paths
    place, sensor = _Place.of(scene, target), scene.sensors[0].name
    approach = tuple(place.frame(f"{1000 * height:.0f} mm", height, place.beside) for height in HEIGHTS)
    half = place.length / 2 + place.half_width + _BEYOND
    over = tuple(
        place.frame(f"{1000 * beside:.0f} mm".replace("-", "−"), EDGE_HEIGHT, float(beside))
        for beside in np.linspace(-half, half, EDGE_FRAMES)
    )
    ends = f"{100 * HEIGHTS[0]:g} cm to {100 * HEIGHTS[-1]:g} cm"
    comes = f"“{target.name}” comes from {ends} before “{sensor}”."
    slides = f"“{target.name}” slides over the edges of “{sensor}”, {100 * EDGE_HEIGHT:g} cm before it; places are those of its centre."
    return [*paths, Way("approach", comes, approach), Way("over the edge", slides, over)]


def _carried_target(scene: Scene) -> Object | None:
    """Returns the first marked target, or the only object, on a link that carries no sensor and has no joint; None where there is no
    such or no sensor."""
    with_sensor = {sensor.link for sensor in scene.sensors} | {None}
    jointed = {link.name for link in scene.links if link.joint is not None}
    targets = [body for body in scene.objects if body.target or len(scene.objects) == 1]
    found = (body for body in targets if body.link not in with_sensor | jointed)
    return next(found, None) if scene.sensors else None


@dataclass(frozen=True)
class _Place:
    """Where a target is before the first plate of a sensor; metres, in the world."""

    scene: Scene
    link: str
    normal: Array
    along: Array  # of length 1, along the plate's first edge
    length: float  # of that edge
    height: float  # of the target's lowest point
    beside: float  # of the target's centre, from the plate's, along that edge
    half_width: float  # of the target along that edge

    @staticmethod
    def of(scene: Scene, target: Object) -> _Place:
        corner, u, v = scene.sensor_rectangles(scene.sensors[0].name)[0]
        points = scene.conductors()[target.name].reshape(-1, 3) - (corner + (u + v) / 2)
        normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
        if points.mean(axis=0) @ normal < 0:
            normal = -normal
        along, length = u / np.linalg.norm(u), float(np.linalg.norm(u))
        low, high = float((points @ along).min()), float((points @ along).max())
        assert target.link is not None
        height = float((points @ normal).min())
        return _Place(scene, target.link, normal, along, length, height, (low + high) / 2, (high - low) / 2)

    def frame(self, name: str, height: float, beside: float) -> Frame:
        """Returns the frame in which the target is so high above the plate, and so far beside its centre."""
        shift = (height - self.height) * self.normal + (beside - self.beside) * self.along
        link = {link.name: link for link in self.scene.links}[self.link]
        local = self.scene.transform_of_link(link.parent).rotation.T @ shift
        x, y, z = (float(a + b) for a, b in zip(link.pose.translation, local))
        return Frame(name, at_rest(self.scene).poses | {self.link: replace(link.pose, translation=(x, y, z))})


def described(path: Way, reference: list[Document] | None) -> Document:
    """Describes a path for the page: the poses of all links in every frame, and the reference readings if they are solved."""

    def pose(each: Pose) -> Document:
        return {"translation": list(each.translation), "quaternion": quaternion(each.rotation).tolist()}

    frames = [{"name": each.name, "poses": [*map(pose, each.poses.values())]} for each in path.frames]
    return {"name": path.name, "said": path.said, "frames": frames, "reference": reference}


def solved(path: Way, live: Any, rtol: float, tell: Callable[[], None]) -> list[Document]:
    """Returns for every frame of a path, by the name of the reading, its change and the error of that (F), by boundary elements.
    `live` is the scene of the module fringe; `tell` is called after each frame. A frame that boundary elements refuse has no
    entries."""
    frames: list[Document] = []
    for frame in path.frames:
        try:
            readings = in_frame(live, frame, "boundary-elements", rtol=rtol)
        except ValueError:
            readings = {}
        known = {name: each for name, each in readings.items() if each.change is not None}
        frames.append({name: [each.change, each.error["change"] or 0.0] for name, each in known.items()})
        tell()
    return frames


def movable(text: str) -> str:
    """Returns the text of a scene in which each target is on a link: one that has none gets a link of its own, with its name, in the
    world's frame, so that it can be dragged. If no object is marked as a target, all are but electrodes. No answer changes by it.
    """
    scene = tomllib.loads(text)
    bodies: list[dict[str, Any]] = scene.get("object", [])
    some_are_marked = any(body.get("target", False) for body in bodies)
    names = {link["name"] for link in scene.get("link", [])}
    added = []
    for body in bodies:
        is_target = body.get("target", False) if some_are_marked else body.get("potential") != "electrode"
        if is_target and "link" not in body:
            name = body["name"]
            while name in names:
                name += "'"
            names.add(name)
            added.append({"name": name})
            body["link"] = name
    if not added:
        return text
    scene["link"] = [*scene.get("link", []), *added]
    return str(tomli_w.dumps(scene))


def covered(text: str, thickness: float, relative_permittivity: float) -> str:
    """Returns the text of a scene in which every sensor has this cover (thickness in m)."""
    scene = tomllib.loads(text)
    for sensor in scene.get("sensor", []):
        sensor["cover"] = {"thickness": thickness, "relative_permittivity": relative_permittivity}
    return str(tomli_w.dumps(scene))


def files(text: str, folder: Path) -> dict[str, str]:
    """Returns the mesh files that a scene names, as it names them, in base64; `folder` is where the scene lies."""
    shapes = (body.get("shape", {}) for body in tomllib.loads(text).get("object", []))
    paths = {shape["file"]: folder.absolute() / shape["file"] for shape in shapes if "file" in shape}
    return {name: base64.b64encode(path.read_bytes()).decode() for name, path in paths.items()}


_SUMMARY = (
    "or use the sliders: every frame, the library in this page computes the readings anew. Drag the empty ground to turn the "
    "view, scroll or pinch to come closer; with shift, dragging turns the body. On the picture, the arrow keys, page up and page down "
    "move it by 5 mm, with shift they turn it by 3 degrees."
)
_SCRIPTS = ("parts.js", "live_view.js", "live_model.js", "live_readings.js", "live_controls.js", "live.js")


def document(title: str, inputs: str, library: str, data: Document, notes: str) -> str:
    """Returns the whole page. `inputs` is the hash of what it is made from, `library` the JavaScript with the library in WebAssembly, `notes`
    the folder of the repository as seen from the page, with a slash at its end."""
    way = "Choose a path, drag a body" if data["paths"] else "Drag a body"
    body = page.filled(
        "live.html",
        style=page.static("live.css"),
        library=page.script(library),
        script=page.static(*_SCRIPTS),
        title=title,
        summary=f"{way}, {_SUMMARY}",
        notes=notes,
        data=page.json_in_page(data, allow_nan=False),
    )
    return page.document(title, inputs, [body], script="")


RTOL = 1e-2
"""Relative error asked of the reference readings."""
LARGEST = 6_000_000
"""Bytes of a page at most."""
_MOST_BODIES = 12
"""Bodies up to which the page begins with the reduced method, if all are plates and cuboids: it is prepared within a second."""

COVERS = (("2 mm of plastic", 2e-3, 3.0), ("a wet film of 0.5 mm", 0.5e-3, 80.0))
"""Covers that the page puts on all sensors: name, thickness (m), relative permittivity."""


class NoLibrary(Exception):
    """The library for pages is not built; the message says how to get it."""


def make(name: str, motion_file: Path | None, target: Path | None, rtol: float | None = RTOL) -> Path:
    """Writes the live page of a scene, a file or a name in geometries/scenes, unless it is up to date; returns where it is.

    The page of a scene of the repository is in its results, of any other scene in the current folder, unless `target` names it. `rtol` is
    the relative error asked of the reference readings along the paths; they are not solved if it is None.

    Remarks on the scene, and the progress of the reference readings, go to standard error. InputError for files that cannot
    be used and for a page that would be too large; NoLibrary where the library for pages is missing."""
    path = find_scene(name)
    # Refuses a wrong scene by the lines of its own file.
    reader.load(path)
    text = movable(path.read_text(encoding="utf-8"))
    scene, native = reader.loads(text, source=str(path)), _native(text, path)
    library = _library()
    for remark in remarks(scene):
        print(f"analysis: remark: {remark}", file=sys.stderr)
    moved = motion_file or motion_beside(path)
    frames = motion.load(moved, scene) if moved else ()
    place = target or (results_folder() / LIVE.folder if is_own(path) else Path.cwd()) / f"{path.stem}.html"
    all_flat = all(isinstance(body.shape, PlateShape | Cuboid) for body in scene.objects)
    data: Document = {
        "scene": text,
        "covers": _covers(text, scene, path),
        "files": files(text, path.parent),
        "reduced": len(scene.sensors) + len(scene.objects) <= _MOST_BODIES and all_flat,
    }
    ways = of_scene(scene, frames)
    # The repository as seen from the page: a relative path where the page is within, an address elsewhere.
    folder = place.resolve().parent
    notes = (os.path.relpath(ROOT, folder) if folder.is_relative_to(ROOT) else ROOT.as_uri()) + "/"
    # The reference readings follow from these.
    unsolved = [described(way, None) for way in ways]
    inputs = keys.page_inputs(data, unsolved, library, rtol, model_module().__version__, notes)
    if page.is_current(place, inputs):
        return place
    references = _references(native, ways, rtol)
    data["paths"] = [described(way, reference) for way, reference in zip(ways, references)]
    data["made"] = f"This page was made from {path.name} by fringe {model_module().__version__}."
    content = document(path.stem.replace("_", " "), inputs, library, data, notes)
    if (size := len(content.encode())) > LARGEST:
        too_large = f"{size / 1e6:.1f} MB, more than {LARGEST / 1e6:g}: its meshes are too large"
        raise InputError(str(path), "", f"its page would have {too_large}")
    write_text(place, content)
    return place


def _library() -> str:
    file = page_library()
    if not file.is_file():
        way = "./run builds it where emscripten is installed (apt-get install emscripten node-acorn)"
        if is_installed():
            way = "live pages are made in the repository"
        raise NoLibrary(f"{file} is missing: {way}")
    return file.read_text(encoding="utf-8")


def _covers(text: str, scene: Scene, path: Path) -> list[Document]:
    """Returns the texts of the scene with each cover on all sensors; none where a sensor has a cover of its own, or where one has no room."""
    if not scene.sensors or any(is_cover(body) for body in scene.objects):
        return []
    found: list[Document] = []
    for name, thickness, permittivity in COVERS:
        with_cover = covered(text, thickness, permittivity)
        try:
            _native(with_cover, path)
        except InputError:
            continue
        found.append({"name": name, "scene": with_cover})
    return found


def _native(text: str, path: Path) -> Any:
    """Returns the scene of the module fringe. InputError for what only the model refuses."""
    try:
        return model_module().Scene.loads(text, path.absolute().parent)
    except ValueError as error:
        raise InputError(str(path), "", str(error)) from error


def _references(native: Any, ways: list[Way], rtol: float | None) -> list[list[Document] | None]:
    """Solves the reference readings along every path, with a line on standard error that says how far it is."""
    if rtol is None or not ways:
        return [None for _ in ways]
    total, done = sum(len(way.frames) for way in ways), 0

    def tell() -> None:
        nonlocal done
        done += 1
        print(f"\ranalysis: reference readings {done} of {total}", end="", file=sys.stderr, flush=True)

    found: list[list[Document] | None] = [solved(way, native, rtol, tell) for way in ways]
    print(file=sys.stderr)
    return found

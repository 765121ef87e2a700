"""`python3 -m analysis show SCENE`: makes one page that shows a scene and its motion."""

from __future__ import annotations

import sys
from pathlib import Path

from analysis.pipeline import keys
from analysis.pipeline.model_stage import model_module
from analysis.report import page
from analysis.report.index_page import MOTION
from analysis.results.store import Document, write_text
from analysis.show import data as show_data
from fem_reference.bodies.remarks import remarks
from geometries.common.errors import InputError
from geometries.common.installation import ROOT, is_own, results_folder
from geometries.common.tables import is_file
from geometries.scene import motion, reader
from geometries.scene.motion import with_frames_between


def document(title: str, inputs: str, data: Document, readings: Document | None) -> str:
    """Returns the whole page. `readings` are those along the motion, and `inputs` is the hash of what the page is made from."""
    body = page.filled(
        "show.html",
        style=page.static("show.css"),
        script=page.static("parts.js", "show_readings.js", "show.js"),
        readings=None if readings is None else page.json_in_page(readings, allow_nan=False),
        title=title,
        summary=_summary(data),
        data=page.json_in_page(data, allow_nan=False),
    )
    return page.document(title, inputs, [body])


def _summary(data: Document) -> str:
    nouns = {
        "objects": "object",
        "links": "link",
        "sensors": "capacitive sensor",
        "eyes": "distance sensor",
        "frames": "frame",
    }
    counts = {key: len(data[key]) for key in nouns} | {"frames": len(data["frames"][:: data["every"]])}
    parts = [_count(counts[key], noun) for key, noun in nouns.items() if counts[key]]
    return ", ".join(parts) + ". Drag to turn, scroll to come closer, hover for names."


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


SCENES = ROOT / "geometries" / "scenes"
MOTION_SUFFIX = ".motion.toml"


def make(
    name: str, motion_file: Path | None, target: Path | None, readings: show_data.Options | None = None
) -> Path:
    """Writes the page of a scene, a file or a name in geometries/scenes; returns where it is.

    The page of a scene of the repository is in its results, of any other scene in the current folder, unless `target` names it.
    Without a motion file the one beside the scene is taken, SCENE.motion.toml for SCENE.toml, or else the scene as it
    stands. With `readings`, plots of the readings along the motion follow. A page that is up to date stays. Prints remarks on the scene on standard error. InputError for files that cannot be used.
    """
    path = find_scene(name)
    scene = reader.load(path)
    for remark in remarks(scene):
        print(f"analysis: remark: {remark}", file=sys.stderr)
    motion_file = motion_file or motion_beside(path)
    frames = motion.load(motion_file, scene) if motion_file else (motion.at_rest(scene),)
    model = model_module()
    data = show_data.collect(path, scene, frames, model, readings.between if readings else 0)
    place = target or (results_folder() / MOTION.folder if is_own(path) else Path.cwd()) / f"{path.stem}.html"
    inputs = keys.page_inputs(data, repr(readings), str(model.__version__))
    if page.is_current(place, inputs):
        return place
    along = None
    if readings:
        moved = with_frames_between(frames, readings.between)
        along = show_data.along(show_data.load(path, model), moved, readings)
    write_text(place, document(path.stem.replace("_", " "), inputs, data, along))
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

"""`python3 -m analysis show SCENE`: makes one page that shows a scene and its motion."""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path

from analysis.pipeline.model_stage import model_module
from analysis.results.store import write_text
from analysis.show import data as show_data, page as show_page
from fem_reference.bodies.remarks import remarks
from geometries.common.errors import InputError
from geometries.common.installation import ROOT, is_own, results_folder
from geometries.common.tables import is_file
from geometries.scene import motion, reader

SCENES = ROOT / "geometries" / "scenes"
MOTION_SUFFIX = ".motion.toml"


def make(name: str, motion_file: Path | None, target: Path | None) -> Path:
    """Writes the page of a scene, a file or a name in geometries/scenes; returns where it is.

    The page of a scene of the repository is in its results, of any other scene in the current folder, unless `target` names it.
    Without a motion file the one beside the scene is taken, SCENE.motion.toml for SCENE.toml, or else the scene as it
    stands. Prints remarks on the scene on standard error. InputError for files that cannot be used.
    """
    path = find_scene(name)
    scene = reader.load(path)
    for remark in remarks(scene):
        print(f"analysis: remark: {remark}", file=sys.stderr)
    motion_file = motion_file or motion_beside(path)
    frames = motion.load(motion_file, scene) if motion_file else (motion.at_rest(scene),)
    data = show_data.collect(path, scene, frames, model_module())
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    digest = hashlib.sha256(text.encode()).hexdigest()
    page = target or (results_folder() / "show" if is_own(path) else Path.cwd()) / f"{path.stem}.html"
    write_text(page, show_page.document(path.stem.replace("_", " "), digest, text, data))
    return page


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

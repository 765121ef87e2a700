"""The text of a scene as a live page has it: targets are on links, which can be moved, sensors may get covers, and mesh files are in the
page."""

from __future__ import annotations

import base64
import tomllib
from pathlib import Path
from typing import Any

import tomli_w


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
            name = _unused(body["name"], names)
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
    names = (body.get("shape", {}).get("file") for body in tomllib.loads(text).get("object", []))
    return {
        name: base64.b64encode((folder.absolute() / name).read_bytes()).decode()
        for name in names
        if name is not None
    }


def _unused(name: str, names: set[str]) -> str:
    while name in names:
        name += "'"
    return name

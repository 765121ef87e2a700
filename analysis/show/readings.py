"""The readings of a scene along its motion: by quick methods in every frame, by boundary elements in the frames of the motion file."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis.results.store import Document
from geometries.scene import poses as scene_poses
from geometries.scene.motion import Frame

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


def collect(live: Any, frames: Sequence[Frame], options: Options) -> Document:
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

"""Every set-up as plain data: its scene, its truth and the estimate of every method."""

from __future__ import annotations

from typing import Any

import numpy as np

from analysis.results.store import Document
from analysis.topics.corrections.estimates import Estimates
from analysis.topics.corrections.set_ups import SetUp
from analysis.topics.corrections.truths import load
from geometries.scene.scene import Scene


def documents(module: Any, found: Estimates, chosen: list[SetUp]) -> list[Document]:
    """Returns every set-up with its scene, its truth and all estimates, as plain data: farads, metres."""
    truths = load()
    return [
        {
            "name": set_up.name,
            "family": set_up.family,
            "sealed": set_up.sealed,
            "distance": _distance(module, set_up.scene),
            "sensor_size": _sensor_size(set_up.scene),
            "truth": float(found.truth[index]),
            "error": truths[set_up.name].error,
            "estimates": {name: float(values[index]) for name, values in found.by_method.items()},
            "scene": set_up.text,
        }
        for index, set_up in enumerate(chosen)
    ]


def _sensor_size(scene: Scene) -> float:
    (plate,) = scene.sensors[0].plates
    return float(np.sqrt(np.linalg.norm(plate.edge_u) * np.linalg.norm(plate.edge_v)))


def _distance(module: Any, scene: Scene) -> float:
    """Returns the shortest distance between the two bodies, in metres."""
    bodies = scene.conductors()
    points = [bodies[name].reshape(-1, 3) for name in ("sensor", "target")]
    return float(module.gjk_distance(*points)[0])

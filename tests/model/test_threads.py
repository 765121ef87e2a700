"""Scenes evaluated from several threads at once: each has the answer of a thread alone, and none waits for Python."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

fringe: Any = pytest.importorskip("fringe")

SCENE = """
[[link]]
name = "arm"
[[sensor]]
name = "front"
link = "arm"
plates = [ { corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] } ]
[[object]]
name = "ball"
shape = { type = "sphere", radius = 0.05, segments = 24 }
translation = [0.01, 0.02, 0.2]
"""
THREADS, POSES = 4, 12


def answers(path: Path) -> list[Any]:
    """Of a scene of its own that moves: capacitances, collisions and what stands where."""
    scene = fringe.Scene.load(str(path))
    found = []
    for step in range(POSES):
        turned = math.radians(5 * step)
        rotation = [
            [math.cos(turned), -math.sin(turned), 0],
            [math.sin(turned), math.cos(turned), 0],
            [0, 0, 1],
        ]
        scene.set_pose("arm", [0, 0, 0.005 * step], rotation)
        found.append([scene.capacitance()["sensors"], scene.collide()])
    return found


def test_every_thread_has_the_answers_of_one_alone(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    alone = answers(path)
    with ThreadPoolExecutor(THREADS) as pool:
        together = list(pool.map(answers, [path] * THREADS))
    assert all(found == alone for found in together)

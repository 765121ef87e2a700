"""Same input, same bits: on one processor or several, and once more."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

from tests import scenes
from tests.programs import ROOT, fringe_command

ARM = ROOT / "geometries" / "scenes" / "x_ray_arm.toml"
# A sphere of so many triangles is evaluated in batches by several threads.
SPHERE = (
    scenes.sensor(
        "front", [[-0.05, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]], [[0.06, -0.05, 0], [0.1, 0, 0], [0, 0.1, 0]]
    )
    + scenes.eye("eye", [0, 0, 0], [0, 0, 1], 40, 0.8)
    + scenes.body("ball", "sphere", radius=0.1, segments=200, translation=[0.01, 0.02, 0.2])
)
PLATES = SPHERE.replace(
    'type = "sphere", radius = 0.1, segments = 200', 'type = "cuboid", size = [0.1, 0.1, 0.05]'
)
# What is asked, in words of the command; a machine of four processors shows more than one of two.
QUESTIONS = {
    "exact": (SPHERE, ["capacitance"]),
    "nearest plates": (SPHERE, ["capacitance", "--method", "exact+nearest"]),
    "facing": (SPHERE, ["capacitance", "--method", "exact+facing"]),
    "with a tolerance": (SPHERE, ["capacitance", "--tolerance", "1e-3"]),
    "split": (SPHERE, ["capacitance", "--method", "split:3"]),
    "formula": (SPHERE, ["capacitance", "--method", "formula"]),
    "boundary elements": (
        PLATES,
        ["capacitance", "--method", "boundary-elements", "--rtol", "1e-3", "--entries"],
    ),
    "reduced": (PLATES, ["capacitance", "--method", "reduced", "--rtol", "1e-3", "--entries"]),
    "collisions": (SPHERE, ["collide"]),
    "distances": (SPHERE, ["sense"]),
}


def answer(words: list[str], scene: Path, processors: set[int]) -> dict[str, Any]:
    """What the command answers on these processors, without the time it took."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, processors)
    try:
        done = fringe_command(*words, scene, "--json")
    finally:
        os.sched_setaffinity(0, before)
    document: dict[str, Any] = json.loads(done.stdout)
    document.pop("seconds", None)
    return document


@pytest.mark.parametrize("question", QUESTIONS)
def test_the_number_of_processors_changes_no_bit(tmp_path: Path, question: str) -> None:
    text, words = QUESTIONS[question]
    (tmp_path / "scene.toml").write_text(text)
    processors = sorted(os.sched_getaffinity(0))
    numbers = [count for count in (1, 2, 4) if count <= len(processors)]
    found = [
        answer(words, tmp_path / "scene.toml", set(processors[:count])) for count in [*numbers, numbers[-1]]
    ]
    assert all(other == found[0] for other in found)


def test_a_whole_arm_is_the_same_twice() -> None:
    """Its parts are evaluated side by side."""
    processors = os.sched_getaffinity(0)
    assert answer(["capacitance"], ARM, processors) == answer(["capacitance"], ARM, processors)

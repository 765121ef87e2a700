"""The truths: the Maxwell matrix of every set-up by boundary elements, kept beside this file.

`python3 -m analysis measure truths corrections` makes `truths.csv` anew, in a minute or two.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from analysis.pipeline.model_stage import model_module
from analysis.results.store import write_text
from analysis.topics.corrections.set_ups import SetUp, set_ups
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical

FILE = Path(__file__).with_name("truths.csv")
RTOL = 1e-4
_COLUMNS = ("name", "mutual", "error", "sensor", "target", "sensor_alone", "target_alone")


@dataclass(frozen=True)
class Truth:
    """Farads: `mutual` with its `error`, the matrix' entries of sensor and target, and what these are without the other."""

    mutual: float
    error: float
    sensor: float
    target: float
    sensor_alone: float
    target_alone: float


def load(file: Path = FILE) -> dict[str, Truth]:
    """Returns the truths by the set-up's name."""
    with file.open(encoding="utf-8", newline="") as lines:
        rows = list(csv.DictReader(lines))
    return {row["name"]: Truth(*(float(row[column]) for column in _COLUMNS[1:])) for row in rows}


def make(file: Path = FILE) -> int:
    """Solves every set-up and writes the file; returns the number of set-ups."""
    module = model_module()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_COLUMNS)
    count = 0
    for count, set_up in enumerate(set_ups(module), start=1):
        truth = solved(module, set_up)
        numbers = [f"{getattr(truth, column):.7g}" for column in _COLUMNS[1:]]
        writer.writerow([set_up.name, *numbers])
    write_text(file, text.getvalue())
    return count


def solved(module: Any, set_up: SetUp) -> Truth:
    both = _maxwell(module, set_up.scene)
    matrix = both["maxwell"]
    alone = both["delta_self"]["sensor"]["value"]
    target = _maxwell(module, replace(set_up.scene, sensors=()))["maxwell"][0, 0]
    return Truth(-matrix[0, 1], both["error"][0, 1], matrix[0, 0], matrix[1, 1], matrix[0, 0] - alone, target)


def _maxwell(module: Any, scene: Scene) -> dict[str, Any]:
    answer: dict[str, Any] = module.Scene.loads(canonical(scene)).maxwell(rtol=RTOL)
    return answer

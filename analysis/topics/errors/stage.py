"""Solves each set-up by boundary elements and splits the model's error into parts; finished set-ups are not computed again."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from analysis.pipeline import model_stage
from analysis.pipeline.set_up_stages import SetUpStages
from analysis.results.answers import Estimate
from analysis.results.set_up import rectangles
from analysis.results.store import Document
from analysis.topics.errors import parts
from analysis.topics.errors.set_ups import SetUp

RTOL = 1e-4
"""Relative accuracy asked of boundary elements: far below the parts, which matter from a per cent on."""
_SOURCES = tuple(f"analysis/topics/errors/{name}" for name in ("paths.py", "parts.py", "stage.py"))
# Expected seconds, the same for all set-ups: the run time cannot be predicted.
_SECONDS = 0.5


def answer(set_up: SetUp, scene: Path) -> Document:
    """Computes the truth with its error, and the parts of the model's error."""
    model = model_stage.model_module()
    plates = rectangles(set_up.scene)
    assert plates is not None
    solved = model.Scene.load(str(scene)).maxwell(rtol=RTOL)
    sensor = set_up.scene.sensors[0].name
    truth = parts.Truth(
        mutual=Estimate(-float(solved["maxwell"][0][1]), float(solved["error"][0][1])),
        delta_self=Estimate(
            float(solved["delta_self"][sensor]["value"]), float(solved["delta_self"][sensor]["error"])
        ),
        target_own=Estimate(float(solved["maxwell"][1][1]), float(solved["error"][1][1])),
    )
    return {
        "reached": bool(solved["reached"]),
        "seconds": float(solved["seconds"]),
        "truth": asdict(truth),
        "split": asdict(parts.split(model, *plates)),
    }


STAGES = SetUpStages[SetUp](
    name="errors",
    what="set-ups taken apart",
    rtol=RTOL,
    sources=(*_SOURCES, "analysis/results/set_up.py"),
    seconds=lambda _: _SECONDS,
    answer=answer,
)

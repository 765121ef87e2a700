"""Compares the model with the stored truths of each set-up of Experiment VIII; finished ones are not computed again."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from analysis.pipeline import model_stage
from analysis.pipeline.set_up_stages import SetUpStages
from analysis.results.store import Document
from analysis.topics.insulators import truths
from analysis.topics.insulators.set_ups import COVER, FILM, HAND, MATTRESS, READING, SENSOR, SetUp
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical

EXACT, REDUCED, IGNORING = "exact", "reduced", "reduced without the layer"
_FORMULA = "formula"
_RTOL = 0.1
"""Relative error asked of the reduced method, which then prepares a set-up in less than a second."""
_SECONDS = 0.3


def answer(set_up: SetUp, _: Path) -> Document:
    """Computes the model's changes (F) of the reading beside the true ones, which are solved only if they are not stored."""
    model = model_stage.model_module()
    true = truths.load().get(set_up.identity) or truths.solved(model, set_up)
    changes = {IGNORING: _change(model, set_up.without)}
    # A dielectric body of the machine takes the reduced method longer to prepare than boundary elements take.
    is_slow = set_up.family == MATTRESS
    changes[REDUCED] = {"refused": "left to boundary elements"} if is_slow else _change(model, set_up.scene)
    layered = set_up.family in (COVER, FILM)
    pairs = _pairs(model, set_up) if layered else {}
    return {"truths": asdict(true), "changes": changes, "pairs": pairs}


def _change(model: Any, scene: Scene) -> Document:
    try:
        reading = model.Scene.loads(canonical(scene)).readings(method=REDUCED, rtol=_RTOL)[READING]
    except ValueError as error:
        return {"refused": str(error)}
    if reading.error["change"] is None:
        return {"refused": "its error is not known"}
    return {"value": float(reading.change), "error": float(reading.error["change"])}


def _pairs(model: Any, set_up: SetUp) -> dict[str, float]:
    """Returns the capacitance (F) of the hand and the sensor by themselves, with the layer, by the integral and by the formula."""
    kept = tuple(body for body in set_up.scene.objects if body.name == HAND or body.conductor == SENSOR)
    loaded = model.Scene.loads(canonical(replace(set_up.scene, objects=kept)))
    answers = {method: loaded.capacitance(**model_stage.options(method)) for method in (EXACT, _FORMULA)}
    return {name: float(each["sensors"][0]["objects"][0]["capacitance"]) for name, each in answers.items()}


STAGES = SetUpStages[SetUp](
    name="insulators",
    what="set-ups with insulators",
    rtol=truths.RTOL,
    sources=tuple(f"analysis/topics/insulators/{name}" for name in ("stage.py", "truths.json")),
    seconds=lambda _: _SECONDS,
    answer=answer,
)

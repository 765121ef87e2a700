"""The true readings of the set-ups of Experiment VIII, by boundary elements: `python3 -m analysis measure truths insulators`, a quarter of an hour."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

from analysis.pipeline import model_stage
from analysis.pipeline.set_up_stages import SetUpStages
from analysis.results.answers import Estimate
from analysis.results.store import Document
from analysis.topics.insulators.set_ups import (
    COVER,
    FILM,
    HAND,
    MATTRESS,
    READING,
    SENSOR,
    SetUp,
    all_set_ups,
)
from analysis.topics.stored import Stored, rounded
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical

RTOL = 5e-2
"""Relative accuracy asked of every entry of the Maxwell matrix and of the reading's change."""
RTOL_OF_LAYERS = 3e-2
"""The same of covers and films, by which the layer rule is measured."""
_DESCRIPTION = (
    "Readings (F) of set-ups with insulators by boundary elements, by the hash of the scene, with stated errors: value without the target, change by "
    "it, and the charge on the hand per volt; with the insulator and without. Made by python3 -m analysis measure truths insulators."
)


@dataclass(frozen=True)
class Truth:
    """The reading without the target, its change by the target, and the charge on the hand per volt; None for an insulating target."""

    background: Estimate
    change: Estimate
    mutual: Estimate | None


@dataclass(frozen=True)
class Truths:
    """A set-up's truth with the insulator and without it."""

    insulated: Truth
    without: Truth


@cache
def load() -> dict[str, Truths]:
    """Returns the records by the identity of their set-up's scene; none without a file."""
    return {identity: read(record) for identity, record in STORED.records().items()}


def solved(model: Any, set_up: SetUp) -> Truths:
    """Solves a set-up with the insulator and without it. `model` is the model's module."""
    rtol = RTOL_OF_LAYERS if set_up.family in (COVER, FILM) else RTOL
    return Truths(_solved(model, set_up.scene, rtol), _solved(model, set_up.without, rtol))


def _solved(model: Any, scene: Scene, rtol: float) -> Truth:
    answer = model.Scene.loads(canonical(scene)).maxwell(rtol=rtol)
    (reading,) = answer["readings"]
    background, change = (
        Estimate(float(reading[key]), float(reading["error"][key])) for key in ("background", "change")
    )
    names = list(answer["conductors"])
    grounded = next((k for k, members in enumerate(answer["members"]) if HAND in members), None)
    if grounded is None:
        return Truth(background, change, None)
    row = names.index(SENSOR)
    entry, error = answer["maxwell"][row][grounded], answer["error"][row][grounded]
    return Truth(background, change, Estimate(-float(entry), float(error)))


def read(record: Document) -> Truths:
    """Reads stored truths."""
    return Truths(*(_truth(record[key]) for key in ("insulated", "without")))


def _truth(record: Document) -> Truth:
    estimates = (
        Estimate(**record[key]) if record[key] else None for key in ("background", "change", "mutual")
    )
    background, change, mutual = estimates
    assert background is not None and change is not None
    return Truth(background, change, mutual)


STORED = Stored[SetUp](
    file=Path(__file__).with_name("truths.json"),
    description=_DESCRIPTION,
    chosen=all_set_ups,
    solve=lambda each: rounded(asdict(solved(model_stage.model_module(), each))),
)


REDUCED, IGNORING = "reduced", "reduced without the layer"


_RTOL = 0.1
"""Relative error asked of the reduced method, which then prepares a set-up in less than a second."""
_SECONDS = 0.3


def answer(set_up: SetUp, _: Path) -> Document:
    """Computes the model's changes (F) of the reading beside the true ones, which are solved only if they are not stored."""
    model = model_stage.model_module()
    true = load().get(set_up.identity) or solved(model, set_up)
    changes = {IGNORING: _change(model, set_up.without)}
    # A dielectric body of the machine takes the reduced method longer to prepare than boundary elements take.
    is_slow = set_up.family == MATTRESS
    changes[REDUCED] = {"refused": "left to boundary elements"} if is_slow else _change(model, set_up.scene)
    return {"truths": asdict(true), "changes": changes}


def _change(model: Any, scene: Scene) -> Document:
    try:
        reading = model.Scene.loads(canonical(scene)).readings(method=REDUCED, rtol=_RTOL)[READING]
    except ValueError as error:
        return {"refused": str(error)}
    if reading.error["change"] is None:
        return {"refused": "its error is not known"}
    return {"value": float(reading.change), "error": float(reading.error["change"])}


STAGES = SetUpStages[SetUp](
    name="insulators",
    what="set-ups with insulators",
    rtol=RTOL,
    sources=tuple(f"analysis/topics/insulators/{name}" for name in ("truths.py", "truths.json")),
    seconds=lambda _: _SECONDS,
    answer=answer,
)

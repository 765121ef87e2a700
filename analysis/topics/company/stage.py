"""Computes the reading of each set-up by boundary elements, and the model's change of it; finished set-ups are not computed again."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter

from analysis.pipeline import model_stage
from analysis.pipeline.set_up_stages import SetUpStages
from analysis.results.store import Document
from analysis.results.commands import COMPARED_METHOD
from analysis.topics.company.set_ups import GUARD, SENSOR, SetUp
from geometries.studies.families import GROUNDED

RTOL = 1e-3
"""Relative accuracy asked of the reading's value, background and change."""
# Expected seconds with a guard, whose edge is close to the sensor's and the housing, and without.
_SECONDS_GUARDED, _SECONDS = 2.0, 0.2


def answer(set_up: SetUp, scene: Path) -> Document:
    """Computes value, background and change (F) with their errors; and `model`, the model's change, which knows only grounded hands."""
    model = model_stage.model_module()
    before = perf_counter()
    reading = model.Scene.load(str(scene)).readings("boundary-elements", rtol=RTOL)[SENSOR]
    seconds = perf_counter() - before
    quantities = {
        name: {"value": float(getattr(reading, name)), "error": float(reading.error[name])}
        for name in ("value", "background", "change")
    }
    grounded = set_up.ground == GROUNDED
    by_model = model.Scene.load(str(scene)).readings(COMPARED_METHOD)[SENSOR] if grounded else None
    return {"seconds": seconds, **quantities, "model": float(by_model.change) if by_model else None}


STAGES = SetUpStages[SetUp](
    name="company",
    what="set-ups in company",
    rtol=RTOL,
    sources=("analysis/topics/company/stage.py",),
    seconds=lambda set_up: _SECONDS_GUARDED if set_up.machine == GUARD else _SECONDS,
    answer=answer,
)

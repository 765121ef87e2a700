"""`python3 -m analysis.topics.company.potential_table`: errors of the change of the reading in company, by every candidate of a formula."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from analysis.pipeline.model_stage import model_module
from analysis.topics.company.potential_formulas import CANDIDATES, MachineAtRest, company
from analysis.topics.company.set_ups import HAND, SENSOR, SetUp, all_set_ups
from geometries.common.children import temporary_folder
from geometries.scene.readings import readings, targets
from geometries.studies.families import GROUNDED

_RTOL = 3e-3
"""Relative accuracy of the truth, a tenth of the least error in the table."""
_PERCENT = 100.0


def errors(module: Any, set_ups: Iterable[SetUp]) -> dict[str, list[float]]:
    """Returns (change − truth)/truth in every set-up by the plain model, the formula and every candidate. Truth: boundary elements."""
    found: dict[str, list[float]] = {}
    with temporary_folder() as folder:
        path = folder / "scene.toml"
        for set_up in set_ups:
            path.write_text(set_up.text, encoding="utf-8")
            scene = module.Scene.load(path)
            truth = scene.readings("boundary-elements", rtol=_RTOL)[SENSOR].change
            changes = {
                "plain model": scene.readings()[SENSOR].change,
                "formula": scene.readings(correction="formula")[SENSOR].change,
                **candidates(set_up),
            }
            for name, change in changes.items():
                found.setdefault(name, []).append(change / truth - 1)
    return found


def candidates(set_up: SetUp) -> dict[str, float]:
    """Returns the change of the reading (F) by every candidate. Raises ValueError unless the hand is grounded."""
    scene = set_up.scene
    marked = zip(scene.objects, targets(scene))
    made = replace(scene, objects=tuple(replace(body, target=is_target) for body, is_target in marked))
    (reading,) = readings(scene)
    given = company(made, MachineAtRest(made), HAND, reading)
    return {name: candidate(given) for name, candidate in CANDIDATES.items()}


def table(found: dict[str, list[float]]) -> str:
    """Writes the table of model/CORRECTIONS.md: root mean square and largest error, in %."""
    rows = ["| change by | rms | worst |", "|---|---|---|"]
    for name, values in found.items():
        relative = _PERCENT * np.abs(values)
        rows.append(f"| {name} | {np.sqrt(np.mean(relative**2)):.3g} | {relative.max():.3g} |")
    return "\n".join(rows)


if __name__ == "__main__":
    print(table(errors(model_module(), [each for each in all_set_ups() if each.ground == GROUNDED])))

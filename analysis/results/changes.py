"""Tells which cases are in company: where the change of a reading is a quantity of its own, and before which machine."""

from __future__ import annotations

from analysis.results.study_results import CaseResult
from geometries.scene.readings import targets
from geometries.scene.scene import Scene
from geometries.studies.machines import NONE

OWN_MACHINE = "machine of the scene"
"""The machine of a scene that is not of a family."""


def is_delta_self(scene: Scene) -> bool:
    """Tells whether the change of each sensor's reading is its delta_self: nothing stays but sensors, each driven by itself."""
    return not scene.readings and all(targets(scene))


def machine_of(case: CaseResult) -> str:
    """Returns the name of the machine of a case, "none" if it has none."""
    if is_delta_self(case.scene):
        return NONE
    return str(case.parameters.get("machine", OWN_MACHINE))

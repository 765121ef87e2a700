"""Synthetic answers: a results folder as `run` leaves it, without solving anything."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

from analysis.results import store, study_results as results
from analysis.results.study_results import Failure
from analysis.study import report
from geometries.scene.writer import canonical
from geometries.studies import families, study
from tests import scenes
from tests.analysis.documents import PICO, empty_document, model_document, reference_document
from tests.scenes import HEAD

PARALLEL = scenes.sweep("parallel", gap=[0.01, 0.02, 0.04])
ONE_CASE = scenes.sweep("parallel", gap=0.02)
EDGE = scenes.sweep("edge", gap=[0.01, 0.02], height=0)
MACHINES = scenes.sweep("parallel", gap=0.02, machine=["none", "housing", "housing+guard"]) + scenes.sweep(
    "parallel", gap=0.02, material="floating", to_ground=1e-10, machine="housing"
)


def enclosed(document: dict[str, Any], below: float, above: float) -> dict[str, Any]:
    """The same answer with a proven interval: each entry of the matrix is between so much below and above, in pF."""
    ends = {
        name: [[value + side * PICO for value in row] for row in document["maxwell"]]
        for name, side in (("lower", -below), ("upper", above))
    }
    return document | ends | {"error_kind": "enclosure"}


def readings_document(change: float, error: float = 0.01) -> list[dict[str, Any]]:
    """One reading, the sensor's, in pF: its background is 9 pF."""
    parts = {"value": 9 + change, "background": 9.0, "change": change}
    return [
        {
            "name": "sensor",
            **{part: value * PICO for part, value in parts.items()},
            "error": {part: error * PICO for part in parts},
            "answered_by": "made up",
        }
    ]


def machine_document(mutual: float, change: float, error: float = 0.01) -> dict[str, Any]:
    """The reference's answer for sensor and target before a grounded housing, in pF."""
    names = ("sensor", "target", "housing")
    matrix = [[9 + change, -mutual, -5.0], [-mutual, 6.0, -1.0], [-5.0, -1.0, 20.0]]
    return reference_document(mutual, 5 + change, error) | {
        "conductors": list(names),
        "maxwell": [[value * PICO for value in row] for row in matrix],
        "error": [[error * PICO] * 3] * 3,
        "levels": [],
        "readings": readings_document(change, error),
    }


def machine_model_document(target: float, change: float | None) -> dict[str, Any]:
    """The model's answer for the same in pF: 30 pF for the housing, and the change that it gives, if it knows one."""
    document = model_document(target)
    for method in document["methods"].values():
        (sensor,) = method["sensors"]
        sensor["objects"].append({"name": "housing", "capacitance": 30 * PICO})
        sensor["total"] += 30 * PICO
        method["readings"] = [{"name": "sensor", "change": None if change is None else change * PICO}]
    return document


MACHINE_ANSWERS: dict[int, tuple[dict[str, Any] | None, dict[str, Any] | None]] = {
    0: (reference_document(2, 1), model_document(1.8)),
    1: (machine_document(1.6, 0.8), machine_model_document(1.8, 1.8)),
    2: (machine_document(1.7, 0.9), machine_model_document(1.8, None)),
    3: (machine_document(1.7, 0.1), None),
}
"""Answers of MACHINES: the model gives 1.8 pF, but no change where the guard is driven, and nothing for a floating target."""


def corrections_document() -> dict[str, Any]:
    """The document of the corrections: three methods in two sealed set-ups, which leave the formula 1 % and -6 % off."""
    errors = {"count": 9, "rms": 0.02, "median": 0.01, "percentile_95": 0.04, "worst": 0.07}
    entries = [
        {
            "name": name,
            "all": errors,
            "open": errors,
            "sealed": {**errors, "rms": rms},
            "families": {"parallel": errors},
        }
        for name, rms in (("exact", 0.5), ("formula", 0.021), ("reduced", 0.001))
    ]
    return {
        "key": "",
        "truths": "truths.csv",
        "set_ups": 9,
        "sealed": 3,
        "corrections": entries,
        "nanoseconds": {"plate": {"exact": 100.0, "formula": 220.0, "reduced": 900.0}},
        "cases": [_corrected("parallel-000", 0.01), _corrected("parallel-001", -0.06)],
    }


def _corrected(name: str, error: float) -> dict[str, Any]:
    """A set-up in which the formula is off by so much."""
    return {
        "name": name,
        "family": "parallel",
        "sealed": True,
        "distance": 0.02,
        "sensor_size": 0.1,
        "truth": PICO,
        "error": 1e-4 * PICO,
        "estimates": {"exact": 0.5 * PICO, "formula": (1 + error) * PICO, "reduced": PICO},
        "scene": canonical(families.parallel((0.1, 0.1), (0.1, 0.1), 0.02)),
    }


def make_results(
    folder: Path,
    sweeps: str = PARALLEL + EDGE,
    answers: dict[int, tuple[dict[str, Any] | None, dict[str, Any] | None]] | None = None,
    failures: list[Failure] | None = None,
    experiment: str = "",
    reference_method: str = study.BOTH,
    boundary: dict[int, dict[str, Any]] | None = None,
) -> Path:
    """A folder of results; `answers` holds (reference, model) by the number of the case, `boundary` the documents of boundary elements.

    `experiment` is the one that the study names, if any. Cases without given answers have mutual 2 pF, delta_self 1 pF, and a
    model value of 1.8 pF.
    """
    named = f'experiment = "{experiment}"\n' if experiment else ""
    chosen = replace(study.loads(named + HEAD + sweeps), reference_method=reference_method)
    for number, case in enumerate(chosen.cases()):
        place = results.case_folder(folder, case.id)
        store.write_text(place / results.SCENE, canonical(case.scene))
        if case.family == study.EMPTY:
            store.write_json(place / results.REFERENCE, empty_document())
            continue
        reference, model = (answers or {}).get(number, (reference_document(2, 1), model_document(1.8)))
        if reference is not None:
            store.write_json(place / results.REFERENCE, reference)
        if boundary is not None and number in boundary:
            store.write_json(place / results.BOUNDARY, boundary[number])
        if model is not None:
            store.write_json(place / results.MODEL, model)
    results.write_manifest(folder, chosen, failures or [])
    return folder


def report_text(folder: Path) -> str:
    """The report of a folder of results and its pages on questions, without their scripts."""
    path = report.make(folder).path
    pages = [path, *sorted((path.parent / report.PAGES).glob("*.html"))]
    whole = "\n".join(page.read_text() for page in pages)
    return re.sub(r"<script.*?</script>", "", whole, flags=re.DOTALL)


def data_of(page: Path, name: str = "data") -> Any:
    """The data that a page's script draws."""
    (found,) = re.findall(
        rf'<script type="application/json" id="{name}">(.*?)</script>', page.read_text(), re.DOTALL
    )
    return json.loads(found)

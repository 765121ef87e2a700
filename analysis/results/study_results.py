"""The folder of a study's results: what was asked (`study.json`) and the answers there are (`cases/<id>/`), with the commands, from the repository's
folder, that compute them anew."""

from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from analysis.results import machine, units
from analysis.results.answers import MatrixAnswer, ModelAnswer
from analysis.results.set_up import SetUp, describe
from analysis.results.store import Document, read_json, write_json
from analysis.results.truth import Truth
from geometries.common import installation
from geometries.common.errors import InputError
from geometries.scene import reader
from geometries.scene.scene import Scene
from geometries.studies.study import BOTH, BOUNDARY_ELEMENTS, EMPTY, FIELD, Case, Parameter, Study, empty_case

MANIFEST = "study.json"
SCENE, REFERENCE, MODEL, SLICE = "scene.toml", "fem.json", "model.json", "slice.json"
BOUNDARY = "boundary.json"
RUN_TIMES, STABILITY = "run_times.json", "stability.json"
COLLISION = ("collision_answers.json", "collision_times.json", "collision_scenes.json")


@dataclass(frozen=True)
class Failure:
    """A stage without an answer, and why. `case` is empty for measurements of the model by itself; `refused` tells whether the stage
    knows at once that it cannot answer such a case."""

    case: str
    stage: str
    reason: str
    refused: bool = False


@dataclass(frozen=True, eq=False)
class CaseResult:
    """One case with the answers that exist, of those methods that the study asks. `name` tells it in words,
    `reference` is the field solver's; `empty` is the id of the case without objects; `refused` says why there
    is no `boundary`, where boundary elements were asked; `by_field` tells whether the field solver was."""

    id: str
    name: str
    family: str
    parameters: dict[str, Parameter]
    empty: str
    folder: Path
    scene: Scene
    reference: MatrixAnswer | None
    model: ModelAnswer | None
    slice: Document | None
    boundary: MatrixAnswer | None
    refused: str
    by_field: bool = True

    @cached_property
    def truth(self) -> Truth | None:
        """The best of both references; None where neither has answered."""
        answered = self.reference is not None or self.boundary is not None
        return Truth(self.reference, self.boundary) if answered else None

    @cached_property
    def set_up(self) -> SetUp | None:
        return describe(self.scene)


@dataclass(frozen=True, eq=False)
class Results:
    """All of a study's results. `experiment` is that of the study, or empty."""

    folder: Path
    title: str
    experiment: str
    rtol: float
    max_seconds: float
    error: str
    reference_method: str
    methods: tuple[str, ...]
    machine: dict[str, str]
    failures: tuple[Failure, ...]
    cases: dict[str, CaseResult]

    def compared(self) -> list[CaseResult]:
        """Returns the cases with objects, in the study's order."""
        return [case for case in self.cases.values() if case.family != EMPTY]


def case_folder(results: Path, case: str) -> Path:
    return results / "cases" / case


def asked(study: Study) -> Document:
    """Returns what the study asks of the methods, as it is stored."""
    names = ("rtol", "max_seconds", "error", "reference_method")
    return {name: getattr(study, name) for name in names} | {"methods": list(study.methods)}


def write_manifest(folder: Path, study: Study, failures: list[Failure]) -> None:
    """Writes what the study asked and which cases failed. An identical file is not written again."""
    document: Document = {
        "format": 1,
        **{name: getattr(study, name) for name in ("name", "title", "experiment")},
        **asked(study),
        "machine": machine.description(),
        "failures": [asdict(failure) for failure in failures],
        "cases": [_case_document(case) for case in study.cases()],
    }
    if read_json(folder / MANIFEST) != document:
        write_json(folder / MANIFEST, document)


def load(folder: Path) -> Results:
    """Returns the results in a folder; InputError when it holds none."""
    manifest = read_json(folder / MANIFEST)
    if manifest is None:
        raise InputError(str(folder), "", f"holds no results: there is no {MANIFEST}")
    parameters: list[dict[str, Parameter]] = [
        {name: (value[0], value[1]) if isinstance(value, list) else value for name, value in stored.items()}
        for stored in (document["parameters"] for document in manifest["cases"])
    ]
    families = [document["family"] for document in manifest["cases"]]
    called = units.of_cases(list(zip(families, parameters)))
    reference_method = manifest.get("reference_method", BOTH)
    return Results(
        folder=folder,
        experiment=manifest.get("experiment", ""),
        reference_method=reference_method,
        methods=tuple(manifest["methods"]),
        **{name: manifest[name] for name in ("title", "rtol", "max_seconds", "error", "machine")},
        failures=tuple(Failure(**failure) for failure in manifest["failures"]),
        cases={
            document["id"]: _case_result(folder, document, name, own, reference_method)
            for document, name, own in zip(manifest["cases"], called, parameters)
        },
    )


def title(folder: Path) -> str:
    """Returns the title of the study whose results are in a folder."""
    return str((read_json(folder / MANIFEST) or {})["title"])


def _case_document(case: Case) -> Document:
    own: dict[str, Any] = {name: each for name, each in case.parameters.items()}
    lists = {name: list(value) for name, value in own.items() if isinstance(value, tuple)}
    document: Document = {"id": case.id, "family": case.family, "parameters": own | lists}
    document["empty"] = empty_case(case).id
    return document if case.alone is None else document | {"by_field": False}


def _case_result(
    results: Path, document: Document, name: str, parameters: dict[str, Parameter], reference_method: str
) -> CaseResult:
    folder = case_folder(results, document["id"])
    model = read_json(folder / MODEL)
    # Answers of a method that the study no longer asks may still be there.
    by_field = reference_method != BOUNDARY_ELEMENTS and document.get("by_field", True)
    reference = read_json(folder / REFERENCE) if by_field else None
    boundary = (read_json(folder / BOUNDARY) or {}) if reference_method != FIELD else {}
    return CaseResult(
        **{part: document[part] for part in ("id", "family", "empty")},
        name=name,
        parameters=parameters,
        folder=folder,
        scene=reader.load(folder / SCENE),
        reference=MatrixAnswer.of(reference) if reference else None,
        model=ModelAnswer.of(model) if model else None,
        slice=read_json(folder / SLICE),
        boundary=MatrixAnswer.of(boundary) if "maxwell" in boundary else None,
        refused=boundary.get("refused", ""),
        by_field=by_field,
    )


COMPARED_METHOD = "exact"
"""The method of the model that reports compare with the reference."""
STATED_RTOLS = {"reduced": 1e-2, "auto": 1e-2, "boundary-elements": 1e-3}
"""The accuracy asked of the methods of a study that state errors, also of every entry in the rows of the sensors."""


def reference_command(results: Results, case: str) -> str:
    """Returns the command that computes the field solver's answer for a case."""
    asked = f"--rtol {results.rtol:g} --max-seconds {results.max_seconds:g} --error {results.error}"
    return f"{installation.command('fem_reference')} {_scene(results, case)} {asked}"


def boundary_command(results: Results, case: str) -> str:
    """Returns the command that computes the answer by boundary elements for a case that has one."""
    answer = results.cases[case].boundary
    assert answer is not None
    return f"{_command(results, case, 'boundary-elements')} --rtol {answer.rtol:g} --entries"


def model_command(results: Results, case: str, method: str = COMPARED_METHOD) -> str:
    """Returns the command that computes the model's answer for a case."""
    rtol = STATED_RTOLS.get(method)
    return _command(results, case, method) + (f" --rtol {rtol:g} --entries" if rtol else "")


def _command(results: Results, case: str, method: str) -> str:
    return f"{installation.model_command()} capacitance {_scene(results, case)} --method {method}"


def _scene(results: Results, case: str) -> str:
    return installation.from_repository(results.folder / "cases" / case / SCENE)

"""The commands, from the repository's folder, that compute the answers of a case anew."""

from __future__ import annotations

from analysis.results.study_results import SCENE, Results
from geometries.common import installation
from geometries.common.installation import from_repository

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
    return from_repository(results.folder / "cases" / case / SCENE)

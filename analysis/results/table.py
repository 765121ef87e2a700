"""`table.csv`: one row for each case, sensor, object and quantity.

| column | what it is |
|---|---|
| case, family, parameters | the case's folder, its family, the family's parameters as JSON (metres, degrees) |
| sensor, object | names; `object` is empty for delta_self, which belongs to all objects together |
| quantity | mutual = −M[s,o], or delta_self = M[s,s] − M0[s,s] with M0 from the scene without objects |
| gap_over_size | shortest distance between the plates over the sensor's size (a size is the square root of an area) |
| tilt_degrees | angle between the planes, 0 … 90 |
| lateral_offset_over_size | distance of the centres along the sensor's plane over the sensor's size |
| size_ratio | target's size over the sensor's |
| reference_F, reference_error_F | the reference's value and the half-width of its interval |
| reached | whether the reference reached the asked accuracy |
| check_F, check_error_F | delta_self once more, as the difference of two separate solves |
| model_error | (exact model − reference)/reference |
| model_error_low, model_error_high | the same for the ends of the reference's interval (ASME V&V 20: the comparison error, with the numerical uncertainty kept apart) |
| reference_seconds, reference_unknowns | run time and unknowns of the reference |
| model_METHOD_F, model_METHOD_seconds | the model's value for each method (for delta_self the sum over the objects) and its time |
| command | recomputes the reference's answer |
"""

from __future__ import annotations

import csv
import io
import json
import math
from dataclasses import dataclass

from analysis.results.answers import Estimate, ModelValue, ReferenceAnswer
from analysis.results.set_up import SetUp
from analysis.results.study_results import SCENE, CaseResult, Results
from geometries.common import installation
from geometries.common.installation import from_repository

TABLE = "table.csv"
MUTUAL, DELTA_SELF = "mutual", "delta_self"
QUANTITIES = (MUTUAL, DELTA_SELF)
COMPARED_METHOD = "exact"


@dataclass(frozen=True)
class Row:
    """One comparison; farads, seconds, relative errors."""

    case: CaseResult
    sensor: str
    object: str
    quantity: str
    set_up: SetUp | None
    reference: Estimate
    check: Estimate | None
    reached: bool
    reference_seconds: float
    reference_unknowns: int
    model: dict[str, float]
    model_seconds: dict[str, float]
    command: str

    @property
    def model_error(self) -> float:
        return relative_error(self.model[COMPARED_METHOD], self.reference.value)

    @property
    def model_error_interval(self) -> tuple[float, float]:
        """The model error at the two ends of the reference's interval: the reference's own error, carried over."""
        return error_interval(self.model[COMPARED_METHOD], self.reference)

    @property
    def reference_error(self) -> float:
        """The half-width of the reference's interval over its value."""
        return self.reference.error / abs(self.reference.value)


def relative_error(model: float, reference: float) -> float:
    """Returns (model − reference)/reference."""
    return (model - reference) / reference


def error_interval(model: float, reference: Estimate) -> tuple[float, float]:
    """Returns the least and the greatest relative error for a true value anywhere in the reference's interval.

    The upper end is infinite when the interval reaches zero.
    """
    low = relative_error(model, reference.value + reference.error)
    least = reference.value - reference.error
    return low, relative_error(model, least) if least > 0 else math.inf


def rows(results: Results) -> list[Row]:
    """Returns a row for each case that has both answers, sensor, object and quantity, in the study's order."""
    found = []
    for case in results.compared():
        if case.reference is not None and case.model is not None:
            for sensor in case.scene.sensors:
                found += _rows_of_sensor(results, case, case.reference, sensor.name)
    return found


def _rows_of_sensor(results: Results, case: CaseResult, reference: ReferenceAnswer, sensor: str) -> list[Row]:
    assert case.model is not None
    values = {method: sensors[sensor] for method, sensors in case.model.values.items()}
    found = [
        _row(
            results,
            case,
            reference,
            (sensor, body, MUTUAL),
            reference.mutual(sensor, body),
            None,
            {method: value.objects[body] for method, value in values.items()},
            values,
        )
        for body in reference.conductors[len(case.scene.sensors) :]
    ]
    if sensor in reference.delta_self:
        totals = {method: value.total for method, value in values.items()}
        check = _difference(reference, results.cases.get(case.empty), sensor)
        change = reference.delta_self[sensor]
        found.append(_row(results, case, reference, (sensor, "", DELTA_SELF), change, check, totals, values))
    return found


def _row(
    results: Results,
    case: CaseResult,
    reference: ReferenceAnswer,
    subject: tuple[str, str, str],
    value: Estimate,
    check: Estimate | None,
    model: dict[str, float],
    values: dict[str, ModelValue],
) -> Row:
    sensor, body, quantity = subject
    return Row(
        case=case,
        sensor=sensor,
        object=body,
        quantity=quantity,
        set_up=case.set_up,
        reference=value,
        check=check,
        reached=reference.reached,
        reference_seconds=reference.seconds,
        reference_unknowns=reference.unknowns,
        model=model,
        model_seconds={method: answer.seconds for method, answer in values.items()},
        command=reference_command(results, case.id),
    )


def _difference(reference: ReferenceAnswer, empty: CaseResult | None, sensor: str) -> Estimate | None:
    """Returns M[s,s] − M0[s,s] from two separate solves, with the sum of their errors."""
    if empty is None or empty.reference is None:
        return None
    whole, alone = reference.self_capacitance(sensor), empty.reference.self_capacitance(sensor)
    return Estimate(whole.value - alone.value, whole.error + alone.error)


def reference_command(results: Results, case: str) -> str:
    """Returns the command, from the repository's folder, that computes the reference's answer for a case."""
    scene = from_repository(results.folder / "cases" / case / SCENE)
    asked = f"--rtol {results.rtol:g} --max-seconds {results.max_seconds:g} --error {results.error}"
    return f"{installation.command('fem_reference')} {scene} {asked}"


def model_command(results: Results, case: str, method: str = COMPARED_METHOD) -> str:
    """Returns the command, from the repository's folder, that computes the model's answer for a case."""
    scene = from_repository(results.folder / "cases" / case / SCENE)
    return f"{installation.model_command()} capacitance {scene} --method {method}"


def to_csv(found: list[Row], methods: tuple[str, ...]) -> str:
    """Returns the rows as CSV text with a header; numbers in full."""
    text = io.StringIO()
    records = [_record(row, methods) for row in found]
    header = list(records[0]) if records else ["case"]
    writer = csv.DictWriter(text, header, lineterminator="\n")
    writer.writeheader()
    writer.writerows(records)
    return text.getvalue()


def _record(row: Row, methods: tuple[str, ...]) -> dict[str, object]:
    low, high = row.model_error_interval
    record: dict[str, object] = {
        "case": row.case.id,
        "family": row.case.family,
        "parameters": json.dumps(row.case.parameters),
        "sensor": row.sensor,
        "object": row.object,
        "quantity": row.quantity,
        "gap_over_size": row.set_up.gap_over_size if row.set_up else "",
        "tilt_degrees": row.set_up.tilt_degrees if row.set_up else "",
        "lateral_offset_over_size": row.set_up.lateral_offset_over_size if row.set_up else "",
        "size_ratio": row.set_up.size_ratio if row.set_up else "",
        "reference_F": row.reference.value,
        "reference_error_F": row.reference.error,
        "reached": row.reached,
        "check_F": row.check.value if row.check else "",
        "check_error_F": row.check.error if row.check else "",
        "model_error": row.model_error,
        "model_error_low": low,
        "model_error_high": high,
        "reference_seconds": row.reference_seconds,
        "reference_unknowns": row.reference_unknowns,
    }
    for method in methods:
        record[f"model_{method}_F"] = row.model[method]
        record[f"model_{method}_seconds"] = row.model_seconds[method]
    return record | {"command": row.command}

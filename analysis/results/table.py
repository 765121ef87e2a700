"""`table.csv`: one row for each case and quantity, of a sensor and an object, of a sensor, or of a reading.

Where nothing stays but sensors and each is driven by itself, the change of a sensor's reading is its delta_self: the row of
delta_self stands for both. Else there is a row of change for every reading in place of delta_self, and rows of mutual only for
the targets. The columns of the model are empty where it knows no value, as of a target that floats.

| column | what it is |
|---|---|
| case, family, parameters | the case's folder, its family, the family's parameters as JSON (metres, degrees) |
| sensor, object | names; `sensor` is what is sensed, `object` is given for mutual only |
| quantity | mutual = −M[s,o], delta_self = M[s,s] − M0[s,s] with M0 from the scene without objects, or change: a reading with the targets less that without them |
| reading | name of the reading, for change only |
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
| model_METHOD_F, model_METHOD_seconds | the model's value for each method (for delta_self the sum over the objects, for change over the targets) and its time |
| command | recomputes the reference's answer |
"""

from __future__ import annotations

import csv
import io
import json
import math
from dataclasses import dataclass

from analysis.results import changes
from analysis.results.answers import Estimate, ModelAnswer, ReferenceAnswer
from analysis.results.set_up import SetUp
from analysis.results.study_results import SCENE, CaseResult, Results
from geometries.common import installation
from geometries.common.installation import from_repository
from geometries.scene.readings import readings, targets
from geometries.scene.scene import Scene
from geometries.studies.machines import NONE

TABLE = "table.csv"
MUTUAL, DELTA_SELF, CHANGE = "mutual", "delta_self", "change"
QUANTITIES = (MUTUAL, DELTA_SELF, CHANGE)
COMPARED_METHOD = "exact"


@dataclass(frozen=True)
class Row:
    """One comparison; farads, seconds, relative errors. Where the model knows no value, `model` is empty and there is no error."""

    case: CaseResult
    sensor: str
    object: str
    reading: str
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
    def is_compared(self) -> bool:
        """Whether the model knows a value."""
        return COMPARED_METHOD in self.model

    @property
    def machine(self) -> str:
        """The name of the machine that sensor and targets are before."""
        return changes.machine_of(self.case)

    @property
    def is_change(self) -> bool:
        """Whether the value is the change of a reading, as delta_self is where there is no machine."""
        return self.quantity == CHANGE or (self.quantity == DELTA_SELF and self.machine == NONE)

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
    """Returns the rows of each case, in the study's order.

    Rows of mutual and delta_self need both answers, rows of change the reference's alone.
    """
    found = []
    for case in results.compared():
        if case.reference is not None:
            found += _rows_of_case(results, case, case.reference)
    return found


def compared(found: list[Row]) -> list[Row]:
    """Returns the rows that the model has a value of."""
    return [row for row in found if row.is_compared]


def _rows_of_case(results: Results, case: CaseResult, reference: ReferenceAnswer) -> list[Row]:
    # Answers of earlier versions have no readings.
    if changes.is_delta_self(case.scene) or not reference.readings:
        bodies = list(reference.conductors[len(case.scene.sensors) :])
        felt = reference.delta_self
    else:
        bodies, felt = _targets(case.scene), {}
    found = []
    if case.model is not None:
        for sensor in (sensor.name for sensor in case.scene.sensors):
            found += _mutual(results, case, reference, case.model, sensor, bodies)
            if sensor in felt:
                found.append(_delta_self(results, case, reference, case.model, sensor))
    return found if felt else found + _changes(results, case, reference)


def _mutual(
    results: Results,
    case: CaseResult,
    reference: ReferenceAnswer,
    model: ModelAnswer,
    sensor: str,
    bodies: list[str],
) -> list[Row]:
    return [
        _row(
            results,
            case,
            reference,
            (sensor, body, "", MUTUAL),
            reference.mutual(sensor, body),
            {method: sensors[sensor].objects[body] for method, sensors in model.values.items()},
        )
        for body in bodies
        if body in reference.conductors and body in model.values[COMPARED_METHOD][sensor].objects
    ]


def _delta_self(
    results: Results, case: CaseResult, reference: ReferenceAnswer, model: ModelAnswer, sensor: str
) -> Row:
    totals = {method: sensors[sensor].total for method, sensors in model.values.items()}
    check = _difference(reference, results.cases.get(case.empty), sensor)
    subject = (sensor, "", "", DELTA_SELF)
    return _row(results, case, reference, subject, reference.delta_self[sensor], totals, check)


def _changes(results: Results, case: CaseResult, reference: ReferenceAnswer) -> list[Row]:
    by_model = case.model.changes if case.model is not None else {}
    return [
        _row(
            results,
            case,
            reference,
            (reading.sense, "", reading.name, CHANGE),
            reference.readings[reading.name].change,
            {method: known[reading.name] for method, known in by_model.items() if reading.name in known},
        )
        for reading in readings(case.scene)
        if reading.name in reference.readings
    ]


def _targets(scene: Scene) -> list[str]:
    """Returns the names of the objects that come and go."""
    return [body.name for body, target in zip(scene.objects, targets(scene)) if target]


def _row(
    results: Results,
    case: CaseResult,
    reference: ReferenceAnswer,
    subject: tuple[str, str, str, str],
    value: Estimate,
    model: dict[str, float],
    check: Estimate | None = None,
) -> Row:
    """Makes the row of a sensor, an object, a reading and a quantity, by their names."""
    sensor, body, reading, quantity = subject
    values = case.model.values if case.model is not None else {}
    seconds = {method: next(iter(sensors.values())).seconds for method, sensors in values.items()}
    return Row(
        case=case,
        sensor=sensor,
        object=body,
        reading=reading,
        quantity=quantity,
        set_up=case.set_up,
        reference=value,
        check=check,
        reached=reference.reached,
        reference_seconds=reference.seconds,
        reference_unknowns=reference.unknowns,
        model=model,
        model_seconds={method: seconds[method] for method in model},
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
    low, high = row.model_error_interval if row.is_compared else ("", "")
    record: dict[str, object] = {
        "case": row.case.id,
        "family": row.case.family,
        "parameters": json.dumps(row.case.parameters),
        "sensor": row.sensor,
        "object": row.object,
        "quantity": row.quantity,
        "reading": row.reading,
        "gap_over_size": row.set_up.gap_over_size if row.set_up else "",
        "tilt_degrees": row.set_up.tilt_degrees if row.set_up else "",
        "lateral_offset_over_size": row.set_up.lateral_offset_over_size if row.set_up else "",
        "size_ratio": row.set_up.size_ratio if row.set_up else "",
        "reference_F": row.reference.value,
        "reference_error_F": row.reference.error,
        "reached": row.reached,
        "check_F": row.check.value if row.check else "",
        "check_error_F": row.check.error if row.check else "",
        "model_error": row.model_error if row.is_compared else "",
        "model_error_low": low,
        "model_error_high": high,
        "reference_seconds": row.reference_seconds,
        "reference_unknowns": row.reference_unknowns,
    }
    for method in methods:
        record[f"model_{method}_F"] = row.model.get(method, "")
        record[f"model_{method}_seconds"] = row.model_seconds.get(method, "")
    return record | {"command": row.command}

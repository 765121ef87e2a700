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
| reference_F, reference_error_F | the best truth at hand, by the method that states less error, and the half-width of its interval |
| answered_by | that method: field solver, or boundary elements |
| reference_error_kind | proven, if the interval is proven to hold the true value, or estimated |
| field_F, field_error_F, field_error_kind | the field solver's value, whether or not it is the best |
| boundary_F, boundary_error_F | the value of boundary elements, whose errors are estimates |
| reached | whether a method reached the asked accuracy in this case, or the error of this value is within it |
| check_F, check_error_F | delta_self once more, as the difference of two separate solves, by the field solver if it answered |
| model_error | (exact model − reference)/reference |
| model_error_low, model_error_high | the same for the ends of the reference's interval (ASME V&V 20: the comparison error, with the numerical uncertainty kept apart) |
| reference_seconds, reference_unknowns | run time and unknowns of the method that answered |
| field_seconds | run time of the field solver |
| model_METHOD_F, model_METHOD_seconds | the model's value for each method (for delta_self the sum over the objects, for change over the targets) and its time |
| model_METHOD_error_F, model_METHOD_answered_by | for methods that state errors: the error, and which method answered, as `auto` chooses one |
| command | recomputes the answer that is used |
"""

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from analysis.results import study_results
from analysis.results.answers import Estimate, ModelChange
from analysis.results.set_up import SetUp, is_delta_self
from analysis.results.store import csv_text
from analysis.results.truth import BOUNDARY, ESTIMATED, FIELD, PROVEN, Known, Truth
from analysis.results.study_results import COMPARED_METHOD, CaseResult, Results
from geometries.scene.readings import readings, targets
from geometries.studies.machines import NONE

TABLE = "table.csv"
MUTUAL, DELTA_SELF, CHANGE = "mutual", "delta_self", "change"
QUANTITIES = (MUTUAL, DELTA_SELF, CHANGE)
OWN_MACHINE = "machine of the scene"
"""The machine of a scene that is not of a family."""


def machine_of(case: CaseResult) -> str:
    """Returns the name of the machine of a case, "none" if it has none."""
    return NONE if is_delta_self(case.scene) else str(case.parameters.get("machine", OWN_MACHINE))


@dataclass(frozen=True)
class Row:
    """One comparison; farads, seconds, relative errors. Where the model knows no value, `model` is empty and there is no error.
    `model_errors` are those that methods of the model state themselves."""

    case: CaseResult
    sensor: str
    object: str
    reading: str
    quantity: str
    set_up: SetUp | None
    known: Known
    check: Estimate | None
    reached: bool
    reference_seconds: float
    reference_unknowns: int
    model: dict[str, float]
    model_errors: dict[str, float]
    model_answered_by: dict[str, str]
    model_seconds: dict[str, float]
    command: str

    @property
    def reference(self) -> Estimate:
        """The best truth at hand."""
        return self.known.best

    @property
    def is_compared(self) -> bool:
        """Whether the model knows a value."""
        return COMPARED_METHOD in self.model

    @property
    def machine(self) -> str:
        """The name of the machine that sensor and targets are before."""
        return machine_of(self.case)

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
    The upper end is infinite when the interval reaches zero."""
    low = relative_error(model, reference.value + reference.error)
    least = reference.value - reference.error
    return low, relative_error(model, least) if least > 0 else math.inf


def rows(results: Results) -> list[Row]:
    """Returns the rows of each case, in the study's order. Rows of mutual and delta_self need the model's
    answer and a reference's, rows of change a reference's alone."""
    solved = [(case, case.truth) for case in results.compared() if case.truth is not None]
    return [row for case, truth in solved for row in _rows_of_case(results, case, truth)]


def short(results: Results, found: list[Row]) -> list[CaseResult]:
    """Returns the cases that are short of the asked accuracy: a value of them, or where no row is of them the whole answer."""
    by_rows: dict[str, bool] = {}
    for row in found:
        by_rows[row.case.id] = by_rows.get(row.case.id, True) and row.reached
    solved = ((case, case.truth) for case in results.cases.values() if case.truth is not None)
    return [case for case, truth in solved if not by_rows.get(case.id, truth.reached)]


def compared(found: list[Row]) -> list[Row]:
    """Returns the rows that the model has a value of."""
    return [row for row in found if row.is_compared]


def _rows_of_case(results: Results, case: CaseResult, truth: Truth) -> Iterator[Row]:
    row, model = partial(_row, results, case), case.model
    felt: tuple[str, ...] = ()
    if is_delta_self(case.scene) or not truth.has_readings:
        bodies, felt = list(truth.conductors[len(case.scene.sensors) :]), truth.sensors
    else:
        bodies = [body.name for body, target in zip(case.scene.objects, targets(case.scene)) if target]
    for sensor in (each.name for each in case.scene.sensors if model is not None):
        assert model is not None
        by_method = {method: sensors[sensor] for method, sensors in model.values.items()}
        for body in bodies:
            if body in truth.conductors and body in by_method[COMPARED_METHOD].objects:
                charges = {
                    method: ModelChange(of.objects[body], of.errors.get(body), of.answered_by)
                    for method, of in by_method.items()
                    if body in of.objects
                }
                yield row((sensor, body, "", MUTUAL), truth.mutual(sensor, body), charges)
        if sensor in felt:
            said = by_method.items()
            totals = {method: ModelChange(of.total, of.total_error, of.answered_by) for method, of in said}
            known = truth.delta_self(sensor)
            checked_by = FIELD if known.field is not None else BOUNDARY
            check = _difference(truth, results.cases.get(case.empty), sensor, checked_by)
            yield row((sensor, "", "", DELTA_SELF), known, totals, check)
    for reading in readings(case.scene) if not felt else ():
        change = truth.change(reading.name)
        if change is not None:
            changes = model.changes if model is not None else {}
            by_methods = {method: of[reading.name] for method, of in changes.items() if reading.name in of}
            yield row((reading.sense, "", reading.name, CHANGE), change, by_methods)


def _row(
    results: Results,
    case: CaseResult,
    subject: tuple[str, str, str, str],
    known: Known,
    model: dict[str, ModelChange],
    check: Estimate | None = None,
) -> Row:
    """Makes the row of a sensor, an object, a reading and a quantity, by their names."""
    values = case.model.values if case.model is not None else {}
    seconds = {method: next(iter(sensors.values())).seconds for method, sensors in values.items()}
    assert case.truth is not None
    answer = case.truth.answers[known.answered_by]
    by_field = known.answered_by == FIELD
    command = study_results.reference_command if by_field else study_results.boundary_command
    return Row(
        case,
        *subject,
        set_up=case.set_up,
        known=known,
        check=check,
        reached=case.truth.reached or known.best.error <= results.rtol * abs(known.best.value),
        reference_seconds=answer.seconds,
        reference_unknowns=answer.unknowns,
        model={method: said.value for method, said in model.items()},
        model_errors={method: said.error for method, said in model.items() if said.error is not None},
        model_answered_by={method: said.answered_by for method, said in model.items()},
        model_seconds={method: seconds[method] for method in model},
        command=command(results, case.id),
    )


def _difference(truth: Truth, empty: CaseResult | None, sensor: str, method: str) -> Estimate | None:
    """Returns M[s,s] − M0[s,s] from two separate solves by one method, with the sum of their errors."""
    if empty is None or empty.truth is None or method not in empty.truth.answers:
        return None
    whole, alone = (each.answers[method].self_capacitance(sensor) for each in (truth, empty.truth))
    return Estimate(whole.value - alone.value, whole.error + alone.error)


def to_csv(found: list[Row], methods: tuple[str, ...]) -> str:
    """Returns the rows as CSV text with a header; numbers in full."""
    stating = {method for row in found for method in row.model_errors}
    records = [_record(row, methods, stating) for row in found]
    return csv_text(records[0] if records else ["case"], (record.values() for record in records))


_DESCRIBED = ("gap_over_size", "tilt_degrees", "lateral_offset_over_size", "size_ratio")


def _record(row: Row, methods: tuple[str, ...], stating: set[str]) -> dict[str, object]:
    low, high = row.model_error_interval if row.is_compared else ("", "")
    kinds = {True: PROVEN, False: ESTIMATED}
    record: dict[str, object] = {
        "case": row.case.id,
        "family": row.case.family,
        "parameters": json.dumps(row.case.parameters),
        "sensor": row.sensor,
        "object": row.object,
        "quantity": row.quantity,
        "reading": row.reading,
        **{name: getattr(row.set_up, name) if row.set_up else "" for name in _DESCRIBED},
        "reference_F": row.reference.value,
        "reference_error_F": row.reference.error,
        "answered_by": row.known.answered_by,
        "reference_error_kind": row.known.error_kind,
        **_values("field", row.known.field),
        "field_error_kind": kinds[row.known.field_is_proven] if row.known.field else "",
        **_values("boundary", row.known.boundary),
        "reached": row.reached,
        **_values("check", row.check),
        "model_error": row.model_error if row.is_compared else "",
        "model_error_low": low,
        "model_error_high": high,
        "reference_seconds": row.reference_seconds,
        "reference_unknowns": row.reference_unknowns,
        "field_seconds": row.case.reference.seconds if row.case.reference else "",
    }
    for method in methods:
        record[f"model_{method}_F"] = row.model.get(method, "")
        if method in stating:
            record[f"model_{method}_error_F"] = row.model_errors.get(method, "")
            record[f"model_{method}_answered_by"] = row.model_answered_by.get(method, "")
        record[f"model_{method}_seconds"] = row.model_seconds.get(method, "")
    return record | {"command": row.command}


def _values(name: str, value: Estimate | None) -> dict[str, object]:
    """Returns the two columns of a value, empty without one."""
    return {f"{name}_F": value.value if value else "", f"{name}_error_F": value.error if value else ""}

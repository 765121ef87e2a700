"""Stored answers as numbers: the reference's and the model's documents, checked for what the comparison needs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from analysis.results.store import Document
from geometries.common.arrays import Array
from geometries.common.measured import picofarads


@dataclass(frozen=True)
class Estimate:
    """A value and the half-width of the interval that holds the truth; farads."""

    value: float
    error: float

    def agrees_with(self, other: Estimate) -> bool:
        """Tells whether the two intervals overlap."""
        return abs(self.value - other.value) <= self.error + other.error

    @property
    def in_picofarads(self) -> str:
        """The value with its error in pF, as people read it."""
        return picofarads(self.value, self.error)


@dataclass(frozen=True)
class ReadingAnswer:
    """A reading: its value, its background without the targets, and the change, which is their difference."""

    value: Estimate
    background: Estimate
    change: Estimate

    @staticmethod
    def of(document: Document) -> ReadingAnswer:
        """Returns the reading in a document of the field solver or of boundary elements."""
        parts, errors = ("value", "background", "change"), document["error"]
        return ReadingAnswer(*(Estimate(float(document[part]), float(errors[part])) for part in parts))


@dataclass(frozen=True, eq=False)
class Level:
    """One mesh of the reference: its Maxwell matrix (n, n) in F, its unknowns and its run time."""

    unknowns: int
    seconds: float
    maxwell: Array


@dataclass(frozen=True, eq=False)
class MatrixAnswer:
    """What the field solver or boundary elements answer: the Maxwell matrix (n, n) in F with its error, sensors first in `conductors`; for each
    sensor `delta_self`, and for each reading its change. Older answers have no readings.

    Where the field solver encloses the truth, from `lower` to `upper`, the error is the distance to the farther bound; its
    `delta_self` and the changes of its `readings` are its own values, from two solutions on the same mesh. Other errors are estimates.
    Boundary elements have no `levels` and name no `method` and no `versions`; `lower_bounds` says of each entry of their diagonal
    whether it cannot exceed the truth, and `rtol` is the relative accuracy that they were asked for."""

    conductors: tuple[str, ...]
    maxwell: Array
    error: Array
    lower: Array
    upper: Array
    is_proven: bool
    """Whether the interval is proven: that of an enclosure is not where bodies are curved or wrapped, or where meshes contradict each other."""
    delta_self: dict[str, Estimate]
    readings: dict[str, ReadingAnswer]
    unknowns: int
    seconds: float
    reached: bool
    levels: tuple[Level, ...]
    method: str
    versions: dict[str, str]
    lower_bounds: tuple[bool, ...]
    rtol: float

    @staticmethod
    def of(document: Document) -> MatrixAnswer:
        """Returns the answer in a document of `fem_reference --json` or in a stored `boundary.json`; KeyError when a part is missing."""
        is_enclosed = document.get("error_kind") == "enclosure"
        maxwell = np.array(document["maxwell"], dtype=np.float64)
        if is_enclosed:
            lower, upper = (np.array(document[name], dtype=np.float64) for name in ("lower", "upper"))
            error = np.maximum(maxwell - lower, upper - maxwell)
        else:
            error = np.array(document["error"], dtype=np.float64)
            lower, upper = maxwell - error, maxwell + error
        doubts = (document.get(name) for name in ("curved", "wrapped", "contradicted"))
        return MatrixAnswer(
            conductors=tuple(document["conductors"]),
            maxwell=maxwell,
            error=error,
            lower=lower,
            upper=upper,
            is_proven=is_enclosed and not any(doubts),
            delta_self={name: Estimate(**change) for name, change in document.get("delta_self", {}).items()},
            readings={each["name"]: ReadingAnswer.of(each) for each in document.get("readings", [])},
            **{name: document[name] for name in ("unknowns", "seconds", "reached")},
            levels=tuple(
                Level(level["unknowns"], level["seconds"], np.array(level["maxwell"], dtype=np.float64))
                for level in document.get("levels", ())
            ),
            method=document.get("method", ""),
            versions=document.get("versions", {}),
            lower_bounds=tuple(document.get("lower_bounds", ())),
            rtol=document.get("rtol", math.nan),
        )

    def mutual(self, sensor: str, body: str) -> Estimate:
        """Returns −M[sensor, body]: the charge on the grounded body per volt on the sensor."""
        place = self.conductors.index(sensor), self.conductors.index(body)
        return Estimate(float(-self.maxwell[place]), float(self.error[place]))

    def self_capacitance(self, sensor: str) -> Estimate:
        """Returns M[sensor, sensor]."""
        place = self.conductors.index(sensor)
        return Estimate(float(self.maxwell[place, place]), float(self.error[place, place]))


@dataclass(frozen=True)
class ModelValue:
    """What one method of the model says of one sensor: F for each object; `total` in place of delta_self, their sum or what the method itself
    says of delta_self; the errors that it states, if any (F); which method answered; and the seconds it took.
    """

    objects: dict[str, float]
    total: float
    errors: dict[str, float]
    total_error: float | None
    answered_by: str
    seconds: float

    @staticmethod
    def of(sensor: Document, method: str, seconds: float) -> ModelValue:
        """Returns what a method's document says of a sensor."""
        own = "delta_self" in sensor
        errors = {body["name"]: body.get("error") for body in sensor["objects"]}
        answered_by = dict.fromkeys(body.get("answered_by", method) for body in sensor["objects"])
        return ModelValue(
            objects={body["name"]: float(body["capacitance"]) for body in sensor["objects"]},
            total=float(sensor["delta_self" if own else "total"]),
            errors={name: float(error) for name, error in errors.items() if error is not None},
            total_error=float(sensor["delta_self_error"]) if own else None,
            answered_by=" and ".join(answered_by),
            seconds=seconds,
        )


@dataclass(frozen=True)
class ModelChange:
    """A change of a reading (F) by a method of the model, the error that it states, if any, and the method that answered."""

    value: float
    error: float | None
    answered_by: str

    @staticmethod
    def of(reading: Document, method: str) -> ModelChange:
        """Returns the change in the document of a reading."""
        error = reading.get("error", {}).get("change")
        return ModelChange(reading["change"], error, reading.get("answered_by", method))


@dataclass(frozen=True)
class ModelAnswer:
    """The model's values by method and sensor, its changes of readings by method and reading, where it knows them, and the reasons of
    the methods that refuse the case."""

    values: dict[str, dict[str, ModelValue]]
    changes: dict[str, dict[str, ModelChange]]
    refused: dict[str, str]
    version: str

    @staticmethod
    def of(document: Document) -> ModelAnswer:
        """Returns the answer in a stored `model.json`; KeyError when a part is missing."""
        found = ModelAnswer({}, {}, {}, document["version"])
        for method, answer in document["methods"].items():
            if "refused" in answer:
                found.refused[method] = answer["refused"]
                continue
            seconds = float(answer["seconds"])
            known = (each for each in answer.get("readings", []) if each["change"] is not None)
            sensors = answer["sensors"]
            found.values[method] = {each["name"]: ModelValue.of(each, method, seconds) for each in sensors}
            found.changes[method] = {each["name"]: ModelChange.of(each, method) for each in known}
        return found

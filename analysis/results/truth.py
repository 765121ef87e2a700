"""The best truth at hand: of what the field solver and boundary elements say of a value, the one that states less error.

The two errors differ in kind. The field solver's is a proven interval (`error = "enclosure"`) or an estimate from successive
meshes, that of boundary elements is an estimate. The cross-check compares both answers, whichever is used."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from analysis.results.answers import Estimate, MatrixAnswer

FIELD, BOUNDARY = "field solver", "boundary elements"
PROVEN, ESTIMATED = "proven", "estimated"


def in_sentence(method: str) -> str:
    """Returns the name of a method with its article, if it has one."""
    return f"the {method}" if method == FIELD else method


@dataclass(frozen=True)
class Known:
    """What the two methods say of one value, F; at least one says something. `field_is_proven` tells whether the field solver's error
    bounds an interval that is proven to hold the true value."""

    field: Estimate | None
    boundary: Estimate | None
    field_is_proven: bool = False

    @property
    def answered_by(self) -> str:
        """The method that states less error; the field solver if both state the same."""
        if self.field is None or self.boundary is None:
            return BOUNDARY if self.field is None else FIELD
        # An error that is not a number is larger than any other.
        return BOUNDARY if _size(self.boundary.error) < _size(self.field.error) else FIELD

    @property
    def best(self) -> Estimate:
        best = self.field if self.answered_by == FIELD else self.boundary
        assert best is not None
        return best

    @property
    def error_kind(self) -> str:
        """Whether the best value's error is proven or estimated."""
        return PROVEN if self.answered_by == FIELD and self.field_is_proven else ESTIMATED


@dataclass(frozen=True, eq=False)
class Truth:
    """The answers of one case by both methods; at least one is there."""

    field: MatrixAnswer | None
    boundary: MatrixAnswer | None

    @property
    def answers(self) -> dict[str, MatrixAnswer]:
        """The answers by their methods."""
        both = {FIELD: self.field, BOUNDARY: self.boundary}
        return {method: answer for method, answer in both.items() if answer is not None}

    @property
    def conductors(self) -> tuple[str, ...]:
        return next(iter(self.answers.values())).conductors

    @property
    def reached(self) -> bool:
        """Whether a method reached the accuracy that it was asked for."""
        return any(answer.reached for answer in self.answers.values())

    @property
    def has_readings(self) -> bool:
        """Whether a method answers readings; older answers have none."""
        return any(answer.readings for answer in self.answers.values())

    def mutual(self, sensor: str, body: str) -> Known:
        """Returns −M[sensor, body]."""
        return self._known(lambda answer: answer.mutual(sensor, body), may_be_proven=True)

    def self_capacitance(self, sensor: str) -> Known:
        """Returns M[sensor, sensor]."""
        return self._known(lambda answer: answer.self_capacitance(sensor), may_be_proven=True)

    def delta_self(self, sensor: str) -> Known:
        """Returns M[sensor, sensor] less the same without the objects; its error is an estimate in any case."""
        return self._known(lambda answer: answer.delta_self.get(sensor))

    def change(self, reading: str) -> Known | None:
        """Returns the change of a reading, whose error is an estimate in any case; None if no method answers it."""

        def change(answer: MatrixAnswer) -> Estimate | None:
            return answer.readings[reading].change if reading in answer.readings else None

        return self._known(change) if any(map(change, self.answers.values())) else None

    @property
    def sensors(self) -> tuple[str, ...]:
        """The sensors whose delta_self is known."""
        return tuple(dict.fromkeys(name for answer in self.answers.values() for name in answer.delta_self))

    def _known(self, value: Callable[[MatrixAnswer], Estimate | None], may_be_proven: bool = False) -> Known:
        found = {method: value(answer) for method, answer in self.answers.items()}
        is_proven = may_be_proven and self.field is not None and self.field.is_proven
        return Known(found.get(FIELD), found.get(BOUNDARY), is_proven)


def _size(error: float) -> float:
    return math.inf if math.isnan(error) else error

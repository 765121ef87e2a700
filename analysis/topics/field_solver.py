"""Readings of a topic's set-ups by the field solver, kept beside the code of the topic, and their comparison with boundary elements."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from analysis.pipeline import reference_stage
from analysis.pipeline.processes import Processes
from analysis.pipeline.set_up_stages import SetUp
from analysis.results.answers import Estimate
from analysis.results.store import Document, write_text
from analysis.results.study_results import SCENE
from analysis.topics.stored import Named, SomeNamed, Stored
from geometries.common.children import temporary_folder

QUANTITIES = ("value", "background", "change")
_SomeNamed = TypeVar("_SomeNamed", bound=Named, covariant=True)


class Entry(Protocol[_SomeNamed]):
    """A set-up with the change of its reading by boundary elements; there may be more quantities."""

    @property
    def set_up(self) -> _SomeNamed:
        ...

    @property
    def change(self) -> Estimate:
        ...


@dataclass(frozen=True)
class Comparison(Generic[SomeNamed]):
    """One quantity of a set-up's reading by both methods (F), and the ends of the interval that the field solver proves, if it does."""

    set_up: SomeNamed
    quantity: str
    field: Estimate
    boundary: Estimate
    proven: tuple[float, float] = (float("-inf"), float("inf"))

    @property
    def difference(self) -> float:
        """Boundary elements less the field solver, relative to the field solver's value."""
        return self.boundary.value / self.field.value - 1

    @property
    def allowed(self) -> float:
        """The sum of both errors, relative to the field solver's value."""
        return (self.boundary.error + self.field.error) / abs(self.field.value)

    @property
    def over_errors(self) -> float:
        """The difference over what both errors allow: above 1 one of the values, or its error, is wrong."""
        return abs(self.difference) / self.allowed

    @property
    def is_proven(self) -> bool:
        """Whether the field solver proves an interval."""
        return self.proven[1] < float("inf")

    @property
    def half_width(self) -> float:
        """Half the width of the proven interval, relative to the field solver's value."""
        lower, upper = self.proven
        return (upper - lower) / 2 / abs(self.field.value)

    @property
    def is_enclosed(self) -> bool:
        """Whether the value by boundary elements lies within the proven interval."""
        lower, upper = self.proven
        return lower <= self.boundary.value <= upper


@dataclass(frozen=True, kw_only=True)
class FieldCheck(Stored[SomeNamed]):
    """Records of the field solver's `quantities` of readings. A record has them by itself, or, with `both`, under "field" beside those by boundary elements
    under "boundary"; it may have "lower" and "upper", the ends of the interval proven for the change. A page counts the set-ups of each `kind`,
    has the columns `described` of them in its table, and an `explanation`."""

    kind: Callable[[SomeNamed], str]
    described: tuple[tuple[str, Callable[[SomeNamed], str]], ...]
    explanation: str = ""
    quantities: tuple[str, ...] = QUANTITIES
    both: bool = False

    def comparisons(self, found: Iterable[Entry[SomeNamed]] = ()) -> list[Comparison[SomeNamed]]:
        """Pairs the quantities that are recorded with those of the entries, in their order, or with those in the records."""
        records = self.records()
        pairs: list[tuple[SomeNamed, Entry[SomeNamed] | None]] = (
            [(each, None) for each in self.chosen()] if self.both else [(each.set_up, each) for each in found]
        )
        return [
            _comparison(set_up, quantity, records[set_up.identity], entry)
            for set_up, entry in pairs
            if set_up.identity in records
            for quantity in self.quantities
        ]


def _comparison(
    set_up: SomeNamed, quantity: str, record: Document, entry: Entry[SomeNamed] | None
) -> Comparison[SomeNamed]:
    """Returns a quantity of the entry, or of the record without one, beside the field solver's."""
    if entry is None:
        field, boundary = (Estimate(**record[method][quantity]) for method in ("field", "boundary"))
        return Comparison(set_up, quantity, field, boundary)
    field, boundary = Estimate(**record[quantity]), getattr(entry, quantity)
    if "lower" not in record:
        return Comparison(set_up, quantity, field, boundary)
    return Comparison(set_up, quantity, field, boundary, (record["lower"], record["upper"]))


def solved(set_up: SetUp, *options: str) -> Document:
    """Solves a set-up by the field solver with these options of its command; NoAnswer if it has none."""
    with temporary_folder() as folder:
        scene = folder / SCENE
        write_text(scene, set_up.text)
        return reference_stage.solve(scene, Processes(), *options)


def quantities_of(reading: Document, names: Iterable[str] = QUANTITIES) -> Document:
    """Returns quantities of a reading as a record has them."""
    return {name: {"value": reading[name], "error": reading["error"][name]} for name in names}

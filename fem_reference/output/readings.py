"""The readings of an answer: for the JSON document, and as a table for people to read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fem_reference.answer.readings import Quantity, ReadingAnswer
from geometries.common.measured import picofarad_interval, picofarads

ANSWERED_BY = "field"
PARTS = ("value", "background", "change")


def reading_document(reading: ReadingAnswer) -> dict[str, Any]:
    """A reading as data for JSON; farads. `lower` and `upper` are there if any bound is proven, with null for those that are not."""
    quantities: dict[str, Quantity] = {part: getattr(reading, part) for part in PARTS}
    document: dict[str, Any] = {"name": reading.name, "answered_by": ANSWERED_BY}
    document |= {part: quantity.value for part, quantity in quantities.items()}
    document["error"] = {part: quantity.error for part, quantity in quantities.items()}
    for side in ("lower", "upper"):
        bounds = {part: getattr(quantity, side) for part, quantity in quantities.items()}
        if any(bound is not None for bound in bounds.values()):
            document[side] = bounds
    return document


def readings_table(readings: Sequence[ReadingAnswer]) -> list[str]:
    """Lines of a table in picofarad, with the errors and, below them, the bounds that are proven."""
    if not readings:
        return []
    width = max(8, *(len(reading.name) for reading in readings)) + 2
    head = "readings, pF: charge sensed per volt on what is driven; without the targets; the change by the targets"
    lines = [head, row(width, "", PARTS)]
    for reading in readings:
        quantities: list[Quantity] = [getattr(reading, part) for part in PARTS]
        lines.append(row(width, reading.name, [picofarads(each.value, each.error) for each in quantities]))
        if any(quantity.lower is not None for quantity in quantities):
            lines.append(row(width, "  proven", list(map(_interval, quantities))))
    return lines


def row(width: int, name: str, entries: Sequence[str]) -> str:
    """A line of a table, with its name in so many columns, and its entries."""
    return f"{name:<{width}}" + "".join(f"  {entry:>22}" for entry in entries)


def _interval(quantity: Quantity) -> str:
    if quantity.lower is None or quantity.upper is None:
        return ""
    return picofarad_interval(quantity.lower, quantity.upper)

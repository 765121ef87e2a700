"""Measurements of the model by itself in the report: where they come from, and what is said without them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeVar

from markupsafe import Markup

from analysis.report import page
from analysis.results.store import Document

_Found = TypeVar("_Found")
_ABSENT = (
    "These results have no measurement by this version of the model on this machine: ./run does it with the default study, and "
    "python3 -m analysis run STUDY --measure-model with any."
)


@dataclass(frozen=True)
class Origin:
    """Where a measurement comes from: the machine's processor and instruction sets, and the command that repeats it."""

    processor: str
    instruction_sets: str
    command: str


def origin(document: Document) -> Origin:
    """Returns where a stored answer comes from."""
    return Origin(document["processor"], document["instruction_sets"], document["command"])


def section(title: str, found: _Found | None, parts: Callable[[_Found], Iterable[Markup]]) -> Markup:
    """Returns the section on a measurement, or that there is none."""
    return page.section(title, *([page.paragraph(_ABSENT)] if found is None else parts(found)))


def again(*origins: Origin, before: str = "") -> Markup:
    """Says where it was measured, and how to measure it again."""
    first, commands = origins[0], "; ".join(each.command for each in origins)
    return page.soft(
        f"{before}{first.processor} with {first.instruction_sets}. Again, from the project's folder: {commands}"
    )

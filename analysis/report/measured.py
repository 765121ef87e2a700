"""Measurements of the model by itself in the report: where they come from, and what is said without them."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from markupsafe import Markup

from analysis.report import page
from analysis.results.store import Document

_ABSENT = (
    "These results have no measurement by this version of the model on this machine: ./run does it with the default study, and "
    "python3 -m analysis run STUDY --measure-model with any."
)


def section(
    title: str, documents: Iterable[Document | None], parts: Callable[..., Iterable[Markup]], before: str = ""
) -> Markup:
    """Returns the section on stored answers: its parts, which are made of these documents, then where the answers were measured, and how to
    measure them again; or that there are none."""
    asked = tuple(documents)
    known = [document for document in asked if document is not None]
    if not known:
        return page.section(title, page.paragraph(_ABSENT))
    first, commands = known[0], "; ".join(document["command"] for document in known)
    again = (
        f"{first['processor']} with {first['instruction_sets']}. Again, from the project's folder: {commands}"
    )
    return page.section(title, *parts(*asked), page.soft(before + again))

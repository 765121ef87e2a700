"""The section on what corrects the model: its cost and remaining error, as a sentence and a table, and set-up by set-up."""

from __future__ import annotations

from collections.abc import Callable

from markupsafe import Markup

from analysis.report import page
from analysis.results.store import Document
from analysis.results.units import percent
from analysis.topics.corrections import cases
from analysis.topics.corrections.estimates import FORMULA, PLAIN, REDUCED

TITLE = "Corrections of the model (mutual)"
COMMAND = "python3 -m analysis corrections"
ABSENT = f"The corrections were not evaluated yet: {COMMAND} does it in a minute."


def section(document: Document, set_ups: str) -> Markup:
    """Returns the section of the topic's document. `set_ups` is the file of the page of its set-ups, as seen from the page."""
    return page.section(
        TITLE,
        page.finding(finding(document)),
        _table(document),
        cases.section(document["cases"], set_ups),
        page.soft(_explanation(document)),
    )


def finding(document: Document) -> str:
    """Tells the error that the best closed formula leaves on unseen set-ups, and its cost."""
    plain, best = _entry(document, PLAIN), _entry(document, FORMULA)
    ratios = {shape: times[FORMULA] / times[PLAIN] for shape, times in document["nanoseconds"].items()}
    reduced = _entry(document, REDUCED)
    return (
        f"In the {best['sealed']['count']} set-ups never used to find it, the formula is {percent(best['sealed']['rms'])} off (rms) and "
        f"{percent(best['sealed']['worst'])} at worst, where the plain model is {percent(plain['sealed']['rms'])} and "
        f"{percent(plain['sealed']['worst'])}, at {min(ratios.values()):.1f} to {max(ratios.values()):.1f} times its time per "
        "triangle. The reduced method has no fitted constant: "
        f"{percent(reduced['all']['rms'])} off (rms) and {percent(reduced['all']['worst'])} at worst in all "
        f"{reduced['all']['count']}."
    )


def _table(document: Document) -> Markup:
    return page.table_of(
        document["corrections"],
        ("method", lambda entry: page.code(entry["name"])),
        ("rms", _error("all", "rms")),
        ("median", _error("all", "median")),
        ("95 %", _error("all", "percentile_95")),
        ("worst", _error("all", "worst")),
        ("sealed: rms", _error("sealed", "rms")),
        ("worst", _error("sealed", "worst")),
        *((f"ns, {shape}", _time(known)) for shape, known in document["nanoseconds"].items()),
        strong=frozenset({_names(document).index(REDUCED)}),
    )


def _error(over: str, name: str) -> Callable[[Document], str]:
    return lambda entry: percent(entry[over][name])


def _time(known: dict[str, float]) -> Callable[[Document], str]:
    return lambda entry: f"{known[entry['name']]:.3g}"


def _explanation(document: Document) -> str:
    return (
        f"{document['set_ups']} set-ups with truths by boundary elements to 1e-4 ({document['truths']}); {document['sealed']} of them are sealed "
        "by a hash of their names: no constant was fitted on them. Errors are relative to the truth. Times: one "
        f"core, one run, new pose each time. Repeat: {COMMAND}."
    )


def _entry(document: Document, name: str) -> Document:
    entry: Document = document["corrections"][_names(document).index(name)]
    return entry


def _names(document: Document) -> list[str]:
    return [entry["name"] for entry in document["corrections"]]

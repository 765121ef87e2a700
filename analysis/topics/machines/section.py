"""The report's section on machines: how far the model's change of a reading is from the true one there, and why."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from analysis.report import page
from analysis.results.units import picofarads, signed_percent
from analysis.topics.machines import plots, records
from analysis.topics.machines.parts import COMPANY
from analysis.topics.machines.records import Entry
from analysis.topics.machines.set_ups import FAMILIES
from analysis.topics.machines.stage import METHODS
from analysis.topics.machines.truths import RTOL
from analysis.topics.spread import range_of, ratio

TITLE = "On machines"
ABSENT = "This version of the model has no study of machines yet: python3 -m analysis machines does it in a minute."
_WHAT = (
    "Change: the reading with the target less that without it, the machine as it is. A part is the decrease of the change when what it names is "
    "included, over the true change; its mean over all orders of including, so that the parts add up to the error exactly. Nothing is fitted. The parts of "
    "the company are differences between true changes by boundary elements; the others are of the sensor and the target by themselves: faces turned away "
    "are triangles that the sensor does not see; another quantity is the charge on the target minus the change of the sensor's own; for a plate the rest is "
    "taken apart as in the page on two plates. The changes by exact and exact+facing are those of a grounded target: the plain model knows no other; the "
    "formula knows company and floating targets. Of a reading between two sensors the plain model gives nothing; its error is then the whole change. Definitions: "
    "analysis/topics/machines/MACHINES.md."
)


def section(found: list[Entry], checked: list[Markup]) -> Markup:
    """Returns the section, with what the field solver finds; one sentence without answers."""
    if not found:
        return page.section(TITLE, page.paragraph(ABSENT))
    return page.section(
        TITLE,
        page.finding(finding(found)),
        page.figures([plots.of_methods(found)]),
        page.table(
            ["family", "set-ups", *(f"{method}: median (least to greatest)" for method in METHODS)],
            _rows(found),
        ),
        page.finding(parts_finding(found)),
        page.figures([plots.of_parts(found)]),
        page.table(
            ["part", "set-ups", "median", "least", "greatest", "greatest part in"], _rows_of_parts(found)
        ),
        page.soft(_WHAT),
        page.paragraph("Sealed set-ups, which no rule was chosen by, and the others; error of the change:"),
        page.table(
            ["method", "set-ups", "count", "median ratio", "rms error", "worst error"], _rows_of_sealed(found)
        ),
        *checked,
        page.folded("Show the numbers", _numbers(found)),
    )


def of_corrections(found: list[Entry]) -> Markup:
    """Returns what each method gives on machines, for the page on corrections; empty without answers."""
    if not found:
        return Markup("")
    return page.section(
        "In company: the change of a reading on machines",
        page.finding(sealed_finding(found)),
        page.table(
            ["method", "set-ups", "count", "median ratio", "rms error", "worst error"], _rows_of_sealed(found)
        ),
        page.soft(
            "Ratio: the method's change over the true one by boundary elements. The page on machines has the set-ups."
        ),
    )


def sealed_finding(found: list[Entry]) -> str:
    """Tells each method's error in the sealed set-ups and in the others."""
    phrases = []
    for method in METHODS:
        told = [
            f"{100 * each.rms:.0f} % rms and {100 * each.worst:+.0f} % at worst in {each.count} {name} ones"
            for name, sealed in (("sealed", True), ("open", False))
            if (
                each := records.statistics(
                    [entry for entry in found if entry.set_up.sealed == sealed], method
                )
            )
        ]
        if told:
            phrases.append(f"{method} is off by {', '.join(told)}")
    return f"In the change of a reading on {len(found)} machines {'; '.join(phrases)}."


def finding(found: list[Entry]) -> str:
    """Tells how many times the true change each method gives."""
    phrases = [
        f"{method} {ratio(each.median)} times ({ratio(each.least)} to {ratio(each.greatest)})"
        for method in METHODS
        if (each := records.statistics(found, method)) is not None
    ]
    sure = max(entry.change.error / abs(entry.change.value) for entry in found)
    return (
        f"Over {len(found)} set-ups on machines the model gives, in the median and from least to most, of the true change of the reading: "
        f"{'; '.join(phrases)}. The true changes are known to {signed_percent(sure).removeprefix('+')} or better, by boundary elements asked for {RTOL:g}."
    )


def parts_finding(found: list[Entry]) -> str:
    """Tells what company makes of the error, and which parts are the greatest."""
    pairs = [entry.true.alone.value / entry.change.value for entry in found if entry.pairs] or [np.nan]
    of_company = {
        name: [entry.parts()[name] for entry in found if name in entry.true.included] for name in COMPANY
    }
    strongest = max(of_company, key=lambda name: float(np.median(of_company[name] or [0.0])))
    greatest = max(records.of_parts(found), key=lambda each: each.largest_in)
    return (
        f"Company alone makes {ratio(float(np.median(pairs)))} times too much of a change ({ratio(min(pairs))} to {ratio(max(pairs))}): so much is the exact change "
        f"of the sensor and the target by themselves over that on the machine, and no better model of pairs can be nearer. Most of it is {strongest} "
        f"({np.median(of_company[strongest]):.2g} of the true change in the median). Of all parts {greatest.name} is the greatest most often, in {greatest.largest_in} "
        f"of {len(found)} set-ups."
    )


def _rows(found: list[Entry]) -> list[list[str]]:
    rows = []
    for family in FAMILIES:
        own = [entry for entry in found if entry.set_up.family == family]
        if own:
            rows.append(
                [family, str(len(own)), *(range_of(records.statistics(own, method)) for method in METHODS)]
            )
    return rows


def _rows_of_parts(found: list[Entry]) -> list[list[str]]:
    return [
        [
            each.name,
            str(each.count),
            f"{each.median:+.3g}",
            f"{each.least:+.3g}",
            f"{each.greatest:+.3g}",
            f"{each.largest_in} of {len(found)}",
        ]
        for each in records.of_parts(found)
    ]


def _rows_of_sealed(found: list[Entry]) -> list[list[str]]:
    rows = []
    for method in METHODS:
        for name, sealed in (("sealed", True), ("open", False)):
            each = records.statistics([entry for entry in found if entry.set_up.sealed == sealed], method)
            if each is not None:
                errors = (f"{100 * each.rms:.0f} %", f"{100 * each.worst:+.0f} %")
                rows.append([method, name, str(each.count), ratio(each.median), *errors])
    return rows


def _numbers(found: list[Entry]) -> Markup:
    header = ["set-up", "name", "sealed", "change (pF)", "pair (pF)", *METHODS, "greatest part"]
    rows = [
        [
            page.code(entry.set_up.id),
            entry.set_up.name,
            "yes" if entry.set_up.sealed else "",
            *(picofarads(each.value, each.error) for each in (entry.change, entry.true.alone)),
            *(ratio(entry.ratio(method)) if method in entry.methods else "" for method in METHODS),
            entry.largest,
        ]
        for entry in found
    ]
    return page.table(header, rows, text_columns=3)

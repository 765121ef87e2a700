"""`python3 -m analysis table`: computes missing answers, then writes the table, its checks and the page that explains them."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from analysis.results.store import Document, write_text
from analysis.results.study_results import REFERENCE, Failure
from analysis.results.units import PICOFARAD
from analysis.topics.published import files, page, rows, stage
from analysis.topics.published.files import Check
from analysis.topics.published.rows import Row
from geometries.studies.study import EMPTY, Case

PLACE = Path(__file__).parent
"""The folder of the published table."""


@dataclass(frozen=True)
class Made:
    """The failures, and a sentence on the table, which is empty without a table."""

    failures: list[Failure]
    headline: str


def make(answers: Path, target: Path, workers: int | None = None) -> Made:
    """Computes the missing answers and writes the files; nothing is written while a set-up lacks an answer."""
    failures = stage.run(answers, workers)
    if failures:
        return Made(failures, "")
    found, checks = collected(answers)
    write_text(target / files.TABLE, files.to_csv(found))
    write_text(target / files.CHECKS, files.checks_to_csv(checks))
    # The page describes the files, so it is made from what was written to them.
    write_text(target / files.PAGE, page.text(*files.load(target)))
    return Made([], page.headline(*files.load(target)))


def digest() -> str:
    """Returns a hash of the table as published and of its checks."""
    contents = [(PLACE / name).read_bytes() for name in (files.TABLE, files.CHECKS)]
    return hashlib.sha256(b"".join(contents)).hexdigest()


def collected(answers: Path) -> tuple[list[Row], list[Check]]:
    """Returns the rows and the checks, from answers that are all there."""
    cases = stage.cases()
    (empty,) = (case for case in cases if case.family == EMPTY)
    alone = rows.alone(_load(answers, empty, stage.BOUNDARY), _load(answers, empty, stage.UPPER))
    found = [
        rows.row(case, _load(answers, case, stage.BOUNDARY), _load(answers, case, stage.UPPER), alone)
        for case in cases
        if case.family != EMPTY
    ]
    by_case = {row.case: row for row in found}
    checks = [
        check
        for case in stage.checked(cases)
        for check in _checks(by_case[case.id], _load(answers, case, REFERENCE))
    ]
    return found, checks


def _load(answers: Path, case: Case, file: str) -> Document:
    document = stage.load(answers, case, file)
    if document is None:
        raise RuntimeError(f"{file} of {case.id} is missing")
    return document


def _checks(row: Row, solved: Document) -> list[Check]:
    """Returns the field solver's values, with estimated errors, beside the table's."""
    matrix, error = solved["maxwell"], solved["error"]
    change = solved["delta_self"]["sensor"]
    values = {
        rows.MUTUAL: (-matrix[0][1], error[0][1]),
        rows.SENSOR: (matrix[0][0], error[0][0]),
        rows.TARGET: (matrix[1][1], error[1][1]),
        rows.DELTA_SELF: (change["value"], change["error"]),
    }
    return [
        Check(
            row.case,
            name,
            value / PICOFARAD,
            uncertain / PICOFARAD,
            row.values[name].best,
            row.values[name].error,
        )
        for name, (value, uncertain) in values.items()
    ]

"""What a method refuses to answer in a study, and why: all cases with the same reason together."""

from __future__ import annotations

import re
from dataclasses import dataclass

from analysis.results.study_results import CaseResult, Results
from analysis.results.truth import BOUNDARY, FIELD, in_sentence
from geometries.studies.study import NO_REFERENCE

# A line names so many of its cases.
_MOST_NAMED = 3
# Reasons that differ in numbers only, such as a distance in every frame of a motion, are the same reason.
_NUMBER = re.compile(r"-?\d+(\.\d+)?(e[-+]?\d+)?")


@dataclass(frozen=True)
class Refusal:
    """A method and its reason to refuse some cases; `answered` of them have the other method's answer. The method is one of the two
    references or one of the model's."""

    method: str
    reason: str
    cases: tuple[str, ...]
    answered: int

    @property
    def sentence(self) -> str:
        """One line that names the method, the first cases and the reason."""
        count = len(self.cases)
        cases = f"case {self.cases[0]}" if count == 1 else f"{count} cases ({named(self.cases)})"
        if self.method not in (FIELD, BOUNDARY):
            return f"the model's {self.method} refuses {cases}: {self.reason}"
        verb = "refuses" if self.method == FIELD else "refuse"
        return f"{in_sentence(self.method)} {verb} {cases}, {self._otherwise}: {self.reason}"

    @property
    def _otherwise(self) -> str:
        other = in_sentence(BOUNDARY if self.method == FIELD else FIELD)
        answers = "answer" if self.method == FIELD else "answers"
        if self.answered == 0:
            return "without another answer"
        whole = self.answered == len(self.cases)
        return f"{other} {answers}" if whole else f"{other} {answers} {self.answered} of them"


def refusals(results: Results) -> list[Refusal]:
    """Returns what the field solver, then what boundary elements and then what methods of the model refuse, the most frequent reason
    first."""
    by_reason: dict[tuple[str, str], dict[str, str]] = {}
    for failure in results.failures:
        # The slice of a refused case is refused too.
        if failure.refused and failure.case in results.cases:
            by_reason.setdefault((FIELD, without_numbers(failure.reason)), {}).setdefault(
                failure.case, failure.reason
            )
    for case in results.cases.values():
        if case.refused:
            by_reason.setdefault((BOUNDARY, without_numbers(case.refused)), {})[case.id] = case.refused
        for method, reason in (case.model.refused if case.model is not None else {}).items():
            by_reason.setdefault((method, without_numbers(reason)), {})[case.id] = reason
    found = [
        Refusal(
            method, _common(cases), tuple(cases), sum(results.cases[case].truth is not None for case in cases)
        )
        for (method, _), cases in by_reason.items()
    ]
    order = {FIELD: 0, BOUNDARY: 1}
    return sorted(found, key=lambda refusal: (order.get(refusal.method, 2), -len(refusal.cases)))


def without_numbers(reason: str) -> str:
    """Returns a reason with the same sign in the place of every number."""
    return _NUMBER.sub("#", reason)


def _common(reasons: dict[str, str]) -> str:
    """Returns the first of some reasons, and says if others have other numbers in it."""
    distinct = list(dict.fromkeys(reasons.values()))
    return distinct[0] + (" (in the others with other numbers)" if distinct[1:] else "")


def unanswered(results: Results) -> list[CaseResult]:
    """Returns the cases that no method has answered, if the study asks for references."""
    if results.error == NO_REFERENCE:
        return []
    return [case for case in results.cases.values() if case.truth is None]


def named(cases: tuple[str, ...]) -> str:
    """Names the first of some cases."""
    more = ", …" if len(cases) > _MOST_NAMED else ""
    return ", ".join(cases[:_MOST_NAMED]) + more

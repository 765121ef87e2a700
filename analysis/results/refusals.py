"""What a method refuses to answer in a study, and why: all cases with the same reason together."""

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
        others = "boundary elements answer" if self.method == FIELD else "the field solver answers"
        some = "" if self.answered == count else f" {self.answered} of them"
        otherwise = f"{others}{some}" if self.answered else "without another answer"
        verb = "refuses" if self.method == FIELD else "refuse"
        return f"{in_sentence(self.method)} {verb} {cases}, {otherwise}: {self.reason}"


def refusals(results: Results) -> list[Refusal]:
    """Returns what the field solver, then what boundary elements and then what methods of the model refuse, the most frequent reason
    first."""
    by_reason: dict[tuple[str, str], dict[str, str]] = {}
    for failure in results.failures:
        # The slice of a refused case is refused too.
        if failure.refused and failure.case in results.cases:
            alike = by_reason.setdefault((FIELD, without_numbers(failure.reason)), {})
            alike.setdefault(failure.case, failure.reason)
    for case in results.cases.values():
        if case.refused:
            by_reason.setdefault((BOUNDARY, without_numbers(case.refused)), {})[case.id] = case.refused
        for method, reason in (case.model.refused if case.model is not None else {}).items():
            by_reason.setdefault((method, without_numbers(reason)), {})[case.id] = reason
    found = []
    for (method, _), cases in by_reason.items():
        answered = sum(results.cases[case].truth is not None for case in cases)
        reason, *others = dict.fromkeys(cases.values())
        told = f"{reason} (in the others with other numbers)" if others else reason
        found.append(Refusal(method, told, tuple(cases), answered))
    order = {FIELD: 0, BOUNDARY: 1}
    return sorted(found, key=lambda refusal: (order.get(refusal.method, 2), -len(refusal.cases)))


def without_numbers(reason: str) -> str:
    """Returns a reason with the same sign in the place of every number."""
    return _NUMBER.sub("#", reason)


def unanswered(results: Results) -> list[CaseResult]:
    """Returns the cases that no method has answered, if the study asks for references."""
    if results.error == NO_REFERENCE:
        return []
    return [case for case in results.cases.values() if case.truth is None]


def named(cases: tuple[str, ...]) -> str:
    """Names the first of some cases."""
    more = ", …" if len(cases) > _MOST_NAMED else ""
    return ", ".join(cases[:_MOST_NAMED]) + more

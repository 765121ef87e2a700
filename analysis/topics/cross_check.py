"""Boundary elements beside the field solver, which share nothing but the scene file: do they agree in every value that both compute, and what do both prove
together for the diagonal of the Maxwell matrix?"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, by_family, figure, guide, marks, power_axis, series_colour
from analysis.results.answers import Estimate, MatrixAnswer
from analysis.results.set_up import is_delta_self
from analysis.results.statistics import grouped
from analysis.results.study_results import CaseResult, Results
from analysis.results.units import duration, percent
from geometries.common.measured import PICOFARAD

QUADRATURE_SHARE = 0.05
"""Largest quadrature error of an entry that is called a lower bound, relative to its stated error (model/BOUNDARY_ELEMENTS.md,
section 6)."""


@dataclass(frozen=True)
class Comparison:
    """One value of a case; farads. The field solver's is known to lie from `low` to `high`."""

    case: CaseResult
    what: str
    reference: float
    low: float
    high: float
    boundary: Estimate

    @property
    def difference(self) -> float:
        """The difference relative to the field solver's value."""
        return (self.boundary.value - self.reference) / abs(self.reference)

    @property
    def allowed(self) -> float:
        """The sum of both errors, relative to the field solver's value."""
        towards = (self.high - self.reference) if self.difference > 0 else (self.reference - self.low)
        return (towards + self.boundary.error) / abs(self.reference)

    @property
    def over_errors(self) -> float:
        """The difference over what both errors allow: above 1 the error bars do not overlap."""
        return abs(self.difference) / self.allowed if self.allowed > 0 else float("inf")

    @property
    def agrees(self) -> bool:
        return self.over_errors <= 1


@dataclass(frozen=True)
class Bracket:
    """A diagonal entry of the Maxwell matrix between bounds (F): `lower` is Galerkin's, `flux` and `upper` are the field solver's."""

    case: CaseResult
    conductor: str
    lower: float
    flux: float
    upper: float

    @property
    def width(self) -> float:
        """The width from the better lower bound to the upper bound, relative to the latter."""
        return (self.upper - max(self.lower, self.flux)) / self.upper

    @property
    def width_before(self) -> float:
        """The same without boundary elements."""
        return (self.upper - self.flux) / self.upper


def comparisons(results: Results) -> list[Comparison]:
    """Returns the entries on and above the diagonal, delta_self and the changes of readings of every case that both have solved, the worst
    first."""
    found = [each for answered in _by_both(results) for each in _of_case(*answered)]
    return sorted(found, key=lambda comparison: -comparison.over_errors)


def _by_both(results: Results) -> Iterator[tuple[CaseResult, MatrixAnswer, MatrixAnswer]]:
    for case in results.cases.values():
        if case.reference is not None and case.boundary is not None:
            yield case, case.reference, case.boundary


def disagreements(found: list[Comparison]) -> list[Comparison]:
    """Returns the comparisons whose error bars do not overlap: one of the two values, or its error, is wrong."""
    return [comparison for comparison in found if not comparison.agrees]


def contradictions(results: Results) -> int:
    """Counts the values that disagree and the diagonal entries whose lower bound is above the upper one."""
    empty = sum(bracket.width < 0 for bracket in brackets(results))
    return len(disagreements(comparisons(results))) + empty


def brackets(results: Results) -> list[Bracket]:
    """Returns the bracket of every diagonal entry that the field solver encloses and boundary elements bound from below."""
    found = []
    for case, reference, boundary in _by_both(results):
        is_bound = dict(zip(boundary.conductors, boundary.lower_bounds, strict=True))
        for here, name in enumerate(reference.conductors):
            if reference.is_proven and is_bound.get(name):
                own = boundary.self_capacitance(name)
                flux, upper = float(reference.lower[here, here]), float(reference.upper[here, here])
                found.append(Bracket(case, name, own.value - QUADRATURE_SHARE * own.error, flux, upper))
    return found


def _of_case(case: CaseResult, reference: MatrixAnswer, boundary: MatrixAnswer) -> list[Comparison]:
    common = [name for name in reference.conductors if name in boundary.conductors]
    found = []
    for pair in combinations_with_replacement(common, 2):
        by_field, by_boundary = (tuple(map(each.conductors.index, pair)) for each in (reference, boundary))
        matrices = reference.maxwell, reference.lower, reference.upper
        value, low, high = (float(each[by_field]) for each in matrices)
        other = Estimate(float(boundary.maxwell[by_boundary]), float(boundary.error[by_boundary]))
        found.append(Comparison(case, f"M[{', '.join(pair)}]", value, low, high, other))
    also = _changes(case, boundary)
    for what, change in _changes(case, reference).items():
        if what in also:
            low, high = change.value - change.error, change.value + change.error
            found.append(Comparison(case, what, change.value, low, high, also[what]))
    return found


def _changes(case: CaseResult, answer: MatrixAnswer) -> dict[str, Estimate]:
    own = {f"delta_self {sensor}": change for sensor, change in answer.delta_self.items()}
    # Elsewhere the changes are delta_self once more.
    if is_delta_self(case.scene):
        return own
    return own | {f"change {name}": reading.change for name, reading in answer.readings.items()}


TITLE = "Boundary elements against the field solver"
_ABSENT = "No case of these results was solved by both methods: run the study's command again."
# Ordinate of differences below rounding: a logarithmic axis has no zero.
_ROUNDING = 1e-9
_WHAT = (
    "Boundary elements (model/BOUNDARY_ELEMENTS.md) share nothing with the field solver but the scene file: other equations, another "
    "language, another reader. They are asked for a tenth of the field solver's accuracy. Two values agree when their error bars "
    "overlap: below the line."
)
_PROOF = (
    "Galerkin's charges have the least energy of all, so that the entries of the diagonal are lower bounds once a twentieth of their "
    "stated error, the most that the integrals may be off, is taken away; the upper ones are energies of continuous potentials by the "
    "field solver. Before: the field solver's own lower bound, by divergence-free fluxes."
)


def sections(results: Results) -> list[Markup]:
    """Returns the agreement, the brackets and what is not comparable; one sentence if nothing is comparable."""
    found = comparisons(results)
    if not found:
        return [page.section(TITLE, page.paragraph(_ABSENT), *_refused(results))]
    parts = [page.finding(finding(found))]
    wrong = disagreements(found)
    if wrong:
        parts += [page.heading("Values that disagree"), _table(wrong)]
    solved = [case.boundary for case in results.cases.values() if case.boundary is not None]
    seconds = float(np.median([answer.seconds for answer in solved]))
    short = f"{sum(not answer.reached for answer in solved)} of {len(solved)} are short of what was asked"
    told = f"{_WHAT} They took {duration(seconds)} (median); {short}, with wider errors."
    parts += [page.figures([_panel(found)]), page.soft(told), page.folded("Show every value", _table(found))]
    made = [page.section(TITLE, *parts, *_refused(results))]
    proven = brackets(results)
    return [*made, _brackets(proven)] if proven else made


def finding(found: list[Comparison]) -> str:
    """Tells how many values agree, and how far apart the others are."""
    cases = {comparison.case.id for comparison in found}
    wrong = disagreements(found)
    worst = found[0]
    sentence = (
        f"In {len(cases)} set-ups both methods answer: {len(found) - len(wrong)} of {len(found)} values agree within the sum of their "
        f"errors, half of them within {np.median([abs(c.difference) for c in found]):.1e} of each other"
    )
    place = f"{worst.what} of {worst.case.name}"
    if wrong:
        return f"{sentence}; {len(wrong)} disagree, {place} by {worst.over_errors:.2g} times what the errors allow."
    return f"{sentence}; the largest difference is {percent(worst.over_errors)} of what the errors allow ({place})."


def in_short(results: Results) -> str:
    """Tells in words how many values agree; empty if nothing is comparable."""
    found = comparisons(results)
    if not found:
        return ""
    agreeing = len(found) - len(disagreements(found))
    apart = percent(float(np.median([abs(each.difference) for each in found])))
    return (
        f"Two solvers that share no code, by finite and by boundary elements, agree within the errors that they state in {agreeing:,} of "
        f"{len(found):,} values; half are within {apart} of each other."
    )


def warning(results: Results, target: str) -> Markup:
    """Returns, for the head of the report, a finding with a link if values disagree; else nothing."""
    wrong = contradictions(results)
    if not wrong:
        return Markup("")
    link = page.link(target, f"{wrong} values of the two references disagree by more than their errors")
    told = page.strong(Markup("{}.").format(link))
    return page.finding(Markup("{} One of the two values, or its stated error, is wrong.").format(told))


def bracket_finding(brackets: list[Bracket]) -> str:
    """Compares the widths of the combined brackets with those of the field solver alone."""
    widths = np.array([bracket.width for bracket in brackets])
    before = np.array([bracket.width_before for bracket in brackets])
    contradicted = int((widths < 0).sum())
    sentence = (
        f"{len(brackets)} diagonal entries lie between Galerkin's lower bound and the field solver's upper one: the bracket is "
        f"{np.median(widths):.1e} wide (median; widest {widths.max():.1e}), {np.median(before / np.maximum(widths, 1e-12)):.2g} times "
        f"narrower (median) than the field solver's alone, which are {before.min():.1e} to {before.max():.1e} wide"
    )
    empty = f"; {contradicted} brackets are empty, which no true bounds can be" if contradicted else ""
    return f"{sentence}{empty}."


def _panel(found: list[Comparison]) -> Panel:
    allowed = [comparison.allowed for comparison in found]
    ends = [min(allowed) / 2, max(allowed) * 2]
    points = by_family(
        found,
        lambda each: each.case.family,
        "%{text}: off by %{y:.1e}, allowed %{x:.1e}",
        x=lambda each: each.allowed,
        y=lambda each: max(abs(each.difference), _ROUNDING),
        customdata=lambda each: each.case.id,
        text=lambda each: each.what,
    )
    x, y = power_axis("both errors together, relative"), power_axis("difference, relative")
    caption = "every value; below the line the error bars overlap"
    return Panel(caption, figure([guide("limit", ends, ends), *points], x, y, height=460))


def _table(found: list[Comparison]) -> Markup:
    return page.table_of(
        found,
        ("set-up", lambda c: page.case_link(c.case.id, c.case.name)),
        ("value", lambda c: c.what),
        ("field solver (pF)", lambda c: f"{c.reference / PICOFARAD:.6f}"),
        ("from", lambda c: f"{c.low / PICOFARAD:.6f}"),
        ("to", lambda c: f"{c.high / PICOFARAD:.6f}"),
        ("boundary elements (pF)", lambda c: c.boundary.in_picofarads),
        ("difference", lambda c: f"{c.difference:+.1e}"),
        ("allowed", lambda c: f"{c.allowed:.1e}"),
        ("overlap", lambda c: page.yes_or_no(c.agrees)),
        text_columns=2,
    )


def _brackets(brackets: list[Bracket]) -> Markup:
    table = page.table_of(
        sorted(brackets, key=lambda bracket: -bracket.width),
        ("set-up", lambda bracket: page.case_link(bracket.case.id, bracket.case.name)),
        ("conductor", lambda bracket: bracket.conductor),
        ("lower (pF)", lambda bracket: f"{max(bracket.lower, bracket.flux) / PICOFARAD:.6f}"),
        ("upper (pF)", lambda bracket: f"{bracket.upper / PICOFARAD:.6f}"),
        ("width", lambda bracket: f"{bracket.width:.1e}"),
        ("by the field solver alone", lambda bracket: f"{bracket.width_before:.1e}"),
        text_columns=2,
    )
    return page.section(
        "Diagonal entries between two proven bounds",
        page.finding(bracket_finding(brackets)),
        page.figures([_bracket_panel(brackets)]),
        page.soft(_PROOF),
        page.folded("Show every bracket", table),
    )


def _bracket_panel(brackets: list[Bracket]) -> Panel:
    before = [bracket.width_before for bracket in brackets]
    ends = [min(before) / 2, max(before) * 2]
    widths = [max(bracket.width, _ROUNDING) for bracket in brackets]
    named = [f"{bracket.case.family}, {bracket.conductor}" for bracket in brackets]
    look, cases = {"color": series_colour(0), "size": 8}, [bracket.case.id for bracket in brackets]
    hover = "%{text}: %{y:.1e} instead of %{x:.1e}<extra></extra>"
    points = marks("diagonal entries", before, widths, look, hover, customdata=cases, text=named)
    x, y = power_axis("width by the field solver alone"), power_axis("width of the bracket")
    drawn = figure([guide("as wide", ends, ends), points], x, y, height=420)
    return Panel("relative widths of the intervals that hold M[i, i]", drawn)


def _refused(results: Results) -> list[Markup]:
    """Returns the cases that boundary elements refuse, by reason."""
    refused = [case for case in results.cases.values() if case.refused]
    if not refused:
        return []
    told: list[str] = [f"{len(refused)} set-ups are not comparable: boundary elements refuse them."]
    for reason, own in grouped(refused, lambda case: case.refused).items():
        links = Markup(", ").join(page.case_link(each.id, each.name) for each in own)
        told.append(Markup("{}: {}.").format(reason, links))
    return [page.heading("Not comparable"), *map(page.paragraph, told)]

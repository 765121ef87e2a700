"""The report's page on the two references side by side: do they agree, and what do both prove together?"""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

from analysis.report import page
from analysis.report.plot import Panel, by_family, figure, guide, marks, power_axis, series_colour
from analysis.results.study_results import Results
from analysis.results.units import duration, percent
from analysis.topics.cross_check import agreement
from analysis.topics.cross_check.agreement import Bracket, Comparison
from geometries.common.measured import PICOFARAD, picofarads

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
    found = agreement.comparisons(results)
    refused = {case.id: case.refused for case in results.cases.values() if case.refused}
    if not found:
        return [page.section(TITLE, page.paragraph(_ABSENT), *_refused(results, refused))]
    parts = [page.finding(finding(found))]
    wrong = agreement.disagreements(found)
    if wrong:
        parts += [page.heading("Values that disagree"), _table(wrong)]
    parts += [page.figures([_panel(found)]), page.soft(f"{_WHAT} {_reached(results)}")]
    parts.append(page.folded("Show every value", _table(found)))
    made = [page.section(TITLE, *parts, *_refused(results, refused))]
    brackets = agreement.brackets(results)
    return [*made, _brackets(brackets)] if brackets else made


def finding(found: list[Comparison]) -> str:
    """Tells how many values agree, and how far apart the others are."""
    cases = {comparison.case.id for comparison in found}
    wrong = agreement.disagreements(found)
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
    found = agreement.comparisons(results)
    if not found:
        return ""
    agreeing = len(found) - len(agreement.disagreements(found))
    apart = percent(float(np.median([abs(each.difference) for each in found])))
    return (
        f"Two solvers that share no code, by finite and by boundary elements, agree within the errors that they state in {agreeing:,} of "
        f"{len(found):,} values; half are within {apart} of each other."
    )


def _reached(results: Results) -> str:
    solved = [case.boundary for case in results.cases.values() if case.boundary is not None]
    short = sum(not answer.reached for answer in solved)
    seconds = float(np.median([answer.seconds for answer in solved]))
    return f"They took {duration(seconds)} (median); {short} of {len(solved)} are short of what was asked, with wider errors."


def warning(results: Results, target: str) -> Markup:
    """Returns, for the head of the report, a finding with a link if values disagree; else nothing."""
    wrong = agreement.contradictions(results)
    if not wrong:
        return Markup("")
    link = page.link(target, f"{wrong} values of the two references disagree by more than their errors")
    return page.finding(
        Markup("{} One of the two values, or its stated error, is wrong.").format(
            page.strong(Markup("{}.").format(link))
        )
    )


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
    return (
        f"{sentence}; {contradicted} brackets are empty, which no true bounds can be."
        if contradicted
        else f"{sentence}."
    )


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
        ("boundary elements (pF)", lambda c: picofarads(c.boundary.value, c.boundary.error)),
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
    points = marks(
        "diagonal entries",
        before,
        [max(bracket.width, _ROUNDING) for bracket in brackets],
        {"color": series_colour(0), "size": 8},
        "%{text}: %{y:.1e} instead of %{x:.1e}<extra></extra>",
        customdata=[bracket.case.id for bracket in brackets],
        text=[f"{bracket.case.family}, {bracket.conductor}" for bracket in brackets],
    )
    x, y = power_axis("width by the field solver alone"), power_axis("width of the bracket")
    drawn = figure([guide("as wide", ends, ends), points], x, y, height=420)
    return Panel("relative widths of the intervals that hold M[i, i]", drawn)


def _refused(results: Results, refused: dict[str, str]) -> list[Markup]:
    """Returns the cases that boundary elements refuse, by reason."""
    if not refused:
        return []
    reasons: dict[str, list[Markup]] = {}
    for case, reason in refused.items():
        reasons.setdefault(reason, []).append(page.case_link(case, results.cases[case].name))
    sentence = f"{len(refused)} set-ups are not comparable: boundary elements refuse them."
    listed = [
        page.paragraph(Markup("{}: {}.").format(reason, Markup(", ").join(cases)))
        for reason, cases in reasons.items()
    ]
    return [page.heading("Not comparable"), page.paragraph(sentence), *listed]

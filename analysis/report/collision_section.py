"""The report's section on collision detection: where the thesis' algorithm fails, and times beside other libraries."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from markupsafe import Markup

from analysis.report import measured, page
from analysis.results.store import Document
from analysis.results.units import percent

TITLE = "Collision detection"
OWN, _ALL_PAIRS = "fringe", "all pairs"

_ANSWERS = (
    "Random pairs of hulls of few vertices, some of each class in units of length from 2^-150 to 2^150, against linear "
    "programming in integers. Gaps and overlaps of apart_by_gap, at_a_face, crossing_edges, coplanar and twins are from 1e-15 to "
    "1e-3 of their size, or 0; on_a_grid, coplanar and twins have many that touch. Exactly: what floating point left open was "
    "decided in integers. The thesis' Algorithm 2.1 is asked as printed, for at most 200 support points."
)
_QUERIES = (
    "Nanoseconds per query, medians of rounds in which all take turns, one core, no query knowing of an earlier one. Half of the "
    "pairs intersect, but in the rows of faces that touch: there every answer but yes is wrong, or, turned, may be for the "
    "poses' rounding. Small: how many answers differ from fringe's."
)
_SCENES = "Milliseconds per frame in which every object moves, and small how many collisions were found."


@dataclass(frozen=True)
class PairClass:
    """The answers on pairs of one kind, compared with exact arithmetic.

    `wrong` and `unproven` are of this project's answers; `exact` counts the pairs that needed exact arithmetic;
    `thesis_wrong` and `thesis_endless` are of the thesis' algorithm as it is printed.
    """

    name: str
    pairs: int
    intersecting: int
    wrong: int
    unproven: int
    exact: int
    thesis_wrong: int
    thesis_endless: int


@dataclass(frozen=True)
class QueryTimes:
    """Nanoseconds per query and how many pairs were found to intersect, by library."""

    name: str
    pairs: int
    nanoseconds: dict[str, float]
    intersecting: dict[str, int]

    @staticmethod
    def of(entry: Document) -> QueryTimes:
        """Returns the times of a row of the stored answer."""
        return QueryTimes(
            entry["name"],
            entry["pairs"],
            {peer["name"]: float(peer["nanoseconds"]) for peer in entry["peers"]},
            {peer["name"]: int(peer["intersecting"]) for peer in entry["peers"]},
        )


@dataclass(frozen=True)
class SceneTimes:
    """Milliseconds per frame and collisions found, by the way of finding them."""

    objects: int
    milliseconds: dict[str, float]
    collisions: dict[str, int]

    @staticmethod
    def of(entry: Document) -> SceneTimes:
        """Returns the times of a scene of the stored answer."""
        return SceneTimes(
            entry["objects"],
            {way["name"]: float(way["milliseconds"]) for way in entry["ways"]},
            {way["name"]: int(way["collisions"]) for way in entry["ways"]},
        )


def section(answers: Document | None, queries: Document | None, scenes: Document | None) -> Markup:
    """Returns three tables, each below its finding; those that were not measured are left out."""
    return measured.section(TITLE, (answers, queries, scenes), _parts)


def _parts(answers: Document | None, queries: Document | None, scenes: Document | None) -> Iterator[Markup]:
    if answers is not None:
        classes = [PairClass(**entry) for entry in answers["answer"]["classes"]]
        yield page.finding(finding_on_answers(classes))
        yield from (_classes_table(classes), page.soft(_ANSWERS))
    if queries is not None:
        rows = [QueryTimes.of(entry) for entry in queries["answer"]["rows"]]
        yield page.finding(finding_on_queries(rows))
        yield from (_queries_table(rows), page.soft(_QUERIES))
    if scenes is not None:
        frames = [SceneTimes.of(entry) for entry in scenes["answer"]["scenes"]]
        yield page.finding(finding_on_scenes(frames))
        yield from (_scenes_table(frames), page.soft(_SCENES))


def finding_on_answers(classes: Sequence[PairClass]) -> str:
    """Returns how many answers are wrong, of this project and of the thesis, and where the thesis' are worst."""
    pairs = sum(each.pairs for each in classes)
    wrong, unproven = sum(each.wrong for each in classes), sum(each.unproven for each in classes)
    exact = sum(each.exact for each in classes)
    thesis_wrong = sum(each.thesis_wrong for each in classes)
    endless = sum(each.thesis_endless for each in classes)
    worst = max(classes, key=_failing_share)
    return (
        f"Of {pairs:,} pairs {wrong:,} were answered wrong and {unproven:,} without a proof, {_share(exact, pairs)} took exact "
        f"arithmetic; the thesis' algorithm was wrong for {thesis_wrong:,} and did not end for {endless:,}, most often in "
        f"the class {worst.name}, {_share(worst.thesis_wrong + worst.thesis_endless, worst.pairs)}."
    )


def finding_on_queries(queries: Sequence[QueryTimes]) -> str:
    """Compares the times of every row with those of the fastest other library."""
    ratios = {}
    for row in queries:
        others = [time for name, time in row.nanoseconds.items() if name != OWN]
        if others and OWN in row.nanoseconds:
            ratios[row.name] = min(others) / row.nanoseconds[OWN]
    if not ratios:
        return "No other library was measured."
    slower = [name for name, ratio in ratios.items() if ratio < 1]
    least, most = min(ratios, key=lambda name: ratios[name]), max(ratios, key=lambda name: ratios[name])
    comparison = f"slower in: {', '.join(slower)}" if slower else "in no row slower"
    return (
        f"Beside the fastest other library of each row fringe is {comparison}; that library takes from {_figures(ratios[least])} "
        f"({least}) to {_figures(ratios[most])} times as long ({most})."
    )


def finding_on_scenes(scenes: Sequence[SceneTimes]) -> str:
    """Tells how the cost grows with the scene, and whether all methods found the same collisions."""
    small, large = scenes[0], scenes[-1]
    agree = all(len(set(scene.collisions.values())) == 1 for scene in scenes)
    own = large.milliseconds[OWN]
    others = ", ".join(
        f"{_figures(time / own)} times as long by {name}"
        for name, time in large.milliseconds.items()
        if name != OWN
    )
    return (
        f"{_figures(large.objects / small.objects)} times as many objects have {_figures(_ratio(large.collisions, small.collisions))} "
        f"times the collisions and take {_figures(own / small.milliseconds[OWN])} times as long, all pairs "
        f"{_figures(_ratio(large.milliseconds, small.milliseconds, _ALL_PAIRS))} times; a frame of {large.objects:,} takes {others}; "
        f"{'all ways found the same number' if agree else 'the ways found different numbers'}."
    )


def _ratio(
    large: dict[str, float] | dict[str, int], small: dict[str, float] | dict[str, int], name: str = OWN
) -> float:
    return large[name] / small[name] if small[name] else float("nan")


def _failing_share(entry: PairClass) -> float:
    return (entry.thesis_wrong + entry.thesis_endless) / entry.pairs if entry.pairs else 0.0


def _share(part: int, whole: int) -> str:
    return percent(part / whole) if whole else "none"


def _figures(number: float) -> str:
    """Writes a number with two digits, or with all digits before the point."""
    return f"{number:.0f}" if abs(number) >= 10 else f"{number:.2g}"


def _classes_table(classes: Sequence[PairClass]) -> Markup:
    return page.table_of(
        classes,
        ("class", lambda each: page.code(each.name)),
        ("pairs", lambda each: f"{each.pairs:,}"),
        ("intersecting", lambda each: _share(each.intersecting, each.pairs)),
        ("wrong", lambda each: f"{each.wrong:,}"),
        ("unproven", lambda each: f"{each.unproven:,}"),
        ("exactly", lambda each: f"{each.exact:,}"),
        ("thesis wrong", lambda each: f"{each.thesis_wrong:,}"),
        ("did not end", lambda each: f"{each.thesis_endless:,}"),
    )


def _queries_table(queries: Sequence[QueryTimes]) -> Markup:
    names = list(dict.fromkeys(name for row in queries for name in row.nanoseconds))
    rows = [[row.name, *(_query_cell(row, name) for name in names)] for row in queries]
    return page.table(["pairs of", *names], rows)


def _query_cell(row: QueryTimes, name: str) -> str:
    if name not in row.nanoseconds:
        return ""
    time = f"{row.nanoseconds[name]:,.1f}"
    if name == OWN:
        return page.strong(time)
    difference = row.intersecting[name] - row.intersecting[OWN]
    return page.two_lines(time, f"{difference:+,}", small=True) if difference else time


def _scenes_table(scenes: Sequence[SceneTimes]) -> Markup:
    names = list(scenes[0].milliseconds)
    rows = [
        [
            f"{scene.objects:,}",
            *(
                page.two_lines(f"{scene.milliseconds[name]:,.3g}", f"{scene.collisions[name]:,}", small=True)
                for name in names
            ),
        ]
        for scene in scenes
    ]
    return page.table(["objects", *names], rows)

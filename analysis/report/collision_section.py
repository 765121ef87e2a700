"""The report's section on collision detection: where the thesis' algorithm fails, and times beside other libraries."""

from collections.abc import Iterator, Sequence

from markupsafe import Markup

from analysis.report import page
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


def section(answers: Document | None, queries: Document | None, scenes: Document | None) -> Markup:
    """Returns three tables, each below its finding; those that were not measured are left out."""
    return page.measured_section(TITLE, (answers, queries, scenes), _parts)


def _parts(answers: Document | None, queries: Document | None, scenes: Document | None) -> Iterator[Markup]:
    def by_name(entries: Sequence[Document]) -> Named:
        return {entry["name"]: entry for entry in entries}

    if answers is not None:
        classes = answers["answer"]["classes"]
        yield from (page.finding(finding_on_answers(classes)), _classes_table(classes), page.soft(_ANSWERS))
    if queries is not None:
        rows = {entry["name"]: by_name(entry["peers"]) for entry in queries["answer"]["rows"]}
        names = list(dict.fromkeys(name for peers in rows.values() for name in peers))
        cells = [[row, *(_query_cell(peers, name) for name in names)] for row, peers in rows.items()]
        table = page.table(["pairs of", *names], cells)
        yield from (page.finding(finding_on_queries(rows)), table, page.soft(_QUERIES))
    if scenes is not None:
        frames = {entry["objects"]: by_name(entry["ways"]) for entry in scenes["answer"]["scenes"]}
        yield from (page.finding(finding_on_scenes(frames)), _scenes_table(frames), page.soft(_SCENES))


Named = dict[str, Document]
"""What was measured of each library, or way, by its name."""


def finding_on_answers(classes: Sequence[Document]) -> str:
    """Returns how many answers are wrong, of this project and of the thesis, and where the thesis' are worst."""
    count = {what: sum(each[what] for each in classes) for what in classes[0] if what != "name"}
    worst = max(classes, key=lambda each: float(_failing(each) / each["pairs"]) if each["pairs"] else 0.0)
    return (
        f"Of {count['pairs']:,} pairs {count['wrong']:,} were answered wrong and {count['unproven']:,} without a proof, "
        f"{_share(count['exact'], count['pairs'])} took exact arithmetic; the thesis' algorithm was wrong for {count['thesis_wrong']:,} and "
        f"did not end for {count['thesis_endless']:,}, most often in the class {worst['name']}, {_share(_failing(worst), worst['pairs'])}."
    )


def finding_on_queries(queries: dict[str, Named]) -> str:
    """Compares the times of every row with those of the fastest other library."""
    ratios: list[tuple[float, str]] = []
    for name, peers in queries.items():
        others = [float(peer["nanoseconds"]) for library, peer in peers.items() if library != OWN]
        if others and OWN in peers:
            ratios.append((min(others) / peers[OWN]["nanoseconds"], name))
    if not ratios:
        return "No other library was measured."
    slower = [name for ratio, name in ratios if ratio < 1]
    (least, nearest), (most, farthest) = min(ratios), max(ratios)
    comparison = f"slower in: {', '.join(slower)}" if slower else "in no row slower"
    return (
        f"Beside the fastest other library of each row fringe is {comparison}; that library takes from {_figures(least)} "
        f"({nearest}) to {_figures(most)} times as long ({farthest})."
    )


def finding_on_scenes(scenes: dict[int, Named]) -> str:
    """Tells how the cost grows with the scene, and whether all methods found the same collisions."""
    (few, small), (many, large) = list(scenes.items())[0], list(scenes.items())[-1]
    agree = all(len({way["collisions"] for way in ways.values()}) == 1 for ways in scenes.values())
    own = large[OWN]["milliseconds"]
    ratios = {name: _figures(way["milliseconds"] / own) for name, way in large.items() if name != OWN}
    others = ", ".join(f"{ratio} times as long by {name}" for name, ratio in ratios.items())

    def growth(way: str, what: str) -> str:
        return _figures(large[way][what] / small[way][what] if small[way][what] else float("nan"))

    return (
        f"{_figures(many / few)} times as many objects have {growth(OWN, 'collisions')} times the collisions and take "
        f"{growth(OWN, 'milliseconds')} times as long, all pairs {growth(_ALL_PAIRS, 'milliseconds')} times; a frame of {many:,} takes "
        f"{others}; {'all ways found the same number' if agree else 'the ways found different numbers'}."
    )


def _failing(entry: Document) -> int:
    return int(entry["thesis_wrong"] + entry["thesis_endless"])


def _share(part: int, whole: int) -> str:
    return percent(part / whole) if whole else "none"


def _figures(number: float) -> str:
    """Writes a number with two digits, or with all digits before the point."""
    return f"{number:.0f}" if abs(number) >= 10 else f"{number:.2g}"


def _classes_table(classes: Sequence[Document]) -> Markup:
    return page.table_of(
        classes,
        ("class", lambda each: page.code(each["name"])),
        ("pairs", lambda each: f"{each['pairs']:,}"),
        ("intersecting", lambda each: _share(each["intersecting"], each["pairs"])),
        ("wrong", lambda each: f"{each['wrong']:,}"),
        ("unproven", lambda each: f"{each['unproven']:,}"),
        ("exactly", lambda each: f"{each['exact']:,}"),
        ("thesis wrong", lambda each: f"{each['thesis_wrong']:,}"),
        ("did not end", lambda each: f"{each['thesis_endless']:,}"),
    )


def _query_cell(peers: Named, name: str) -> str:
    if name not in peers:
        return ""
    time = f"{peers[name]['nanoseconds']:,.1f}"
    if name == OWN:
        return page.strong(time)
    difference = peers[name]["intersecting"] - peers[OWN]["intersecting"]
    return page.two_lines(time, f"{difference:+,}", small=True) if difference else time


def _scenes_table(scenes: dict[int, Named]) -> Markup:
    def cell(way: Document) -> Markup:
        return page.two_lines(f"{way['milliseconds']:,.3g}", f"{way['collisions']:,}", small=True)

    rows = [[f"{objects:,}", *map(cell, ways.values())] for objects, ways in scenes.items()]
    return page.table(["objects", *next(iter(scenes.values()))], rows)

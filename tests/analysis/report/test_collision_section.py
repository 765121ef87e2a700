"""The report's section on collision detection: findings computed by hand, and cells that say what was measured."""

from __future__ import annotations

from markupsafe import escape
from pathlib import Path
from typing import Any

from analysis.report import collision_section
from analysis.results import collision_measurements, store, study_results as results
from analysis.study import report
from tests.analysis.synthetic import make_results, report_text

ORIGIN = {"key": "k", "processor": "a processor", "instruction_sets": "AVX2", "command": "it", "passed": True}


def counts(name: str, **more: int) -> dict[str, Any]:
    entry = {"pairs": 1000, "intersecting": 500, "wrong": 0, "unproven": 0, "exact": 20}
    return {"name": name} | entry | {"thesis_wrong": 0, "thesis_endless": 0} | more


def times(name: str, **nanoseconds: float) -> dict[str, Any]:
    peers = [{"name": peer, "nanoseconds": time, "intersecting": 50} for peer, time in nanoseconds.items()]
    return {"name": name, "pairs": 100, "peers": peers}


def scene(objects: int, own: float, all_pairs: float, collisions: int) -> dict[str, Any]:
    ways = {"fringe": own, "all pairs": all_pairs}
    return {
        "objects": objects,
        "ways": [{"name": n, "milliseconds": t, "collisions": collisions} for n, t in ways.items()],
    }


ANSWERS = ORIGIN | {
    "answer": {"classes": [counts("easy"), counts("hard", thesis_wrong=200, thesis_endless=50)]}
}
QUERIES = ORIGIN | {
    "answer": {"rows": [times("cubes", fringe=30, FCL=300, Bullet=600), times("cones", fringe=100, FCL=200)]}
}
SCENES = ORIGIN | {"answer": {"scenes": [scene(100, 1, 2, 10), scene(1000, 12, 200, 100)]}}


def measured(*documents: dict[str, Any] | None) -> collision_measurements.Collision:
    found = collision_measurements.collision(*documents)
    assert found is not None
    return found


def test_the_finding_on_answers_computed_by_hand() -> None:
    text = collision_section.finding_on_answers(measured(ANSWERS, None, None).classes)
    assert "Of 2,000 pairs 0 were answered wrong and 0 without a proof, 2 % took exact arithmetic" in text
    assert "wrong for 200 and did not end for 50, most often in the class hard, 25 %" in text


def test_the_finding_on_times_computed_by_hand() -> None:
    text = collision_section.finding_on_queries(measured(None, QUERIES, None).queries)
    assert "in no row slower" in text
    assert "takes from 2 (cones) to 10 times as long (cubes)" in text


def test_a_row_that_is_slower_is_named() -> None:
    slow = ORIGIN | {"answer": {"rows": [times("cubes", fringe=400, FCL=300)]}}
    assert "slower in: cubes" in collision_section.finding_on_queries(measured(None, slow, None).queries)


def test_the_finding_on_scenes_computed_by_hand() -> None:
    text = collision_section.finding_on_scenes(measured(None, None, SCENES).scenes)
    assert "10 times as many objects have 10 times the collisions and take 12 times as long" in text
    assert "all pairs 100 times" in text and "17 times as long by all pairs" in text
    assert "all ways found the same number" in text


def test_other_answers_are_told_in_their_cell() -> None:
    row = times("cubes", fringe=30, FCL=300)
    row["peers"][1]["intersecting"] = 47
    text = collision_section.section(measured(None, ORIGIN | {"answer": {"rows": [row]}}, None))
    assert "<strong>30.0</strong>" in text and "<small>−3</small>" in text


def test_results_without_measurements_say_so(tmp_path: Path) -> None:
    page = report_text(make_results(tmp_path))
    assert f"<h2>{collision_section.TITLE}</h2>\n<p>These results have no measurement" in page


def test_the_report_takes_measurements_up_when_they_appear(tmp_path: Path) -> None:
    folder = make_results(tmp_path)
    report.make(folder)
    for name, document in zip(results.COLLISION, (ANSWERS, QUERIES, SCENES)):
        store.write_json(folder / name, document)
    page = report_text(folder)
    assert escape(collision_section.finding_on_answers(measured(ANSWERS, None, None).classes)) in page
    assert page.count("did not end</th>") == 1

"""What the report says of measurements of the model by itself: findings computed by hand, and cells that say what was measured."""

import re
from pathlib import Path
from typing import Any

import pytest

from analysis.report import collision_section, run_times_section, stability_section
from analysis.results import statistics, store, study_results as results
from tests.analysis.synthetic import make_results, report_text

ORIGIN = {
    "key": "k",
    "processor": "a processor",
    "instruction_sets": "AVX2",
    "command": "build/bin/it",
    "passed": True,
}


def timed(name: str, family: int, nanoseconds: float, error: float, **more: Any) -> dict[str, Any]:
    """An entry of the benchmark's answer."""
    seconds = nanoseconds / 1e9
    entry = {"name": name, "family_index": family, "run_type": "iteration", "triangles": 2000.0}
    return entry | {"per_triangle": seconds, "error": error} | more


def run_times_document(*entries: dict[str, Any]) -> dict[str, Any]:
    return ORIGIN | {"answer": {"context": {"compiler": "a compiler"}, "benchmarks": list(entries)}}


TIMES = run_times_document(
    timed("I_fine/exact", 0, 50, 4e-16),
    timed("I_fine/split:4", 1, 800, 3e-7),
    timed("I_fine/split:0", 2, 30, 8e-5),
    timed("II_fine/exact", 3, 200, 5e-16),
    timed("II_fine/split:4", 4, 700, 4e-7),
    timed("II_fine/split:0", 5, 250, 8e-5),
)


def errors_document(**more: Any) -> dict[str, Any]:
    errors = {
        "triangles": 100,
        "not_finite": 0,
        "wrong_by_1_percent": 0,
        "largest_error": 1e-15,
        "median_error": 1e-16,
        "largest_over_conditioning": 4.0,
        "median_over_conditioning": 0.5,
        "percentile_99_over_conditioning": 3.0,
    }
    return errors | more


def stability_document(exact: dict[str, Any] | None = None, **more: Any) -> dict[str, Any]:
    """Two classes: in the second the thesis' formula gives no number for 7 of its 40 triangles."""
    nothing = errors_document(
        triangles=0, largest_over_conditioning=None, percentile_99_over_conditioning=None
    )
    thesis = errors_document(triangles=40, not_finite=7, wrong_by_1_percent=9, largest_over_conditioning=2e6)
    classes = [
        {"name": "random", "truth_failed": 0, "methods": {"exact": errors_document(), "thesis": nothing}},
        {
            "name": "parallel",
            "truth_failed": 0,
            "methods": {"thesis": thesis, "exact": exact or errors_document()},
        },
    ]
    return ORIGIN | {"answer": {"limit": 16.0, "classes": classes}} | more


def test_of_repetitions_in_any_order_the_fastest_counts_and_aggregates_do_not() -> None:
    found = run_times_section.by_set(
        [
            timed("b/exact", 1, 90, 2e-16),
            timed("a/split:4", 0, 30, 1e-7),
            timed("b/exact", 1, 80, 2e-16),
            timed("b/exact", 1, 1, 2e-16, run_type="aggregate"),
            timed("a/split:4", 0, 40, 1e-7),
        ]
    )
    assert list(found.items()) == [
        ("a", {"split:4": timed("a/split:4", 0, 30, 1e-7)}),
        ("b", {"exact": timed("b/exact", 1, 80, 2e-16)}),
    ]


def test_the_front_is_what_nothing_else_beats_in_both() -> None:
    found = {
        "exact": (5.0, 1.0),
        "as slow as exact and worse": (5, 2),
        "fast": (1, 9),
        "beaten": (4, 6),
        "between": (3, 5),
    }
    found["as wrong as fast and slower"] = (2, 9)
    assert statistics.front(found, lambda method: found[method]) == ["fast", "between", "exact"]


def test_the_finding_on_run_times_computed_by_hand() -> None:
    text = run_times_section.finding(run_times_section.by_set(TIMES["answer"]["benchmarks"]))
    assert "exact is right to 5.0e-16 on every set" in text
    assert "split:4 takes from 3.5 to 16 times as long and is wrong by 3e-07 to 4e-07" in text
    assert text.endswith("are exact, split:0.")


def test_the_finding_on_stability_computed_by_hand() -> None:
    text = stability_section.finding(stability_document())
    assert "exact keeps the limit of 16 in all 2 classes" in text
    assert "Over 200 triangles exact is off by up to 4 times the conditioning" in text
    assert "Over 40 triangles the thesis' formula is off by up to 2e+06 times" in text
    assert "7 of its values are not finite, 9 are wrong by more than 1 %" in text


@pytest.mark.parametrize(
    "more", [{"largest_over_conditioning": 16.1}, {"not_finite": 1}, {"wrong_by_1_percent": 1}]
)
def test_a_class_in_which_the_exact_method_fails_is_named(more: dict[str, Any]) -> None:
    text = stability_section.finding(stability_document(errors_document(**more)))
    assert "exact fails, in: parallel." in text and "keeps" not in text


def test_what_the_program_found_wrong_is_never_told_as_right() -> None:
    assert "exact fails." in stability_section.finding(stability_document(passed=False))


def test_a_class_without_finite_values_has_counts_and_no_error() -> None:
    exact = errors_document(largest_over_conditioning=None, percentile_99_over_conditioning=None)
    text = stability_section.section(stability_document(exact))
    (row,) = re.findall(r"<tr><td class=\"text\">parallel</td>(.*?)</tr>", text)
    cells = re.findall(r"<td *>(.*?)</td>", row)
    assert cells == ["100", "", "", "0", "0", "2e+06", "3", "7 of 40", "9 of 40"]


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


def test_findings_on_collisions_computed_by_hand() -> None:
    text = collision_section.section(ANSWERS, QUERIES, SCENES)
    assert "Of 2,000 pairs 0 were answered wrong and 0 without a proof, 2 % took exact arithmetic" in text
    assert "wrong for 200 and did not end for 50, most often in the class hard, 25 %" in text
    assert "in no row slower" in text
    assert "takes from 2 (cones) to 10 times as long (cubes)" in text
    assert "10 times as many objects have 10 times the collisions and take 12 times as long" in text
    assert "all pairs 100 times" in text and "17 times as long by all pairs" in text
    assert "all ways found the same number" in text


def test_a_row_that_is_slower_is_named_and_other_answers_are_told_in_their_cell() -> None:
    row = times("cubes", fringe=400, FCL=300)
    row["peers"][1]["intersecting"] = 47
    text = collision_section.section(None, ORIGIN | {"answer": {"rows": [row]}}, None)
    assert "slower in: cubes" in text
    assert "<strong>400.0</strong>" in text and "<small>−3</small>" in text


SECTIONS = {
    run_times_section: ("a compiler", {results.RUN_TIMES: TIMES}),
    stability_section: ("exact keeps the limit of 16", {results.STABILITY: stability_document()}),
    collision_section: ("did not end</th>", dict(zip(results.COLLISION, (ANSWERS, QUERIES, SCENES)))),
}


def section_of(page: str, title: str) -> str:
    (found,) = re.findall(rf"<section>\s*<h2>{re.escape(title)}</h2>(.*?)</section>", page, re.DOTALL)
    return str(found)


def test_the_report_says_how_to_measure_and_takes_measurements_up_when_they_appear(tmp_path: Path) -> None:
    folder = make_results(tmp_path)
    page = report_text(folder)
    for section in SECTIONS:
        text = section_of(page, section.TITLE)
        assert "These results have no measurement" in text and "--measure-model" in text
    for _, documents in SECTIONS.values():
        for name, document in documents.items():
            store.write_json(folder / name, document)
    page = report_text(folder)
    for section, (told, _) in SECTIONS.items():
        text = section_of(page, section.TITLE)
        assert told in text
        assert "a processor" in text and "no measurement" not in text

"""The report's section on what boundary elements take: findings computed by hand, and what it says of the cube."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from analysis.report import boundary_times_section as section
from analysis.results import boundary_measurements, store, study_results as results
from analysis.study import report
from tests.analysis.synthetic import make_results, report_text


def scene(name: str, seconds: float, reached: bool = True) -> dict[str, Any]:
    entry = {"rtol": 0.01, "unknowns": 2853, "stated": 0.0077, "mebibytes": 183.4}
    return {"name": name, "seconds": seconds, "reached": reached} | entry


def size(panels: int, seconds: float, mebibytes: float) -> dict[str, Any]:
    return {"panels": panels, "seconds": seconds, "mebibytes": mebibytes, "error": 4e-5}


def solid(name: str, capacity: float, published: float | None) -> dict[str, Any]:
    entry = {"stated": 2e-4, "panels": 6432, "seconds": 2.1, "mebibytes": 90.0}
    return {"name": name, "capacity": capacity, "published": published} | entry


def document(cube: float = 0.66064, reached: bool = True) -> dict[str, Any]:
    answer = {
        "scenes": [scene("plates", 0.002), scene("arm", 60.2, reached)],
        "sizes": [size(50_000, 4.0, 900), size(100_000, 10.0, 1980)],
        "solids": [solid("cube", cube, 0.66067815), solid("octahedron", 0.5, None)],
    }
    origin = {"processor": "a processor", "instruction_sets": "AVX2", "command": "it", "passed": True}
    return {"key": "k"} | origin | {"answer": answer}


def measured(**more: Any) -> boundary_measurements.BoundaryTimes:
    found = boundary_measurements.boundary_times(document(**more))
    assert found is not None
    return found


def test_the_finding_on_scenes_computed_by_hand() -> None:
    text = section.finding_on_scenes(measured().scenes)
    assert text == "2 of 2 scenes have the accuracy asked for. The longest took 60 s: arm."


def test_a_scene_that_was_stopped_is_named() -> None:
    text = section.finding_on_scenes(measured(reached=False).scenes)
    assert text.startswith("1 of 2 scenes have the accuracy asked for, not: arm.")


def test_the_finding_on_sizes_computed_by_hand() -> None:
    text = section.finding_on_sizes(measured().sizes)
    assert text == (
        "100,000 panels take 10 s and 1,980 MiB: 2.0 times the panels take 2.5 times the time and 2.2 times the memory."
    )


def test_the_finding_on_solids_computed_by_hand() -> None:
    text = section.finding_on_solids(measured().solids)
    assert text == (
        "The capacities of the regular polyhedra are stated to 0.04 %; "
        "that of the cube is 0.0058 % off the published one, within its stated error."
    )


def test_a_capacity_beyond_its_stated_error_is_told() -> None:
    assert "beyond its stated error" in section.finding_on_solids(measured(cube=0.6600).solids)


def test_results_without_measurements_say_so(tmp_path: Path) -> None:
    page = report_text(make_results(tmp_path))
    assert f"<h2>{section.TITLE}</h2>\n<p>These results have no measurement" in page


def test_the_report_takes_measurements_up_when_they_appear(tmp_path: Path) -> None:
    folder = make_results(tmp_path)
    report.make(folder)
    store.write_json(folder / results.BOUNDARY_TIMES, document())
    page = report_text(folder)
    assert section.finding_on_scenes(measured().scenes) in page
    assert "0.66064 ± 0.00020" in page and "0.66067815" in page

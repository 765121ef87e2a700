"""Figures of a report: errors in the change of a reading by machine, targets coloured by what each part adds to the sensor, and small drawings of both."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.pipeline.model_stage import model_module
from analysis.report import drawing, plots_in_space, plots_of_errors
from analysis.report.drawing import thumbnail
from analysis.report.plot import Panel, Plot
from analysis.report.plots_in_space import areas, coloured
from analysis.results import study_results as results, table
from analysis.results.table import DELTA_SELF, MUTUAL
from analysis.results.units import VACUUM_PERMITTIVITY
from analysis.study import report
from geometries.scene.scene import Medium, Scene
from geometries.studies import families
from tests.analysis.synthetic import MACHINES, MACHINE_ANSWERS, make_results, report_text


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return make_results(tmp_path, MACHINES, MACHINE_ANSWERS)


def plot(folder: Path) -> Plot:
    return plots_of_errors.error_of_changes(table.rows(results.load(folder)))


def points(panel: Panel) -> dict[str, tuple[Any, Any]]:
    return {trace.name: (list(trace.x), list(trace.y)) for trace in panel.figure.data}


def test_the_change_is_drawn_by_machine_with_mutual_and_delta_self_beside_it(folder: Path) -> None:
    change, mutual, delta_self = plot(folder).panels
    assert [panel.caption for panel in (mutual, delta_self)] == ["mutual", "delta_self"]
    # 1.8 pF instead of 1 pF and of 0.8 pF; the model knows no change with a guard and none of a floating target.
    found = points(change)
    assert found["no machine"] == (pytest.approx([1.0]), pytest.approx([80.0]))
    assert found["housing"] == (pytest.approx([0.8]), pytest.approx([125.0]))
    assert set(found) == {"no machine", "housing"}
    assert points(mutual)["housing+guard"] == (pytest.approx([1.7]), pytest.approx([100 / 17]))
    assert set(points(delta_self)) == {"no machine"}


def test_the_finding_tells_the_error_by_machine_and_how_many_are_left_out(folder: Path) -> None:
    finding = plot(folder).finding
    assert finding.startswith(
        "In the change of a reading the model is 125 % too high with housing (one case), 80 % too high without a machine (one case)"
    )
    assert finding.endswith("The model knows no value of 2 more.")


def test_without_machines_delta_self_is_the_change_and_is_drawn_once(tmp_path: Path) -> None:
    change, mutual = plot(make_results(tmp_path)).panels
    assert list(points(change)) == ["no machine"] and mutual.caption == "mutual"
    assert len(points(change)["no machine"][0]) == 5


def test_it_is_the_first_figure_of_the_report_and_its_points_open_their_cases(folder: Path) -> None:
    text = report.make(folder).path.read_text(encoding="utf-8")
    first = text.index("plotly-graph-div", text.index("<body>"))
    assert text.index(plots_of_errors.TITLE) < first
    told = [
        text.index(f">{where}: the model is")
        for where in ("On machines, change of the reading", MUTUAL, DELTA_SELF)
    ]
    assert told == sorted(told)
    assert 'data-cases="cases"' in text
    for case in results.load(folder).compared():
        assert (f'"{case.id}"' in text) == (case.model is not None)


def test_every_page_is_made_where_the_model_knows_no_value(folder: Path) -> None:
    text = report_text(folder)
    pages = [case.folder / "case.html" for case in results.load(folder).compared()]
    for number, value in ((3, "0.100"), (2, "0.900")):
        told = f"change of sensor: {value} ± 0.010 pF by the field solver (estimated error); the model has no answer."
        assert told in pages[number].read_text()
    # Where the model has an answer, targets are coloured by what each part adds.
    assert ["fF/cm²" in page.read_text() for page in pages] == [True, True, True, False]
    assert ["machine (grey)" in page.read_text() for page in pages] == [False, True, True, True]
    assert "to ground 100 pF, machine housing" in pages[3].read_text()
    assert "rows of change" in text


def test_a_study_of_which_the_model_knows_nothing_has_a_report_too(tmp_path: Path) -> None:
    answers = {number: (reference, None) for number, (reference, _) in MACHINE_ANSWERS.items()}
    text = report_text(make_results(tmp_path, MACHINES, answers))
    assert plots_of_errors.TITLE not in text and "rows of change" in text


SIDE = 0.1
SQUARE = (SIDE, SIDE)
PER_SQUARE_CENTIMETRE = 1e-15 / 1e-4


def target_of(scene: Scene) -> Any:
    """The target as it is drawn."""
    (found,) = [trace for trace in coloured(scene).figure.data if trace.name == "target"]
    return found


def lowered(scene: Scene, height: float) -> Scene:
    """The scene with its target so much lower."""
    (body,) = scene.objects
    x, y, z = body.pose.translation
    return replace(scene, objects=(replace(body, pose=replace(body.pose, translation=(x, y, z - height))),))


@pytest.mark.parametrize("permittivity", [1.0, 3.0])
def test_between_parallel_plates_every_part_adds_the_same(permittivity: float) -> None:
    gap = 0.02
    target = target_of(replace(families.parallel(SQUARE, SQUARE, gap), medium=Medium(permittivity)))
    expected = permittivity * VACUUM_PERMITTIVITY / gap
    assert np.asarray(target.intensity) * PER_SQUARE_CENTIMETRE == pytest.approx(expected, rel=1e-3)
    assert len(target.i) == len(target.intensity) > 500


def test_parts_add_up_to_the_model_s_answer() -> None:
    scene = families.straddle(SQUARE, SQUARE, 0.02, (0.04, 0.0), 20.0, 0.0)
    target = target_of(scene)
    vertices = np.stack([target.x, target.y, target.z], axis=-1)
    corners = vertices[np.stack([target.i, target.j, target.k], axis=-1)]
    total = (areas(corners * 1e-2) * np.asarray(target.intensity)).sum() * PER_SQUARE_CENTIMETRE
    triangles = scene.conductors()[scene.objects[0].name]
    plate = scene.sensor_rectangles(scene.sensors[0].name)[0]
    expected = VACUUM_PERMITTIVITY * model_module().plate_integral(triangles, *plate).sum()
    assert total == pytest.approx(expected, rel=1e-3)


def test_what_touches_the_sensor_has_no_colour_and_the_rest_keeps_its_own() -> None:
    target = target_of(lowered(families.inclined(SQUARE, SQUARE, 0.01, 10.0), 0.01))
    assert np.isfinite(target.cmax) and target.cmax > 0


def test_a_target_that_lies_on_the_sensor_is_drawn() -> None:
    target = target_of(lowered(families.parallel(SQUARE, SQUARE, 0.02), 0.02))
    assert target.cmax == 0 and not np.isfinite(np.asarray(target.intensity, dtype=float)).any()


_POLYGON = re.compile(r'points="([^"]*)" fill="#(..)(..)(..)"')


def polygons(scene: Scene) -> list[tuple[np.ndarray, tuple[int, int, int]]]:
    found = _POLYGON.findall(drawing.of_scene(scene, "a scene"))
    return [
        (
            np.array([[float(x) for x in point.split(",")] for point in points.split()]),
            (int(r, 16), int(g, 16), int(b, 16)),
        )
        for points, r, g, b in found
    ]


def test_everything_is_within_the_drawing() -> None:
    points = np.concatenate([points for points, _ in polygons(families.parallel(SQUARE, SQUARE, 0.02))])
    assert (points >= 0).all() and (points <= (drawing.WIDTH, drawing.HEIGHT)).all()
    # One of the two directions is filled but for the margin.
    spans = np.ptp(points, axis=0) - (drawing.WIDTH, drawing.HEIGHT)
    assert spans.max() == pytest.approx(-2 * drawing.MARGIN, abs=0.2)


def test_the_target_above_hides_the_sensor_below() -> None:
    drawn = polygons(families.parallel(SQUARE, SQUARE, 0.001))
    middle = np.array([drawing.WIDTH, drawing.HEIGHT]) / 2
    covering = [colour for points, colour in drawn if np.linalg.norm(points.mean(axis=0) - middle) < 15]
    red, _, blue = covering[-1]
    assert red > blue


def test_pieces_cover_their_triangles() -> None:
    triangle = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.3, 0.0]]])
    pieces = plots_in_space.cut(triangle, 0.11)
    edges = np.linalg.norm(np.roll(pieces, -1, axis=1) - pieces, axis=2)
    assert edges.max() <= 0.11
    assert areas(pieces).sum() == pytest.approx(0.15, rel=1e-12)


def test_a_thumbnail_places_points_on_the_scales_of_their_axes() -> None:
    trace = {"type": "scatter", "mode": "markers", "x": [1.0, 10.0, 100.0, 0.0], "y": [0.0, 1.0, 2.0, 5.0]}
    drawn = thumbnail([trace], {"xaxis": {"type": "log"}}, "a figure")
    x = [float(each) for each in re.findall(r'cx="([^"]*)"', drawn)]
    y = [float(each) for each in re.findall(r'cy="([^"]*)"', drawn)]
    assert len(x) == 3, "zero has no place on a logarithmic axis"
    assert x[1] - x[0] == pytest.approx(x[2] - x[1], abs=0.11)
    assert y[0] > y[1] > y[2], "larger values are higher up"


def test_bars_of_a_thumbnail_stand_on_each_other() -> None:
    bars = [{"type": "bar", "x": ["a", "b"], "y": heights} for heights in ([1.0, 2.0], [3.0, -1.0])]
    drawn = thumbnail(bars, {"barmode": "relative"}, "bars")
    boxes = [
        tuple(map(float, each)) for each in re.findall(r'y="([^"]*)" width="[^"]*" height="([^"]*)"', drawn)
    ]
    (first, second, third, fourth) = boxes
    assert third[0] + third[1] == pytest.approx(first[0], abs=0.11), "a positive bar on the one before it"
    assert fourth[0] == pytest.approx(second[0] + second[1], abs=0.11), "a negative bar below zero"


def test_a_figure_without_points_has_no_thumbnail() -> None:
    assert thumbnail([{"type": "heatmap", "z": [[1.0]]}], {}, "a map") == ""

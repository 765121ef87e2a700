"""Small drawings of scenes and of figures."""

from __future__ import annotations

import re

import numpy as np
import pytest

from analysis.report import drawing, plots_in_space
from analysis.report.drawing import thumbnail
from analysis.report.run_times_section import placed
from geometries.scene.scene import Scene
from geometries.studies import families

SQUARE = (0.1, 0.1)
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
    areas = np.linalg.norm(np.cross(pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 0]), axis=1) / 2
    assert edges.max() <= 0.11
    assert areas.sum() == pytest.approx(0.15, rel=1e-12)


def test_colours_of_targets_and_machines_differ() -> None:
    text = drawing.of_scene(families.parallel(SQUARE, SQUARE, 0.02, machine="housing"), "a machine")
    greys = [
        colour
        for _, colour in polygons(families.parallel(SQUARE, SQUARE, 0.02, machine="housing"))
        if max(colour) - min(colour) < 40
    ]
    assert greys and 'aria-label="a machine"' in text


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


def test_labels_do_not_cover_each_other() -> None:
    points = [(100.0, 100.0), (103.0, 100.0), (300.0, 100.0)]
    places = placed(points, ["1e-3", "1e-4", "1e-6"])
    assert places[0] == "top right" and places[2] == "top right"
    assert places[1] is not None and places[1] != places[0]


def test_a_label_without_room_is_left_out() -> None:
    places = placed([(100.0, 100.0)] * 12, [f"1e-{n}" for n in range(12)])
    assert places.count(None) >= 6
    assert placed([(0.0, 0.0)], [""]) == [None]

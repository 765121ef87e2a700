"""Targets coloured by what each part adds to the sensor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analysis.pipeline.model_stage import model_module
from analysis.report.plots_in_space import areas, coloured
from analysis.results.units import VACUUM_PERMITTIVITY
from geometries.scene.scene import Medium, Scene
from geometries.studies import families

SIDE = 0.1
SQUARE = (SIDE, SIDE)
PER_SQUARE_CENTIMETRE = 1e-15 / 1e-4


def test_between_parallel_plates_every_part_adds_the_same() -> None:
    gap = 0.02
    (target,) = [
        trace
        for trace in coloured(families.parallel(SQUARE, SQUARE, gap)).figure.data
        if trace.name == "target"
    ]
    assert np.asarray(target.intensity) * PER_SQUARE_CENTIMETRE == pytest.approx(
        VACUUM_PERMITTIVITY / gap, rel=1e-3
    )
    assert len(target.i) == len(target.intensity) > 500


def test_parts_add_up_to_the_model_s_answer() -> None:
    scene = families.straddle(SQUARE, SQUARE, 0.02, (0.04, 0.0), 20.0, 0.0)
    (target,) = [trace for trace in coloured(scene).figure.data if trace.name == "target"]
    corners = np.stack([target.x, target.y, target.z], axis=-1)[
        np.stack([target.i, target.j, target.k], axis=-1)
    ]
    total = (areas(corners * 1e-2) * np.asarray(target.intensity)).sum() * PER_SQUARE_CENTIMETRE
    (body,) = scene.objects
    triangles = scene.conductors()[body.name]
    plate = scene.sensor_rectangles(scene.sensors[0].name)[0]
    assert total == pytest.approx(
        VACUUM_PERMITTIVITY * model_module().plate_integral(triangles, *plate).sum(), rel=1e-3
    )


def test_what_touches_the_sensor_has_no_colour_and_the_rest_keeps_its_own() -> None:
    scene = families.inclined(SQUARE, SQUARE, 0.01, 10.0)
    (body,) = scene.objects
    x, y, z = body.pose.translation
    touching = replace(body, pose=replace(body.pose, translation=(x, y, z - 0.01)))
    (target,) = [
        trace for trace in coloured(replace(scene, objects=(touching,))).figure.data if trace.name == "target"
    ]
    assert np.isfinite(target.cmax) and target.cmax > 0


def test_a_medium_multiplies_what_every_part_adds() -> None:
    scene = families.parallel(SQUARE, SQUARE, 0.02)
    values = []
    for medium in (scene.medium, Medium(relative_permittivity=3.0)):
        shown = coloured(replace(scene, medium=medium)).figure.data
        values.append(np.asarray(next(trace for trace in shown if trace.name == "target").intensity))
    assert values[1] == pytest.approx(3 * values[0], rel=1e-3)


def test_a_target_that_lies_on_the_sensor_is_drawn(scene_in_contact: Scene) -> None:
    (target,) = [trace for trace in coloured(scene_in_contact).figure.data if trace.name == "target"]
    assert target.cmax == 0 and not np.isfinite(np.asarray(target.intensity, dtype=float)).any()


@pytest.fixture
def scene_in_contact() -> Scene:
    scene = families.parallel(SQUARE, SQUARE, 0.02)
    (body,) = scene.objects
    x, y, _ = body.pose.translation
    return replace(scene, objects=(replace(body, pose=replace(body.pose, translation=(x, y, 0.0))),))

"""Changes from charges on panels: against boundary elements of machine and target together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analysis.pipeline.model_stage import model_module
from analysis.topics.machines.panel_truths import Machine, Resolution, Targets
from geometries.scene.poses import Pose
from geometries.scene.scene import Link, Object, Plate, Scene, Sensor
from geometries.scene.shapes import Cuboid
from geometries.scene.writer import canonical

HAND = Object("hand", Cuboid((0.08, 0.12, 0.03)), link="hand", target=True)
SCENE = Scene(
    links=(Link("hand", pose=Pose((0.02, 0.0, 0.06))),),
    sensors=(
        Sensor("front", (Plate((-0.05, -0.05, 0), (0.1, 0, 0), (0, 0.1, 0)),)),
        Sensor("side", (Plate((0.06, -0.05, 0), (0.1, 0, 0), (0, 0.1, 0)),)),
    ),
    objects=(Object("housing", Cuboid((0.3, 0.2, 0.05)), pose=Pose((0.05, 0, -0.03))), HAND),
)

RESOLUTION = Resolution(5e-3, 4000, 500, 0.7, 4000)


def test_changes_are_those_of_boundary_elements() -> None:
    live = model_module().Scene.loads(canonical(SCENE))
    targets = Targets(SCENE, 300)
    pose = np.eye(4)
    pose[:3, 3] = SCENE.links[0].pose.translation
    found = Machine(live, targets, RESOLUTION).changes(targets, pose)
    for name, reading in live.readings(method="boundary-elements", rtol=1e-2).items():
        assert found[name] == pytest.approx(reading.change, rel=6e-3)


def test_targets_that_float_or_move_against_each_other_are_refused() -> None:
    floating = replace(SCENE, objects=(replace(HAND, potential="floating"),))
    apart = replace(SCENE, objects=(HAND, replace(HAND, name="arm", link=None)))
    for scene in (floating, apart, replace(SCENE, objects=())):
        with pytest.raises(ValueError, match="grounded and on one link"):
            Targets(scene)


def test_a_target_that_reaches_into_the_machine_is_refused() -> None:
    """There charges of panels that coincide have no energy."""
    live = model_module().Scene.loads(canonical(SCENE))
    targets = Targets(SCENE, 300)
    machine = Machine(live, targets, RESOLUTION)
    targets.panels = machine._panels
    with pytest.raises(ArithmeticError, match="touch or overlap"):
        machine.changes(targets, np.eye(4))

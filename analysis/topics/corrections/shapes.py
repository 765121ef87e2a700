"""`python3 -m analysis.topics.corrections.shapes`: the formula's error for shapes that it was not fitted to."""

from __future__ import annotations

from typing import Any

from analysis.pipeline.model_stage import model_module
from geometries.common.children import temporary_folder
from geometries.scene.poses import AxisRotation, Pose
from geometries.scene.scene import Object, Scene
from geometries.scene.shapes import Arc, Cone, Cylinder, Shape, Sphere
from geometries.scene.writer import canonical
from geometries.studies import families

_SENSOR, _HEIGHT, _DEGREES = 0.1, 0.075, 70.0
_RTOL = 3e-3
"""Relative accuracy of the truth: a third of the last printed digit."""
SHAPES: dict[str, Shape] = {
    "sphere": Sphere(0.03, 16),
    "cylinder": Cylinder(0.03, 0.1, 16),
    "cone": Cone(0.05, 0.1, 16),
    "concave arc": Arc(0.05, 0.06, 0.1, 180.0, 8),
}


def errors(module: Any) -> dict[str, float]:
    """Returns (formula − truth)/truth by shape; its centre lies above that of the sensor, its axis turned."""
    found = {}
    alone = families.empty((_SENSOR, _SENSOR))
    with temporary_folder() as folder:
        path = folder / "scene.toml"
        for name, shape in SHAPES.items():
            pose = Pose((0.0, 0.0, _HEIGHT), AxisRotation((0.0, 1.0, 0.0), _DEGREES))
            target = Object("target", shape, pose=pose)
            path.write_text(canonical(Scene(sensors=alone.sensors, objects=(target,))), encoding="utf-8")
            scene = module.Scene.load(path)
            truth = -scene.maxwell(rtol=_RTOL)["maxwell"][0, 1]
            found[name] = float(scene.capacitance(correction="formula")["sensors"][0]["total"] / truth - 1)
    return found


def sentence(found: dict[str, float]) -> str:
    """Writes the sentence of model/CORRECTIONS.md on these shapes."""
    return ", ".join(f"{name} {100 * error:+.1f} %" for name, error in found.items())


if __name__ == "__main__":
    print(sentence(errors(model_module())))

"""`python3 -m analysis.topics.corrections.large_targets`: the formula's error before targets far larger than the sensor.

The truth is enclosed: mutual grows with the target, since a larger grounded body leaves less charge to infinity. So it is at least what
boundary elements find for a smaller target, less their error, and at most what they find for a larger one or for the whole plane,
the sensor before its mirror image. Close before the
largest targets boundary elements reach their limit of unknowns; only values with a small stated error are used.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.pipeline.model_stage import model_module
from geometries.common.children import temporary_folder
from geometries.scene.scene import Scene
from geometries.scene.writer import canonical
from geometries.studies import families

SENSOR = 0.1
SIDES = (2, 5, 10, 20, 40)
"""Sides of the square target relative to the square sensor's."""
GAPS = (0.1, 0.3, 1.0, 3.0)
"""Gaps relative to the sensor's side; the plates are parallel and concentric."""
_RTOL = 3e-3
# Largest stated error (relative) that is taken as reliable.
_SURE = 0.01
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Large:
    """By side and gap (n, m): `formula` over the plane's mutual, and the bounds of the truth over it."""

    formula: Array
    low: Array
    high: Array

    @property
    def error(self) -> Array:
        """The error of the formula, relative to the middle of the bounds."""
        return np.asarray(2 * self.formula / (self.low + self.high) - 1)

    @property
    def uncertainty(self) -> Array:
        """The uncertainty of that error, from the bounds of the truth."""
        return np.asarray((self.high - self.low) / (self.high + self.low))


def measured(module: Any) -> Large:
    """Evaluates the formula and boundary elements; takes seconds."""
    formula, value, error = (np.empty((len(SIDES), len(GAPS))) for _ in range(3))
    with temporary_folder() as folder:
        path = folder / "scene.toml"
        for column, gap in enumerate(GAPS):
            image = _load(
                module, path, families.parallel((SENSOR, SENSOR), (SENSOR, SENSOR), 2 * gap * SENSOR)
            )
            plane = _before_plane(image)
            for row, side in enumerate(SIDES):
                target = (side * SENSOR, side * SENSOR)
                scene = _load(module, path, families.parallel((SENSOR, SENSOR), target, gap * SENSOR))
                solved = scene.maxwell(rtol=_RTOL)
                value[row, column] = -solved["maxwell"][0, 1] / plane
                error[row, column] = solved["error"][0, 1] / plane
                formula[row, column] = scene.capacitance(correction="formula")["sensors"][0]["total"] / plane
    sure = error <= _SURE * value
    low = np.maximum.accumulate(np.where(sure, value - error, 0))
    high = np.minimum.accumulate(np.where(sure, np.minimum(value + error, 1), 1)[::-1])[::-1]
    return Large(formula, low, high)


def lines(found: Large) -> list[str]:
    """Returns the table in Markdown, per cent."""
    rows = [
        f"| {side} | " + " | ".join(_cell(*each) for each in zip(errors, uncertainties)) + " |"
        for side, errors, uncertainties in zip(SIDES, found.error, found.uncertainty)
    ]
    head = "| target/sensor | " + " | ".join(f"gap/sensor {gap:g}" for gap in GAPS) + " |"
    return [head, "|---" * (len(GAPS) + 1) + "|", *rows]


def _cell(error: float, uncertainty: float) -> str:
    text = f"{100 * error:+.0f}"
    return text if uncertainty < 0.005 else f"{text} ± {100 * uncertainty:.0f}"


def _load(module: Any, path: Path, scene: Scene) -> Any:
    path.write_text(canonical(scene), encoding="utf-8")
    return module.Scene.load(path)


def _before_plane(image: Any) -> float:
    """Returns the charge per volt of a sensor whose mirror image has the opposite potential."""
    matrix = image.maxwell(rtol=_RTOL)["maxwell"]
    return float(matrix[0, 0] - matrix[0, 1])


if __name__ == "__main__":
    print("\n".join(lines(measured(model_module()))))

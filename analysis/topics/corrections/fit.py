"""`python3 -m analysis measure fit`: fits the constants of `formula` to the set-ups that are not sealed.

It minimises the sum of the fourth powers of ln(formula/truth), in which the worst errors count more than in least squares.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from analysis.pipeline.model_stage import model_module
from analysis.results.units import VACUUM_PERMITTIVITY
from analysis.topics.corrections.set_ups import SetUp, set_ups
from analysis.topics.corrections.truths import load

Array = NDArray[np.float64]
NAMES = (
    "linear_stiffness",
    "quadratic_stiffness",
    "remaining_stiffness",
    "fringe",
    "attraction",
    "saturation",
    "tilt",
    "fringe_near",
)
_START = (2.0, 2.0, 8.0, 1.0, 4.0, 0.2, 0.7, -1.0)


def terms(module: Any, chosen: Sequence[SetUp]) -> tuple[dict[str, Array], Array]:
    """Returns the formula's terms in the set-ups, and the truth over ε; arrays (n,), variations (3, n)."""
    truths = load()
    rows = [module.Scene.loads(set_up.text).formula_terms()[0][0] for set_up in chosen]
    truth = np.array([truths[set_up.name].mutual / VACUUM_PERMITTIVITY for set_up in chosen])
    return {name: np.array([row[name] for row in rows]).T for name in rows[0]}, truth


def part(found: dict[str, Array], mask: NDArray[np.bool_]) -> dict[str, Array]:
    """Returns the terms of some of the set-ups."""
    return {name: values[..., mask] for name, values in found.items()}


def formula(found: dict[str, Array], constants: Array) -> Array:
    """Returns the formula of model/CORRECTIONS.md, section 4, written a second time."""
    stiffness, (fringe, attraction, saturation, tilt, fringe_near) = constants[:3], constants[3:]
    product = found["own_of_sensor"] * found["own_of_object"]
    coupled = found["potential"] ** 2 * product
    polarised = np.ones_like(coupled)
    for body in ("on_sensor", "on_object"):
        value = stiffness @ found[body]
        polarised = polarised * (1 + coupled * value / (1 + saturation * value))
    drawn = 1 + attraction * coupled * found["drawn"]
    far = found["potential"] * product * drawn / np.maximum(1 / polarised - coupled * drawn**2, 0.02)
    faces = found["flux"] > 0
    ratio = np.where(faces, found["flux"], 1) / np.where(faces, found["soft_flux"], 1)
    fringes = fringe * (1 + fringe_near * coupled) * np.sqrt(found["facing_area"]) * np.log(ratio)
    return np.asarray(far + found["flux"] - found["soft_flux"] + tilt * found["tilted_excess"] + fringes)


def fit(found: dict[str, Array], truth: Array) -> Array:
    """Returns the constants in the order of NAMES."""

    def squares(constants: Array) -> Array:
        # The solver squares these once more; they are scaled to suit its tolerances.
        return np.asarray(100 * np.log(np.maximum(formula(found, constants) / truth, 1e-6)) ** 2)

    first = least_squares(lambda c: np.log(np.maximum(formula(found, c) / truth, 1e-6)), _START)
    return np.asarray(least_squares(squares, first.x).x)


def measure(_: argparse.Namespace) -> int:
    """Prints the constants."""
    opened = [set_up for set_up in set_ups(model_module()) if not set_up.sealed]
    for name, constant in zip(NAMES, fit(*terms(model_module(), opened))):
        print(f"{name} = {constant:.3f}")
    return 0

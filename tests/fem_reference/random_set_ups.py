"""Enclosures of random plates against the panel method: python3 -m tests.fem_reference.random_set_ups [--count N] [--seed S].

Prints one line for each set of plates. Fails when an enclosure excludes every matrix within the error of the panel method.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from fem_reference.bodies.shapes import separation, rectangle
from fem_reference.solve.level import solve_level
from fem_reference.bodies.conductors import normalised
from fem_reference.mesh.size_rules import Sizing
from tests.fem_reference import panel_method
from tests.fem_reference.panel_method import Plate

Array = NDArray[np.float64]

LEAST_GAP = 0.1
"""Least gap between two plates over the smaller one's shorter side; for narrower gaps the panel method would need finer panels."""


def set_ups(count: int, seed: int) -> Iterator[list[Plate]]:
    """Yield `count` sets of two plates, every third one of three, with sides of 2 to 12 cm, in any pose, close but not touching."""
    random = np.random.default_rng(seed)
    made = 0
    while made < count:
        plates = [_random_plate(random) for _ in range(3 if made % 3 == 2 else 2)]
        bodies = [rectangle("", plate.corner, plate.edge_u, plate.edge_v) for plate in plates]
        pairs = combinations(bodies, 2)
        if all(separation(a, b) > LEAST_GAP * min(a.size, b.size) for a, b in pairs):
            made += 1
            yield plates


def _random_plate(random: np.random.Generator) -> Plate:
    axes = Rotation.random(random_state=random).as_matrix()
    u, v = random.uniform(0.02, 0.12, 2)[:, None] * axes[:2]
    return Plate(random.uniform(-0.06, 0.06, 3) - (u + v) / 2, u, v)


def enclosed(plates: list[Plate], refinement: float) -> tuple[bool, float, float]:
    """Whether every entry lies inside, the largest relative width, and the largest relative error of the panel method."""
    bodies = [rectangle(str(k), plate.corner, plate.edge_u, plate.edge_v) for k, plate in enumerate(plates)]
    problem = normalised([str(k) for k in range(len(plates))], 1, bodies, range(len(plates)))
    interval = solve_level(problem, 1.0, Sizing(refinement=refinement), "enclosure").enclosure
    assert interval is not None
    truth, slack = panel_method.maxwell(plates)
    inside = np.all(interval.lower <= truth + slack) and np.all(truth - slack <= interval.upper)
    width = np.max((interval.upper - interval.lower) / np.abs(truth))
    return bool(inside), float(width), float(np.max(slack / np.abs(truth)))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    missed = 0
    for number, plates in enumerate(set_ups(options.count, options.seed), 1):
        inside, width, slack = enclosed(plates, 2)
        missed += not inside
        word = "inside" if inside else "OUTSIDE"
        print(
            f"{number:3}: {len(plates)} plates, {word}, widest {width:.1e}, panels sure to {slack:.1e}",
            flush=True,
        )
    print(f"{options.count - missed} of {options.count} enclosed")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())

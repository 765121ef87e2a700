"""Random soups: do boundary elements answer conductors as machines have them? `python3 -m tests.model.random_soups [--count N] [--first K]`.

Solves the soup of every scene at `--rtol` (0.03), and the clean conductor at a third of it, each in a process of its own that may take two minutes. Where
the two have the same surface, all entries and `delta_self` must differ by no more than both errors together; where one contains the
other, neither its quadratic form may be the smaller one by more. Prints a line for each scene. What fails is kept in `build/soups`: two scenes and
their meshes, in a folder with the scene's number.
"""

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometries.common.arrays import Array
from tests.model.soups import Relation, random_case, written

ROOT = Path(__file__).resolve().parents[2]
COMMAND = ROOT / "build" / "bin" / "fringe"
KEPT = ROOT / "build" / "soups"
LONGEST = 120.0
"""Seconds after which a solve counts as one that hangs."""
NOT_REACHED = 3
"""Exit status of an answer whose error is larger than `--rtol`."""


@dataclass(frozen=True)
class Outcome:
    """What came of one scene."""

    number: int
    kinds: tuple[str, ...]
    failure: str
    """Crash, hang, refusal or wrong answer; empty if there is none."""
    ratio: float
    """The largest difference, or violation of the order, relative to the error that is stated for it."""
    error: float
    """The largest stated error of the soup's entries, relative to the geometric mean of the diagonal entries of row and column."""
    reached: bool
    seconds: float
    """What the solve of the soup took."""


class Failure(Exception):
    """A solve without an answer."""


def solve(scene: Path, rtol: float) -> dict[str, Any]:
    """The answer of the command; raises Failure for a crash, a hang or a refusal."""
    command = [COMMAND, "capacitance", scene, "--method", "boundary-elements", "--rtol", str(rtol), "--json"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=LONGEST)
    except subprocess.TimeoutExpired as hang:
        raise Failure(f"{scene.stem} hangs") from hang
    if done.returncode == 2:
        raise Failure(f"{scene.stem} is refused: {done.stderr.strip()}")
    if done.returncode not in (0, NOT_REACHED):
        raise Failure(f"{scene.stem} ends with {done.returncode}: {done.stderr.strip()}")
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def outcome(number: int, seed: int, rtol: float, folder: Path) -> Outcome:
    """Makes a scene in an empty folder and compares its two answers."""
    random = np.random.default_rng([seed, number])
    case = random_case(random)
    clean, soup = written(case, random, folder)
    start = time.monotonic()
    try:
        answer = solve(soup, rtol)
        seconds = time.monotonic() - start
        truth = solve(clean, rtol / 3)
    except Failure as failure:
        seconds = time.monotonic() - start
        return Outcome(number, case.kinds, str(failure), np.nan, np.nan, False, seconds)
    ratio, failure = compared(case.relation, truth, answer)
    diagonal = np.sqrt(np.diag(answer["maxwell"]))
    error = float(np.max(np.array(answer["error"]) / np.outer(diagonal, diagonal)))
    return Outcome(number, case.kinds, failure, ratio, error, answer["reached"], seconds)


def compared(relation: Relation, clean: dict[str, Any], soup: dict[str, Any]) -> tuple[float, str]:
    """The largest difference relative to what both errors allow, and what is wrong, if anything."""
    (values, error), (exact, error_of_exact) = _of_two(soup), _of_two(clean)
    allowed = error + error_of_exact
    if values.shape != exact.shape:
        return np.inf, f"{len(values)} conductors, not {len(exact)}: {soup['conductors']}"
    if not np.all(np.isfinite(values)) or not np.all(np.isfinite(allowed)):
        return np.inf, "an entry or error is not finite"
    if relation is Relation.SAME:
        one, other = soup["sensors"][0], clean["sensors"][0]
        difference = np.append(values - exact, one["delta_self"] - other["delta_self"])
        ratio = float(
            np.max(
                np.abs(difference) / np.append(allowed, one["delta_self_error"] + other["delta_self_error"])
            )
        )
        are_bounds = [soup["lower_bounds"][0], all(soup["lower_bounds"][1:])][: len(values)]
        excess = (np.diag(values - exact) / np.diag(allowed))[np.array(are_bounds)]
        if ratio > 1:
            return ratio, "differs"
        return ratio, "above the truth though called a lower bound" if np.any(excess > 1) else ""
    smaller, larger = (values, exact) if relation is Relation.LESS else (exact, values)
    ratio = max(_violation(smaller - larger, allowed, voltages) for voltages in _voltages(len(values)))
    return ratio, "" if ratio <= 1 else f"not {relation.value} than the clean conductor"


def _of_two(answer: dict[str, Any]) -> tuple[Array, Array]:
    """The matrix of the sensor and of all other conductors together, and its errors: what is inside a mesh that is not closed, and does
    not touch it, is a grounded conductor of its own."""
    values, errors = np.array(answer["maxwell"]), np.array(answer["error"])
    if len(values) == 1:
        return values, errors
    together = np.zeros((len(values), 2))
    together[0, 0] = together[1:, 1] = 1
    return together.T @ values @ together, together.T @ errors @ together


def _violation(difference: Array, allowed: Array, voltages: Array) -> float:
    """By how much a difference's quadratic form is above zero, relative to what the errors allow."""
    magnitude = np.abs(voltages)
    return float(max(0.0, voltages @ difference @ voltages) / (magnitude @ allowed @ magnitude))


def _voltages(count: int) -> Array:
    """Sensor and body by themselves, together and against each other."""
    return np.array([[1.0]]) if count == 1 else np.array([[1.0, 0], [0, 1], [1, 1], [1, -1]])


def summary(outcomes: list[Outcome]) -> str:
    """The numbers of all scenes together."""
    answered = [one for one in outcomes if np.isfinite(one.ratio)]
    failures = Counter(one.failure.split(":")[0] for one in outcomes if one.failure)
    lines = [
        f"{len(outcomes)} scenes, {len(answered)} answered, {sum(failures.values())} failures {dict(failures)}"
    ]
    lines.append(f"not reached: {sum(not one.reached for one in answered)}")
    for name, numbers in (
        ("difference / stated error", [one.ratio for one in answered]),
        ("stated error", [one.error for one in answered]),
        ("seconds", [one.seconds for one in outcomes]),
    ):
        quantiles = np.quantile(numbers or [np.nan], [0.5, 0.9, 0.99, 1])
        lines.append(
            "{}: median {:.2g}, nine of ten {:.2g}, 99 of 100 {:.2g}, largest {:.2g}".format(name, *quantiles)
        )
    kinds = sorted({kind for one in outcomes for kind in one.kinds})
    for kind in kinds:
        having = [one.ratio for one in answered if kind in one.kinds]
        lines.append(f"  {kind}: {len(having)} scenes, largest {max(having, default=np.nan):.2g}")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rtol", type=float, default=0.03)
    arguments = parser.parse_args()
    outcomes = []
    for number in range(arguments.first, arguments.first + arguments.count):
        with tempfile.TemporaryDirectory() as folder:
            one = outcome(number, arguments.seed, arguments.rtol, Path(folder))
            if one.failure:
                shutil.copytree(folder, KEPT / f"{arguments.seed}-{number}", dirs_exist_ok=True)
        outcomes.append(one)
        said = f"ratio {one.ratio:.2f}, error {one.error:.1e}{'' if one.reached else ' (not reached)'}, {one.seconds:.1f} s"
        print(
            f"{number}: {', '.join(one.kinds)}: {said}{'; FAILURE ' if one.failure else ''}{one.failure}",
            flush=True,
        )
    print(summary(outcomes))
    sys.exit(any(one.failure for one in outcomes))


if __name__ == "__main__":
    main()

"""Random scenes and motions by every method, several in one process: `python3 -m tests.fuzz.random_answers SECONDS [--first SEED]`.

A method answers or refuses by name. An answer's numbers are numbers; what is reached has finite errors; every reading says who answered it.
Nothing ends the process. What does not hold is printed with its seed; `--only SEED` runs that one again and prints its scene. With the library
of a build with sanitizers (FRINGE_MODULES, its folder `python`) the same command finds what is written where it does not belong.
"""

import argparse
import math
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

from geometries.scene.poses import AxisRotation
from tests.fuzz.random_scenes import RandomScene, scene

_ROOT = Path(__file__).resolve().parents[2]
# Scenes that one process evaluates: what one spoils, another one may find.
_TOGETHER = 25
# Longest time for one answer, which most find in a second: the others are left out.
_MOST_SECONDS = 4.0
_OPTIONS: tuple[dict[str, Any], ...] = (
    {"method": "exact"},
    {"method": "formula"},
    {"method": "reduced", "rtol": 0.1},
    {"method": "reduced", "rtol": 0.1, "derivatives": True},
    {"method": "reduced", "entries": True},
    {"method": "reduced", "entries": True, "derivatives": True},
    {"method": "boundary-elements", "rtol": 0.1},
    {"method": "auto", "entries": True, "max_seconds": 2.0},
    {"method": "auto", "rtol": 0.1, "max_seconds": 2.0},
)


class TooLong(Exception):
    """An answer takes longer than it may."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seconds", type=float, nargs="?", default=60.0)
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--only", type=int, help="run the scene of this seed and print it")
    parser.add_argument("--together", type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.only is not None:
        print(scene(random.Random(options.only)).text)
        return _evaluate_all(options.only, 1)
    if options.together is not None:
        return _evaluate_all(options.first, options.together)
    return _run(options.first, options.seconds)


def _run(first: int, seconds: float) -> int:
    end, seed, failures = time.monotonic() + seconds, first, 0
    while time.monotonic() < end:
        words = ["-m", "tests.fuzz.random_answers", "--first", str(seed), "--together", str(_TOGETHER)]
        done = subprocess.run(
            [sys.executable, *words], cwd=_ROOT, stdout=subprocess.PIPE, text=True, check=False
        )
        lines = done.stdout.splitlines()
        found = [line for line in lines if line.startswith("!")]
        if done.returncode < 0:
            found.append(f"! signal {-done.returncode} in {lines[-1] if lines else 'no scene'}")
        print(*found, sep="\n", end="\n" if found else "", flush=True)
        failures += len(found)
        seed += _TOGETHER
    print(f"{seed - first} scenes, {failures} findings")
    return 1 if failures else 0


def _evaluate_all(first: int, count: int) -> int:
    signal.signal(signal.SIGALRM, _ring)
    failures = 0
    for seed in range(first, first + count):
        for finding in _findings(scene(random.Random(seed)), seed):
            print(f"! seed {seed}: {finding}", flush=True)
            failures += 1
    return 1 if failures else 0


def _ring(number: int, frame: FrameType | None) -> None:
    raise TooLong


def _findings(made: RandomScene, seed: int) -> Iterator[str]:
    module = _module()
    try:
        live = module.Scene.loads(made.text)
    except ValueError as error:
        print(f"seed {seed}: refused: {error}", flush=True)
        return
    chance = random.Random(seed)
    chosen = chance.sample(_OPTIONS, 4)
    for number, frame in enumerate(made.frames):
        for link, (translation, axis, degrees) in zip(made.links, frame):
            live.set_pose(link, translation, AxisRotation(axis, degrees).matrix())
        for asked in chosen:
            print(f"seed {seed}, frame {number}, {asked}", flush=True)
            yield from (f"frame {number}, {asked}: {each}" for each in _answer(live, asked))


def _answer(live: Any, asked: dict[str, Any]) -> Iterator[str]:
    try:
        signal.setitimer(signal.ITIMER_REAL, _MOST_SECONDS)
        try:
            answer = live.capacitance(**asked)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
    except TooLong:
        return
    except ValueError:
        # Its method refuses the scene.
        return
    except Exception as error:
        yield f"{type(error).__name__}: {error}"
        return
    yield from _wrong(answer)


def _wrong(answer: dict[str, Any]) -> Iterator[str]:
    """Says what does not hold of an answer."""
    for reading in answer["readings"]:
        if not reading["answered_by"]:
            yield f"reading {reading['name']} says not who answered it"
    # What is not known of a derivative is not a number.
    numbers = [each for each in _numbers(answer, "") if "derivative" not in each[0]]
    yield from (f"{place} is not a number" for place, value in numbers if math.isnan(value))
    yield from (f"{place} is {value}" for place, value in numbers if "error" in place and value < 0)
    if answer.get("reached"):
        yield from (
            f"reached, but {place} is infinite"
            for place, value in numbers
            if "error" in place and math.isinf(value)
        )


def _numbers(answer: Any, place: str) -> Iterator[tuple[str, float]]:
    if isinstance(answer, dict):
        for key, value in answer.items():
            yield from _numbers(value, f"{place}.{key}")
    elif isinstance(answer, (list, tuple, np.ndarray)):
        for value in answer:
            yield from _numbers(value, place)
    elif isinstance(answer, float):
        yield place, answer


def _module() -> Any:
    sys.path.insert(0, os.environ.get("FRINGE_MODULES", str(_ROOT / "build/python")))
    import fringe

    return fringe


if __name__ == "__main__":
    sys.exit(main())

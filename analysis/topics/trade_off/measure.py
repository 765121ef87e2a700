"""Run time against error: `python3 -m analysis.topics.trade_off.measure RESULTS TARGET` asks every method of the module on every pair of plates of a study.

All run on one core. Methods take turns at every pose, so that other work on the machine disturbs all alike. A time is
that of one pose after a move, with the bodies already prepared; the smallest of several, because disturbances only
add to it. As the stage of a study the answer is kept as long as code, set-ups and machine are the same."""

import functools
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from analysis.pipeline import keys
from analysis.pipeline.model_stage import model_module
from analysis.pipeline.scheduler import run_all
from analysis.pipeline.stage import NoAnswer, Processes, Stage, outdated, unfinished_file
from analysis.results import machine, study_results
from analysis.results.store import Document, read_json, write_json
from geometries.common.children import temporary_folder
from geometries.common.installation import ROOT, from_repository
from geometries.scene.scene import Link, Scene
from geometries.scene.writer import canonical

ANSWER = "trade_off.json"
NAME = "run time against error of all methods"
_MODULE = "analysis.topics.trade_off.measure"
_SOURCES = ("model", "CMakeLists.txt", "CMakePresets.json", "analysis/topics/trade_off/measure.py")
_SECONDS = 90.0


def run(folder: Path, cases: list[str], wanted: bool) -> list[study_results.Failure]:
    """Measures the cases of a study whose manifest is in the folder, if `wanted` and not done; an outdated answer is removed."""
    target = folder / ANSWER
    answer = functools.partial(_answer, folder, target)
    stages = outdated([Stage(NAME, "", target, key(cases), _SECONDS, answer)])
    return run_all(stages, 1, "measured") if wanted else []


def command(folder: Path) -> str:
    """Returns the command, from the project's folder, that repeats the measurement."""
    return f"python3 -m {_MODULE} {from_repository(folder)} again.json"


def key(cases: list[str]) -> str:
    """Returns the key, which depends on the machine because times do; `cases` are the identities of the set-ups."""
    command = f"{_MODULE} {' '.join(cases)}"
    return keys.measurement_key(command, keys.code_of(_SOURCES, ROOT), machine.identity())


def _answer(folder: Path, target: Path, processes: Processes) -> Document:
    with unfinished_file(target) as unfinished:
        finished = processes.run_module(_MODULE, str(folder.resolve()), str(unfinished))
        answer = read_json(unfinished)
    if finished.exit_code != 0 or answer is None:
        raise NoAnswer(finished.reason)
    return {**machine.origin(), **answer}


TRUTH_RTOL = 3e-6
"""Relative accuracy of the truth: about the best that boundary elements reach; where they miss it, the truth's error says so."""
LEVELS = tuple(range(9))
RTOLS_OF_REDUCED = ("1e-2", "1e-3", "3e-4")
_TURNS = 5
_POSES = 5
"""Poses per turn: the second one finds code and bodies in the processor's caches, as a moving scene does."""
# Methods that take milliseconds and more: disturbances are short compared with them.
_TURNS_OF_BOUNDARY_ELEMENTS = {"1e-2": 5, "1e-3": 5, "1e-4": 2, "1e-5": 1}
_MOVER = "what moves"
_AT_HOME = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
_ELSEWHERE = ((0.0, 0.0, 0.01), (1.0, 0.0, 0.0, 0.0))


@dataclass(frozen=True)
class Method:
    """`kind` is thesis, model, formula, reduced or boundary elements; `ask` returns mutual (F) and the seconds it took. It is asked
    for so many `poses` in each of its `turns`."""

    kind: str
    name: str
    turns: int
    poses: int
    ask: Callable[[Any], tuple[float, float]]


def methods() -> list[Method]:
    """Returns every method."""
    of_integrals = {f"split:{level}": "thesis" for level in LEVELS} | {"exact": "model", "formula": "formula"}
    found = []
    for name, kind in of_integrals.items():
        found.append(Method(kind, name, _TURNS, _POSES, functools.partial(_integral, method=name)))
    for rtol in RTOLS_OF_REDUCED:
        ask = functools.partial(_matrix, method="reduced", rtol=float(rtol))
        found.append(Method("reduced", f"reduced {rtol}", _TURNS, _POSES, ask))
    for rtol, turns in _TURNS_OF_BOUNDARY_ELEMENTS.items():
        ask = functools.partial(_matrix, rtol=float(rtol))
        found.append(Method("boundary elements", rtol, turns, 1, ask))
    return found


def measured(module: Any, cases: list[study_results.CaseResult]) -> Document:
    """Returns the truths by case, and for every method its values and its seconds by case."""
    known = methods()
    truths: dict[str, Document] = {}
    answers: list[Document] = [
        {"kind": method.kind, "name": method.name, "values": {}, "seconds": {}} for method in known
    ]
    with temporary_folder() as folder:
        path = folder / "scene.toml"
        for case in cases:
            path.write_text(canonical(movable(case.scene)), encoding="utf-8")
            solved = module.Scene.load(str(path)).maxwell(rtol=TRUTH_RTOL)
            entry, error = (float(solved[name][0][1]) for name in ("maxwell", "error"))
            truths[case.id] = {"mutual": -entry, "error": error, "reached": bool(solved["reached"])}
            for answer, (value, seconds) in zip(answers, _in_turn(module, path, known)):
                answer["values"][case.id], answer["seconds"][case.id] = value, seconds
    return {"truth_rtol": TRUTH_RTOL, "truths": truths, "methods": answers}


def movable(scene: Scene) -> Scene:
    """Returns the scene with its objects on a link, which can be moved."""
    objects = tuple(replace(body, link=_MOVER) for body in scene.objects)
    return replace(scene, links=(Link(_MOVER),), objects=objects)


def _in_turn(module: Any, path: Path, known: list[Method]) -> list[tuple[float, float]]:
    """Returns (mutual, seconds) of each method, each with a scene of its own that has answered before."""
    scenes = [module.Scene.load(str(path)) for _ in known]
    values = [method.ask(scene)[0] for method, scene in zip(known, scenes)]
    best = [float("inf")] * len(known)
    for turn in range(max(method.turns for method in known)):
        for number, (method, scene) in enumerate(zip(known, scenes)):
            for _ in range(method.poses if turn < method.turns else 0):
                scene.set_pose(_MOVER, *_ELSEWHERE)
                scene.set_pose(_MOVER, *_AT_HOME)
                values[number], seconds = method.ask(scene)
                best[number] = min(best[number], seconds)
    return list(zip(values, best))


def _integral(scene: Any, method: str) -> tuple[float, float]:
    answer = scene.capacitance(method=method)
    return float(answer["sensors"][0]["total"]), float(answer["seconds"])


def _matrix(scene: Any, **options: Any) -> tuple[float, float]:
    answer = scene.maxwell(**options)
    return -float(answer["maxwell"][0][1]), float(answer["seconds"])


def main(folder: str, target: str) -> None:
    """Measures the pairs of plates in a folder of results on one core, and writes the answer."""
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    cases = [case for case in study_results.load(Path(folder)).compared() if case.set_up is not None]
    write_json(Path(target), measured(model_module(), cases))


if __name__ == "__main__":
    main(*sys.argv[1:])

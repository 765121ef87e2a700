"""The field reference's answer for one case, from a process of its own."""

from pathlib import Path

from analysis.pipeline.stage import Finished, NoAnswer, Processes, Refused, parsed, unfinished_file
from analysis.results.store import Document
from geometries.studies.study import Study

SOLVE, SLICE = "reference", "slice of the potential"
MODULE = "fem_reference"
# Exit statuses with an answer: within the asked accuracy, and short of it with its true error.
_ANSWERED = (0, 3)
_WRONG_INPUT = 2


def answer(scene: Path, study: Study, processes: Processes) -> Document:
    """Solves a scene file as accurately as the study asks."""
    asked = ["--rtol", repr(study.rtol), "--max-seconds", repr(study.max_seconds), "--error", study.error]
    return solve(scene, processes, *asked)


def solve(scene: Path, processes: Processes, *asked: str) -> Document:
    """Solves a scene file with options of the field solver's command; NoAnswer if there is none."""
    finished = _run(processes, scene, *asked, "--json")
    document = parsed(finished.output)
    if "maxwell" not in document:
        raise NoAnswer(finished.reason)
    return document


def answer_slice(scene: Path, target: Path, processes: Processes) -> Document:
    """Computes a slice of the potential around a scene; `target` is the file that it is for."""
    with unfinished_file(target) as unfinished:
        finished = _run(processes, scene, "--slice", str(unfinished))
        if not unfinished.is_file():
            raise NoAnswer(finished.reason)
        return parsed(unfinished.read_text(encoding="utf-8"))


def _run(processes: Processes, scene: Path, *asked: str) -> Finished:
    place = str(scene.resolve())
    finished = processes.run_module(MODULE, place, *asked)
    if finished.exit_code == _WRONG_INPUT:
        # Without the place, which differs, the reason is the same for all cases that are refused for it.
        raise Refused(finished.last_line.removeprefix(f"{MODULE}: ").removeprefix(f"{place}: "))
    if finished.exit_code not in _ANSWERED:
        raise NoAnswer(finished.reason)
    return finished

"""Runs the programs of the build that measure the model by itself, without a study."""

import functools
import os
import shlex
from dataclasses import dataclass
from pathlib import Path

from analysis.pipeline import keys
from analysis.pipeline.stage import NoAnswer, Processes, Stage, parsed, unfinished_file
from analysis.results import machine
from analysis.results.store import Document
from analysis.results.study_results import COLLISION, RUN_TIMES, STABILITY
from geometries.common.installation import ROOT, no_benchmark

_BIN = Path("build", "bin")
# Exit statuses with an answer: everything is correct, and some values are wrong.
_ANSWERED = (0, 1)
# Placeholder in the arguments for the file that a program writes its answer to.
_ANSWER = "ANSWER.json"


@dataclass(frozen=True)
class Measurement:
    """`arguments` name the answer's file as ANSWER.json; `seconds` is the expected time; `sources` are the folders and
    files of the repository that determine the result besides the model and how it is built."""

    name: str
    file: str
    program: str
    arguments: tuple[str, ...]
    seconds: float
    sources: tuple[str, ...] = ()

    @property
    def command(self) -> str:
        """The command, from the repository's folder, that repeats the measurement."""
        return shlex.join([str(_BIN / self.program), *self.arguments])


def timed(answer: str) -> tuple[str, ...]:
    """Returns the options of a benchmark that is to write its answer to a file."""
    return (
        # Three times, far apart, so that a disturbance affects only one of them.
        "--benchmark_repetitions=3",
        "--benchmark_enable_random_interleaving=true",
        f"--benchmark_out={answer}",
        "--benchmark_out_format=json",
    )


def _drawn(count: str) -> tuple[str, ...]:
    """Returns the options of a program that is to try so many random cases."""
    return "--count", count, "--json", _ANSWER


_SOURCES = ("model", "CMakeLists.txt", "CMakePresets.json")
_STRESS, _COLLISION = ("tests/model/stress",), ("tests/model/collision",)
_STABLE, _SCENES = "stability of the integral", "collisions of scenes"
_TIMES, _PAIRS = "times of collision queries", "answers of collision queries"
MEASUREMENTS = (
    Measurement("run time against error", RUN_TIMES, "plate_integral_benchmark", timed(_ANSWER), 40),
    Measurement(_STABLE, STABILITY, "plate_integral_stress", _drawn("100000"), 60, _STRESS),
    Measurement(_PAIRS, COLLISION[0], "collision_stress", _drawn("50000"), 20, _COLLISION),
    Measurement(_TIMES, COLLISION[1], "collision_benchmark", ("21", _ANSWER), 20),
    Measurement(_SCENES, COLLISION[2], "scene_collision_benchmark", ("5", _ANSWER), 10),
)


def stages(folder: Path) -> list[Stage]:
    """Returns the stages of all measurements, whose answers lie in a folder of results."""
    return [stage(measurement, folder) for measurement in MEASUREMENTS]


def stage(measurement: Measurement, folder: Path) -> Stage:
    """Returns the stage of one measurement. Its key depends on the machine, as do run times and the instructions that the code chooses."""
    code = keys.code_of((*_SOURCES, *measurement.sources), ROOT)
    key = keys.measurement_key(measurement.command, code, machine.identity())
    target = folder / measurement.file
    answer = functools.partial(_answer, measurement, target)
    return Stage(measurement.name, "", target, key, measurement.seconds, answer)


def _answer(measurement: Measurement, target: Path, processes: Processes) -> Document:
    """Runs the program; the document says where its answer was measured and whether the program found it right."""
    program = ROOT / _BIN / measurement.program
    if not program.is_file():
        raise NoAnswer(no_benchmark(_BIN / measurement.program))
    with unfinished_file(target) as unfinished:
        arguments = [argument.replace(_ANSWER, str(unfinished)) for argument in measurement.arguments]
        finished = processes.run([str(program), *arguments], ROOT, dict(os.environ))
        if finished.exit_code not in _ANSWERED or not unfinished.is_file():
            raise NoAnswer(finished.reason)
        answer = parsed(unfinished.read_text(encoding="utf-8"))
    origin = {"command": measurement.command, "passed": finished.exit_code == 0}
    return {**machine.origin(), **origin, "answer": answer}

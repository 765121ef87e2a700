"""Asks the field solver for one scene, in a process of its own with a limit of time."""

from __future__ import annotations

import time
from pathlib import Path

from analysis.honesty.asking import stated
from analysis.honesty.kinds import Drawn
from analysis.honesty.methods import (
    ANSWERED,
    ENDED,
    FIELD_RTOL,
    FIELD_SECONDS,
    FIELD_SOLVER,
    LATE,
    PARTS,
    REFUSED,
    Answer,
    Stated,
    entry,
    part_of,
)
from analysis.pipeline import reference_stage
from analysis.pipeline.processes import Processes
from analysis.pipeline.stage import NoAnswer, Refused
from analysis.results.answers import ReferenceAnswer
from analysis.results.store import write_text

_SCENES = "scenes"
_LATE = "no level was finished within"


def field_answer(scene: Drawn, folder: Path, processes: Processes) -> Answer:
    """Answers a scene, which is written to a file in the folder, by the field solver's intervals."""
    file = folder / _SCENES / f"{scene.seed}.toml"
    write_text(file, scene.text)
    asked = ["--rtol", repr(FIELD_RTOL), "--max-seconds", repr(FIELD_SECONDS)]
    if scene.has_readings:
        asked.append("--only-readings")
    begin = time.monotonic()
    try:
        answer = ReferenceAnswer.of(reference_stage.solve(file, processes, *asked))
    except Refused as error:
        return Answer(REFUSED, time.monotonic() - begin, str(error))
    except NoAnswer as error:
        return Answer(LATE if _LATE in str(error) else ENDED, time.monotonic() - begin, str(error))
    values = _readings(answer) if scene.has_readings else _matrix(answer)
    return Answer(ANSWERED, time.monotonic() - begin, values=values)


def _readings(answer: ReferenceAnswer) -> dict[str, Stated]:
    return {
        part_of(name, part): stated(getattr(reading, part).value, getattr(reading, part).error, FIELD_SOLVER)
        for name, reading in answer.readings.items()
        for part in PARTS
    }


def _matrix(answer: ReferenceAnswer) -> dict[str, Stated]:
    names = answer.conductors
    return {
        entry(names[i], names[j]): stated(
            float(answer.maxwell[i, j]), float(answer.error[i, j]), FIELD_SOLVER
        )
        for i in range(len(names))
        for j in range(i + 1)
    }

"""Asks the model's Python module for one answer, with a limit of time."""

from __future__ import annotations

import math
import signal
import time
from dataclasses import replace
from types import FrameType
from typing import Any

from analysis.honesty.methods import ANSWERED, ENDED, LATE, REFUSED, Answer, Stated
from analysis.honesty.quantities import CHANGE, PARTS, entry, in_pose, pair, part_of
from analysis.pipeline.model_stage import model_module

_LONGEST_REASON = 300


class TooLong(Exception):
    """An answer takes longer than it may."""


def ask(text: str, has_readings: bool, options: dict[str, Any], seconds: float) -> Answer:
    """Answers a scene's text: parts of its readings or, if it has none, entries of its Maxwell matrix, or the capacitances of its pairs where
    the method finds no matrix; with the option `motion`, an array of poses, the changes in each of them. What takes more than `seconds`
    of processor time has no answer: that is the same on a busy machine. To be called on the main thread only, whose signals end what takes too long.
    """
    before = signal.signal(signal.SIGPROF, _ring)
    begin = time.monotonic()

    def outcome(kind: str, reason: str = "") -> Answer:
        return Answer(kind, time.monotonic() - begin, reason[:_LONGEST_REASON])

    try:
        signal.setitimer(signal.ITIMER_PROF, seconds)
        try:
            found = _answered(text, has_readings, options)
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
    except TooLong:
        return outcome(LATE)
    except ValueError as error:
        return outcome(REFUSED, str(error))
    # Whatever else the library raises is a finding, not an end of the run.
    except Exception as error:
        return outcome(ENDED, f"{type(error).__name__}: {error}")
    finally:
        signal.signal(signal.SIGPROF, before)
    return replace(found, seconds=time.monotonic() - begin)


def _answered(text: str, has_readings: bool, options: dict[str, Any]) -> Answer:
    scene = model_module().Scene.loads(text)
    if "motion" in options:
        return Answer(ANSWERED, values=_changes(scene.readings_of(**options)))
    if not has_readings:
        # The formula knows no entries of a matrix.
        entries = {} if options["method"] == "formula" else {"entries": True}
        answer = scene.capacitance(**{**options, **entries})
        values = _matrix(answer) if "maxwell" in answer else _pairs(answer)
        return Answer(ANSWERED, values=values, reached=answer.get("reached"))
    values = {
        part_of(name, part): stated(getattr(reading, part), reading.error[part], reading.answered_by)
        for name, reading in scene.readings(**options).items()
        for part in PARTS
    }
    return Answer(ANSWERED, values=values)


def _changes(answer: Any) -> dict[str, Stated]:
    """Returns the changes in each pose."""
    return {
        part_of(in_pose(name, frame), CHANGE): stated(
            float(answer.change[frame, column]),
            float(answer.error["change"][frame, column]),
            answer.answered_by[frame][column],
        )
        for frame in range(len(answer.frames))
        for column, name in enumerate(answer.readings)
    }


def _pairs(answer: dict[str, Any]) -> dict[str, Stated]:
    if not answer["sensors"]:
        raise ValueError("finds no Maxwell matrix")
    return {
        pair(sensor["name"], each["name"]): stated(each["capacitance"], each["error"], each["answered_by"])
        for sensor in answer["sensors"]
        for each in sensor["objects"]
    }


def _matrix(answer: dict[str, Any]) -> dict[str, Stated]:
    names, values, errors = answer["conductors"], answer["maxwell"], answer["error"]
    return {
        entry(names[i], names[j]): stated(float(values[i][j]), float(errors[i][j]), answer["answered_by"])
        for i in range(len(names))
        for j in range(i + 1)
    }


def stated(value: float | None, error: float | None, by: str) -> Stated:
    """Returns what is stated; a number that is not finite is one that is not known."""
    return Stated(_known(value), _known(error), by)


def _known(number: float | None) -> float | None:
    return number if number is not None and math.isfinite(number) else None


def _ring(number: int, frame: FrameType | None) -> None:
    raise TooLong

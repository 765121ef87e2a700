"""Asks the model's Python module for one answer, with a limit of time."""

from __future__ import annotations

import math
import signal
import time
from types import FrameType
from typing import Any

from analysis.honesty.methods import ANSWERED, ENDED, LATE, REFUSED, Answer, Stated
from analysis.honesty.quantities import PARTS, entry, part_of
from analysis.pipeline.model_stage import model_module

_LONGEST_REASON = 300


class TooLong(Exception):
    """An answer takes longer than it may."""


def ask(text: str, has_readings: bool, options: dict[str, Any], seconds: float) -> Answer:
    """Answers a scene's text: parts of its readings or, if it has none, entries of its Maxwell matrix. What takes more than `seconds`
    of processor time has no answer: that is the same on a busy machine. To be called on the main thread only, whose signals end what takes too long.
    """
    before = signal.signal(signal.SIGPROF, _ring)
    begin = time.monotonic()

    def outcome(kind: str, reason: str = "") -> Answer:
        return Answer(kind, time.monotonic() - begin, reason[:_LONGEST_REASON])

    try:
        signal.setitimer(signal.ITIMER_PROF, seconds)
        try:
            values = _values(text, has_readings, options)
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
    return Answer(ANSWERED, time.monotonic() - begin, values=values)


def _values(text: str, has_readings: bool, options: dict[str, Any]) -> dict[str, Stated]:
    scene = model_module().Scene.loads(text)
    if not has_readings:
        return _matrix(scene.capacitance(**options))
    return {
        part_of(name, part): stated(getattr(reading, part), reading.error[part], reading.answered_by)
        for name, reading in scene.readings(**options).items()
        for part in PARTS
    }


def _matrix(answer: dict[str, Any]) -> dict[str, Stated]:
    if "maxwell" not in answer:
        raise ValueError("finds no Maxwell matrix")
    names, values, errors = answer["conductors"], answer["maxwell"], answer["error"]
    return {
        entry(names[i], names[j]): stated(
            float(values[i][j]), float(errors[i][j]), answer["options"]["method"]
        )
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

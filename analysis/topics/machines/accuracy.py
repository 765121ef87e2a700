"""The formula in company to an accuracy, compared with the stored truths of the set-ups on machines.

`python3 -m analysis measure accuracy --rtol 0.01 --every 13` takes every 13th set-up; all take half an hour of one core.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass

import numpy as np

from analysis.pipeline import model_stage
from analysis.topics.machines import truths
from analysis.topics.machines.set_ups import FAMILIES, READING, all_set_ups
from geometries.common.arguments import positive_integer, positive_number
from geometries.scene.writer import canonical


@dataclass(frozen=True)
class _Answer:
    """Errors relative to the true change: the actual one, the one stated, and that of the truth."""

    family: str
    error: float
    stated: float
    truth: float
    seconds: float


def measured(rtol: float, every: int, first: int) -> list[_Answer]:
    """Answers every so-many-th set-up that has a stored truth."""
    model, known, found = model_stage.model_module(), truths.load(), []
    for set_up in all_set_ups()[first::every]:
        if set_up.identity not in known:
            continue
        true = known[set_up.identity].changes.full
        before = time.process_time()
        reading = model.Scene.loads(canonical(set_up.scene)).readings(correction="formula", rtol=rtol)[
            READING
        ]
        seconds = time.process_time() - before
        scale = abs(true.value)
        answer = _Answer(
            set_up.family,
            (reading.change - true.value) / scale,
            reading.error["change"] / scale,
            true.error / scale,
            seconds,
        )
        print(
            f"{set_up.name}: error {answer.error:.2%}, stated {answer.stated:.2%}, truth ± {answer.truth:.2%}",
            flush=True,
        )
        found.append(answer)
    return found


def row(name: str, answers: list[_Answer]) -> str:
    """Returns a row of the table in model/CORRECTIONS.md: errors in %, their largest ratio to the stated one and to both errors together."""
    errors = np.abs([each.error for each in answers])
    stated = np.array([each.stated for each in answers])
    both = stated + np.array([each.truth for each in answers])
    seconds = float(np.median([each.seconds for each in answers]))
    return (
        f"| {name} | {len(answers)} | {100 * np.sqrt(np.mean(errors**2)):.2f} | {100 * errors.max():.1f} | {100 * np.median(stated):.1f} "
        f"| {(errors / stated).max():.2f} | {(errors / both).max():.2f} | {seconds:.1f} |"
    )


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what may be asked for."""
    parser.add_argument("--rtol", type=positive_number, default=1e-2)
    parser.add_argument("--every", type=positive_integer, default=1)
    parser.add_argument("--first", type=int, default=0)


def measure(asked: argparse.Namespace) -> int:
    """Prints each set-up and the table."""
    answers = measured(asked.rtol, asked.every, asked.first)
    for family in FAMILIES:
        if own := [each for each in answers if each.family == family]:
            print(row(family, own))
    print(row("all", answers))
    return 0

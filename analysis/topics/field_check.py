"""Readings of set-ups by the field solver, kept beside the code of their topic. Those that have a record are not solved again."""

from __future__ import annotations

import argparse
import math

from analysis.topics.all import TOPICS
from analysis.topics.insulators import truths as insulators
from geometries.common.arguments import positive_number
from geometries.common.errors import InputError

_STORED = {topic.name: topic.check for topic in TOPICS if topic.check}


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the topic and the time."""
    parser.add_argument(
        "topic", choices=_STORED, help="an hour or so of one core for each; delete the file to solve all anew"
    )
    parser.add_argument(
        "--seconds",
        type=positive_number,
        default=math.inf,
        metavar="S",
        help="begin none after these seconds",
    )
    parser.add_argument(
        "--boundary",
        action="store_true",
        help="of the insulators that have a record, solve anew by boundary elements only",
    )


def measure(options: argparse.Namespace) -> int:
    """Solves what has no record; status 1 where some remain without."""
    if options.boundary and options.topic != insulators.STAGES.name:
        raise InputError(
            "",
            "",
            f"--boundary is an option of {insulators.STAGES.name}: the records of {options.topic} have no boundary elements",
        )
    if options.boundary:
        print(f"insulators: {insulators.solve_again()} set-ups solved by boundary elements")
        return 0
    solved, left = _STORED[options.topic].complete(seconds=options.seconds)
    print(f"{options.topic}: {solved} set-ups solved, {left} remain without a record")
    return 1 if left else 0

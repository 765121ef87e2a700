"""True values of set-ups by boundary elements, kept beside the code of their topic. Those that have a record are not solved again."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from analysis.topics.all import TOPICS
from analysis.topics.corrections import set_ups as corrections

_MAKE: dict[str, Callable[[], int]] = {"corrections": corrections.make} | {
    topic.name: lambda stored=topic.truths: stored.complete().solved for topic in TOPICS if topic.truths
}


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the topic."""
    parser.add_argument(
        "topic",
        choices=_MAKE,
        help="a minute for the corrections, a quarter of an hour for the others; delete the file to solve all anew",
    )


def measure(options: argparse.Namespace) -> int:
    """Solves what has no record; those of the corrections all anew."""
    print(f"{options.topic}: {_MAKE[options.topic]()} set-ups solved")
    return 0

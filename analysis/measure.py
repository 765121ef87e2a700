"""`python3 -m analysis measure WHAT`: makes what is stored with the project anew, or measures what a note tells."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from analysis.documentation import measurements
from analysis.topics.all import TOPICS
from analysis.topics.corrections import estimates, set_ups as corrections
from analysis.topics.insulators import truths as insulators
from geometries.common.errors import InputError

_TRUTHS: dict[str, Callable[[], int]] = {"corrections": corrections.make} | {
    topic.name: lambda stored=topic.truths: stored.complete().solved for topic in TOPICS if topic.truths
}
_CHECKS = {topic.name: topic.check for topic in TOPICS if topic.check}


def _solve_truths(options: argparse.Namespace) -> int:
    """Solves what has no record; those of the corrections all anew."""
    print(f"{options.topic}: {_TRUTHS[options.topic]()} set-ups solved")
    return 0


def _solve_checks(options: argparse.Namespace) -> int:
    """Solves what has no record; status 1 where some remain without."""
    own = insulators.STAGES.name
    if options.boundary and options.topic != own:
        reason = f"--boundary is an option of {own}: the records of {options.topic} have no boundary elements"
        raise InputError("", "", reason)
    if options.boundary:
        print(f"{own}: {insulators.solve_again()} set-ups solved by boundary elements")
        return 0
    solved, left = _CHECKS[options.topic].complete(seconds=options.seconds)
    print(f"{options.topic}: {solved} set-ups solved, {left} remain without a record")
    return 1 if left else 0


MEASURES: dict[str, Callable[[argparse.Namespace], int]] = {
    "truths": _solve_truths,
    "field-check": _solve_checks,
    "corrections": estimates.measure,
    "benchmarks": measurements.measure,
}

"""`python3 -m analysis measure WHAT`: makes what is stored with the project anew, or measures what a note tells."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from analysis.documentation import measurements
from analysis.topics.all import TOPICS
from analysis.topics.corrections import estimates, set_ups as corrections
from analysis.topics.insulators import truths as insulators
from geometries.common import installation
from geometries.common.arguments import positive_number
from geometries.common.errors import InputError

_TRUTHS: dict[str, Callable[[], int]] = {"corrections": corrections.make} | {
    topic.name: lambda stored=topic.truths: stored.complete().solved for topic in TOPICS if topic.truths
}
_CHECKS = {topic.name: topic.check for topic in TOPICS if topic.check}


def _add_topic_of_truths(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "topic",
        choices=_TRUTHS,
        help="a minute for the corrections, a quarter of an hour for the others; delete the file to solve all anew",
    )


def _solve_truths(options: argparse.Namespace) -> int:
    """Solves what has no record; those of the corrections all anew."""
    print(f"{options.topic}: {_TRUTHS[options.topic]()} set-ups solved")
    return 0


def _add_topic_of_checks(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "topic", choices=_CHECKS, help="an hour or so of one core for each; delete the file to solve all anew"
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


def _solve_checks(options: argparse.Namespace) -> int:
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
    solved, left = _CHECKS[options.topic].complete(seconds=options.seconds)
    print(f"{options.topic}: {solved} set-ups solved, {left} remain without a record")
    return 1 if left else 0


@dataclass(frozen=True)
class Measure:
    """What it makes, how that is described, what is called with the options, which returns the exit status, and what adds the options."""

    makes: str
    description: str | None
    call: Callable[[argparse.Namespace], int]
    add_options: Callable[[argparse.ArgumentParser], None] = lambda _: None


MEASURES = {
    "truths": Measure(
        "true values of a topic's set-ups that have no record",
        "True values of set-ups by boundary elements, kept beside the code of their topic. Those that have a record are not solved again.",
        _solve_truths,
        _add_topic_of_truths,
    ),
    "field-check": Measure(
        "readings of a topic's set-ups by the field solver that have no record",
        "Readings of set-ups by the field solver, kept beside the code of their topic. Those that have a record are not solved again.",
        _solve_checks,
        _add_topic_of_checks,
    ),
    "corrections": Measure(
        "tables of errors in model/CORRECTIONS.md, section 5", estimates.__doc__, estimates.measure
    ),
    "benchmarks": Measure(
        "measured tables of model/MEASUREMENTS.md", measurements.__doc__, measurements.measure
    ),
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what there is to measure, and the arguments that are handed on."""
    width = max(map(len, MEASURES))
    lines = (f"  {name:{width}}  {each.makes}" for name, each in MEASURES.items())
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.description = "\n".join(
        ["Makes anew, or measures:", *lines, "", "WHAT --help lists its arguments."]
    )
    # A dictionary of choices would be taken for subcommands by what makes completions for shells.
    parser.add_argument("what", metavar="WHAT", choices=list(MEASURES), help="one of these")
    parser.add_argument("arguments", metavar="ARGUMENT", nargs=argparse.REMAINDER, help="of WHAT")


def run(what: str, words: Sequence[str]) -> int:
    """Measures; returns the exit status."""
    chosen = MEASURES[what]
    program = f"{installation.command('analysis')} measure {what}"
    parser = argparse.ArgumentParser(prog=program, description=chosen.description)
    chosen.add_options(parser)
    return chosen.call(parser.parse_args(words))

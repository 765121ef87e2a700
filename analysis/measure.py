"""`python3 -m analysis measure WHAT`: makes what is stored with the project anew, or measures what a note tells."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module

from geometries.common import installation


@dataclass(frozen=True)
class Measure:
    """What it makes, and the module that does it, which is loaded only for this: its function `measure` takes the options, which its function
    `arguments` adds to the parser, and returns the exit status."""

    makes: str
    module: str


MEASURES = {
    "truths": Measure("true values of a topic's set-ups that have no record", "analysis.topics.truths"),
    "field-check": Measure(
        "readings of a topic's set-ups by the field solver that have no record", "analysis.topics.field_check"
    ),
    "corrections": Measure(
        "tables of errors in model/CORRECTIONS.md, section 5", "analysis.topics.corrections.estimates"
    ),
    "benchmarks": Measure("measured tables of model/MEASUREMENTS.md", "analysis.documentation.measurements"),
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
    module = import_module(chosen.module)
    parser = argparse.ArgumentParser(
        prog=f"{installation.command('analysis')} measure {what}", description=module.__doc__
    )
    if hasattr(module, "arguments"):
        module.arguments(parser)
    status: int = module.measure(parser.parse_args(words))
    return status

"""Values of command-line options, refused with a reason that argparse prints."""

from __future__ import annotations

import argparse
import math


def positive_number(text: str) -> float:
    """Returns a finite number greater than 0; raises argparse.ArgumentTypeError for anything else."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number greater than 0")
    return value


def positive_integer(text: str) -> int:
    """Returns a whole number greater than 0; raises argparse.ArgumentTypeError for anything else."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number greater than 0")
    return int(text)

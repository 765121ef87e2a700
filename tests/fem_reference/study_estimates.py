"""Estimates against the known quantities of the verification: python3 -m tests.fem_reference.study_estimates [--rtol R] [NAME …].

Prints one line for each set-up, then how large the true errors are beside the stated ones. Fails when a true error exceeds the stated one by more
than the truth is uncertain.
"""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np

from analysis.topics.verification.rows import carried_error
from analysis.topics.verification.set_ups import Quantity, true_cases
from fem_reference.answer.reference import Reference, solve_conductors


def ratio(quantity: Quantity, found: Reference) -> float:
    """The error of a quantity, as far as the truth is known, over the stated one."""
    if quantity.of is None:
        value, error = float(found.delta_self.value[0]), float(found.delta_self.error[0])
    else:
        value = quantity.of(found.maxwell.value)
        error = carried_error(quantity.of, found.maxwell.value, found.maxwell.error)
    off = abs(value - quantity.truth) - quantity.truth_error * abs(quantity.truth)
    return max(off, 0.0) / error


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="only these set-ups")
    parser.add_argument("--rtol", type=float, default=1e-3)
    options = parser.parse_args()
    cases = true_cases()
    ratios, seconds = [], []
    for name in options.names or [name for name, case in cases.items() if not case.longer]:
        start = time.process_time()
        found = solve_conductors(cases[name].set_up.conductors(), rtol=options.rtol, error="estimate")
        seconds.append(time.process_time() - start)
        own = [ratio(quantity, found) for quantity in cases[name].quantities]
        ratios += own
        unknowns = " + ".join(f"{level.unknowns:,}" for level in found.levels)
        words = "reached" if found.reached else "NOT REACHED"
        print(
            f"{name}: {words}, {unknowns} unknowns, {seconds[-1]:.1f} s, at most {max(own):.2f} of the stated error",
            flush=True,
        )
    rms = float(np.sqrt(np.mean(np.square(ratios))))
    print(
        f"{len(ratios)} quantities: {max(ratios):.2f} of the stated error at most, {rms:.2f} rms; "
        f"{np.median(seconds):.1f} s of a processor (median)"
    )
    return 0 if max(ratios) <= 1 else 1


if __name__ == "__main__":
    sys.exit(main())

"""Command line: python3 -m fem_reference SCENE [--rtol R] [--error KIND] [--columns NAME,…] [--max-…] [--json] [--output F.vtu] [--slice F]."""

from __future__ import annotations

import argparse
import io
import logging
import math
import os
import shlex
import sys
from pathlib import Path

from geometries.common import installation
from geometries.common.interpreter import continue_with

ANSWERED, FAILED, WRONG_INPUT, NOT_REACHED = 0, 1, 2, 3


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not value > 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive number")
    return value


def _field_file(text: str) -> Path:
    if not text.endswith(".vtu"):
        raise argparse.ArgumentTypeError(f"{text!r} does not end in .vtu")
    return Path(text)


def _names(text: str) -> tuple[str, ...]:
    names = tuple(text.split(","))
    if not all(names):
        raise argparse.ArgumentTypeError(f"{text!r} has an empty name")
    return names


def _parser(program: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=program,
        description="The Maxwell capacitance matrix of a scene by finite elements, with an error for every entry.",
        epilog="Exit status: 0 answered; 2 wrong input; 3 the asked accuracy was not reached, the answer and its "
        "errors are given all the same; 1 anything else.",
    )
    parser.add_argument("scene", metavar="SCENE", help="a scene file (TOML)")
    parser.add_argument(
        "--rtol", type=_positive, default=1e-3, help="largest relative error of an entry (default 1e-3)"
    )
    parser.add_argument(
        "--max-seconds",
        type=_positive,
        default=math.inf,
        help="start no level that would end later than this",
    )
    parser.add_argument(
        "--max-unknowns",
        type=_positive,
        default=math.inf,
        help="start no level that would have more unknowns than this",
    )
    parser.add_argument(
        "--max-memory",
        type=_positive,
        default=math.inf,
        metavar="GIB",
        help="start no level that would take more memory than this",
    )
    parser.add_argument(
        "--error",
        choices=("enclosure", "estimate"),
        default="enclosure",
        help="what rtol is asked of: half the width of intervals proven to hold the truth (default), or errors estimated from "
        "successive meshes, several times faster",
    )
    parser.add_argument(
        "--columns",
        metavar="NAME[,NAME…]",
        type=_names,
        default=(),
        help="solve only these conductors' rows and columns, the other ones grounded (default: all)",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON document and nothing else")
    parser.add_argument(
        "--output",
        metavar="FILE.vtu",
        type=_field_file,
        help="also write potential, field and bodies, the first sensor at 1 V, on the coarsest mesh, for ParaView",
    )
    parser.add_argument(
        "--slice",
        metavar="FILE",
        help="in the place of the matrix: write the potential in a vertical plane through the conductors' centres, "
        "the first sensor at 1 V, to this JSON file",
    )
    parser.add_argument("--version", action="version", version=_version())
    return parser


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return f"fem_reference with dolfinx {version('fenics-dolfinx')}"
    except PackageNotFoundError:
        return "fem_reference, dolfinx not found"


def main(arguments: list[str] | None = None) -> int:
    """Run the command; returns its exit status."""
    options = _parser(installation.command("fem_reference")).parse_args(arguments)
    continue_with("dolfinx")
    _prepare_libraries()
    from mpi4py import MPI

    from fem_reference import output
    from fem_reference.limits import Limits
    from geometries.common.errors import InputError

    # Every process runs all of this, and comes to the same end; one of them says so.
    is_first = MPI.COMM_WORLD.rank == 0
    told = sys.stderr if is_first else io.StringIO()
    try:
        alone = [
            ("--slice", options.slice),
            ("--output", options.output),
            ("--error enclosure", options.error == "enclosure"),
        ]
        what = next((name for name, asked in alone if asked), None)
        if MPI.COMM_WORLD.size > 1 and what is not None:
            raise InputError(
                options.scene, what, "is made by a single process; several solve with --error estimate"
            )
        if options.slice is not None:
            return output.write_slice(Path(options.scene), Path(options.slice))
        if options.output is not None:
            output.write_field(Path(options.scene), options.output)
        limits = Limits(options.max_seconds, options.max_unknowns, options.max_memory * 2**30)
        return output.answer(
            Path(options.scene), options.json, options.rtol, options.error, limits, options.columns
        )
    except InputError as wrong:
        print(f"fem_reference: {wrong}", file=told)
        return WRONG_INPUT
    except (RuntimeError, OSError, MemoryError) as failure:
        words = shlex.join(sys.argv[1:] if arguments is None else arguments)
        print(
            f"fem_reference: {options.scene}: {failure or 'out of memory'}; "
            f"to see it again: {installation.command('fem_reference')} {words}",
            file=told,
        )
        return FAILED


def _prepare_libraries() -> None:
    """Compiled forms are kept beside the build; a process uses one core, since cases run side by side; no chatter."""
    logging.getLogger().setLevel(logging.WARNING)
    os.environ.setdefault("XDG_CACHE_HOME", str(installation.cache_folder()))
    os.environ.setdefault("OMP_NUM_THREADS", "1")


if __name__ == "__main__":
    sys.exit(main())

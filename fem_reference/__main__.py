"""The command `python3 -m fem_reference SCENE`; --help lists its options."""

from __future__ import annotations

import argparse
import io
import logging
import math
import os
import shlex
import sys
import time
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from fem_reference.common.supervision import Report, supervised
from geometries.common import installation
from geometries.common.arguments import positive_number
from geometries.common.errors import InputError

ANSWERED, FAILED, WRONG_INPUT, NOT_REACHED = 0, 1, 2, 3


def _field_file(text: str) -> Path:
    """Parse the name of a VTU file."""
    if not text.endswith(".vtu"):
        raise argparse.ArgumentTypeError(f"{text!r} does not end in .vtu")
    return Path(text)


def _names(text: str) -> tuple[str, ...]:
    """Parse names separated by commas."""
    names = tuple(text.split(","))
    if not all(names):
        raise argparse.ArgumentTypeError(f"{text!r} has an empty name")
    return names


def _parser(program: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=program,
        description="Compute the Maxwell capacitance matrix and the readings of a scene by finite elements, with an error for each.",
        epilog="Exit status: 0 answered; 2 wrong input; 3 the requested accuracy was not reached (the answer is printed with "
        "the errors reached); 130 interrupted by Ctrl-C (the same, if there is an answer); 1 any other failure.",
    )
    parser.add_argument("scene", metavar="SCENE", help="a scene file (TOML)")
    parser.add_argument(
        "--rtol", type=positive_number, default=1e-3, help="largest relative error of an entry (default 1e-3)"
    )
    for limit, unit, exceeds in (
        (
            "--max-seconds",
            "S",
            "end later than this many seconds after the start, and end one that does, the first one too",
        ),
        ("--max-unknowns", "N", "have more unknowns than this"),
        ("--max-memory", "GIB", "take more memory than this"),
    ):
        words = f"start no level that is predicted to {exceeds} (default: no limit)"
        parser.add_argument(limit, type=positive_number, default=math.inf, metavar=unit, help=words)
    parser.add_argument(
        "--error",
        choices=("enclosure", "estimate"),
        default="enclosure",
        help="the error that --rtol limits: half the width of an interval that is proven to contain the true value (default), or an "
        "error estimated from wider bounds, which is several times faster",
    )
    parser.add_argument(
        "--columns",
        metavar="NAME[,NAME…]",
        type=_names,
        default=(),
        help="solve for the rows and columns of these conductors only, and for their readings, with the other conductors grounded and their "
        "edges meshed more coarsely; much faster in scenes of large machines (default: all)",
    )
    parser.add_argument(
        "--only-readings",
        action="store_true",
        help="ask for the accuracy of the readings and their changes only, not of every entry of the matrix and of delta_self",
    )
    parser.add_argument(
        "--no-symmetry",
        action="store_true",
        help="mesh the whole of space even if the scene is its own mirror image; slower, for checking the use of symmetry",
    )
    parser.add_argument(
        "--geometry",
        choices=("exact", "wrapped", "auto"),
        default="auto",
        help="exact: mesh every body as it is, and refuse meshes that bound no solid; wrapped: replace the objects of every conductor by "
        "a closed surface around them; auto: only where they cannot be meshed as they are (default)",
    )
    parser.add_argument(
        "--wrap-alpha",
        metavar="M",
        type=positive_number,
        help="radius in metres of the narrowest hollow that such a surface follows, everywhere (default: at each place 0.4 of the "
        "distance to the nearest other conductor, at most 0.02 of the extent)",
    )
    parser.add_argument(
        "--wrap-offset",
        metavar="M",
        type=positive_number,
        help="distance in metres of such a surface from what it contains, where that is least (default: --rtol / 8, within 1e-3 and 2.5e-3, "
        "times the distance to the nearest other conductor)",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON document and nothing else")
    parser.add_argument(
        "--output",
        metavar="FILE.vtu",
        type=_field_file,
        help="also write a file for ParaView with the potential, the field and the bodies on the coarsest mesh, with the first sensor "
        "at 1 V",
    )
    parser.add_argument(
        "--slice",
        metavar="FILE",
        help="instead of computing the matrix, write to this JSON file the potential in a vertical plane through the conductors' "
        "centres, with the first sensor at 1 V",
    )
    parser.add_argument("--version", action="version", version=_version())
    return parser


def _version() -> str:
    try:
        return f"fem_reference with dolfinx {version('fenics-dolfinx')}"
    except PackageNotFoundError:
        return "fem_reference, dolfinx not found"


def main(arguments: list[str] | None = None, report: Report = lambda _: None) -> int:
    """Run the command; returns its exit status. `report` gets the answer so far after every level."""
    options = _parser(installation.command("fem_reference")).parse_args(arguments)
    _prepare_libraries()
    from mpi4py import MPI

    # Every process runs all of this and ends with the same status; only the first one prints messages.
    is_first = MPI.COMM_WORLD.rank == 0
    error_stream = sys.stderr if is_first else io.StringIO()
    try:
        single_process_only = [("--slice", options.slice), ("--output", options.output)]
        refused = next((name for name, asked in single_process_only if asked), None)
        if MPI.COMM_WORLD.size > 1 and refused is not None:
            raise InputError(options.scene, refused, "needs a single process")
        return _answered(options, report)
    except InputError as wrong:
        print(f"fem_reference: {wrong}", file=error_stream)
        return WRONG_INPUT
    except (RuntimeError, OSError, MemoryError) as failure:
        words = shlex.join(sys.argv[1:] if arguments is None else arguments)
        # The other processes may wait for this one. The first one, if it failed as well, is to say so alone.
        time.sleep(0.0 if is_first else 1.0)
        print(
            f"fem_reference: {options.scene}: {failure or 'out of memory'}; "
            f"to see it again: {installation.command('fem_reference')} {words}",
            file=sys.stderr,
            flush=True,
        )
        if MPI.COMM_WORLD.size > 1:
            MPI.COMM_WORLD.Abort(FAILED)
        return FAILED


def _answered(options: argparse.Namespace, report: Report) -> int:
    """Solve the scene as the options say; returns the exit status."""
    # Loading the solver takes a part of the time that is given.
    start = time.monotonic()
    from fem_reference.bodies.wrapping import Geometry
    from fem_reference.common.limits import Limits
    from fem_reference.output import documents

    limits = Limits(options.max_seconds, options.max_unknowns, options.max_memory * 2**30)
    clock = documents.Clock(Path(options.scene), options.json, options.rtol, start, limits.seconds, report)
    clock.preparing()
    if options.slice is not None:
        return documents.write_slice(Path(options.scene), Path(options.slice))
    if options.output is not None:
        documents.write_field(Path(options.scene), options.output)
    return documents.answer(
        clock,
        limits,
        error=options.error,
        columns=options.columns,
        symmetry=not options.no_symmetry,
        geometry=Geometry(options.geometry, options.wrap_alpha, options.wrap_offset),
        only_readings=options.only_readings,
    )


def _prepare_libraries() -> None:
    """Keep compiled forms beside the build, use one core per process, since cases run side by side, and silence the libraries' logs."""
    # The form compiler logs through the root logger, whose level the build tools set themselves: only disabling works.
    logging.disable(logging.INFO)
    os.environ.setdefault("XDG_CACHE_HOME", str(installation.cache_folder()))
    os.environ.setdefault("OMP_NUM_THREADS", "1")


if __name__ == "__main__":
    # Help and wrong options need no packages.
    _parser(installation.command("fem_reference")).parse_args()
    installation.continue_with("dolfinx")
    sys.exit(supervised(lambda report: main(report=report), NOT_REACHED))

"""The output of the command: a JSON document, a table for people to read, a slice of the potential, and a field file."""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import basix
import dolfinx
import gmsh
import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from fem_reference.output.pictures import potential_slice, write_field_file
from fem_reference.output.readings import reading_document, readings_table, row
from fem_reference.solve.level import Level
from fem_reference.common.limits import Limits
from fem_reference.common.supervision import AnswerSoFar, Report
from fem_reference.answer.shared_errors import GeometryError
from fem_reference.answer.reference import ErrorKind, Reference, maxwell
from fem_reference.bodies.remarks import remarks
from geometries.common.files import whole_file
from geometries.common.measured import PICOFARAD, picofarad_interval, picofarads
from geometries.scene.reader import load

# Version of the documents' format, as geometries/schemas/FORMATS.md describes it.
FORMAT = 1
ANSWERED, NOT_REACHED = 0, 3

# Seconds after the limit of time in which the solver may end by itself, as it does between two levels.
_GRACE = 2.0

METHOD = (
    "the value lies between an upper and a lower bound of the energies on one mesh, by shares of their distance that were measured for "
    "each kind of edge; the next mesh is refined where the error arises"
)
"""How values and errors are found."""
INTERVAL: dict[ErrorKind, str] = {
    "estimate": "lower and upper are the value less and plus its estimated error",
    "enclosure": "lower and upper enclose the true value: energies of a continuous potential and of a divergence-free flux, "
    "both continued to infinity and integrated to rounding on straight and quarter-point cells; the surfaces of the bodies "
    "listed as curved are those of second-order cells, whose deviation widens the interval by an estimate",
}

WRAPPED_INTERVAL = "; bodies were wrapped, and what that costs widens the bounds by an estimate, except for those that `proven` names"


@dataclass(frozen=True)
class Clock:
    """What to print about a scene when the limit of time is over; `report` hands it to the process that watches this one."""

    path: Path
    as_json: bool
    rtol: float
    start: float
    """When the command began (s), on the monotonic clock."""
    seconds: float
    """The limit; infinity for none."""
    report: Report

    def preparing(self) -> None:
        """From now on until the next report, the bodies are being prepared."""
        stage = "the bodies were still being prepared, where unclean and large meshes are wrapped"
        self._nothing(f"{stage}: give more time, simplify the meshes, or choose a larger --wrap-alpha", ())

    def solving(self, found: Sequence[str]) -> None:
        """From now on until the next report, the first level is being solved; `found` are the remarks on the scene."""
        self._nothing(
            "the first one has the coarsest mesh: give more time, or simplify the scene's meshes", found
        )

    def answered(self, text: str, message: str, left: float | None = None) -> None:
        """There is an answer to print, with a message, unless a better one comes in the time (s) that is left, the limit's by default."""
        self.report(AnswerSoFar(text, message, self._left() if left is None else left))

    def _left(self) -> float:
        return max(0.0, self.start + self.seconds - time.monotonic()) + _GRACE

    def _nothing(self, advice: str, found: Sequence[str]) -> None:
        """Say what to print when the limit of time ends this."""
        if math.isinf(self.seconds) or MPI.COMM_WORLD.rank != 0:
            return
        reason = f"no level was finished within {self.seconds:g} s"
        document = {
            "format": FORMAT,
            "rtol": self.rtol,
            "reached": False,
            "stopped_by": reason,
            "levels": [],
            "remarks": list(found),
        }
        text = json.dumps(document) if self.as_json else ""
        message = f"fem_reference: {self.path}: {reason}; {advice}"
        self.report(AnswerSoFar(text, message, self._left(), is_answer=False))


def answer(clock: Clock, limits: Limits, **asked: Any) -> int:
    """Solve a scene file and print the answer; returns the exit status. The clock gets the answer so far after every level, and `asked`
    goes to `maxwell`."""
    path, as_json = clock.path, clock.as_json
    scene = load(path)
    is_first = MPI.COMM_WORLD.rank == 0
    found = remarks(scene)
    if is_first:
        for remark in found:
            print(f"fem_reference: remark: {remark}", file=sys.stderr, flush=True)

    def progress(so_far: Reference) -> None:
        if not is_first:
            # The parents of other processes know that there is an answer, and leave it to the first to print it.
            clock.answered("", "", math.inf)
            return
        if not as_json:
            _print_level(so_far)
        stopped = so_far.stopped("it was stopped before the next level ended")
        clock.answered(_text(stopped, as_json, found), _shortfall(path, stopped))

    reference = maxwell(
        scene,
        clock.rtol,
        limits.seconds,
        limits.unknowns,
        limits.memory,
        str(path),
        progress,
        prepared=lambda: clock.solving(found),
        **asked,
    )
    status = ANSWERED if reference.reached else NOT_REACHED
    if not is_first:
        return status
    text = _text(reference, as_json, found)
    # Nothing ends the command any more while it prints.
    clock.answered(text, _shortfall(path, reference), math.inf)
    print(text)
    if not reference.reached:
        print(_shortfall(path, reference), file=sys.stderr)
        if reference.contradicted is not None:
            print(
                f"fem_reference: {path}: do not rely on the errors: {reference.contradicted}", file=sys.stderr
            )
    return status


def _text(reference: Reference, as_json: bool, found: Sequence[str]) -> str:
    return json.dumps(document(reference, found)) if as_json else table(reference)


def _shortfall(path: Path, reference: Reference) -> str:
    """Say how accurate an answer is that is less accurate than asked for, and why."""
    return (
        f"fem_reference: {path}: asked {reference.rtol:.3g}, reached {reference.worst:.3g} in {reference.seconds:.0f} s; "
        f"{reference.stopped_by}"
    )


def document(reference: Reference, found: Sequence[str] = ()) -> dict[str, Any]:
    """The answer, with the remarks on the scene, as data for JSON: farads, metres, seconds, bytes; matrices row by row in the order of
    `conductors`."""
    problem = reference.problem
    sensors = problem.names[: problem.sensors]
    result: dict[str, Any] = {
        "format": FORMAT,
        "conductors": list(problem.names),
        "maxwell": reference.maxwell.value.tolist(),
        "lower": reference.lower.tolist(),
        "upper": reference.upper.tolist(),
        "error": reference.maxwell.error.tolist(),
        "extrapolated": reference.maxwell.extrapolated.tolist(),
        "members": [list(members) for members in problem.members[: len(problem.names)]],
        "charges": [charges.tolist() for charges in reference.charges],
    }
    if reference.geometry is not None:
        result |= _geometry_document(reference, reference.geometry)
    if reference.has_objects:
        result["delta_self"] = {
            name: {
                "value": float(reference.delta_self.value[k]),
                "error": float(reference.delta_self.error[k]),
            }
            for k, name in enumerate(sensors)
        }
    finest = reference.levels[-1]
    return result | {
        "readings": list(map(reading_document, reference.readings)),
        "not_asked": list(problem.grounded),
        "ground": "room" if problem.room is not None else "infinity",
        "left_out": [{"name": body.name, "bound": float(body.bound.max())} for body in reference.left_out],
        "floating": list(problem.floating),
        "dielectrics": [
            {"name": body.name, "relative_permittivity": body.relative_permittivity}
            for body in problem.dielectrics
        ],
        "rtol": reference.rtol,
        "reached": reference.reached,
        "stopped_by": reference.stopped_by,
        "contradicted": reference.contradicted,
        "worst_relative_error": reference.worst,
        "error_kind": reference.error_kind,
        "interval": _interval(reference),
        "curved": list(problem.curved),
        "symmetry_planes": [
            {"normal": plane.normal.tolist(), "offset": plane.offset} for plane in reference.planes
        ],
        "method": METHOD,
        "levels": [_level_document(level) for level in reference.levels],
        "unknowns": finest.unknowns,
        "memory_per_unknown": finest.memory / finest.unknowns,
        "seconds": reference.seconds,
        "processes": MPI.COMM_WORLD.size,
        "versions": versions(),
        "remarks": list(found),
    }


def _interval(reference: Reference) -> str:
    """What `lower` and `upper` are."""
    words = INTERVAL[reference.error_kind] + (WRAPPED_INTERVAL if reference.problem.wraps else "")
    if reference.enclosure is not None and reference.contradicted is not None:
        words += f"; nothing is proven: {reference.contradicted}"
    return words


def _geometry_document(reference: Reference, geometry: GeometryError) -> dict[str, Any]:
    """What was wrapped, what that costs, and which bounds are proven nevertheless."""
    may_be_proven = not reference.problem.curved and reference.contradicted is None
    return {
        "geometry_error": geometry.error.tolist(),
        "proven": {
            "lower": (geometry.lower_proven & may_be_proven).tolist(),
            "upper": (geometry.upper_proven & may_be_proven).tolist(),
        },
        "wrapped": [
            {
                "members": list(wrap.members),
                "alpha": wrap.alpha,
                "offset": wrap.offset,
                "triangles": len(wrap.triangles),
            }
            for wrap in reference.problem.wraps
        ],
    }


def versions() -> dict[str, str]:
    """Versions of the libraries on which the numbers of an answer depend."""
    return {
        "dolfinx": dolfinx.__version__,
        "basix": basix.__version__,
        "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        "gmsh": gmsh.__version__,
        "numpy": np.__version__,
    }


def table(reference: Reference) -> str:
    """A table of the Maxwell matrix and delta_self in picofarad, each with its error, for people to read."""
    problem, names = reference.problem, reference.problem.names
    width = max(8, *(len(name) for name in names)) + 2
    lines = [
        "Maxwell matrix, pF: charge on the row's conductor per volt on the column's",
        row(width, "", names),
    ]
    entries = zip(names, reference.maxwell.value, reference.maxwell.error)
    lines += [row(width, name, list(map(picofarads, *both))) for name, *both in entries]
    for members in problem.members[: len(names)]:
        if len(members) > 1:
            lines.append(f"one conductor: {', '.join(members)}")
    if reference.enclosure is not None:
        why = reference.unproven_because
        lines.append("proven to lie in" if why is None else f"estimated to lie in, because {why}")
        bounds = zip(names, reference.lower, reference.upper)
        lines += [row(width, name, list(map(picofarad_interval, *both))) for name, *both in bounds]
    for wrap in problem.wraps:
        lines.append(
            f"wrapped: {', '.join(wrap.members)}, {len(wrap.triangles)} triangles, offset {wrap.offset * 1e3:.3g} mm"
        )
    if reference.geometry is not None:
        worst = float(np.max(reference.geometry.error / np.abs(reference.maxwell.value)))
        lines.append(f"largest relative error due to the wraps: {worst:.2e}, included in all errors")
    if reference.has_objects:
        lines.append("delta_self, pF: the sensor's own entry less what it is without the objects")
        changes = zip(names[: problem.sensors], reference.delta_self.value, reference.delta_self.error)
        lines += [row(width, name, [picofarads(*change)]) for name, *change in changes]
    lines += readings_table(reference.readings)
    if problem.grounded:
        lines.append(f"grounded, their columns not asked for: {', '.join(problem.grounded)}")
    if problem.room is not None:
        lines.append("ground: the walls of the room")
    for left in reference.left_out:
        lines.append(
            f"left out: {left.name}, adds at most {left.bound.max() / PICOFARAD:.2g} pF to an own entry"
        )
    if problem.floating:
        lines.append(f"floating, without charge and so without a row: {', '.join(problem.floating)}")
    for body in problem.dielectrics:
        lines.append(f"dielectric: {body.name}, relative permittivity {body.relative_permittivity:g}")
    if reference.planes:
        lines.append(f"planes of symmetry found: {len(reference.planes)}; one side of them was solved")
    finest = reference.levels[-1]
    lines.append(
        f"largest relative error {reference.worst:.2e} ({reference.error_kind}), {len(reference.levels)} levels, "
        f"{finest.unknowns} unknowns, {reference.seconds:.1f} s"
    )
    return "\n".join(lines)


def write_slice(path: Path, target: Path) -> int:
    """Write the potential in a vertical plane to a JSON file; leaves no incomplete file behind. Returns the exit status."""
    text = json.dumps({"format": FORMAT, **potential_slice(load(path), str(path))})
    with whole_file(target) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
    return ANSWERED


def write_field(path: Path, target: Path) -> None:
    """Write the field around the scene to a VTU file; leaves no incomplete file behind."""
    if not target.parent.is_dir():
        raise FileNotFoundError(f"there is no folder {target.parent} for {target.name}")
    write_field_file(load(path), target, str(path))


def _print_level(so_far: Reference) -> None:
    """Print a line about the level that has just been finished to standard error."""
    level = so_far.levels[-1]
    lacking = so_far.worst <= so_far.rtol and not so_far.reached and so_far.contradicted is None
    print(
        f"edge size {level.edge_size * 1e3:.3g} mm: {level.unknowns} unknowns, {level.seconds:.1f} s, "
        f"largest relative error so far {so_far.worst:.2e}"
        + (f", of changes {so_far.worst_of_changes:.2e}" if lacking else ""),
        file=sys.stderr,
        flush=True,
    )


def _level_document(level: Level) -> dict[str, Any]:
    """One level as data for JSON."""
    described: dict[str, Any] = {
        "h_min": level.edge_size,
        "unknowns": level.unknowns,
        "cells": level.cells,
        "seconds": level.seconds,
        "maxwell": level.maxwell.tolist(),
        "delta_self": level.delta_self.tolist(),
        "sensors_alone": level.sensors_alone.tolist(),
    }
    if level.enclosure is not None:
        described |= {
            "lower": level.enclosure.lower.tolist(),
            "upper": level.enclosure.upper.tolist(),
            "flux_seconds": level.flux_seconds,
        }
    elif level.bounds is not None:
        check = level.bounds.interval
        described["check"] = {"lower": check.lower.tolist(), "upper": check.upper.tolist()}
    return described

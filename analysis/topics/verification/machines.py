"""Machines whose capacitances the field reference encloses: python3 -m analysis measure machines [NAME …].

The command solves those named, or those without an answer for the scene as it is now, and writes `machines.json`, the answers, and
`MACHINES.md`, their table. `--scene NAME` prints the scene of a machine instead.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import logging
import math
import os
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Literal

from analysis.pipeline.model_stage import model_module
from analysis.results.store import Document, write_text
from analysis.results.units import PICOFARAD
from geometries.common.children import end_with
from geometries.common.errors import InputError
from geometries.scene.meshes import read_triangles
from geometries.scene.poses import AxisRotation, Pose, Vector3
from geometries.scene.reader import load
from geometries.scene.scene import Object, Plate, Reading, Room, Scene, Sensor
from geometries.scene.shapes import Cuboid, Cylinder, MeshShape
from geometries.scene.writer import canonical, identity

ANSWERS = Path(__file__).with_name("machines.json")
TABLE = Path(__file__).with_name("MACHINES.md")
SCENES = Path(__file__).resolve().parents[3] / "geometries" / "scenes"
LINKS = Path(__file__).resolve().parents[1] / "machines" / "links"

BOUNDARY_RTOL = 1e-2
"""Relative tolerance of the changes of readings by boundary elements, with which machines of plane faces are compared."""


MOST_BODIES = 20
"""Largest number of sensors and objects of such a machine: boundary elements take more time than the enclosure of more bodies."""


@dataclass(frozen=True)
class Machine:
    """A scene, the conductors whose rows are asked for, and the relative accuracy that is asked for."""

    name: str
    caption: str
    scene: Scene
    columns: tuple[str, ...]
    rtol: float
    error: Literal["enclosure", "estimate"] = "enclosure"
    only_readings: bool = False
    """Whether the accuracy is asked of the readings and their changes, and not of every entry."""


def machines() -> list[Machine]:
    """The machines of the table."""
    front = ("front",)
    housing = _before_a_housing()
    post = Object("post", Cylinder(0.03, 0.3, 32), pose=Pose((0.141, 0.005, -0.02)))
    room = Room((4.0, 3.0, 2.5), Pose((0.3, 0.2, 0.55)))
    return [
        Machine("housing", "a sensor of 5 × 5 cm, 2 mm before a housing; a hand 5 cm before it", housing, front, 1e-2),
        Machine("post", "the same, and a cylinder 1 mm beside the housing",
                replace(housing, objects=(*housing.objects, post)), front, 1e-2),
        Machine("room", "the same without the cylinder, in a room of 4 × 3 × 2.5 m", replace(housing, room=room), front, 1e-2),
        Machine("forty bodies", "the same in free space, on a table with 37 boxes",
                replace(housing, objects=(*housing.objects, *_boxes(37))), front, 1e-2),
        Machine("housing, finer", "the first of these again; only the reading", housing, front, 1e-3, only_readings=True),
        Machine("guarded_sensor", "geometries/scenes/guarded_sensor.toml", load(SCENES / "guarded_sensor.toml"), (), 1e-2),
        Machine("robot arm", "an arm of six links that overlap, four of them meshes that bound no solid; a sensor of 5 × 5 cm, 1 cm off the forearm; "
                "a hand 5 cm before it; only the reading", _robot_arm(), front, 2e-2, "estimate", True),
        Machine("robot arm, enclosed", "the same between bounds", _robot_arm(), front, 5e-2, only_readings=True),
        Machine("x_ray_arm", "geometries/scenes/x_ray_arm.toml, three of its sensors; only their readings",
                load(SCENES / "x_ray_arm.toml"), ("side left", "side right", "below head left"), 2e-2, only_readings=True),
    ]  # fmt: skip


def _before_a_housing() -> Scene:
    plate = Plate((-0.025, -0.025, 0.0), (0.05, 0.0, 0.0), (0.0, 0.05, 0.0))
    return Scene(
        sensors=(Sensor("front", (plate,)),),
        objects=(
            Object("housing", Cuboid((0.2, 0.16, 0.1)), pose=Pose((0.01, 0.005, -0.052))),
            Object("hand", Cuboid((0.09, 0.08, 0.03)), pose=Pose((0.02, 0.01, 0.065)), target=True),
        ),
        readings=(Reading("front", "front", ("front",)),),
    )


def _robot_arm() -> Scene:
    """An arm whose forearm lies along x below the sensor; wrist, upper arm, shoulder and base overlap at the joints."""
    file = LINKS / "worn.obj"
    surface, digest = read_triangles(file), hashlib.sha256(file.read_bytes()).hexdigest()

    def link(name: str, length: float, centre: Vector3, rotation: AxisRotation = AxisRotation()) -> Object:
        shape = MeshShape(str(file), digest, length, surface)
        return Object(name, shape, pose=Pose(centre, rotation))

    along_x, along_y = AxisRotation((0.0, 1.0, 0.0), 90.0), AxisRotation((1.0, 0.0, 0.0), 90.0)
    plate = Plate((-0.025, -0.025, 0.0), (0.05, 0.0, 0.0), (0.0, 0.05, 0.0))
    return Scene(
        sensors=(Sensor("front", (plate,)),),
        objects=(
            link("forearm", 0.36, (0.0, 0.0, -0.0676), along_x),
            link("wrist", 0.16, (0.2, 0.0, -0.0676)),
            link("upper arm", 0.4, (-0.16, 0.0, -0.22)),
            link("shoulder", 0.3, (-0.16, 0.05, -0.4), along_y),
            Object("turntable", Cylinder(0.09, 0.12, 32), pose=Pose((-0.16, 0.05, -0.48))),
            Object("base", Cuboid((0.24, 0.24, 0.2)), pose=Pose((-0.16, 0.05, -0.6))),
            Object("hand", Cuboid((0.09, 0.08, 0.03)), pose=Pose((0.02, 0.01, 0.065)), target=True),
        ),
        readings=(Reading("front", "front", ("front",)),),
    )


def _boxes(count: int) -> tuple[Object, ...]:
    """Boxes in rows on the plane through the bottom of the housing, which they surround."""
    places = [(x, y) for y in range(-3, 4) for x in range(-3, 4) if max(abs(x), abs(y)) > 1]
    return tuple(
        Object(
            f"box {number}",
            Cuboid((0.1, 0.08, 0.06 + 0.02 * (number % 3))),
            pose=Pose((0.16 * x, 0.14 * y, -0.102 + (0.06 + 0.02 * (number % 3)) / 2)),
        )
        for number, (x, y) in enumerate(places[:count], start=1)
    )


def answer(machine: Machine, max_seconds: float = math.inf) -> Document:
    """Encloses a machine's capacitances, in picofarad; for machines of a few bodies with plane faces boundary elements add the
    readings.

    The refinement ends before a mesh that would be done after `max_seconds`.
    """
    from fem_reference.answer import reference

    start = time.process_time()
    found = reference.maxwell(
        machine.scene,
        machine.rtol,
        max_seconds,
        source=machine.name,
        columns=machine.columns,
        error=machine.error,
        only_readings=machine.only_readings,
    )
    seconds = time.process_time() - start
    entries = [
        (f"M[{found.names[i]}, {found.names[j]}]", found.maxwell.value[i, j], found.maxwell.error[i, j], found.lower[i, j], found.upper[i, j])
        for i in range(len(found.names))
        for j in range(i, len(found.names))
    ]  # fmt: skip
    for reading in found.readings:
        for kind in KINDS:
            part = getattr(reading, kind)
            entries.append((f"{kind} of {reading.name}", part.value, part.error, part.lower, part.upper))
    document: Document = {
        "scene": identity(machine.scene),
        "rtol": machine.rtol,
        "reached": found.reached,
        "kind": found.error_kind,
        "proven": found.enclosure is not None and not found.curved and not found.wraps,
        "unknowns": [level.unknowns for level in found.levels],
        "processor_seconds": round(seconds, 1),
        "bytes_per_unknown": round(found.levels[-1].memory / found.levels[-1].unknowns),
        "stopped_by": found.stopped_by,
        "quantities": [
            {"name": name} | {key: None if v is None else v / PICOFARAD for key, v in zip(KEYS, values)}
            for name, *values in entries
        ],
    }
    bodies = len(machine.scene.sensors) + len(machine.scene.objects)
    if document["proven"] and machine.scene.room is None and bodies <= MOST_BODIES:
        document["boundary_elements"] = _boundary_elements(machine)
    return document


KINDS = ("background", "change")
"""The quantities of a reading in the table."""
KEYS = ("value", "error", "lower", "upper")
"""What is stored of every quantity, in picofarad; bounds may be absent."""


def _boundary_elements(machine: Machine) -> list[Document]:
    """The backgrounds and changes of the readings (pF) by boundary elements, each with its error."""
    loaded = model_module().Scene.loads(canonical(machine.scene))
    known = loaded.readings(method="boundary-elements", rtol=BOUNDARY_RTOL)
    return [
        {
            "name": f"{kind} of {name}",
            "value": getattr(reading, kind) / PICOFARAD,
            "error": reading.error[kind] / PICOFARAD,
        }
        for name, reading in known.items()
        for kind in KINDS
    ]


def stored() -> dict[str, Document]:
    """The answers by the names of their machines."""
    if not ANSWERS.is_file():
        return {}
    found: dict[str, Document] = json.loads(ANSWERS.read_text(encoding="utf-8"))
    return found


def page(answers: dict[str, Document]) -> str:
    """The table of the answers, in the order of the machines."""
    known = [machine for machine in machines() if machine.name in answers]
    lines = [_HEAD]
    lines += [f"* **{each.name}**: {each.caption}; asked for {each.rtol:g}." for each in known]
    lines += ["", "| machine | quantity | lower (pF) | value (pF) | upper (pF) | stated error |", "|---|---|---|---|---|---|"]  # fmt: skip
    for each in known:
        for quantity in answers[each.name]["quantities"]:
            lower, upper = (_number(quantity[key]) for key in ("lower", "upper"))
            error = abs(quantity["error"] / quantity["value"]) if quantity["value"] else 0.0
            lines.append(
                f"| {each.name} | {quantity['name']} | {lower} | {_number(quantity['value'])} | {upper} | {error:.1e} |"
            )
    lines += [
        "",
        "| machine | unknowns | processor seconds | kB per unknown | interval | as asked |",
        "|---|---|---|---|---|---|",
    ]
    for each in known:
        found = answers[each.name]
        unknowns = " + ".join(f"{count:,}" for count in found["unknowns"])
        kind = "proven" if found["proven"] else "not proven: curved or wrapped bodies"
        kind = "estimated" if found["kind"] == "estimate" else kind
        reached = "yes" if found["reached"] else f"no: {found['stopped_by']}"
        lines.append(
            f"| {each.name} | {unknowns} | {found['processor_seconds']:g} | {found['bytes_per_unknown'] / 1000:.1f} | {kind} | {reached} |"
        )
    missing = [machine.name for machine in machines() if machine.name not in answers]
    if missing:
        lines += ["", f"Not solved yet: {', '.join(missing)}."]
    return "\n".join(lines) + "\n"


_HEAD = """# Machines with enclosed capacitances

Entries of the Maxwell matrix and readings of whole machines, each between bounds (fem_reference/NUMERICS.md, sections 5 and 14). The error of a change
is an estimate; its bounds are the differences of those of the reading and of its background. `python3 -m analysis measure machines` makes this page,
and with `--scene NAME` it prints a scene. Bodies too far away to matter are left out, and the intervals account for them. The memory is the
largest that the process held, its libraries included.
"""


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.6g}"


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the machines and what may be asked of them."""
    known = [machine.name for machine in machines()]
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"machines to solve anew: {', '.join(known)}"
    )
    parser.add_argument(
        "--max-seconds", type=float, default=math.inf, help="limit for the solution of each machine"
    )
    parser.add_argument("--scene", choices=known, help="print the scene of a machine instead")


def measure(options: argparse.Namespace) -> int:
    """Solves machines and writes the files; returns the exit status."""
    known = {machine.name: machine for machine in machines()}
    if options.scene is not None:
        print(canonical(known[options.scene].scene), end="")
        return 0
    unknown = [name for name in options.names if name not in known]
    if unknown:
        raise InputError("", "", f"no machine is called {unknown[0]!r}; there are {', '.join(known)}")
    answers = stored()
    for name, machine in known.items():
        is_missing = name not in answers or answers[name]["scene"] != identity(machine.scene)
        if name in options.names or (not options.names and is_missing):
            # Each machine has a process of its own, so that the peak of its memory is its own.
            with ProcessPoolExecutor(1, get_context("spawn"), _prepare, (os.getpid(),)) as executor:
                found = executor.submit(answer, machine, options.max_seconds).result()
            # Another process may have written meanwhile.
            answers = {**stored(), name: found}
            ordered = {each: answers[each] for each in known if each in answers}
            write_text(ANSWERS, json.dumps(ordered, indent=1) + "\n")
            write_text(TABLE, page(ordered))
    return 0


def _prepare(parent: int) -> None:
    """End with the parent, and silence the form compiler, which logs through the root logger."""
    end_with(parent)
    logging.disable(logging.INFO)

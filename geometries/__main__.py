"""`python3 -m geometries`: converts meshes, writes persons, and lists the cases of a study."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from geometries.common.errors import InputError
from geometries.common.files import whole_file
from geometries.common.installation import command
from geometries.scene import meshes
from geometries.scene.person import BUILDS, POSTURES, Person, capsule_objects, capsules
from geometries.studies import study

# As everywhere in the project: 0 answered, 2 the input is wrong.
_WRONG_INPUT = 2


def main(arguments: list[str] | None = None) -> int:
    """Runs the command line; returns the exit code."""
    options = _parser(command("geometries")).parse_args(arguments)
    try:
        if options.command == "convert":
            count = meshes.convert(options.source, options.target)
            print(f"{options.target}: {count} triangles")
        elif options.command == "person":
            print(_write_person(Person(options.height, options.age, options.posture), options.target))
        else:
            print(_table(study.load(study.find(options.study))))
    except InputError as error:
        print(error, file=sys.stderr)
        return _WRONG_INPUT
    return 0


def _parser(program: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=program, description="Convert meshes, write persons, and list the cases of a study."
    )
    commands = parser.add_subparsers(dest="command", required=True)
    convert = commands.add_parser(
        "convert", help="convert a mesh of any format that meshio reads to STL, OBJ or PLY"
    )
    convert.add_argument("source", type=Path, metavar="IN")
    convert.add_argument("target", type=Path, metavar="OUT")
    person = commands.add_parser(
        "person", help="write a person as a mesh (STL, OBJ, PLY) or as the capsules of a scene (TOML)"
    )
    person.add_argument("target", type=Path, metavar="OUT")
    person.add_argument("--height", type=_height, default=1.75, metavar="M", help="in metres (default: 1.75)")
    person.add_argument("--age", choices=tuple(BUILDS), default="adult", help="default: adult")
    person.add_argument("--posture", choices=POSTURES, default="standing", help="default: standing")
    expand = commands.add_parser("expand", help="list the cases of a study")
    expand.add_argument("study", metavar="STUDY", help="a name in geometries/studies, or a file")
    return parser


def _height(text: str) -> float:
    try:
        height = float(text)
    except ValueError:
        height = 0.0
    if not 0 < height < 1e30:
        raise argparse.ArgumentTypeError(f"{text!r} is not a length greater than 0")
    return height


def _write_person(person: Person, target: Path) -> str:
    """Writes a person into a file, whole or not at all; returns what it holds."""
    if target.suffix.lower() != ".toml":
        triangles = person.triangles()
        meshes.write(triangles, target)
        return f"{target}: {len(triangles)} triangles"
    text = capsule_objects(person)
    try:
        with whole_file(target) as unfinished:
            unfinished.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(str(target), "", f"cannot be written: {error.strerror}") from error
    return f"{target}: {len(capsules(person))} capsules"


def _table(chosen: study.Study) -> str:
    cases = chosen.cases()
    lines = [f"{case.id}  {case.family:<9} {_parameters(case)}" for case in cases]
    return "\n".join([f"{chosen.title}: {len(cases)} cases, lengths in metres, angles in degrees", *lines])


def _parameters(case: study.Case) -> str:
    return "  ".join(
        f"{name}={'×'.join(map(_text, value)) if isinstance(value, tuple) else _text(value)}"
        for name, value in case.parameters.items()
    )


def _text(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


if __name__ == "__main__":
    sys.exit(main())

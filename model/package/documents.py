"""Manual pages, and completions for bash and zsh, of every command: documents.py FRINGE FOLDER.

They are made from the parsers of the commands in Python, and from what the command FRINGE prints as its help.
"""

from __future__ import annotations

import argparse
import gzip
import os
import re
import subprocess
import sys
from pathlib import Path

import shtab
from build_manpages.manpage import Manpage

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import analysis.__main__ as analysis
import fem_reference.__main__ as fem_reference
import geometries.__main__ as geometries

_FILES = {"FILE", "FILE.vtu", "IN", "INPUT", "JSON", "NEW", "OLD", "OUT", "SCENE", "STUDY"}
_FOLDERS = {"DIR", "FOLDER", "RESULTS"}
_EXIT_STATUS = (
    "0 answered; 2 the input is wrong; 3 the asked accuracy was not reached, the answer and its errors are given all the same; "
    "1 anything else."
)
_SUMMARIES = {
    "fringe": "what a capacitive proximity sensor feels, by a fast model",
    "fringe-reference": "the Maxwell capacitance matrix of a scene by finite elements",
    "fringe-analysis": "compare the model with the reference, and report",
    "fringe-geometries": "convert meshes, and list the cases of a study",
}


def main(fringe: Path, folder: Path) -> None:
    """Write all documents to the folder, which is made when missing."""
    # argparse breaks lines where a terminal would; manual pages are filled by who shows them.
    os.environ["COLUMNS"] = "10000"
    parsers = [
        parser_of(fringe),
        fem_reference._parser("fringe-reference"),
        analysis._parser("fringe-analysis"),
        geometries._parser("fringe-geometries"),
    ]
    for parser in parsers:
        name = parser.prog
        _write(folder / "man1" / f"{name}.1.gz", gzip.compress(manual(parser).encode(), mtime=0))
        complete_paths(parser)
        _write(folder / "bash" / name, shtab.complete(parser, "bash").encode())
        _write(folder / "zsh" / f"_{name}", shtab.complete(parser, "zsh").encode())


def manual(parser: argparse.ArgumentParser) -> str:
    """The manual page of a command."""
    parser.man_short_description = _SUMMARIES[parser.prog]  # type: ignore[attr-defined]
    parser._manpage = [{"heading": "exit status", "content": _EXIT_STATUS}]  # type: ignore[attr-defined]
    return str(Manpage(parser))


def complete_paths(parser: argparse.ArgumentParser) -> None:
    """Let arguments that are files or folders be completed as such."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                complete_paths(command)
        elif action.metavar in _FILES:
            action.complete = shtab.FILE  # type: ignore[attr-defined]
        elif action.metavar in _FOLDERS:
            action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]


def parser_of(fringe: Path) -> argparse.ArgumentParser:
    """A parser that takes what the C++ command takes, by its help."""
    sections = _sections(fringe)
    parser = argparse.ArgumentParser("fringe", description=sections[""][0][1])
    _add_arguments(parser, sections)
    commands = parser.add_subparsers(metavar="COMMAND")
    for name, text in sections["Subcommands"]:
        of_command = _sections(fringe, name)
        command = commands.add_parser(name, help=text, description=of_command[""][0][1])
        _add_arguments(command, of_command)
    return parser


def _sections(fringe: Path, *command: str) -> dict[str, list[tuple[str, str]]]:
    """The lines (what, text) of a help, by their headings; the description under the heading ''."""
    printed = subprocess.run([fringe, *command, "--help"], capture_output=True, text=True, check=True).stdout
    sections: dict[str, list[tuple[str, str]]] = {"": [("", printed.splitlines()[0])]}
    heading = ""
    # The text of a long option stands on the next line.
    for line in re.sub(r"(?m)^( {2}-\S.*\S)\n {20,}", r"\1  ", printed).splitlines()[1:]:
        if found := re.fullmatch(r"(\w+):", line):
            heading = found[1]
        elif found := re.fullmatch(r" {2}(\S.*?) {2,}(\S.*)", line):
            sections.setdefault(heading, []).append((found[1], found[2]))
    return sections


def _add_arguments(parser: argparse.ArgumentParser, sections: dict[str, list[tuple[str, str]]]) -> None:
    for what, text in sections.get("Positionals", []):
        parser.add_argument(what.split()[0], help=text.replace("%", "%%"), metavar=what.split()[0])
    for what, text in sections["Options"]:
        names, _, value = what.partition(" ")
        if "--help" in names:
            continue
        if value:
            kind, _, default = value.partition("=")
            told = f"{text} (default: {default})" if default else text
            parser.add_argument(*names.split(","), metavar=kind.split()[0], help=told.replace("%", "%%"))
        else:
            parser.add_argument(*names.split(","), action="store_true", help=text.replace("%", "%%"))


def _write(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))

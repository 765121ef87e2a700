"""`python3 -m tests.bad_input.corpus FOLDER`: every scene that is wrong or unusual, each in a folder of its own.

The tests make the same cases; nothing of them is kept in the repository. `--long` adds those of gigabytes.
"""

import argparse
from pathlib import Path

from tests.bad_input import keys, meshes, places, texts
from tests.bad_input.case import Case


def cases() -> list[Case]:
    """All of them, under names that are unique."""
    made = [*texts.cases(), *keys.cases(), *keys.numbers(), *meshes.cases(), *places.cases()]
    names = [case.name for case in made]
    assert len(set(names)) == len(names), sorted(name for name in names if names.count(name) > 1)
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--long", action="store_true", help="also those of gigabytes")
    options = parser.parse_args()
    for number, case in enumerate(cases()):
        if case.long and not options.long:
            continue
        folder = options.folder / f"{number:04}"
        folder.mkdir(parents=True)
        print(f"{folder.name}  {'legal' if case.place is None else 'wrong'}  {case.name}")
        case.make(folder)


if __name__ == "__main__":
    main()

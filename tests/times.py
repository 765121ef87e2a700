"""Tells where the time of a check went: the seconds of its steps, and its slowest tests.

    python3 -m tests.times FOLDER

FOLDER is the one in which `check` keeps `steps.tsv` (seconds, tab, name) and the JUnit files of ctest and pytest.
"""

import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

SHOWN = 40


def steps(folder: Path) -> list[tuple[float, str]]:
    """Returns the seconds and the name of every step that ended, in their order."""
    file = folder / "steps.tsv"
    lines = file.read_text(encoding="utf-8").splitlines() if file.is_file() else []
    return [(float(seconds), name) for seconds, name in (line.split("\t") for line in lines)]


def slowest(folder: Path, count: int) -> list[tuple[float, str]]:
    """Returns the seconds and the names of the slowest tests, the slowest first; files that a killed step left unfinished tell nothing."""
    found = []
    for file in sorted(folder.glob("*.xml")):
        try:
            cases = ElementTree.parse(file).getroot().iter("testcase")
        except ElementTree.ParseError:
            continue
        for case in cases:
            place, name = case.get("classname") or "", case.get("name") or ""
            # CTest gives the name twice.
            label = name if place in ("", name) else f"{place}.{name}"
            found.append((float(case.get("time") or 0), f"{file.stem}: {label}"))
    return sorted(found, reverse=True)[:count]


def text(folder: Path) -> str:
    """Returns both tables, as `check` prints them."""
    ended, tests = steps(folder), slowest(folder, SHOWN)
    lines = ["", "Seconds of each step"]
    lines += [f"{seconds:8.0f}  {name}" for seconds, name in ended]
    lines += [f"{sum(seconds for seconds, _ in ended):8.0f}  together"]
    if tests:
        lines += ["", f"Seconds of the {len(tests)} slowest tests"]
        lines += [f"{seconds:8.1f}  {name}" for seconds, name in tests]
    return "\n".join(lines)


if __name__ == "__main__":
    print(text(Path(sys.argv[1])))

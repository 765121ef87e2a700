"""The live page beside a study's results, to which their report links; `python3 -m analysis live` makes it."""

from __future__ import annotations

from pathlib import Path

FOLDER = "live"
"""The folder of live pages in the results."""
DEFAULT = "sensor_head"
"""The machine of which ./run makes a page, a name in geometries/scenes."""
TITLE = "What do the sensors read while a hand is dragged?"
SAYS = (
    "A machine in 3-D on which the hand can be moved: in every frame the model, its correction and the reduced method with its error, "
    "computed in the page."
)


def beside(results: Path) -> str | None:
    """Returns the page's file as seen from the folder of a study's results; None where it was not made."""
    file = Path(FOLDER) / f"{DEFAULT}.html"
    return f"../{file.as_posix()}" if (results.resolve().parent / file).is_file() else None

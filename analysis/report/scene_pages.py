"""The pages of scenes beside a study's results, to which their report links; `python3 -m analysis live` and `show` make them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class ScenePage:
    """A page that ./run makes of a scene; `scene` is a name in geometries/scenes, `folder` one in the results."""

    folder: str
    scene: str
    title: str
    says: str

    def beside(self, results: Path) -> str | None:
        """Returns the page's file as seen from the folder of a study's results; None where it was not made."""
        file = Path(self.folder) / f"{self.scene}.html"
        return f"../{file.as_posix()}" if (results.resolve().parent / file).is_file() else None


LIVE = ScenePage(
    "live",
    "sensor_head",
    "What do the sensors read while a hand is dragged?",
    "A machine in 3-D on which the hand can be moved: in every frame the model, the formula and the reduced method with its error, "
    "computed in the page.",
)
MOTION = ScenePage(
    "show",
    "position_sensor",
    "What do the sensors read along a motion?",
    "A block slides over five electrodes, as a film: the model, the formula and the reduced method in every frame, boundary elements "
    "in some, over time.",
)


def all_beside(results: Path) -> list[tuple[ScenePage, str]]:
    """Returns the pages that were made, with their files as seen from the folder of a study's results."""
    found = [(page, page.beside(results)) for page in (LIVE, MOTION)]
    return [(page, file) for page, file in found if file is not None]

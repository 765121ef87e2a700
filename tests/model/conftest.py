"""Where the tests of the model find what the build made."""

import sys

import pytest

from tests import scenes
from tests.programs import ROOT

sys.path.insert(0, str(ROOT / "build" / "python"))


@pytest.fixture(scope="session")
def sensor_before_a_housing() -> str:
    """A scene whose grounded box nearly takes up the charge of the sensor before it, as seen from afar."""
    return scenes.SENSOR + scenes.body("housing", "cuboid", size=[0.2, 0.2, 0.1], translation=[0, 0, -0.06])

"""The canonical text: one text for each scene, which loads to the same scene; its hash is the scene's identity."""

from __future__ import annotations

import pytest
import tomli_w

from geometries.scene import reader, writer
from geometries.scene.scene import Scene
from geometries.studies import families
from tests.geometries.schemas import WHOLE


def scenes() -> list[Scene]:
    tilted = families.corner((0.073, 0.119), (0.1, 0.1), (0.01, 0.02), 0.003, 17.2, 33.0)
    return [reader.loads(tomli_w.dumps(WHOLE)), families.parallel((0.1, 0.1), (0.2, 0.2), 0.0137), tilted]


@pytest.mark.parametrize("scene", scenes(), ids=["full", "parallel", "corner"])
def test_the_canonical_text_loads_to_an_equal_scene_and_is_its_own_canonical_text(scene: Scene) -> None:
    text = writer.canonical(scene)
    again = reader.loads(text)
    assert again == scene
    assert writer.canonical(again) == text


def test_order_of_keys_integers_defaults_and_the_sign_of_zero_do_not_change_the_identity() -> None:
    plain = (
        '[[sensor]]\nname = "s"\nplates = [{ corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] }]'
    )
    wordy = """
        [medium]
        relative_permittivity = 1.0
        [[sensor]]
        plates = [{ edge_v = [0.0, 1.0, -0.0], corner = [0.0, -0.0, 0.0], edge_u = [1e0, 0, 0] }]
        coupling_capacitance = 5e-12
        input_voltage = 2.5
        name = "s"
    """
    assert writer.identity(reader.loads(plain)) == writer.identity(reader.loads(wordy))


def test_the_last_bit_of_a_number_changes_the_identity() -> None:
    ids = {writer.identity(families.parallel((0.1, 0.1), (0.1, 0.1), gap)) for gap in (0.3, 0.1 + 0.2)}
    assert len(ids) == 2

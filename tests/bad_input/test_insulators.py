"""Wrong insulators: boundary elements, the model and the field solver refuse them, naming the bodies and the reason."""

from __future__ import annotations

import pytest

from analysis.pipeline.model_stage import model_module
from fem_reference.bodies.conductors import conductors
from geometries.common.errors import InputError
from geometries.scene.reader import loads

SENSOR = """
[[sensor]]
name = "front"
plates = [{ corner = [-0.05, -0.05, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] }]
"""
HAND = """
[[object]]
name = "hand"
shape = { type = "cuboid", size = [0.1, 0.1, 0.03] }
translation = [0, 0, 0.025]
"""


def glass(name: str, x: float, permittivity: float = 4) -> str:
    return f"""
[[object]]
name = "{name}"
shape = {{ type = "cuboid", size = [0.02, 0.02, 0.01] }}
translation = [{x}, 0, 0.025]
material = {{ relative_permittivity = {permittivity} }}
"""


def cover(thickness: float, permittivity: float = 3) -> str:
    return f"cover = {{ thickness = {thickness}, relative_permittivity = {permittivity} }}\n"


WRONG = {
    "a cover thicker than the gap": (SENSOR + cover(0.012) + HAND, ("front cover", "hand")),
    "a cover of less than empty space": (SENSOR + cover(0.002, 0.5) + HAND, ("front", "at least 1")),
    "an insulator inside a conductor": (SENSOR + HAND + glass("core", 0), ("core", "inside")),
    "a permittivity of zero": (SENSOR + HAND + glass("glass", 0.1, 0), ("glass", "relative_permittivity")),
}


@pytest.mark.parametrize("text,told", WRONG.values(), ids=WRONG)
def test_both_references_refuse_it(text: str, told: tuple[str, ...]) -> None:
    with pytest.raises(InputError) as by_field:
        conductors(loads(text))
    with pytest.raises(ValueError) as by_boundary_elements:
        model_module().Scene.loads(text).maxwell(rtol=0.1)
    for refusal in (by_field, by_boundary_elements):
        assert all(word in str(refusal.value) for word in told)


@pytest.mark.parametrize("method", ["exact", "formula", "auto"])
def test_the_model_refuses_a_cover_thicker_than_the_gap(method: str) -> None:
    with pytest.raises(ValueError, match='"front cover" and object "hand".*thicker than the gap'):
        model_module().Scene.loads(SENSOR + cover(0.012) + HAND).capacitance(method)


def test_the_reduced_method_refuses_what_touches_several_conductors() -> None:
    text = (
        SENSOR + HAND + glass("pad", 0).replace("translation = [0, 0, 0.025]", "translation = [0, 0, 0.005]")
    )
    with pytest.raises(
        ValueError, match='"pad" touches sensor "front" .* and object "hand".*boundary-elements'
    ):
        model_module().Scene.loads(text).capacitance(method="reduced", entries=True)


def test_dielectric_bodies_may_overlap() -> None:
    text = SENSOR + HAND + glass("glass", 0.1) + glass("wood", 0.11)
    assert [body.name for body in conductors(loads(text)).dielectrics] == ["glass", "wood"]
    assert model_module().Scene.loads(text).maxwell(rtol=0.2)["maxwell"][0, 0] > 0

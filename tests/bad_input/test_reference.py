"""The field reference and scenes that cannot be read, or that can be read and have no capacitance: status 2, one line, nothing
written; and insulators that it and boundary elements refuse, naming the bodies and the reason."""

from pathlib import Path

import pytest

from analysis.pipeline.model_stage import model_module
from fem_reference.__main__ import main
from fem_reference.bodies.conductors import conductors
from geometries.common.errors import InputError
from geometries.scene.reader import loads
from tests import scenes
from tests.bad_input import meshes, places, texts
from tests.bad_input.case import Case
from tests.programs import in_this_process
from tests.scenes import SENSOR

UNSOLVABLE = [case for case in meshes.cases() if case.unsolvable]
# It reads with the reader that test_scenes.py tries on all cases.
UNREADABLE = [
    case
    for case in [*texts.cases(), *places.cases()]
    if case.name in ("malformed: prose", "a line's end in a wrong object's name", "the scene is a pipe")
]
# A closed surface around these would be none around a body.
UNWRAPPABLE = [
    case
    for case in UNSOLVABLE
    if case.name.endswith(("on one line", "of a point", "denormal size", "huge size"))
]


EXACT = ["--geometry", "exact"]


@pytest.mark.parametrize(
    ("case", "options"),
    [*((case, []) for case in UNREADABLE + UNWRAPPABLE), *((case, EXACT) for case in UNSOLVABLE)],
    ids=lambda value: value.name if isinstance(value, Case) else " ".join(value),
)
def test_a_scene_that_cannot_be_solved(tmp_path: Path, case: Case, options: list[str]) -> None:
    """A mesh that bounds no solid cannot unless it may be wrapped."""
    scene = case.make(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    done = in_this_process(main, scene, "--json", *options)
    assert (done.returncode, done.stdout) == (2, "")
    errors = done.stderr
    # Remarks on a scene precede its refusal.
    while errors.startswith("fem_reference: remark: "):
        errors = errors[errors.index("\n") + 1 :]
    assert errors.startswith("fem_reference: ") and errors.endswith("\n") and errors[:-1].isprintable()
    assert str(scene)[:200] in errors and (case.place or case.unsolvable or "") in errors
    assert sorted(tmp_path.rglob("*")) == before


HAND = scenes.body("hand", "cuboid", size=[0.1, 0.1, 0.03], translation=[0, 0, 0.025])


def glass(name: str, x: float, z: float = 0.025, permittivity: float = 4) -> str:
    material = {"relative_permittivity": permittivity}
    return scenes.body(name, "cuboid", size=[0.02, 0.02, 0.01], translation=[x, 0, z], material=material)


def cover(thickness: float, permittivity: float = 3) -> str:
    return f"cover = {{ thickness = {thickness}, relative_permittivity = {permittivity} }}\n"


WRONG = {
    "a cover thicker than the gap": (SENSOR + cover(0.012) + HAND, ("front cover", "hand")),
    "a cover of less than empty space": (SENSOR + cover(0.002, 0.5) + HAND, ("front", "at least 1")),
    "an insulator inside a conductor": (SENSOR + HAND + glass("core", 0), ("core", "inside")),
    "a permittivity of zero": (
        SENSOR + HAND + glass("glass", 0.1, permittivity=0),
        ("glass", "relative_permittivity"),
    ),
}


@pytest.mark.parametrize("text,told", WRONG.values(), ids=WRONG)
def test_both_references_refuse_it(text: str, told: tuple[str, ...]) -> None:
    with pytest.raises(InputError) as by_field:
        conductors(loads(text))
    with pytest.raises(ValueError) as by_boundary_elements:
        model_module().Scene.loads(text).maxwell(rtol=0.1)
    for refusal in (by_field, by_boundary_elements):
        assert all(word in str(refusal.value) for word in told)


def test_dielectric_bodies_may_overlap() -> None:
    text = SENSOR + HAND + glass("glass", 0.1) + glass("wood", 0.11)
    assert [body.name for body in conductors(loads(text)).dielectrics] == ["glass", "wood"]
    assert model_module().Scene.loads(text).maxwell(rtol=0.2)["maxwell"][0, 0] > 0

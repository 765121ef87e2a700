"""What conductors, targets and readings may not be; tests/end_to_end compares the words with those of the other reader."""

from __future__ import annotations

import pytest

from geometries.common.errors import InputError
from geometries.scene import reader

FLOATING = 'potential = "floating"\nconductor = "c"\n'
ELECTRODE = 'potential = "electrode"\n'


def sensor(name: str, keys: str = "") -> str:
    plate = "{ corner = [0, 0, 0], edge_u = [0.1, 0, 0], edge_v = [0, 0.1, 0] }"
    return f'[[sensor]]\nname = "{name}"\nplates = [{plate}]\n{keys}\n'


def body(name: str, keys: str = "") -> str:
    return f'[[object]]\nname = "{name}"\nshape = {{ type = "cube", size = 0.1 }}\n{keys}\n'


def reading(keys: str) -> str:
    return f'[[reading]]\nname = "r"\n{keys}\n'


def measured(sense: str, *drive: str) -> str:
    return reading(f'sense = "{sense}"\ndrive = {list(drive)}')


def refused(text: str) -> tuple[str, str]:
    """The key and the reason of the refusal."""
    with pytest.raises(InputError) as caught:
        reader.loads(text)
    return caught.value.key, caught.value.reason


@pytest.mark.parametrize("value", ["0", "-1e-12"])
def test_a_capacitance_to_ground_is_positive(value: str) -> None:
    key, reason = refused(body("o", f'potential = "floating"\nto_ground = {value}'))
    assert key == 'object "o": to_ground'
    assert "greater than 0" in reason


@pytest.mark.parametrize("potential", ["grounded", "electrode"])
def test_only_floating_objects_have_a_capacitance_to_ground(potential: str) -> None:
    assert refused(body("o", f'potential = "{potential}"\nto_ground = 1e-10')) == (
        'object "o": to_ground',
        f"is a key of floating objects, and this one is {potential}",
    )


def test_a_conductor_has_one_capacitance_to_ground() -> None:
    assert refused(body("o", FLOATING + "to_ground = 1e-10") + body("p", FLOATING)) == (
        'object "p": to_ground',
        'one conductor has one capacitance to ground, but "o" and "p" differ',
    )


def test_an_electrode_is_no_target() -> None:
    assert refused(body("o", ELECTRODE + "target = true")) == (
        'object "o": target',
        "an electrode cannot be a target",
    )


def test_a_target_carries_no_sensor() -> None:
    arm = '[[link]]\nname = "arm"\n' + sensor("s", 'link = "arm"')
    assert refused(arm + body("o", 'link = "arm"\ntarget = true')) == (
        'object "o": target',
        'a target cannot carry a sensor, but its link carries "s"',
    )
    assert reader.loads(arm + body("o", "target = true")).objects[0].target


@pytest.mark.parametrize(("first", "second"), [("o", "p"), ("p", "o")])
def test_a_floating_conductor_is_a_target_as_a_whole(first: str, second: str) -> None:
    marks = {first: "target = true", second: ""}
    assert refused("".join(body(name, FLOATING + marks[name]) for name in ("o", "p"))) == (
        'object "p": target',
        f'all objects of a floating conductor are targets or none is, but "{first}" is and "{second}" is not',
    )


def test_a_part_of_a_grounded_conductor_may_be_a_target() -> None:
    scene = reader.loads(body("o", 'conductor = "c"\ntarget = true') + body("p", 'conductor = "c"'))
    assert [part.target for part in scene.objects] == [True, False]


@pytest.mark.parametrize(
    ("keys", "key", "reason"),
    [
        ('drive = ["s"]', "sense", "is missing"),
        ('sense = "s"', "drive", "is missing"),
        ('sense = "s"\ndrive = []', "drive", "must not be empty"),
        ('sense = "s"\ndrive = "s"', "drive", "must be a list of strings"),
        ('sense = "s"\ndrive = [1]', "drive", "must be a list of strings"),
        ('sense = "s"\ndrive = ["s", "s"]', "drive", '"s" is named twice'),
        ('sense = "s"\ndrive = ["s"]\nnoise = 0', "noise", "must be greater than 0, not 0.0"),
        ('sense = "s"\ndrive = ["s"]\nthreshold = -1', "threshold", "must be greater than 0, not -1.0"),
        (
            'sense = "s"\ndrive = ["s"]\ncolour = 1',
            "colour",
            "unknown key; there are drive, name, noise, sense, threshold",
        ),
    ],
)
def test_a_reading_senses_one_and_drives_some(keys: str, key: str, reason: str) -> None:
    assert refused(sensor("s") + reading(keys)) == (f'reading "r": {key}', reason)


def test_readings_have_names_of_their_own() -> None:
    one = measured("s", "s")
    assert refused(sensor("s") + one + one) == ('reading "r": name', "is already used")
    assert reader.loads(sensor("s") + one.replace('"r"', '"s"')).readings[0].name == "s"


def test_a_reading_senses_and_drives_sensors_and_electrodes_by_their_conductor() -> None:
    machine = (
        sensor("s") + body("left", ELECTRODE + 'conductor = "bars"') + body("hand", 'potential = "floating"')
    )
    assert reader.loads(machine + measured("bars", "s", "bars")).readings[0].drive == ("s", "bars")
    for name in ("left", "hand", "nobody", ""):
        reason = f'"{name}" is neither a sensor nor the conductor of an electrode; the scene has "s", "bars"'
        assert refused(machine + measured("s", name)) == ('reading "r": drive', reason)


def test_the_message_lists_ten_names_at_most() -> None:
    names = [str(number) for number in range(12)]
    reason = refused("".join(map(sensor, names)) + measured("x", "0"))[1]
    assert reason.endswith('; the scene has "0", "1", "2", "3", "4", "5", "6", "7", "8", "9" and 2 more')
    assert refused(body("o") + measured("o", "o"))[1].endswith("; the scene has none")

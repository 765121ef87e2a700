"""Study files and their page, geometries/STUDY.md: expansion into cases, their identities, the studies that come with the project, and what is refused."""

import inspect
import re
from collections import Counter
from pathlib import Path

import pytest

from geometries.__main__ import main
from geometries.common.errors import InputError
from geometries.scene import reader
from geometries.studies import families, schema, study
from geometries.studies.machines import MACHINES
from tests import scenes
from tests.scenes import HEAD
from tests.programs import in_this_process

SWEEP = scenes.sweep("parallel", gap=0.02)
SCENE = scenes.table("sweep", family="scene", file="arm.toml")
EDGE = SWEEP.replace("parallel", "edge") + "height = 0\n"


def expand(*sweeps: str) -> list[study.Case]:
    return study.loads(HEAD + "".join(sweeps)).cases()


def values(cases: list[study.Case], name: str) -> list[study.Parameter]:
    return [case.parameters[name] for case in cases if case.family != study.EMPTY]


def test_a_sweep_without_lists_is_one_case_and_its_empty_scene() -> None:
    case, alone = expand(SWEEP)
    assert case.scene == families.parallel((0.1, 0.1), (0.1, 0.1), 0.02)
    assert case.parameters == {
        "sensor_size": (0.1, 0.1),
        "target_size": (0.1, 0.1),
        "gap": 0.02,
        "offset": (0.0, 0.0),
        "material": "grounded",
        "to_ground": 0.0,
        "machine": "none",
    }
    assert (alone.family, alone.parameters) == ("empty", {"sensor_size": (0.1, 0.1)})
    assert alone.scene == families.empty((0.1, 0.1))


def test_lists_are_swept_as_a_product_by_default() -> None:
    cases = expand(
        SWEEP.replace("0.02", "[0.01, 0.02]").replace(
            "target_size = [0.1, 0.1]", "target_size = [[1, 1], [2, 2]]"
        )
    )
    assert list(zip(values(cases, "target_size"), values(cases, "gap"))) == [
        ((1, 1), 0.01),
        ((1, 1), 0.02),
        ((2, 2), 0.01),
        ((2, 2), 0.02),
    ]


def test_zip_walks_through_the_lists_together() -> None:
    cases = expand(
        EDGE.replace("0.02", "[0.01, 0.02]").replace("height = 0", "height = [0.3, 0.4]") + 'combine = "zip"'
    )
    assert list(zip(values(cases, "gap"), values(cases, "height"))) == [(0.01, 0.3), (0.02, 0.4)]


def test_errors_are_estimated_unless_enclosures_are_asked_for() -> None:
    assert study.loads(HEAD + SWEEP).error == "estimate"
    asked = HEAD.replace("max_seconds = 60", 'max_seconds = 60\nerror = "enclosure"')
    assert study.loads(asked + SWEEP).error == "enclosure"
    with pytest.raises(InputError, match="reference.error.*estimate, enclosure.*guess"):
        study.loads(asked.replace("enclosure", "guess") + SWEEP)


def test_both_methods_are_the_reference_unless_one_is_asked_for() -> None:
    usual = study.loads(HEAD + SWEEP)
    assert (usual.reference_method, usual.by_field, usual.by_boundary_elements) == ("both", True, True)
    field = study.loads(HEAD.replace("[reference]", '[reference]\nmethod = "field"') + SWEEP)
    assert (field.by_field, field.by_boundary_elements) == (True, False)
    with pytest.raises(InputError, match="reference.method.*field, boundary-elements, both.*'bem'"):
        study.loads(HEAD.replace("[reference]", '[reference]\nmethod = "bem"') + SWEEP)


def test_boundary_elements_alone_need_no_limit_of_time_and_prove_no_intervals() -> None:
    alone = HEAD.replace("[reference]", '[reference]\nmethod = "boundary-elements"')
    untimed = study.loads(alone.replace("max_seconds = 60\n", "") + SWEEP)
    assert (untimed.by_field, untimed.by_boundary_elements) == (False, True)
    with pytest.raises(InputError, match="reference.error.*prove no intervals"):
        study.loads(alone.replace("max_seconds = 60", 'error = "enclosure"') + SWEEP)
    with pytest.raises(InputError, match="reference.max_seconds.*missing"):
        study.loads(HEAD.replace("max_seconds = 60\n", "") + SWEEP)


ALONE = 'reference = { method = "boundary-elements", rtol = 3e-2 }\n'


def test_boundary_elements_may_be_the_only_reference_of_a_sweep() -> None:
    other = SWEEP.replace("gap = 0.02", "gap = [0.02, 0.03]") + ALONE
    read = study.loads(HEAD + SWEEP + other)
    assert [case.alone for case in read.sweeps] == [None, 3e-2, 3e-2]
    # What another sweep asks of both stays asked of both, and so does the sensor alone, which they share.
    assert [case.alone for case in read.cases()] == [None, 3e-2, None]
    assert [case.alone for case in study.loads(HEAD + other).cases()] == [3e-2] * 3
    for wrong, key in (("boundary-elements", "method"), ("rtol = 3e-2", "rtol")):
        with pytest.raises(InputError, match=f"sweep.*reference.{key}"):
            study.loads(HEAD + SWEEP + ALONE.replace(wrong, "field" if key == "method" else "rtol = 2"))
    with pytest.raises(InputError, match="reference: the study does not ask boundary elements"):
        study.loads(HEAD.replace("[reference]", '[reference]\nmethod = "field"') + SWEEP + ALONE)


def test_without_a_reference_nothing_is_asked_of_it() -> None:
    alone = HEAD.replace("rtol = 1e-3\n", "").replace("max_seconds = 60", 'error = "none"')
    assert alone != HEAD and study.loads(alone + SWEEP).error == "none"
    with pytest.raises(InputError, match="reference.rtol.*missing"):
        study.loads(alone.replace('"none"', '"estimate"') + SWEEP)


def test_an_experiment_is_one_of_the_thesis() -> None:
    assert study.loads(HEAD + SWEEP).experiment == ""
    assert study.loads('experiment = "III"\n' + HEAD + SWEEP).experiment == "III"
    with pytest.raises(InputError, match="experiment.*I, II, III, IV, V, VI.*'7'"):
        study.loads('experiment = "7"\n' + HEAD + SWEEP)


BOX = scenes.sweep("box", thickness=0.04, gap=0.02)


def test_a_text_is_a_parameter_like_any_other() -> None:
    assert values(expand(BOX), "material") == ["grounded"]
    assert values(expand(BOX + 'material = ["floating", "grounded"]'), "material") == ["floating", "grounded"]
    for wrong in ('"wet"', "3", "[]", "{ linspace = [1, 2, 3] }"):
        with pytest.raises(InputError, match="material"):
            expand(BOX + f"material = {wrong}")


def test_two_sensors_are_compared_with_both_of_them_alone() -> None:
    two = SWEEP.replace("parallel", "sensors") + "separation = 0.01\n"
    case, alone = expand(two)
    assert [sensor.name for sensor in alone.scene.sensors] == ["sensor", "neighbour"]
    assert alone.scene.sensors == case.scene.sensors and not alone.scene.objects


def test_ranges() -> None:
    linear = values(expand(SWEEP.replace("0.02", "{ linspace = [0.01, 0.03, 3] }")), "gap")
    assert linear == pytest.approx([0.01, 0.02, 0.03])
    geometric = values(expand(SWEEP.replace("0.02", "{ geomspace = [0.01, 0.04, 3] }")), "gap")
    assert geometric == pytest.approx([0.01, 0.02, 0.04])


def test_the_same_scene_is_one_case_and_keeps_the_first_place() -> None:
    cases = expand(SWEEP, EDGE, SWEEP)
    assert [case.family for case in cases] == ["parallel", "edge", "empty"]


def test_each_distinct_sensor_gets_one_empty_scene() -> None:
    sensors = SWEEP.replace("sensor_size = [0.1, 0.1]", "sensor_size = [[0.1, 0.1], [0.04, 0.04]]")
    assert Counter(case.family for case in expand(sensors, EDGE)) == {"parallel": 2, "edge": 1, "empty": 2}


def test_a_changed_parameter_of_one_family_changes_only_its_own_identities() -> None:
    before = {case.id for case in expand(SWEEP, EDGE)}
    after = {case.id for case in expand(SWEEP.replace("0.02", "0.03"), EDGE)}
    assert len(before & after) == 2 and len(before - after) == 1


ARM = (
    scenes.link("arm")
    + scenes.sensor("front", [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]], link="arm")
    + scenes.body("target", "cube", size=0.1, translation=[0, 0, 0.2])
)
MOTION = scenes.table(
    "frame", name="far", poses=[{"link": "arm", "translation": [0, 0, -0.1]}]
) + scenes.table(
    "frame", name="turned", poses=[{"link": "arm", "rotation": {"axis": [0, 0, 1], "degrees": 30}}]
)


def scene_study(folder: Path, sweep: str = SCENE, scene: str = ARM) -> study.Study:
    (folder / "arm.toml").write_text(scene)
    (folder / "arm.motion.toml").write_text(MOTION)
    (folder / "study.toml").write_text(HEAD + sweep)
    return study.load(folder / "study.toml")


def test_a_scene_of_ones_own_is_a_case_as_it_stands(tmp_path: Path) -> None:
    (case,) = scene_study(tmp_path).sweeps
    assert case.family == "scene" and case.parameters == {"scene": "arm", "frame": "1 as in the scene"}
    assert [body.name for body in case.scene.objects] == ["target"]


def test_a_motion_makes_a_case_of_every_frame_and_one_of_the_sensor_alone(tmp_path: Path) -> None:
    cases = scene_study(tmp_path, SCENE + 'motion = "arm.motion.toml"').cases()
    assert [case.parameters.get("frame") for case in cases] == ["1 far", "2 turned", None]
    assert cases[1].scene.pose_of_object("target")[1][2] == 0.2
    assert cases[1].scene.links[0].pose.translation == (0, 0, -0.1)
    assert not cases[2].scene.objects and not cases[2].scene.links


def test_the_sensors_alone_have_no_reading_of_the_electrodes_that_were_there(tmp_path: Path) -> None:
    guard = scenes.body("guard", "cube", size=0.1, potential="electrode")
    reading = scenes.table("reading", name="guarded", sense="front", drive=["front", "guard"])
    with_guard, alone = scene_study(tmp_path, scene=ARM + guard + reading).cases()
    assert reader.loads(with_guard.text).readings and not reader.loads(alone.text).readings


def test_sensors_of_two_links_alone_are_a_case_for_every_pose(tmp_path: Path) -> None:
    second = scenes.sensor("fixed", [[0.5, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])
    found = scene_study(tmp_path, SCENE + 'motion = "arm.motion.toml"', ARM + second).cases()
    assert sum(case.family == study.EMPTY for case in found) == 2


def test_a_scene_without_a_sensor_is_no_case(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no sensor"):
        scene_study(tmp_path, scene=scenes.body("target", "cube", size=0.1))


def test_what_is_wrong_in_a_studys_scene_is_told_with_its_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="arm.toml.*size"):
        scene_study(tmp_path, scene=ARM.replace("size = 0.1", "size = -1"))


@pytest.mark.parametrize(
    ("text", "key", "reason"),
    [
        (HEAD, "sweep", "at least one sweep"),
        (SWEEP, "reference", "is missing"),
        ("colour = 1" + HEAD + SWEEP, "colour", "unknown key"),
        ("solver = 1\n" + SWEEP, "solver", "unknown key; there are format, name, title, experiment, reference"),
        (HEAD.replace("rtol", "accuracy") + SWEEP, "reference.accuracy", "there are method, rtol"),
        (HEAD.replace('"synthetic"', '"../n"') + SWEEP, "name", "must not contain a path"),
        (HEAD.replace("1e-3", "0") + SWEEP, "reference.rtol", "greater than 0"),
        (HEAD.replace("1e-3", "2") + SWEEP, "reference.rtol", "a relative accuracy, less than 1"),
        (HEAD.replace('"exact", ', "") + SWEEP, "model.methods", '"exact"'),
        (HEAD.replace('"exact"', "3") + SWEEP, "model.methods", "list of strings"),
        (HEAD.replace('"split:4"', '"kirchhoff"') + SWEEP, "model.methods", "reduced"),
        (HEAD + SCENE, "sweep[0].file", "is not a file"),
        (HEAD + SWEEP.replace("parallel", "paralel"), "sweep[0].family", "unknown family"),
        (HEAD + SWEEP.replace("gap = 0.02", ""), "sweep[0].gap", "is missing"),
        (HEAD + SWEEP.replace("gap", "hinge_gap"), "sweep[0].hinge_gap", "unknown key"),
        (HEAD + SWEEP + "tilt_degrees = 3", "sweep[0].tilt_degrees", "unknown key"),
        (HEAD + SWEEP.replace("0.02", '"2 cm"'), "sweep[0].gap", "must be a number"),
        (HEAD + SWEEP.replace("0.02", "[]"), "sweep[0].gap", "at least one value"),
        (HEAD + SWEEP.replace("0.02", "[0.02, nan]"), "sweep[0].gap", "must be finite"),
        (HEAD + SWEEP.replace("0.02", "-0.02"), "sweep[0].gap", "greater than 0"),
        (HEAD + SWEEP.replace("0.02", "{ logspace = [1, 2, 3] }"), "sweep[0].gap", "a range is"),
        (HEAD + SWEEP.replace("0.02", "{ geomspace = [0, 1, 3] }"), "sweep[0].gap.geomspace", "ends greater"),
        (HEAD + SWEEP.replace("0.02", "{ linspace = [0, 1, 1.5] }"), "sweep[0].gap.linspace", "integer number"),
        (HEAD + SWEEP.replace("[0.1, 0.1]", "0.1"), "sweep[0].sensor_size", "list of 2 numbers"),
        (HEAD + SWEEP + 'combine = "sum"', "sweep[0].combine", "product or zip"),
        (
            HEAD
            + EDGE.replace("0.02", "[1, 2]").replace("height = 0", "height = [1, 2, 3]")
            + 'combine = "zip"',
            "sweep[0].combine",
            "lists of equal length",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_expanded_is_refused_by_key_and_reason(text: str, key: str, reason: str) -> None:
    with pytest.raises(InputError) as caught:
        study.loads(text, source="study.toml")
    assert (caught.value.file, caught.value.key) == ("study.toml", key)
    assert reason in caught.value.reason


def test_the_default_study_has_at_least_eight_cases_of_every_family() -> None:
    cases = study.load(study.find("default")).cases()
    count = Counter(case.family for case in cases)
    assert all(count[family] >= 8 for family in ("parallel", "inclined", "edge", "corner", "straddle"))
    assert count[study.EMPTY] <= 5


def test_the_default_study_has_every_machine_and_the_same_set_ups_without_one() -> None:
    cases = [case for case in study.load(study.find("default")).sweeps if case.family == "parallel"]
    by_machine: dict[object, set[object]] = {}
    for case in cases:
        others = {name: value for name, value in case.parameters.items() if name != "machine"}
        by_machine.setdefault(case.parameters["machine"], set()).add(tuple(others.items()))
    assert set(by_machine) == set(MACHINES)
    assert all(len(own) >= 2 and own <= by_machine["none"] for own in by_machine.values())


def test_a_study_is_found_by_name_or_by_path(tmp_path: Path) -> None:
    assert study.find("smoke").stem == "smoke"
    own = tmp_path / "own.toml"
    own.write_text(HEAD + SWEEP)
    assert study.find(str(own)) == own
    with pytest.raises(InputError, match="one of the known studies: default, .*nightly, .*smoke"):
        study.find("missing")


def test_expand_lists_the_cases() -> None:
    printed = in_this_process(main, "expand", "smoke").stdout
    assert "3 cases" in printed and "gap=0.05" in printed
    assert "material=floating" in in_this_process(main, "expand", "experiment_6").stdout
    assert main(["expand", "missing"]) == 2


PAGE = (Path(study.__file__).parents[1] / "STUDY.md").read_text(encoding="utf-8")
REQUIRED = "must be given"


def table_after(heading: str, first: str) -> list[list[str]]:
    """The rows of the first table after a heading whose first column has this title."""
    text = PAGE.split(f"{heading}\n", 1)[1].split(f"| {first} |", 1)[1].split("\n\n", 1)[0]
    return [[cell.strip() for cell in line.strip("| ").split(" | ")] for line in text.splitlines()[2:]]


def parameters() -> dict[tuple[str, str], str]:
    """The default of each parameter of each family, as the page has it."""
    every, found, name = [*families.FAMILIES], {}, ""
    for line in PAGE.split("| parameter |", 1)[1].split("\n\n", 1)[0].splitlines()[2:]:
        first, where, _, default, _ = (cell.strip() for cell in line.split("|")[1:6])
        name = first.strip("`") or name
        chosen = every if where.startswith("all but") else re.findall(r"`(\w+)`", where)
        found |= {(family, name): default for family in chosen}
    return found


def test_the_example_is_a_study() -> None:
    example = re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    assert example is not None
    read = study.loads(example[1])
    assert read.reference_method == study.BOTH and len(read.sweeps) == 5 * 2 * 5 + 1


def test_every_parameter_of_every_family_is_there_with_its_default() -> None:
    shown = parameters()
    known = {
        (family, name): parameter.default
        for family, function in families.FAMILIES.items()
        for name, parameter in inspect.signature(function).parameters.items()
    }
    assert {key for key in shown if key[0] != "scene"} == set(known)
    assert {name for family, name in shown if family == "scene"} == {"file", "motion"}
    for key, default in known.items():
        if default is inspect.Parameter.empty:
            assert shown[key] == REQUIRED, key
        else:
            text = str(list(default)).replace(".0", "") if isinstance(default, tuple) else default
            number = f"{text:g}" if isinstance(text, float) else text
            quoted = f'"{number}"' if isinstance(default, str) else number
            assert shown[key] == f"`{quoted}`", key


@pytest.mark.parametrize(("heading", "keys"), [("## The file", None), ("## `[reference]`", "reference")])
def test_every_key_of_the_schema_is_there(heading: str, keys: str | None) -> None:
    properties = schema.schema()["properties"]
    known = set(properties[keys]["properties"] if keys else properties) - {"reference", "model", "sweep"}
    assert {row[0].strip("`") for row in table_after(heading, "key")} == known


def test_every_family_and_every_form_of_a_method_are_there() -> None:
    names = {row[0].strip("`") for row in table_after("## `[[sweep]]`", "family")}
    assert names == {*families.FAMILIES, "scene"}
    forms = re.findall(r'"([\w:+-]+)"', study.METHODS)
    listed = PAGE.split("## `[model]`")[1].split("## `[[sweep]]`")[0]
    assert forms and all(form in listed for form in forms)

"""The live page in headless Chromium: the native library's numbers, what moves bodies, and how long frames take."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis import live
from analysis.pipeline.model_stage import model_module
from analysis.report.index_page import LIVE
from geometries.scene import poses, reader
from tests import scenes
from tests.analysis.live.browser import Browser, opened, skip_where_missing, wait_for

pytestmark = pytest.mark.night
skip_where_missing()

SCENE = live.find_scene(LIVE.scene)
ROUNDING = 1e-9
"""Largest relative difference between the page and the native library, which use other instructions and other logarithms."""
ITERATION = 1e-4
"""Largest relative difference of the formula's changes: its conjugate gradients stop at 3e-5, and it sums in single precision."""
ANSWERS = """
    const {scene, choosePath, goTo} = window.livePage, found = [];
    choosePath(arguments[0]);
    for (const at of arguments[1]) {
      goTo(at);
      found.push({exact: scene.capacitance("exact"), formula: scene.capacitance("formula"), reduced: scene.capacitance("reduced", 0.3),
                  eyes: scene.distances(), pairs: scene.collisions()});
    }
    return found;"""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("live") / "page.html"
    return live.make(LIVE.scene, None, target, None)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with Browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def ready(browser: Browser, page: Path) -> Browser:
    opened(browser, page)
    return browser


@pytest.fixture(scope="module")
def native() -> Any:
    return model_module().Scene.load(str(SCENE))


def place(native: Any, way: live.Way, number: int) -> None:
    """Takes the links of the native scene to a frame."""
    for link, pose in way.frames[number].poses.items():
        native.set_pose(link, np.array(pose.translation), poses.quaternion(pose.rotation))


def changes(answer: dict[str, Any]) -> list[float]:
    return [np.nan if each["change"] is None else each["change"] for each in answer["readings"]]


def totals(answer: dict[str, Any]) -> list[float]:
    return [
        value
        for sensor in answer["sensors"]
        for value in (
            sensor["total"],
            sensor["voltage"],
            *(body["capacitance"] for body in sensor["objects"]),
        )
    ]


@pytest.mark.parametrize("number", [0, 1])
def test_models_and_geometry_are_those_of_the_native_library(
    ready: Browser, native: Any, number: int
) -> None:
    way = live.of_scene(reader.load(SCENE), ())[number]
    found = ready.run(ANSWERS, number, list(range(len(way.frames))))
    assert len(found) == len(way.frames)
    for frame, said in enumerate(found):
        place(native, way, frame)
        answer = native.capacitance()
        np.testing.assert_allclose(totals(said["exact"]), totals(answer), rtol=ROUNDING)
        np.testing.assert_allclose(changes(said["exact"]), changes(answer), rtol=ROUNDING)
        answer = native.capacitance("formula")
        np.testing.assert_allclose(changes(said["formula"]), changes(answer), rtol=ITERATION)
        assert all(reading["error"]["change"] is None for reading in said["formula"]["readings"])
        eye, other = said["eyes"]["distance_sensors"][0], native.sense()["distance_sensors"][0]
        assert (eye["distance"] is None) == (other["distance"] is None)
        if other["distance"] is not None:
            np.testing.assert_allclose(eye["distance"], other["distance"], rtol=ROUNDING)
            np.testing.assert_allclose(eye["point"], other["point"], rtol=ROUNDING, atol=1e-12)
            assert eye["object"] == other["object"]
        assert said["pairs"]["pairs"] == native.collide()["pairs"]


def test_the_reduced_method_is_right_within_the_errors_that_the_page_states(
    ready: Browser, native: Any
) -> None:
    way = live.of_scene(reader.load(SCENE), ())[0]
    frames = [0, 4, 7]
    for number, said in zip(frames, ready.run(ANSWERS, 0, frames)):
        place(native, way, number)
        truth = native.readings("boundary-elements", rtol=0.01)
        for reading in said["reduced"]["readings"]:
            best = truth[reading["name"]]
            allowed = reading["error"]["change"] + best.error["change"]
            assert abs(reading["change"] - best.change) <= allowed, (number, reading["name"])
            assert reading["error"]["change"] < 0.3 * abs(reading["change"])


def test_mouse_and_keyboard_move_the_hand_and_its_readings_follow(ready: Browser, native: Any) -> None:
    ready.run("document.getElementById('home').click()")
    # The middle of the hand on the picture.
    at = ready.run(
        """const box = document.getElementById("surface").getBoundingClientRect();
           return [Math.round(box.left + box.width / 2), Math.round(box.top + box.height * 0.4)]"""
    )
    drag = [
        {"type": "pointerMove", "duration": 0, "x": at[0], "y": at[1]},
        {"type": "pointerDown", "button": 0},
        {"type": "pointerMove", "duration": 20, "x": at[0] + 30, "y": at[1] - 40},
        {"type": "pointerUp", "button": 0},
    ]
    ready.act("pointer", drag)
    dragged = moved_hand(ready)
    assert np.linalg.norm(dragged - [0, 0, 0.06]) > 0.01
    ready.act("key", [{"type": "keyDown", "value": "\ue00e"}, {"type": "keyUp", "value": "\ue00e"}])
    np.testing.assert_allclose(moved_hand(ready) - dragged, [0, 0, 0.005], atol=1e-12)
    native.set_pose("wrist", moved_hand(ready), np.array([1.0, 0, 0, 0]))
    said = ready.run("return window.livePage.scene.capacitance('formula')")
    np.testing.assert_allclose(changes(said), changes(native.capacitance("formula")), rtol=ITERATION)
    assert ready.complaints() == []


def test_bars_have_room_on_a_wide_screen(page: Path) -> None:
    with Browser(1300, 900) as wide:
        opened(wide, page)
        widths = wide.run(
            """const shown = [...document.querySelectorAll(".bar")].filter(bar => bar.offsetParent);
               return shown.map(bar => bar.clientWidth)"""
        )
    assert widths and min(widths) > 100


def moved_hand(browser: Browser) -> Any:
    pose = browser.run("return window.livePage.scene.poses()[0]")
    return np.array(pose)[[3, 7, 11]]


def test_a_floating_hand_is_asked_anew(ready: Browser) -> None:
    ready.run("document.getElementById('home').click()")
    name = "[...document.querySelectorAll('#floating button')].find(button => button.textContent === arguments[0]).click()"
    ask = "return window.livePage.scene.capacitance(arguments[0], 0.3)"
    grounded = changes(ready.run(ask, "reduced"))
    ready.run(name, "floating")
    floating = changes(ready.run(ask, "reduced"))
    # Its field goes on to the ground behind it, so it is felt less, and the model does not know it.
    assert abs(floating[2]) < 0.7 * abs(grounded[2])
    assert np.isnan(changes(ready.run("return window.livePage.scene.capacitance('exact')"))).all()
    ready.run(name, "grounded")
    np.testing.assert_allclose(changes(ready.run(ask, "reduced")), grounded, rtol=ROUNDING)


def test_the_guard_is_driven_or_grounded(ready: Browser) -> None:
    press = "document.querySelector('#floating button[title*=\"' + arguments[0] + '\"]').click()"
    shown = "return document.getElementById('trace-title').textContent"
    ready.run(press, "“left, guard grounded”")
    assert ready.run(shown) == "Trace of “left, guard grounded”"
    ready.run(press, "“left”")
    assert ready.run(shown) == "Trace of “left”"
    assert ready.complaints() == []


def test_a_cover_is_put_on_the_sensors_and_the_hand_stays_where_it_is(browser: Browser, page: Path) -> None:
    opened(browser, page)
    browser.run("window.livePage.setLink(0, [0.01, 0.02, 0.04], [1, 0, 0, 0])")
    name, thickness, permittivity = live.COVERS[0]
    press = "[...document.querySelectorAll('#floating button')].find(button => button.textContent === arguments[0]).click()"
    browser.run(press, name)
    told = "return window.livePage ? window.livePage.state.cover : null"
    wait_for(browser, told, 1)
    np.testing.assert_allclose(moved_hand(browser), [0.01, 0.02, 0.04])
    covered = live.covered(live.movable(SCENE.read_text()), thickness, permittivity)
    native = model_module().Scene.loads(covered)
    native.set_pose("wrist", np.array([0.01, 0.02, 0.04]), np.array([1.0, 0, 0, 0]))
    said = browser.run("return window.livePage.scene.capacitance('boundary-elements', 0.3)")
    answer = native.readings("boundary-elements", rtol=0.3)
    expected = [answer[reading["name"]].change for reading in said["readings"]]
    np.testing.assert_allclose(changes(said), expected, rtol=1e-6)
    browser.run(press, "none")
    wait_for(browser, told, 0)
    assert browser.complaints() == []


def test_scenes_with_mesh_files_are_whole(browser: Browser, tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    corners = [(0, 0, 0), (0.05, 0, 0), (0, 0.05, 0), (0, 0, 0.05)]
    sides = [(1, 3, 2), (1, 2, 4), (1, 4, 3), (2, 3, 4)]
    text = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a} {b} {c}" for a, b, c in sides]
    (tmp_path / "meshes" / "wedge.obj").write_text("\n".join(text))
    (tmp_path / "scenes").mkdir()
    scene = tmp_path / "scenes" / "wedge.toml"
    scene.write_text(
        (
            scenes.sensor("front", [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])
            + scenes.body("wedge", "mesh", file="../meshes/wedge.obj", translation=[0.02, 0.02, 0.03])
        )
    )
    target = live.make(str(scene), None, tmp_path / "wedge.html")
    opened(browser, target)
    said = browser.run("return window.livePage.scene.capacitance('exact')")
    answer = model_module().Scene.load(str(scene)).capacitance()
    np.testing.assert_allclose(totals(said), totals(answer), rtol=ROUNDING)


def test_how_fast_it_is_on_one_core(page: Path, record_property: Any, capsys: Any) -> None:
    assert page.stat().st_size <= live.LARGEST
    with Browser(is_on_one_core=True) as browser:
        times = opened(browser, page)
        # The browser compiles the library once more, for speed, while the first frames are shown.
        first, *_, last = (shown_frames(browser) for _ in range(4))
        assert browser.complaints() == []
    record_property("frames_per_second", last["shown"])
    with capsys.disabled():
        print(
            f"\nlive page on one core: first answer after {times['firstAnswer'] / 1000:.2f} s, reduced method prepared in "
            f"{times['preparation'] / 1000:.2f} s, {first['shown']:.0f} frames a second at first and {last['shown']:.0f} after four "
            f"ways along the path, each for {last['each']:.1f} ms of processor time of the whole browser; the median frame takes "
            f"{last['frame']:.1f} ms (model {last['model']:.2f}, formula {last['formula']:.2f}, reduced {last['reduced']:.2f}, "
            f"colours {last['colours']:.2f}, geometry {last['geometry']:.2f}, picture and page {last['page']:.2f})"
        )


def shown_frames(browser: Browser) -> dict[str, float]:
    """Moves along a path in 60 frames; returns the frames shown in a second, and the median times of their parts, ms."""
    before = browser.processor_seconds()
    frames = browser.run_until_done("window.livePage.measure(0, 60, arguments[0])")
    each = 1000 * (browser.processor_seconds() - before) / len(frames)
    assert len(frames) == 60 and all(frame["frame"] > 0 for frame in frames)
    shown = 1000 * (len(frames) - 1) / (frames[-1]["now"] - frames[0]["now"])
    return {part: float(np.median([frame[part] for frame in frames])) for part in frames[0]} | {
        "shown": shown,
        "each": each,
    }

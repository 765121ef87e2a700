"""A headless Chromium that a test drives: the few commands of WebDriver that are needed, over http to chromedriver."""

import base64
import json
import re
import shutil
import subprocess
import time
import urllib.error
import urllib.request
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import psutil
import pytest

from geometries.common.installation import page_library
from tests.waiting import DEADLINE

PROGRAMS = ("chromium", "chromedriver")
# The sandbox needs what root in a container lacks. Without a graphics card, drawing the page by the processor is several times faster
# than drawing it by WebGL that the processor imitates; only the picture of the scene needs that.
_OPTIONS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
)


_READY = "return window.livePage ? window.livePage.ready() : null"


def skip_where_missing() -> None:
    """Skips the tests of the module that calls this where the library for pages or a browser is missing."""
    if not page_library().is_file():
        pytest.skip(
            f"{page_library()} is missing: ./run --prepare browser builds it where emscripten is installed",
            allow_module_level=True,
        )
    if missing := " and ".join(program for program in PROGRAMS if shutil.which(program) is None):
        pytest.skip(f"no browser: {missing} not installed", allow_module_level=True)


class Browser:
    """Opens pages in a window of the given size, in CSS pixels; with `is_on_one_core`, all of the browser runs on one core."""

    def __init__(
        self, width: int = 1000, height: int = 720, *options: str, is_on_one_core: bool = False
    ) -> None:
        self._driver = subprocess.Popen(
            ["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        if is_on_one_core:
            driver = psutil.Process(self._driver.pid)
            driver.cpu_affinity(driver.cpu_affinity()[:1])  # the browser inherits it
        self._address = f"http://127.0.0.1:{self._port()}"
        arguments = [*_OPTIONS, f"--window-size={width},{height}", *options]
        asked = {
            "goog:chromeOptions": {"binary": shutil.which("chromium"), "args": arguments},
            "goog:loggingPrefs": {"browser": "ALL"},
            "timeouts": {"script": int(1000 * DEADLINE), "pageLoad": int(1000 * DEADLINE)},
        }
        session = self._send("POST", "/session", {"capabilities": {"alwaysMatch": asked}})
        self._session = f"/session/{session['sessionId']}"

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._send("DELETE", self._session, None)
        finally:
            self._driver.terminate()
            self._driver.wait(timeout=DEADLINE)

    def open(self, page: Path) -> None:
        self._send("POST", f"{self._session}/url", {"url": page.resolve().as_uri()})

    def run(self, script: str, *arguments: Any) -> Any:
        """Runs the body of a function of JavaScript; returns what it returns."""
        return self._send(
            "POST", f"{self._session}/execute/sync", {"script": script, "args": list(arguments)}
        )

    def run_until_done(self, script: str, *arguments: Any) -> Any:
        """Runs the body of a function of JavaScript, whose last argument is to be called with what is returned."""
        return self._send(
            "POST", f"{self._session}/execute/async", {"script": script, "args": list(arguments)}
        )

    def act(self, kind: str, actions: list[dict[str, Any]]) -> None:
        """Lets a mouse ("pointer") or a keyboard ("key") act."""
        source = {"type": kind, "id": kind, "actions": actions}
        self._send("POST", f"{self._session}/actions", {"actions": [source]})

    def complaints(self) -> list[str]:
        """Returns what the page wrote to the console as an error since the last call."""
        entries = self._send("POST", f"{self._session}/se/log", {"type": "browser"})
        return [entry["message"] for entry in entries if entry["level"] == "SEVERE"]

    def processor_seconds(self) -> float:
        """Returns the processor time that all processes of the browser have taken so far."""
        processes = psutil.Process(self._driver.pid).children(recursive=True)
        return sum(process.cpu_times().user + process.cpu_times().system for process in processes)

    def picture(self) -> bytes:
        """Returns the window as a PNG."""
        return base64.b64decode(self._send("GET", f"{self._session}/screenshot", None))

    def _port(self) -> int:
        assert self._driver.stdout is not None
        for line in self._driver.stdout:
            if found := re.search(r"successfully on port (\d+)", line):
                return int(found.group(1))
        raise RuntimeError("chromedriver did not start")

    def _send(self, method: str, path: str, body: dict[str, Any] | None) -> Any:
        request = urllib.request.Request(
            self._address + path,
            data=None if body is None else json.dumps(body).encode(),
            headers={"Content-Type": "application/json"},
            method=method,
        )
        try:
            with urllib.request.urlopen(request, timeout=DEADLINE) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from error


def opened(browser: Browser, page: Path) -> dict[str, Any]:
    """Opens a live page; returns how long its first answers took, ms."""
    browser.open(page)
    return dict(wait_for(browser, "return true", True))


def wait_for(browser: Browser, script: str, value: Any) -> Any:
    """Waits until a script returns the value and the live page has answered; returns how long its first answers took, ms."""
    end = time.monotonic() + DEADLINE
    while time.monotonic() < end:
        # A page that is being read anew may refuse to run a script.
        with suppress(RuntimeError):
            if browser.run(script) == value and (found := browser.run(_READY)):
                return found
        time.sleep(0.05)
    raise AssertionError(f"the page does not answer: {browser.complaints()}")

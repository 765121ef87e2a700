"""The page of a scene: its frame, its style and its script; the script draws what the data say."""

from __future__ import annotations

from html import escape
from pathlib import Path

from analysis.report import page
from analysis.results.store import Document

_FOLDER = Path(__file__).parent


def document(title: str, digest: str, text: str, data: Document) -> str:
    """The whole page. `text` is the data as JSON, `digest` its hash."""
    style = (_FOLDER / "show.css").read_text(encoding="utf-8")
    script = (_FOLDER / "show.js").read_text(encoding="utf-8")
    # What ends a script element in HTML must not stand in one.
    harmless = text.replace("</", "<\\/")
    body = [
        f"<style>{style}</style>",
        f"<h1>{escape(title)}</h1>",
        page.soft(_summary(data)),
        _STAGE,
        f'<script type="application/json" id="data">{harmless}</script>',
        f"<script>{script}</script>",
    ]
    return page.document(title, digest, body)


def _summary(data: Document) -> str:
    nouns = {
        "objects": "object",
        "links": "link",
        "sensors": "capacitive sensor",
        "eyes": "distance sensor",
        "frames": "frame",
    }
    parts = [_count(len(data[key]), noun) for key, noun in nouns.items() if data[key]]
    return ", ".join(parts) + ". Drag to turn, scroll to come closer, hover for names."


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


_STAGE = """
<div class="stage">
<div class="view">
  <div id="scene"></div>
  <div class="timeline" data-needs="motion">
    <button id="play" type="button">Play</button>
    <div id="frames" role="group" aria-label="Frames; the arrow keys step through them"></div>
    <p id="frame-name" aria-live="polite"></p>
  </div>
  <div class="switches">
    <fieldset id="boxes"><legend>Bounding boxes</legend>
      <label><input type="radio" name="boxes" value="none" checked>none</label>
      <label><input type="radio" name="boxes" value="aabb">along the axes</label>
      <label><input type="radio" name="boxes" value="obb">oriented</label>
    </fieldset>
    <label data-needs="eyes"><input type="checkbox" id="cones" checked>cones of the distance sensors</label>
    <label data-needs="links"><input type="checkbox" id="links">links</label>
  </div>
  <p class="legend soft">
    <span data-needs="sensors"><i class="mark sensor"></i>capacitive sensor</span>
    <span data-needs="eyes"><i class="mark eye"></i>distance sensor, with a line to the closest visible point</span>
    <span data-needs="collisions"><i class="mark bounds"></i>only the bounds overlap</span>
    <span data-needs="collisions"><i class="mark collision"></i>collision</span>
  </p>
</div>
<aside class="readings">
  <section id="distances"></section>
  <section id="outputs"></section>
  <section id="collisions"></section>
</aside>
</div>
"""

"use strict";
// The panel of the readings: their bars, whether they are noticed, distances, collisions, and two plots of a change, over time and along a
// path. The size of a change stands on a scale of powers of ten.

/** The methods of a live page in the order of their bars: what tells their lines apart besides colour. */
const METHODS = [
  { name: "model", method: "exact", dash: [] },
  { name: "formula", method: "formula", dash: [7, 4] },
  { name: "reduced", method: "reduced", dash: [2, 3] },
];
const CHART = { low: 1e-16, high: 1e-10 };  // F, the ends of the scale

/** A change in F as text; `error` may be missing. */
function farads(value, error) {
  if (value === null || value === undefined) return "not known";
  if (!Number.isFinite(value)) return "contact";
  const unit = Math.max(Math.abs(value), error || 0) < 1e-13 ? [1e-15, "fF"] : [1e-12, "pF"];
  const digits = x => { const s = Math.abs(x / unit[0]); return s === 0 ? 1 : Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(s)))); };
  const minus = text => text.replace("-", "−");
  if (error === null || error === undefined) return `${minus(String(+(value / unit[0]).toFixed(digits(value))))} ${unit[1]}`;
  const places = error === 0 ? digits(value) : Math.max(0, Math.min(6, 1 - Math.floor(Math.log10(error / unit[0]))));
  return `${minus((value / unit[0]).toFixed(places))} ± ${(error / unit[0]).toFixed(places)} ${unit[1]}`;
}

/** The place of a size on the scale: 0 at its low end, 1 at its high end. */
const placeOnScale = size => Math.min(1, Math.max(0, Math.log10(Math.max(size, CHART.low) / CHART.low) / Math.log10(CHART.high / CHART.low)));
const powers = () => [-16, -15, -14, -13, -12, -11, -10].map(power => [10 ** power, power < -12 ? `${10 ** (power + 15)} fF` : `${10 ** (power + 12)} pF`]);

/** Draws a plot: lines {points: [[x, F]], colour, dash, name}, marks {x, value, error, colour}, a threshold, a place on the x axis. */
function drawChart(canvas, { from, to, ticks, lines, marks = [], threshold, now }, theme) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2), box = canvas.getBoundingClientRect();
  if (canvas.width !== Math.round(box.width * ratio)) canvas.width = Math.round(box.width * ratio);
  if (canvas.height !== Math.round(box.height * ratio)) canvas.height = Math.round(box.height * ratio);
  const pen = canvas.getContext("2d"), [left, right, top, bottom] = [46, 66, 8, 22];
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, box.width, box.height);
  pen.font = "11px system-ui, sans-serif";
  const sizes = [...lines.flatMap(l => l.points.map(p => Math.abs(p[1]))), ...marks.map(m => Math.abs(m.value)), threshold || 0].filter(s => s > 0 && Number.isFinite(s));
  if (!sizes.length) return;
  const low = 10 ** Math.floor(Math.log10(Math.max(Math.min(...sizes), 1e-17))), high = 10 ** Math.ceil(Math.log10(Math.max(...sizes) * 1.0001));
  const x = value => left + (value - from) / (to - from || 1) * (box.width - left - right);
  const y = size => top + (1 - Math.log10(Math.max(Math.abs(size), low) / low) / (Math.log10(high / low) || 1)) * (box.height - top - bottom);
  pen.lineWidth = 1;
  for (let power = Math.round(Math.log10(low)); power <= Math.round(Math.log10(high)); ++power) {
    const size = 10 ** power, at = y(size);
    pen.strokeStyle = theme.line;
    pen.beginPath(); pen.moveTo(left, at); pen.lineTo(box.width - right, at); pen.stroke();
    pen.fillStyle = theme.soft; pen.textAlign = "right";
    pen.fillText(size < 0.99e-12 ? `${+(size * 1e15).toPrecision(1)} fF` : `${+(size * 1e12).toPrecision(1)} pF`, left - 4, at + 4);
  }
  pen.textAlign = "center";
  for (const [value, text] of ticks) pen.fillText(text, x(value), box.height - 6);
  if (threshold) {
    pen.strokeStyle = theme.ink; pen.setLineDash([5, 4]); pen.lineWidth = 1.5;
    pen.beginPath(); pen.moveTo(left, y(threshold)); pen.lineTo(box.width - right, y(threshold)); pen.stroke();
    pen.setLineDash([]);
    pen.textAlign = "left"; pen.fillStyle = theme.ink;
    pen.fillText("threshold", left + 4, y(threshold) - 4);
  }
  if (now !== undefined) {
    pen.strokeStyle = theme.soft; pen.lineWidth = 1;
    pen.beginPath(); pen.moveTo(x(now), top); pen.lineTo(x(now), box.height - bottom); pen.stroke();
  }
  const taken = [];
  for (const { points, colour, dash, name } of lines) {
    const drawn = points.filter(p => p[1] !== null && p[1] !== 0 && Number.isFinite(p[1]));
    if (!drawn.length) continue;
    pen.strokeStyle = colour; pen.fillStyle = colour; pen.lineWidth = 2; pen.setLineDash(dash);
    pen.beginPath();
    drawn.forEach((p, k) => (k ? pen.lineTo(x(p[0]), y(p[1])) : pen.moveTo(x(p[0]), y(p[1]))));
    pen.stroke(); pen.setLineDash([]);
    let height = y(drawn[drawn.length - 1][1]) + 4;
    while (taken.some(other => Math.abs(other - height) < 12)) height += 12;
    taken.push(height);
    pen.textAlign = "left";
    pen.fillText(name, box.width - right + 5, height);
  }
  for (const { at, value, error, colour } of marks) {
    pen.strokeStyle = colour; pen.lineWidth = 2;
    const [a, b] = [Math.abs(value) + error, Math.max(Math.abs(value) - error, low)].map(y);
    pen.beginPath();
    pen.moveTo(x(at), a); pen.lineTo(x(at), b);
    for (const end of [a, b]) { pen.moveTo(x(at) - 3, end); pen.lineTo(x(at) + 3, end); }
    pen.rect(x(at) - 3.5, y(value) - 3.5, 7, 7);
    pen.stroke();
  }
}

/** Tells the answers that `state` holds. */
function makeReadings({ data, state, readings, theme, recolour, trace, along, pick }) {
  const rows = readings.map((reading, number) => {
    const box = element("div", "reading"), title = element("div", "title"), noticed = element("span", "noticed");
    const drive = `charge on ${reading.sense}, driven: ${reading.drive.join(", ")}` + (reading.threshold ? `; threshold ${farads(reading.threshold)}` : "");
    title.append(element("b", "", reading.name), noticed);
    title.tabIndex = 0;
    title.setAttribute("role", "button");
    title.addEventListener("click", () => choose(number));
    title.addEventListener("keydown", event => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); choose(number); } });
    box.append(title, element("div", "drive", drive));
    const lines = {};
    for (const name of [...METHODS.map(m => m.name), "reference"]) {
      const row = element("div", `row ${name}`), bar = element("div", "bar"), size = element("span", "size"), error = element("span", "error"), value = element("span", "value");
      bar.append(size, error);
      if (reading.threshold) {
        const mark = element("span", "threshold");
        mark.style.left = `${100 * placeOnScale(reading.threshold)}%`;
        bar.append(mark);
      }
      row.append(element("span", "name", name), bar, value);
      row.hidden = name === "reference";
      box.append(row);
      lines[name] = { row, size, error, value };
    }
    return { box, title, noticed, lines, reading };
  });
  const ticks = element("div", "ticks");
  for (const [size, text] of powers()) {
    const tick = element("span", "", text);
    tick.style.left = `${100 * placeOnScale(size)}%`;
    ticks.append(tick);
  }
  byId("readings").append(...rows.map(row => row.box), ticks);
  function choose(number) { state.reading = number; recolour(); chosen(); }
  /** Marks the chosen reading where it can be chosen. */
  function chosen() {
    document.querySelectorAll("[data-reading]").forEach(button => button.setAttribute("aria-pressed", Number(button.dataset.reading) === state.reading));
    rows.forEach((row, n) => { row.box.classList.toggle("chosen", n === state.reading); row.title.setAttribute("aria-pressed", n === state.reading); });
    byId("trace-title").textContent = readings.length ? `Trace of “${readings[state.reading].name}”` : "Trace";
  }

  /** Sets a bar, and where `isSlow` its text. */
  function tellOne({ size, error, value, row }, { change, error: stated, refused }, isSlow) {
    const known = change !== null && change !== undefined, at = known && change !== 0 ? placeOnScale(Math.abs(change)) : 0;
    size.style.transform = `scaleX(${at})`;
    const shows = known && stated !== null && stated !== undefined && stated > 0;
    error.hidden = !shows;
    if (shows) {
      const low = placeOnScale(Math.max(Math.abs(change) - stated, 0)), high = placeOnScale(Math.abs(change) + stated);
      error.style.left = `${100 * low}%`;
      error.style.width = `${100 * (high - low)}%`;
    }
    if (!isSlow) return;
    const text = known ? farads(change, stated) : refused && refused.length < 20 ? refused : "no answer";
    if (value.textContent !== text) value.textContent = text;
    const hint = refused && refused.length >= 20 ? refused : known ? "" : "This method does not know this reading.";
    if (row.title !== hint) row.title = hint;
  }
  /** Tells by the best answer at hand whether a change is above its threshold: with an error, only if it is by more than that; never by
   * one whose method could not find its error. */
  function noticedBy(threshold, said) {
    if (!threshold) return "";
    const best = ["reference", "reduced", "formula", "model"].find(name => said[name] && said[name].change !== null && said[name].change !== undefined);
    if (!best) return "";
    const { change, error } = said[best], size = Math.abs(change);
    if (error === null) return `perhaps noticed (${best}, error unknown)`;
    if (size - (error || 0) > threshold) return `noticed (${best})`;
    return size + (error || 0) < threshold ? `not noticed (${best})` : `perhaps noticed (${best})`;
  }
  /** Tells the answers: bars in every frame, texts and charts, which no eye follows faster, only where `isSlow`. */
  function tell(isSlow) {
    rows.forEach(({ noticed, lines, reading }) => {
      const said = {};
      for (const { name } of METHODS) tellOne(lines[name], (said[name] = pick(state.answers[name], reading.name)), isSlow);
      lines.reference.row.hidden = !state.reference;
      if (state.reference) tellOne(lines.reference, (said.reference = pick(state.reference, reading.name)), isSlow);
      if (!isSlow) return;
      const text = noticedBy(reading.threshold, said);
      if (noticed.textContent !== text) noticed.textContent = text;
    });
    if (!isSlow) return;
    state.told = performance.now();
    const refusals = METHODS.filter(({ name }) => state.answers[name].refused && state.answers[name].refused.length >= 20).map(({ name }) => `${name}: ${state.answers[name].refused}.`).join(" ");
    if (byId("refusals").textContent !== refusals) byId("refusals").textContent = refusals;
    tellGeometry();
    if (readings.length) tellCharts();
  }
  let geometryTold = null;
  function tellGeometry() {
    const eyes = state.geometry.eyes.map(eye => ["", eye.distance === null ? `${eye.name}: nothing in its cone` : `${eye.name}: ${(1000 * eye.distance).toFixed(1)} mm to ${eye.object}`]);
    const pairs = state.geometry.pairs.filter(pair => pair.status === "collision").map(pair => ["collision", `collision: ${pair.a} and ${pair.b}`]);
    const said = [...eyes, ...(pairs.length ? pairs : [["", "no collision"]])], text = said.join("\n");
    if (text === geometryTold) return;
    geometryTold = text;
    byId("geometry").replaceChildren(...said.map(([kind, each]) => element("p", kind, each)));
  }
  const lineOf = (points, m) => ({ points, colour: theme[METHODS[m].name], dash: METHODS[m].dash, name: METHODS[m].name });
  function tellCharts() {
    const now = performance.now() / 1000, threshold = readings[state.reading].threshold;
    drawChart(byId("trace"), {
      from: -15, to: 0, ticks: [[-15, "−15 s"], [-10, "−10 s"], [-5, "−5 s"], [0, "now"]], threshold,
      lines: METHODS.map((_, m) => lineOf(trace.map(each => [each.now - now, each.values[state.reading][m]]), m)),
    }, theme);
    byId("along").hidden = state.path === null;
    if (state.path === null) return;
    const path = data.paths[state.path], passed = [...along].sort((a, b) => a[0] - b[0]), every = Math.ceil(path.frames.length / 6);
    const solved = path.reference && !state.changed ? path.reference.map((frame, at) => ({ at, value: frame[readings[state.reading].name] })) : [];
    drawChart(byId("path"), {
      from: 0, to: path.frames.length - 1, now: state.at, threshold, ticks: path.frames.map((frame, n) => [n, frame.name]).filter((_, n) => n % every === 0),
      lines: METHODS.map((_, m) => lineOf(passed.map(([at, values]) => [at, values[state.reading][m]]), m)),
      marks: solved.filter(({ value }) => value).map(({ at, value }) => ({ at, value: value[0], error: value[1], colour: theme.reference })),
    }, theme);
    byId("path-said").textContent = `${path.said} ` + (solved.length ? "Squares with error bars: boundary elements, solved when the page was made." : state.changed ? "The reference curve holds for the scene as in its file only." : "No reference was solved for this path.");
  }
  return { choose, chosen, tell };
}

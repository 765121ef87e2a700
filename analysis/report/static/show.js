"use strict";
// Draws a scene: bodies are fixed in the frames of their links, and every frame of the motion gives the poses of the links.
// Beside it the changes of the readings are plotted along the motion, with a line at the frame that is shown.

/** Draws a plot for each reading; a click on one calls `go` with the frame. Returns what marks a frame in all of them. */
function makeReadings(data, go) {
  const place = byId("along"), PICO = 1e12;
  if (!place) return { mark: () => {} };
  const along = JSON.parse(byId("along-data").textContent);
  const STYLE = {
    model: { color: "#0072b2", dash: "solid" }, formula: { color: "#c75b00", dash: "dash" },
    reduced: { color: "#24292f", dash: "dot" }, "boundary elements": { color: "#007a57", symbol: "square-open" },
  };
  const last = data.frames.length - 1, keys = data.frames.map((_, n) => n).filter(n => n % data.every === 0);
  const sizes = values => values.map(value => (value ? Math.abs(value) * PICO : null));

  function trace(method, reading) {
    const { color, dash, symbol } = STYLE[method.name], values = method.changes[reading.name] || [], errors = method.errors[reading.name] || [];
    const isKnown = errors.some(error => error !== null), bars = { type: "data", array: sizes(errors), color, thickness: 1, width: symbol ? 4 : 0, visible: isKnown };
    // Bars at every frame would cover the line.
    if (!symbol) bars.array = bars.array.map((error, n) => (n % data.every === 0 ? error : null));
    return {
      name: method.name, x: method.frames, y: sizes(values), mode: symbol ? "markers" : "lines", error_y: bars,
      line: { color, dash, width: 2 }, marker: { color, symbol, size: 8 },
      text: method.frames.map(n => data.frames[n].name), hovertemplate: "%{text}: %{y:.4g} pF<extra>%{fullData.name}</extra>",
    };
  }
  const cursor = frame => ({ type: "line", xref: "x", yref: "paper", x0: frame, x1: frame, y0: 0, y1: 1, line: { color: "#57606a", width: 1.5 } });
  const level = reading => ({ type: "line", xref: "paper", yref: "y", x0: 0, x1: 1, y0: reading.threshold * PICO, y1: reading.threshold * PICO, line: { color: "#24292f", width: 1.5, dash: "dash" } });
  const known = along.methods.filter(method => !method.refused), every = Math.ceil(keys.length / 8);
  const plots = along.readings.map(reading => {
    const plot = element("div", "plot"), shapes = reading.threshold ? [level(reading)] : [];
    place.append(plot);
    Plotly.newPlot(plot, known.map(method => trace(method, reading)), {
      title: { text: reading.name, font: { size: 14 }, x: 0.02, xanchor: "left" }, height: 300, margin: { l: 62, r: 12, t: 34, b: 40 },
      font: FONT, paper_bgcolor: "white", plot_bgcolor: "white",
      xaxis: { range: [-0.02 * last, 1.02 * last], tickvals: keys.filter((_, n) => n % every === 0), ticktext: keys.filter((_, n) => n % every === 0).map(n => data.frames[n].name), gridcolor: "#e4e7eb" },
      yaxis: { type: "log", title: { text: "size of the change, pF" }, gridcolor: "#e4e7eb", exponentformat: "none", nticks: 6 },
      legend: { orientation: "h", x: 1, xanchor: "right", y: 1.02, yanchor: "bottom" }, shapes: [cursor(0), ...shapes],
    }, QUIET);
    plot.on("plotly_click", event => go(event.points[0].x));
    return plot;
  });
  for (const method of along.methods.filter(each => each.refused)) {
    place.append(element("p", "soft", `${method.name}: ${method.refused}.`));
  }
  return { mark: frame => plots.forEach(plot => Plotly.relayout(plot, { "shapes[0].x0": frame, "shapes[0].x1": frame })) };
}

(() => {
  const data = JSON.parse(byId("data").textContent);
  const CONE = "#f0c808";
  const MARKS = { bounds: "#e69f00", collision: "#d0342c" };
  const SAID = { bounds: "only their bounds overlap", collision: "collision" };
  // A muted hue for each link, so that marks and sensors stand out.
  const LINK_COLOURS = ["#c3c9d0", "#d8c7a3", "#a9bccf", "#b7cdbb", "#cdb9d2", "#d6bdb0", "#b5c9c9", "#c8c8a6"];
  const WORLD_COLOUR = "#c3c9d0";
  const EDGES = [0, 1, 3, 2, 0, 4, 5, 7, 6, 4, null, 1, 5, null, 2, 6, null, 3, 7];
  const FRAME_SECONDS = 0.9;
  const state = { frame: 0, boxes: "none", cones: true, links: false };

  // --- geometry ---

  const { placed, turned, sum, cross, unit } = space;
  const matrixOf = (frame, link) => (link === null ? space.IDENTITY : frame.links[link]);
  const columns = points => ({ x: points.map(p => p && p[0]), y: points.map(p => p && p[1]), z: points.map(p => p && p[2]) });

  // An apex, then rings on the spherical cap from the axis outwards.
  const RINGS = 5, SPOKES = 36;
  function conePoints(apex, axis, eye) {
    const least = axis.map(Math.abs).indexOf(Math.min(...axis.map(Math.abs)));
    const u = unit(cross(axis, [0, 1, 2].map(i => (i === least ? 1 : 0)))), w = cross(axis, u);
    const points = [apex];
    for (let ring = 1; ring <= RINGS; ++ring) {
      const angle = (eye.half_angle * ring) / RINGS;
      for (let spoke = 0; spoke < SPOKES; ++spoke) {
        const turn = (2 * Math.PI * spoke) / SPOKES;
        const across = sum(u.map(x => x * Math.cos(turn)), Math.sin(turn), w);
        points.push(sum(sum(apex, eye.range * Math.cos(angle), axis), eye.range * Math.sin(angle), across));
      }
    }
    return points;
  }
  const coneFaces = [];
  for (let spoke = 0; spoke < SPOKES; ++spoke) {
    const next = (spoke + 1) % SPOKES, outer = 1 + (RINGS - 1) * SPOKES;
    coneFaces.push([0, outer + spoke, outer + next]);
    for (let ring = 1; ring < RINGS; ++ring) {
      const inner = 1 + (ring - 1) * SPOKES;
      coneFaces.push([inner + spoke, inner + SPOKES + spoke, inner + SPOKES + next]);
      coneFaces.push([inner + spoke, inner + SPOKES + next, inner + next]);
    }
    if (spoke > 1) coneFaces.push([1, spoke, 1 + spoke]);
  }

  // --- what a frame shows ---

  /** The worst status of every object that is not clear. */
  function statuses(frame) {
    const worst = {};
    for (const [a, b, status] of frame.collisions ? frame.collisions.pairs : [])
      for (const name of [a, b]) if (worst[name] !== "collision") worst[name] = status;
    return worst;
  }

  function worstOf(frame) {
    const all = Object.values(statuses(frame));
    return all.includes("collision") ? "collision" : all.length ? "bounds" : "clear";
  }

  const colourOfLink = link => (link === null ? WORLD_COLOUR : LINK_COLOURS[link % LINK_COLOURS.length]);

  const lines = (colour, width, more) => ({
    type: "scatter3d", mode: "lines", x: [], y: [], z: [], line: { color: colour, width }, hoverinfo: "skip", showlegend: false, ...more,
  });

  function makeTraces() {
    const traces = data.objects.map(body => solid(body, colourOfLink(body.link)));
    traces.push(...data.sensors.map(sensor => solid(sensor, SENSOR)));
    const faces = data.eyes.flatMap((eye, n) => coneFaces.map(face => face.map(v => v + n * (1 + RINGS * SPOKES))));
    traces.push(solid({ name: "cone", faces, vertices: [] }, CONE, { opacity: 0.16, hoverinfo: "skip", flatshading: false }));
    traces.push(lines(INK, 5));
    traces.push({ type: "scatter3d", mode: "markers", x: [], y: [], z: [], text: [], hoverinfo: "text", marker: { color: INK, size: 4 } });
    traces.push({ type: "scatter3d", mode: "markers", x: [], y: [], z: [], text: data.eyes.map(eye => eye.name), hoverinfo: "text",
                  marker: { color: CONE, size: 4, line: { color: INK, width: 1 } } });
    traces.push(lines("#7d8791", 2), lines(MARKS.bounds, 5), lines(MARKS.collision, 5));
    traces.push(lines("#8c959f", 3, { line: { color: "#8c959f", width: 3, dash: "dot" } }));
    traces.push(...["#d1242f", "#1a7f37", "#0969da"].map(colour => lines(colour, 5)));
    traces.push({ type: "scatter3d", mode: "text", x: [], y: [], z: [], text: [], hoverinfo: "skip",
                  textposition: "top center", textfont: { color: INK, size: 22 } });
    return traces;
  }

  function boxOf(frame, number) {
    if (state.boxes === "obb") {
      const body = data.objects[number], m = matrixOf(frame, body.link);
      return body.obb.map(corner => placed(m, corner));
    }
    const [x0, y0, z0, x1, y1, z1] = frame.aabb[number];
    return [x0, x1].flatMap(x => [y0, y1].flatMap(y => [z0, z1].map(z => [x, y, z])));
  }

  function boxLines(frame, worst, status) {
    if (state.boxes === "none") return [];
    return data.objects.flatMap((body, number) => {
      if ((worst[body.name] || "clear") !== status) return [];
      const corners = boxOf(frame, number);
      return [...EDGES.map(n => (n === null ? null : corners[n])), null];
    });
  }

  /** The points of every trace, in the order of makeTraces. */
  function pointsOf(frame, worst) {
    const bodies = [...data.objects, ...data.sensors].map(body => {
      const m = matrixOf(frame, body.link);
      return body.vertices.map(p => placed(m, p));
    });
    const apexes = data.eyes.map(eye => placed(matrixOf(frame, eye.link), eye.apex));
    const cones = data.eyes.flatMap((eye, n) => state.cones ? conePoints(apexes[n], turned(matrixOf(frame, eye.link), eye.direction), eye) : []);
    const seen = frame.readings.map((reading, n) => (reading ? [apexes[n], reading.point, null] : [])).flat();
    const ends = frame.readings.filter(reading => reading).map(reading => reading.point);
    const origins = data.links.map((link, n) => placed(frame.links[n], [0, 0, 0]));
    const tree = data.links.flatMap((link, n) => (link.parent === null ? [] : [origins[link.parent], origins[n], null]));
    const axes = [0, 1, 2].map(axis => origins.flatMap((origin, n) => [origin, sum(origin, 0.18, [0, 4, 8].map(r => frame.links[n][r + axis])), null]));
    const links = state.links ? [tree, ...axes, origins] : [[], [], [], [], []];
    return [...bodies, cones, seen, ends, apexes, ...["clear", "bounds", "collision"].map(status => boxLines(frame, worst, status)), ...links];
  }

  /** The links' names; those of links in one place stand in one text, on the first of them. */
  function linkNames(frame) {
    const places = frame.links.map(m => [3, 7, 11].map(n => m[n].toFixed(3)).join());
    return data.links.map((link, n) =>
      places.indexOf(places[n]) < n ? "" : data.links.filter((_, other) => places[other] === places[n]).map(l => l.name).join(", "));
  }

  // --- the picture ---

  const plot = byId("scene");

  function draw() {
    const frame = data.frames[state.frame], worst = statuses(frame);
    const all = pointsOf(frame, worst).map(columns);
    const update = { x: all.map(c => c.x), y: all.map(c => c.y), z: all.map(c => c.z) };
    const bodies = data.objects.length;
    Plotly.restyle(plot, update, all.map((_, n) => n));
    // Links lie inside their bodies, which become transparent to show them.
    const colours = data.objects.map(body => MARKS[worst[body.name]] || colourOfLink(body.link));
    Plotly.restyle(plot, { color: colours, opacity: state.links ? 0.35 : 1 }, data.objects.map((_, n) => n));
    const said = frame.readings.flatMap((reading, n) => reading ? [`${data.eyes[n].name}: ${millimetres(reading.distance)} to ${reading.object}`] : []);
    Plotly.restyle(plot, { text: [said, linkNames(frame)] }, [bodies + data.sensors.length + 2, all.length - 1]);
    tell(frame);
  }

  /** Ranges that hold every frame, so that nothing jumps. */
  function axes() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const include = p => p.forEach((x, i) => { low[i] = Math.min(low[i], x); high[i] = Math.max(high[i], x); });
    for (const frame of data.frames) {
      frame.aabb.forEach(box => { include(box.slice(0, 3)); include(box.slice(3)); });
      data.sensors.forEach(sensor => sensor.vertices.forEach(p => include(placed(matrixOf(frame, sensor.link), p))));
      data.eyes.forEach(eye => include(placed(matrixOf(frame, eye.link), eye.apex)));
    }
    const largest = Math.max(...low.map((x, i) => high[i] - x)) || 1;
    const range = low.map((x, i) => { const margin = Math.max(0.02 * largest, (0.1 * largest - (high[i] - x)) / 2); return [x - margin, high[i] + margin]; });
    // The same size on the screen, whatever the proportions of the scene.
    const extent = range.map(([a, b]) => b - a), scale = 1.9 / Math.hypot(...extent);
    const named = i => ({ ...AXIS, zerolinecolor: "#d0d7de", showspikes: false, range: range[i], title: { text: "xyz"[i] + " (m)", font: { size: 11 } } });
    return { xaxis: named(0), yaxis: named(1), zaxis: named(2), aspectmode: "manual",
             aspectratio: { x: scale * extent[0], y: scale * extent[1], z: scale * extent[2] } };
  }

  // --- the readings ---

  const millimetres = metres => `${(1000 * metres).toPrecision(4).replace(/\.?0+$/, "")} mm`;
  function fill(id, title, parts) {
    const section = byId(id);
    section.replaceChildren(...(parts.length ? [element("h2", "", title), ...parts] : []));
  }

  /** A line with a bar from 0; what is above `rest`, both shares of the width, is dark. */
  function row(name, value, share, rest, kind, hint) {
    const line = element("div", "reading"), bar = element("div", "bar " + kind);
    for (const [part, length] of [["whole", share], ["rest", Math.min(share, rest)]]) {
      const piece = element("span", part);
      piece.style.width = `${100 * Math.min(1, Math.max(0, length))}%`;
      bar.append(piece);
    }
    line.title = hint;
    line.append(element("span", "name", name), element("span", "value", value), bar);
    return line;
  }

  function distanceRows(frame) {
    const rows = data.eyes.map((eye, n) => {
      const reading = frame.readings[n];
      if (!reading) return row(eye.name, `nothing within ${millimetres(eye.range)}`, 0, 0, "sight", "");
      return row(eye.name, `${millimetres(reading.distance)} to ${reading.object}`, reading.distance / eye.range, 0, "sight", "");
    });
    return rows.length ? [...rows, element("p", "soft", "To the closest visible point; a full bar is the sensor's range.")] : [];
  }

  /** A sensor's lowest output of all frames: what it gives at rest. */
  const restOf = n => Math.min(...data.frames.map(frame => frame.outputs[n].delta_voltage));

  function outputRows(frame) {
    if (!data.sensors.length) return [];
    if (!frame.outputs) return [element("p", "soft", `No outputs: ${frame.refused}`)];
    const rows = frame.outputs.map((output, n) => {
      const sensor = data.sensors[n], rest = restOf(n);
      const said = output.total === null ? "contact" : `${output.delta_voltage.toFixed(3)} V`;
      const more = data.frames.length > 1 && output.total !== null ? ` (+${(1000 * (output.delta_voltage - rest)).toFixed(0)} mV)` : "";
      const shares = output.objects.map(([name, value]) => `${name} ${value === null ? "contact" : (value * 1e12).toFixed(2) + " pF"}`);
      const dark = data.frames.length > 1 ? rest / sensor.input_voltage : 0;
      return row(sensor.name, said + more, output.delta_voltage / sensor.input_voltage, dark, "output", `Most of it from ${shares.join(", ")}`);
    });
    const above = data.frames.length > 1 ? ", dark what is above the lowest of all frames" : "";
    return [...rows, element("p", "soft", `Drop of the output voltage by the model's capacitances; a full bar is the input voltage${above}.`)];
  }

  function collisionRows(frame) {
    if (!frame.collisions) return [];
    const pairs = [...frame.collisions.pairs].sort((a, b) => (a[2] === b[2] ? 0 : a[2] === "collision" ? -1 : 1));
    const rows = pairs.map(([a, b, status]) => {
      const line = element("p", "pair");
      line.append(element("span", "mark " + status), `${a} and ${b}: ${SAID[status]}`);
      return line;
    });
    const { broad, narrow } = frame.collisions.tests;
    const clear = rows.length ? [] : [element("p", "pair", "All clear.")];
    return [...rows, ...clear, element("p", "soft", `${broad} tests of bounds, ${narrow} of shapes.`)];
  }

  /** The number of a frame of the motion file; those in between have none. */
  const place = n => (n % data.every === 0 ? `${n / data.every + 1} of ${(data.frames.length - 1) / data.every + 1}: ` : "");

  function tell(frame) {
    fill("distances", "Distance sensors", distanceRows(frame));
    fill("outputs", "Capacitive sensors", outputRows(frame));
    fill("collisions", "Collisions", collisionRows(frame));
    byId("frame-name").textContent = data.frames.length > 1 ? `${place(state.frame)}${frame.name}` : "";
    document.querySelectorAll("#frames button").forEach((button, n) => button.setAttribute("aria-pressed", n * data.every === state.frame));
    readings.mark(state.frame);
    history.replaceState(null, "", `#frame=${state.frame + 1}&boxes=${state.boxes}&links=${state.links ? 1 : 0}&cones=${state.cones ? 1 : 0}`);
  }

  // --- the controls ---

  const readings = makeReadings(data, frame => { stop(); go(frame); });
  const frames = byId("frames"), play = byId("play");
  let timer = null;

  function stop() {
    clearInterval(timer);
    timer = null;
    play.textContent = "Play";
  }

  function go(frame) {
    state.frame = (frame + data.frames.length) % data.frames.length;
    draw();
  }
  /** Goes to the next frame of the motion file in a direction, over those in between. */
  function step(direction) {
    const near = state.frame / data.every, last = (data.frames.length - 1) / data.every;
    const next = direction > 0 ? Math.floor(near) + 1 : Math.ceil(near) - 1;
    go(data.every * ((next + last + 1) % (last + 1)));
    frames.children[state.frame / data.every].focus();
  }

  function readAddress() {
    const asked = new URLSearchParams(location.hash.slice(1));
    const frame = Number(asked.get("frame"));
    if (frame >= 1 && frame <= data.frames.length) state.frame = Math.floor(frame) - 1;
    if (["aabb", "obb"].includes(asked.get("boxes"))) state.boxes = asked.get("boxes");
    if (asked.get("links")) state.links = asked.get("links") === "1";
    if (asked.get("cones")) state.cones = asked.get("cones") === "1";
    document.querySelector(`#boxes input[value="${state.boxes}"]`).checked = true;
    byId("cones").checked = state.cones;
    byId("links").checked = state.links;
  }

  data.frames.filter((_, n) => n % data.every === 0).forEach((frame, n) => {
    const button = element("button", worstOf(frame), String(n + 1));
    button.type = "button";
    button.title = frame.name;
    button.addEventListener("click", () => { stop(); go(n * data.every); });
    frames.append(button);
  });
  const present = { motion: data.frames.length > 1, eyes: data.eyes.length, links: data.links.length, sensors: data.sensors.length,
                    collisions: data.frames[0].collisions };
  document.querySelectorAll("[data-needs]").forEach(part => { part.hidden = !present[part.dataset.needs]; });
  frames.addEventListener("keydown", event => {
    const direction = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!direction) return;
    event.preventDefault();
    stop();
    step(direction);
  });
  play.addEventListener("click", () => {
    if (timer !== null) return stop();
    play.textContent = "Pause";
    timer = setInterval(() => go(state.frame + 1), 1000 * FRAME_SECONDS / data.every);
  });
  byId("boxes").addEventListener("change", event => { state.boxes = event.target.value; draw(); });
  byId("cones").addEventListener("change", event => { state.cones = event.target.checked; draw(); });
  byId("links").addEventListener("change", event => { state.links = event.target.checked; draw(); });

  readAddress();
  drawScene(plot, makeTraces(), { ...axes(), camera: { eye: { x: 0.77, y: -1.66, z: 0.59 }, center: { x: 0, y: 0, z: -0.05 } } }, draw);
})();

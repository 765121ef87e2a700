"use strict";
// The live page: links are dragged, turned or slid, and every frame asks the library for the readings, distances and collisions.
(async () => {
  const opened = performance.now();
  const data = JSON.parse(document.getElementById("data").textContent);
  const byId = id => document.getElementById(id);
  const trouble = text => { byId("trouble").hidden = false; byId("trouble").textContent = text; };
  const element = (tag, className, text) => {
    const made = document.createElement(tag);
    if (className) made.className = className;
    if (text !== undefined) made.textContent = text;
    return made;
  };

  let scene;
  try {
    scene = await openScene(data.scene, data.files);
  } catch (error) {
    return trouble(`The scene cannot be shown: ${error.message}`);
  }
  const described = scene.described, roles = described.roles;
  const view = makeView(byId("surface"), byId("overlay"));
  if (!view) trouble("This browser draws no WebGL: the scene is not shown, but all answers are.");

  // The relative error that is asked of the reduced method. It states a smaller one of most changes, and is then fast enough for each frame.
  const RTOL = 0.3;

  // --- what moves ---

  const links = described.links.map(link => ({ translation: [...link.translation], quaternion: [...link.quaternion] }));
  const readings = Object.entries(roles.readings).map(([name, reading]) => ({ name, ...reading }));
  const state = { link: firstLink(), reading: 0, reduced: data.reduced, rtol: RTOL, path: null, at: 0, playing: false, reference: null, floats: new Set(), frames: 0, told: -1e9, moved: 0 };
  let poses = scene.poses(), answers = {}, geometry = {}, dirty = true, spent = {}, firstAnswer = null;
  const trace = [], along = new Map();

  function firstLink() {
    const isLast = link => described.links.every(other => other.parent !== link);
    const carriers = described.objects.filter(body => body.link !== null && isLast(body.link));
    const carrier = carriers.find(body => roles.objects[body.name].target) || carriers[0];
    return carrier ? carrier.link : described.links.length ? described.links.length - 1 : null;
  }
  const poseOf = link => (link === null ? space.IDENTITY : poses[link]);
  const parentPose = link => poseOf(described.links[link].parent);

  function setLink(link, translation, quaternion) {
    links[link] = { translation, quaternion };
    scene.setPose(link, translation, quaternion);
    poses = scene.poses();
    state.reference = null;
    dirty = true;
  }
  function shift(link, change) {
    const { translation, quaternion } = links[link];
    setLink(link, space.sum(translation, 1, space.turnedBack(parentPose(link), change)), quaternion);
  }
  /** Turns a link about an axis of the world through a point of the world. */
  function turn(link, axis, angle, centre) {
    const parent = parentPose(link), local = space.turnedBack(parent, axis), step = space.turn(local, angle);
    const pivot = space.turnedBack(parent, space.sum(centre, -1, [parent[3], parent[7], parent[11]]));
    const away = space.sum(links[link].translation, -1, pivot), q = space.product(space.product(step, [0, ...away]), [step[0], -step[1], -step[2], -step[3]]);
    const turned = space.product(step, links[link].quaternion), length = Math.hypot(...turned);
    setLink(link, space.sum(pivot, 1, q.slice(1)), turned.map(x => x / length));
  }

  // --- the extent of the scene ---

  function boxOf(bodies) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const body of bodies)
      for (let k = 0; k < body.triangles.length; k += 3)
        space.placed(poseOf(body.link), body.triangles.slice(k, k + 3)).forEach((x, i) => { low[i] = Math.min(low[i], x); high[i] = Math.max(high[i], x); });
    return [low, high];
  }
  const bodies = [...described.objects, ...described.sensors], whole = boxOf(bodies);
  const extent = Math.hypot(...whole[0].map((x, i) => whole[1][i] - x));
  const centreOf = link => { const [low, high] = boxOf(bodies.filter(body => body.link === link)); return Number.isFinite(low[0]) ? low.map((x, i) => (x + high[i]) / 2) : [3, 7, 11].map(k => poses[link][k]); };

  // --- colours ---

  const theme = {};
  function readTheme() {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["ink", "soft", "line", "paper", "model", "formula", "reduced", "reference", "body", "plate", "seen", "bad"]) theme[name] = style.getPropertyValue(`--${name}`).trim();
    theme.rgb = text => { const n = parseInt(text.slice(1), 16); return [n >> 16, (n >> 8) & 255, n & 255].map(x => x / 255); };
    theme.bodyColour = theme.rgb(theme.body);
    theme.plateColour = theme.rgb(theme.plate);
  }
  readTheme();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readTheme(); dirty = true; });

  // The colours span two powers of ten below the largest charge per area when the reading was chosen; contact is beyond.
  const DECADES = 2;
  let brightest = null;
  const sensorOf = reading => Math.max(0, described.sensors.findIndex(sensor => sensor.name === readings[reading].sense));
  const starts = described.objects.reduce((all, body) => [...all, all[all.length - 1] + body.triangles.length / 9], [0]);

  function colour() {
    const densities = described.sensors.length ? scene.densities(sensorOf(state.reading)) : null;
    if (!densities || !view) return;
    const isNew = brightest === null;
    brightest ??= 10 ** Math.ceil(Math.log10(densities.reduce((most, x) => (Number.isFinite(x) ? Math.max(most, x) : most), 1e-30)));
    if (isNew) tellScale();
    described.objects.forEach((body, number) => {
      const shares = new Float32Array(starts[number + 1] - starts[number]).fill(-1);
      if (roles.objects[body.name].potential !== "grounded" || state.floats.has(body.name)) return view.setShares(number, shares);
      for (let t = 0; t < shares.length; ++t) {
        const density = densities[starts[number] + t];
        shares[t] = density > 0 ? Math.min(1, Math.max(0, 1 + Math.log10(density / brightest) / DECADES)) : 0;
      }
      view.setShares(number, shares);
    });
  }
  function tellScale() {
    const box = byId("scale"), end = brightest * 1e12, text = x => `${+x.toPrecision(2)} pC/m²`;
    const bar = element("i");
    bar.style.background = `linear-gradient(90deg, ${SCALE.map(c => `rgb(${c.map(x => Math.round(255 * x)).join()})`).join()})`;
    const said = element("span", "", text(end / 10 ** DECADES));
    said.append(bar, text(end));
    const hover = element("span", "", "");
    hover.id = "hover";
    box.replaceChildren(element("span", "", `Charge per area that the model finds on grounded bodies for 1 V on “${described.sensors[sensorOf(state.reading)].name}”, by powers of ten:`), said, hover);
  }

  // --- asking ---

  const pick = (answer, name) => {
    const found = answer.readings && answer.readings.find(reading => reading.name === name);
    return found ? { change: found.change, error: found.error.change } : { refused: answer.refused || "no answer" };
  };
  function ask() {
    const timed = (part, action) => { const start = performance.now(); action(); spent[part] = performance.now() - start; };
    // The reduced method answers in every second frame where it takes long; the frame after the last one makes up for it.
    state.isStale = spent.reduced > 3 && state.reduced && state.prepared && !state.isStale;
    for (const { name, method } of METHODS)
      if (name !== "reduced") timed(name, () => { answers[name] = scene.capacitance(method); });
      else if (!state.reduced) answers[name] = { refused: "off" };
      else if (!state.prepared) answers[name] = { refused: "preparing …" };
      else if (!state.isStale) timed(name, () => { answers[name] = scene.capacitance(method, state.rtol); });
    timed("geometry", () => {
      geometry = { eyes: described.distance_sensors.length ? scene.distances().distance_sensors : [], pairs: scene.collisions().pairs || [] };
    });
    timed("colours", colour);
    firstAnswer ??= performance.now() - opened;
    const now = performance.now() / 1000, values = readings.map(({ name }) => METHODS.map(m => (m.name === "reduced" && state.isStale ? null : pick(answers[m.name], name).change ?? null)));
    trace.push({ now, values });
    while (trace.length && trace[0].now < now - 15) trace.shift();
    if (state.path !== null) along.set(Math.round(state.at * 1000) / 1000, values);
  }

  function prepare() {
    state.prepared = false;
    dirty = true;
    if (!state.reduced) return;
    // The page is drawn first, as the preparation may take a second.
    requestAnimationFrame(() => setTimeout(() => {
      const start = performance.now(), first = scene.capacitance("reduced:1", state.rtol);
      state.preparation = performance.now() - start;
      state.prepared = true;
      if (first.refused) byId("said").textContent = `The reduced method has no answer: ${first.refused}`;
      dirty = true;
    }));
  }

  // --- the picture ---

  function colliding() {
    const worst = new Set();
    for (const { a, b, status } of geometry.pairs) if (status === "collision") { worst.add(a); worst.add(b); }
    return worst;
  }
  function coneRim(eye, pose) {
    const axis = space.turned(pose, eye.direction), apex = space.placed(pose, eye.apex);
    const u = space.unit(space.cross(axis, Math.abs(axis[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0])), w = space.cross(axis, u), half = eye.full_angle_degrees * Math.PI / 360;
    const rim = [];
    for (let k = 0; k <= 40; ++k) {
      const angle = 2 * Math.PI * k / 40, across = space.sum(u.map(x => x * Math.cos(angle)), Math.sin(angle), w);
      rim.push(space.sum(space.sum(apex, eye.range * Math.cos(half), axis), eye.range * Math.sin(half), across));
    }
    return { apex, rim };
  }
  function cornersOf(triangles) {
    const ends = [0, 1, 2].map(i => triangles.reduce(([low, high], x, k) => (k % 3 === i ? [Math.min(low, x), Math.max(high, x)] : [low, high]), [Infinity, -Infinity]));
    return [0, 1, 2, 3, 4, 5, 6, 7].map(n => ends.map((end, i) => end[(n >> i) & 1]));
  }
  function draw() {
    if (!view) return;
    view.resize();
    const worst = colliding(), count = described.objects.length;
    view.drawBodies((body, number) => ({ colour: number < count && roles.objects[body.name].potential !== "electrode" ? theme.bodyColour : theme.plateColour, hatched: number >= count || worst.has(body.name) || roles.objects[body.name].potential === "electrode" }), poseOf);
    view.clearOverlay();
    const text = { colour: theme.ink, ground: theme.paper };
    described.distance_sensors.forEach((eye, n) => {
      const pose = poseOf(eye.link), { apex, rim } = coneRim(eye, pose), reading = geometry.eyes[n];
      view.line(rim, { colour: theme.seen, width: 1, dash: [3, 5] });
      for (const k of [0, 10, 20, 30]) view.line([apex, rim[k]], { colour: theme.seen, width: 1, dash: [3, 5] });
      if (!reading || reading.distance === null) return;
      view.line([apex, reading.point], { colour: theme.seen, width: 3 });
      view.label(reading.point, `${eye.name}: ${(1000 * reading.distance).toFixed(1)} mm`, text);
    });
    const few = bodies.length <= 12;
    bodies.forEach((body, number) => {
      if (!few && !worst.has(body.name) && !(number >= count && described.sensors.length < 5)) return;
      // Beside the corner of its box that is furthest to the right.
      const corners = (body.corners ??= cornersOf(body.triangles)).map(p => space.placed(poseOf(body.link), p)), places = corners.map(p => (view.project(p) || [-1])[0]);
      view.label(corners[places.indexOf(Math.max(...places))], worst.has(body.name) ? `${body.name}: collision` : body.name, { ...text, bold: worst.has(body.name), colour: worst.has(body.name) ? theme.bad : theme.ink });
    });
  }

  // --- the readings ---

  const rows = readings.map((reading, number) => {
    const box = element("div", "reading"), title = element("div", "title"), noticed = element("span", "noticed");
    const drive = `charge on ${reading.sense}, driven: ${reading.drive.join(", ")}` + (reading.threshold ? `; threshold ${farads(reading.threshold)}` : "");
    title.append(element("b", "", reading.name), noticed);
    title.tabIndex = 0;
    title.setAttribute("role", "button");
    const choose = () => { state.reading = number; brightest = null; dirty = true; chosen(); };
    title.addEventListener("click", choose);
    title.addEventListener("keydown", event => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); choose(); } });
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
  function chosen() {
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
  /** Tells by the best answer at hand whether a change is above its threshold: with an error, only if it is by more than that. */
  function noticedBy(threshold, said) {
    if (!threshold) return "";
    const best = ["reference", "reduced", "formula", "model"].find(name => said[name] && said[name].change !== null && said[name].change !== undefined);
    if (!best) return "";
    const { change, error } = said[best], size = Math.abs(change);
    if (size - (error || 0) > threshold) return `noticed (${best})`;
    return size + (error || 0) < threshold ? `not noticed (${best})` : `perhaps noticed (${best})`;
  }
  /** Tells the answers: bars in every frame, texts and charts, which no eye follows faster, only where `isSlow`. */
  function tell(isSlow) {
    rows.forEach(({ noticed, lines, reading }) => {
      const said = {};
      for (const { name } of METHODS) tellOne(lines[name], (said[name] = pick(answers[name], reading.name)), isSlow);
      lines.reference.row.hidden = !state.reference;
      if (state.reference) tellOne(lines.reference, (said.reference = pick(state.reference, reading.name)), isSlow);
      if (!isSlow) return;
      const text = noticedBy(reading.threshold, said);
      if (noticed.textContent !== text) noticed.textContent = text;
    });
    if (!isSlow) return;
    state.told = performance.now();
    const refusals = METHODS.filter(({ name }) => answers[name].refused && answers[name].refused.length >= 20).map(({ name }) => `${name}: ${answers[name].refused}.`).join(" ");
    if (byId("refusals").textContent !== refusals) byId("refusals").textContent = refusals;
    tellGeometry();
    sliders.forEach(update => update());
    if (readings.length) tellCharts();
  }
  function tellGeometry() {
    const eyes = geometry.eyes.map(eye => ["", eye.distance === null ? `${eye.name}: nothing in its cone` : `${eye.name}: ${(1000 * eye.distance).toFixed(1)} mm to ${eye.object}`]);
    const pairs = geometry.pairs.filter(pair => pair.status === "collision").map(pair => ["collision", `collision: ${pair.a} and ${pair.b}`]);
    const said = [...eyes, ...(pairs.length ? pairs : [["", "no collision"]])], text = said.join("\n");
    if (text === state.geometry) return;
    state.geometry = text;
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

  // --- the controls ---

  const AXES = ["x", "y", "z"], reach = Math.max(0.6 * extent, 0.1);
  const sliders = [];
  function slider(name, low, high, step, read, write, say) {
    const label = element("label", ""), input = element("input"), output = element("output");
    Object.assign(input, { type: "range", min: low, max: high, step });
    input.setAttribute("aria-label", name);
    input.addEventListener("input", () => { state.playing = false; write(Number(input.value)); });
    label.append(element("span", "", name), input, output);
    byId("sliders").append(label);
    sliders.push(() => { const value = read(); if (document.activeElement !== input || Math.abs(Number(input.value) - value) > step) input.value = value; output.textContent = say(value).replace("-", "−"); });
  }
  /** The angles about z, y and x, in degrees, that make up a quaternion. */
  function anglesOf([w, x, y, z]) {
    const degrees = radians => radians * 180 / Math.PI;
    return [degrees(Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))), degrees(Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x))))), degrees(Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))];
  }
  const ofAngles = degrees => [2, 1, 0].reduce((q, k) => space.product(q, space.turn([0, 1, 2].map(i => (i === k ? 1 : 0)), degrees[k] * Math.PI / 180)), [1, 0, 0, 0]);
  function makeSliders() {
    byId("sliders").replaceChildren();
    sliders.length = 0;
    if (state.path !== null) {
      const frames = data.paths[state.path].frames;
      slider("on the path", 0, frames.length - 1, 0.01, () => state.at, at => goTo(at), at => frames[Math.round(at)].name);
    }
    if (state.link === null) return;
    const link = described.links[state.link], start = link.translation;
    if (link.joint) {
      const isTurned = link.joint.kind === "revolute", unit = isTurned ? 180 / Math.PI : 1000;
      const [low, high] = [link.joint.lower ?? (isTurned ? -Math.PI : -reach), link.joint.upper ?? (isTurned ? Math.PI : reach)];
      link.at ??= link.joint.position;
      slider(link.joint.name, low, high, (high - low) / 500, () => link.at, value => {
        link.at = value;
        scene.setJoint(link.joint.name, value);
        poses = scene.poses();
        state.reference = null;
        dirty = true;
      }, value => `${(value * unit).toFixed(1)} ${isTurned ? "°" : "mm"}`);
      return;
    }
    AXES.forEach((axis, i) => slider(axis, start[i] - reach, start[i] + reach, 0.0005, () => links[state.link].translation[i],
      value => setLink(state.link, links[state.link].translation.map((x, k) => (k === i ? value : x)), links[state.link].quaternion), value => `${(1000 * value).toFixed(1)} mm`));
    AXES.forEach((axis, i) => slider(`about ${axis}`, -180, 180, 0.5, () => anglesOf(links[state.link].quaternion)[i],
      value => setLink(state.link, links[state.link].translation, ofAngles(anglesOf(links[state.link].quaternion).map((a, k) => (k === i ? value : a)))), value => `${value.toFixed(1)} °`));
  }

  described.links.forEach((link, n) => {
    const option = element("option", "", link.joint ? `${link.name} (joint ${link.joint.name})` : link.name);
    option.value = n;
    byId("link").append(option);
  });
  if (state.link !== null) byId("link").value = state.link;
  byId("link").addEventListener("change", event => { state.link = Number(event.target.value); makeSliders(); dirty = true; });
  byId("home").addEventListener("click", () => {
    leavePath();
    described.links.forEach((link, n) => {
      setLink(n, [...link.translation], [...link.quaternion]);
      if (link.joint) { link.at = link.joint.position; scene.setJoint(link.joint.name, link.at); }
    });
    poses = scene.poses();
  });
  const look = () => { if (view) { Object.assign(view.camera, { yaw: -0.9, pitch: 0.42 }); view.frame(whole); dirty = true; } };
  byId("look").addEventListener("click", look);
  byId("solve").addEventListener("click", () => {
    byId("said").textContent = "Solving by boundary elements …";
    setTimeout(() => {
      const start = performance.now(), answer = scene.capacitance("boundary-elements", 0.02);
      state.reference = answer.refused ? null : answer;
      byId("said").textContent = answer.refused ? `Boundary elements have no answer: ${answer.refused}` : `Solved in ${((performance.now() - start) / 1000).toFixed(1)} s to 2 % of the readings.`;
      dirty = true;
    }, 50);
  });
  byId("rtol").addEventListener("change", event => { state.rtol = Number(event.target.value); prepare(); });
  byId("reduced").checked = state.reduced;
  byId("reduced").addEventListener("change", event => { state.reduced = event.target.checked; prepare(); });

  // Whether a target is grounded, floating, or has the capacitance of a person to the ground.
  const GROUNDS = [["grounded", false, 0], ["floating", true, 0], ["100 pF to ground", true, 100e-12]];
  const switched = described.objects.filter(body => roles.objects[body.name].target && ["grounded", "floating"].includes(roles.objects[body.name].potential));
  if (switched.length <= 4) switched.forEach(body => {
    const group = element("div", "group"), role = roles.objects[body.name];
    group.setAttribute("role", "group");
    group.append(element("span", "name", `${body.name} is`));
    GROUNDS.forEach(([name, floats, toGround], n) => {
      const button = element("button", "", name), isNow = role.potential === "grounded" ? n === 0 : n === (role.to_ground ? 2 : 1);
      button.type = "button";
      button.setAttribute("aria-pressed", isNow);
      button.addEventListener("click", () => {
        scene.setFloating(body.name, floats, toGround);
        state.floats[floats ? "add" : "delete"](body.name);
        group.querySelectorAll("button").forEach(other => other.setAttribute("aria-pressed", other === button));
        state.changed = !isNow;
        state.reference = null;
        along.clear();
        trace.length = 0;
        prepare();
      });
      group.append(button);
    });
    byId("floating").append(group);
  });

  // --- paths ---

  function between(a, b, share) {
    const near = a.quaternion.reduce((sum, x, k) => sum + x * b.quaternion[k], 0) < 0 ? -1 : 1;
    const q = a.quaternion.map((x, k) => x + share * (near * b.quaternion[k] - x)), length = Math.hypot(...q);
    // At a frame its own numbers are taken, so that the answers there are those of the frame.
    return share === 0 ? a : { translation: a.translation.map((x, k) => x + share * (b.translation[k] - x)), quaternion: q.map(x => x / length) };
  }
  function goTo(at) {
    const frames = data.paths[state.path].frames, first = Math.min(Math.floor(at), frames.length - 1), next = Math.min(first + 1, frames.length - 1);
    state.at = at;
    frames[first].poses.forEach((pose, link) => {
      const { translation, quaternion } = between(pose, frames[next].poses[link], at - first), here = links[link];
      if (translation.some((x, k) => x !== here.translation[k]) || quaternion.some((x, k) => x !== here.quaternion[k])) setLink(link, translation, quaternion);
    });
    dirty = true;
  }
  const buttons = data.paths.map((path, n) => {
    const button = element("button", "", path.name);
    button.type = "button";
    button.title = path.said;
    button.setAttribute("aria-pressed", false);
    button.addEventListener("click", () => (state.path === n && state.playing ? stop() : play(n)));
    byId("paths").append(button);
    return button;
  });
  function stop() { state.playing = false; }
  function choosePath(n) {
    if (state.path !== n) along.clear();
    state.path = n;
    buttons.forEach((button, k) => button.setAttribute("aria-pressed", k === n));
    makeSliders();
  }
  function leavePath() { state.path = null; stop(); buttons.forEach(button => button.setAttribute("aria-pressed", false)); makeSliders(); }
  const SECONDS = 7;
  function play(n) {
    choosePath(n);
    state.began = performance.now();
    state.playing = true;
    dirty = true;
  }
  function advance(now) {
    if (!state.playing) return;
    const last = data.paths[state.path].frames.length - 1, share = (now - state.began) / 1000 / SECONDS;
    goTo(Math.min(last, Math.max(0, share * last)));
    if (share >= 1) stop();
  }

  // --- mouse, touch, keyboard ---

  const surface = byId("surface"), pointers = new Map();
  let held = null;
  const localAt = event => { const box = surface.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  function grab(event) {
    surface.focus({ preventScroll: true });
    surface.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, localAt(event));
    held = null;
    if (pointers.size > 1 || !view) return;
    const under = view.hit(...localAt(event), poseOf), body = under && bodies[under.body];
    if (body && body.link !== null && !described.links[body.link].joint) {
      held = { link: body.link, point: under.point };
      leavePath();
      if (state.link !== body.link) { state.link = body.link; byId("link").value = body.link; makeSliders(); }
    }
  }
  function drag(event) {
    if (!view) return;
    const before = pointers.get(event.pointerId), now = localAt(event);
    if (!before) return hover(now);
    pointers.set(event.pointerId, now);
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    if (pointers.size === 2) {
      const [a, b] = [...pointers.values()], other = a === now ? b : a;
      view.camera.distance *= Math.hypot(before[0] - other[0], before[1] - other[1]) / Math.max(1, Math.hypot(now[0] - other[0], now[1] - other[1]));
    } else if (held && (event.shiftKey || event.buttons === 2)) {
      const { right, up } = view.axes(), centre = centreOf(held.link);
      turn(held.link, up, dx / 120, centre);
      turn(held.link, right, dy / 120, centre);
    } else if (held) {
      // In the plane through the held point that faces the eye.
      const { back } = view.axes(), { from, along: way } = view.sight(...now), far = space.dot(space.sum(held.point, -1, from), back) / space.dot(way, back);
      const point = space.sum(from, far, way);
      shift(held.link, space.sum(point, -1, held.point));
      held.point = point;
    } else {
      view.camera.yaw -= dx / 150;
      view.camera.pitch = Math.max(-1.5, Math.min(1.5, view.camera.pitch + dy / 150));
    }
    dirty = true;
  }
  function hover(at) {
    const place = byId("hover"), under = place && view.hit(...at, poseOf);
    if (!place) return;
    const body = under && bodies[under.body], densities = under && under.body < described.objects.length && described.sensors.length ? scene.densities(sensorOf(state.reading)) : null;
    place.textContent = !body ? "" : densities ? `here on ${body.name}: ${+(densities[starts[under.body] + under.triangle] * 1e12).toPrecision(3)} pC/m²` : `here: ${body.name}`;
  }
  surface.addEventListener("pointerdown", grab);
  surface.addEventListener("pointermove", drag);
  for (const kind of ["pointerup", "pointercancel"]) surface.addEventListener(kind, event => { pointers.delete(event.pointerId); held = null; });
  surface.addEventListener("contextmenu", event => event.preventDefault());
  surface.addEventListener("wheel", event => { if (!view) return; event.preventDefault(); view.camera.distance *= Math.exp(event.deltaY / 900); dirty = true; }, { passive: false });
  const KEYS = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowDown: [0, -1, 0], ArrowUp: [0, 1, 0], PageDown: [0, 0, -1], PageUp: [0, 0, 1] };
  const TURNS = { ArrowLeft: [0, -1, 0], ArrowRight: [0, 1, 0], ArrowDown: [1, 0, 0], ArrowUp: [-1, 0, 0], PageDown: [0, 0, -1], PageUp: [0, 0, 1] };
  surface.addEventListener("keydown", event => {
    const step = KEYS[event.key];
    if (!step || state.link === null || described.links[state.link].joint) return;
    event.preventDefault();
    leavePath();
    if (event.shiftKey) turn(state.link, TURNS[event.key], Math.PI / 60, centreOf(state.link));
    else shift(state.link, step.map(x => 0.005 * x));
  });
  new ResizeObserver(() => { dirty = true; }).observe(surface);

  // --- the frames ---

  const SLOW = 120;  // ms between two changes of the texts while something moves
  function frame(now) {
    advance(now);
    if (!dirty && state.isStale) dirty = true;
    if (!dirty && state.told < state.moved && now > state.moved + SLOW) tell(true);
    if (dirty) {
      state.moved = now;
      dirty = false;
      const start = performance.now();
      ask();
      const drawn = performance.now();
      draw();
      tell(drawn > state.told + SLOW);
      spent.page = performance.now() - drawn;
      spent.frame = performance.now() - start;
      ++state.frames;
      if (state.frames === 1 || state.frames % 30 === 0 || !state.playing) tellSpeed();
    }
    requestAnimationFrame(frame);
  }
  function tellSpeed() {
    const text = Object.entries(spent).filter(([part]) => part !== "frame").map(([part, ms]) => `${part} ${ms.toFixed(1)}`).join(", ");
    byId("speed").textContent = `The last frame took ${spent.frame.toFixed(1)} ms (${text}). The first answer came ${(firstAnswer / 1000).toFixed(2)} s after the page was read. ` + data.made;
  }

  if (view) { view.setBodies(bodies); view.frame(whole); view.resize(); }
  chosen();
  makeSliders();
  prepare();
  requestAnimationFrame(frame);

  // What a test needs: the answers in any pose, as JSON, and how long frames take.
  window.livePage = {
    scene, state, spent, answers: () => answers, play, goTo, choosePath, setLink,
    ready: () => firstAnswer !== null && (!state.reduced || state.prepared) ? { firstAnswer, preparation: state.preparation ?? null } : null,
    /** Moves along a path in `count` frames; calls back with the times of each frame, in ms. */
    measure: (path, count, done) => {
      choosePath(path);
      const times = [], last = data.paths[path].frames.length - 1;
      const step = now => {
        if (times.length) Object.assign(times[times.length - 1], spent);
        if (times.length === count) return done(times);
        goTo((times.length / (count - 1)) * last);
        times.push({ now });
        requestAnimationFrame(step);
      };
      requestAnimationFrame(step);
    },
  };
})();

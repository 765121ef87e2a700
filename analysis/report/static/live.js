"use strict";
// The live page: links are dragged, turned or slid, and every frame asks the library for the readings, distances and collisions.
(async () => {
  const opened = performance.now();
  const data = JSON.parse(byId("data").textContent);
  const trouble = text => { byId("trouble").hidden = false; byId("trouble").textContent = text; };

  // A page that was read anew for another cover goes on where it was.
  const kept = history.state || { cover: 0, links: [], joints: [] };
  let scene;
  try {
    scene = await openScene(kept.cover ? data.covers[kept.cover - 1].scene : data.scene, data.files);
  } catch (error) {
    return trouble(`The scene cannot be shown: ${error.message}`);
  }
  const described = scene.described, roles = described.roles;
  const view = makeView(byId("surface"), byId("overlay"));
  if (!view) trouble("This browser draws no WebGL: the scene is not shown, but all answers are.");

  // The relative error that is asked of the reduced method. It states a smaller one of most changes, and is then fast enough for each frame.
  const RTOL = 0.3;

  // --- the parts of the page ---

  const readings = Object.entries(roles.readings).map(([name, reading]) => ({ name, ...reading }));
  const state = { link: null, reading: 0, reduced: data.reduced, rtol: RTOL, path: null, at: 0, playing: false, reference: null, cover: kept.cover, changed: kept.cover > 0, floats: new Set(), frames: 0, told: -1e9, moved: -1e9, isCoarse: false, dirty: true, answers: {}, geometry: {} };
  const spent = {}, trace = [], along = new Map();
  let firstAnswer = null;
  const page = { data, scene, described, roles, view, state, readings, trace, along, pick, prepare };
  Object.assign(page, makeMotion(page));
  state.link = page.firstLink();
  Object.assign(page, makePicture(page));
  Object.assign(page, makeReadings(page));
  Object.assign(page, makePaths(page));
  Object.assign(page, makeControls(page));
  listen(page);

  // --- asking ---

  function pick(answer, name) {
    const found = answer.readings && answer.readings.find(reading => reading.name === name);
    return found ? { change: found.change, error: found.error.change } : { refused: answer.refused || "no answer" };
  }
  function ask() {
    const timed = (part, action) => { const start = performance.now(); action(); spent[part] = performance.now() - start; };
    // The reduced method answers in every second frame where it takes long; the frame after the last one makes up for it.
    state.isStale = spent.reduced > 3 && state.reduced && state.prepared && !state.isStale;
    for (const { name, method } of METHODS)
      if (name !== "reduced") timed(name, () => { state.answers[name] = scene.capacitance(method); });
      else if (!state.reduced) state.answers[name] = { refused: "off" };
      else if (!state.prepared) state.answers[name] = { refused: "preparing …" };
      else if (!state.isStale) timed(name, () => { state.answers[name] = scene.capacitance(method, state.rtol); });
    timed("geometry", () => {
      state.geometry = { eyes: described.distance_sensors.length ? scene.distances().distance_sensors : [], pairs: scene.collisions().pairs || [] };
    });
    timed("colours", page.colour);
    firstAnswer ??= performance.now() - opened;
    const now = performance.now() / 1000, values = readings.map(({ name }) => METHODS.map(m => (m.name === "reduced" && state.isStale ? null : pick(state.answers[m.name], name).change ?? null)));
    // A trace of 15 s takes 300 places at most: no eye tells more of them apart.
    if (trace.length > 1 && now - trace[trace.length - 2].now < 0.05) trace.pop();
    trace.push({ now, values });
    while (trace.length && trace[0].now < now - 15) trace.shift();
    if (state.path !== null) along.set(Math.round(state.at * 1000) / 1000, values);
  }

  function prepare() {
    state.prepared = false;
    state.dirty = true;
    if (!state.reduced) return;
    // The page is drawn first, as the preparation may take a second.
    requestAnimationFrame(() => setTimeout(() => {
      const start = performance.now(), first = scene.capacitance("reduced", state.rtol);
      state.preparation = performance.now() - start;
      state.prepared = true;
      if (first.refused) byId("said").textContent = `The reduced method has no answer: ${first.refused}`;
      state.dirty = true;
    }));
  }

  // --- the frames ---

  const SLOW = 200;  // ms between two changes of the texts while something moves
  function tell(isSlow) {
    page.tell(isSlow);
    if (isSlow) page.updateSliders();
  }
  function frame(now) {
    page.advance(now);
    if (!state.dirty && state.isStale) state.dirty = true;
    if (!state.dirty && now > state.moved + SLOW) {
      if (state.isCoarse) page.draw(state.isCoarse = false);
      if (state.told < state.moved) tell(true);
    }
    if (state.dirty) {
      state.isCoarse = now < state.moved + SLOW;
      state.moved = now;
      state.dirty = false;
      const start = performance.now();
      ask();
      const drawn = performance.now();
      page.draw(state.isCoarse);
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

  if (view) { view.setBodies(page.bodies); view.frame(page.whole); view.resize(false); }
  page.chosen();
  page.makeSliders();
  page.goOn(kept);
  prepare();
  requestAnimationFrame(frame);

  // What a test needs: the answers in any pose, as JSON, and how long frames take.
  window.livePage = {
    scene, state, spent, answers: () => state.answers, play: page.play, goTo: page.goTo, choosePath: page.choosePath, setLink: page.setLink,
    ready: () => firstAnswer !== null && (!state.reduced || state.prepared) ? { firstAnswer, preparation: state.preparation ?? null } : null,
    /** Moves along a path in `count` frames; calls back with the times of each frame, in ms. */
    measure: (path, count, done) => {
      page.choosePath(path);
      const times = [], last = data.paths[path].frames.length - 1;
      const step = now => {
        if (times.length) Object.assign(times[times.length - 1], spent);
        if (times.length === count) return done(times);
        page.goTo((times.length / (count - 1)) * last);
        times.push({ now });
        requestAnimationFrame(step);
      };
      requestAnimationFrame(step);
    },
  };
})();

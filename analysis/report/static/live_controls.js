"use strict";
// The controls: sliders of links and joints, boundary elements on request, whether a target floats, and covers of sensors. What moves links
// besides: the buttons of paths, and mouse, touch and keyboard on the picture.

/** Makes the controls. Functions of other parts that they call are those of `page`. */
function makeControls(page) {
  const { data, scene, described, roles, view, state, readings, links, setLink, whole, extent, trace, along } = page;
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
      slider("on the path", 0, frames.length - 1, 0.01, () => state.at, at => page.goTo(at), at => frames[Math.round(at)].name);
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
        state.poses = scene.poses();
        state.reference = null;
        state.dirty = true;
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
  byId("link").addEventListener("change", event => { state.link = Number(event.target.value); makeSliders(); state.dirty = true; });
  byId("home").addEventListener("click", () => {
    page.leavePath();
    described.links.forEach((link, n) => {
      setLink(n, [...link.translation], [...link.quaternion]);
      if (link.joint) { link.at = link.joint.position; scene.setJoint(link.joint.name, link.at); }
    });
    state.poses = scene.poses();
  });
  const look = () => { if (view) { Object.assign(view.camera, { yaw: -0.9, pitch: 0.42 }); view.frame(whole); state.dirty = true; } };
  byId("look").addEventListener("click", look);
  byId("solve").addEventListener("click", () => {
    byId("said").textContent = "Solving by boundary elements …";
    setTimeout(() => {
      const start = performance.now(), answer = scene.capacitance("boundary-elements", 0.02);
      state.reference = answer.refused ? null : answer;
      byId("said").textContent = answer.refused ? `Boundary elements have no answer: ${answer.refused}` : `Solved in ${((performance.now() - start) / 1000).toFixed(1)} s to 2 % of the readings.`;
      state.dirty = true;
    }, 50);
  });
  byId("rtol").addEventListener("change", event => { state.rtol = Number(event.target.value); page.prepare(); });
  byId("reduced").checked = state.reduced;
  byId("reduced").addEventListener("change", event => { state.reduced = event.target.checked; page.prepare(); });

  /** Makes a group of buttons below the picture; `press` gets the number of the one that is pressed. */
  function group(label, names, press) {
    const buttons = names.map((name, n) => {
      const button = element("button", "", name);
      button.type = "button";
      button.addEventListener("click", () => press(n));
      return button;
    });
    const made = element("div", "group");
    made.setAttribute("role", "group");
    made.append(element("span", "name", label), ...buttons);
    byId("floating").append(made);
    return buttons;
  }
  const mark = (buttons, chosen) => buttons.forEach((button, n) => button.setAttribute("aria-pressed", n === chosen));

  // Whether a target is grounded, floating, or has the capacitance of a person to the ground.
  const GROUNDS = [["grounded", false, 0], ["floating", true, 0], ["100 pF to ground", true, 100e-12]];
  const switched = described.objects.filter(body => roles.objects[body.name].target && ["grounded", "floating"].includes(roles.objects[body.name].potential));
  if (switched.length <= 4) switched.forEach(({ name }) => {
    const role = roles.objects[name], own = role.potential === "grounded" ? 0 : role.to_ground ? 2 : 1;
    const buttons = group(`${name} is`, GROUNDS.map(([words]) => words), n => {
      const [, floats, toGround] = GROUNDS[n];
      scene.setFloating(name, floats, toGround);
      state.floats[floats ? "add" : "delete"](name);
      mark(buttons, n);
      state.changed = n !== own || state.cover > 0;
      state.reference = null;
      along.clear();
      trace.length = 0;
      page.prepare();
    });
    mark(buttons, own);
  });

  // The readings of a sensor that is driven itself, with a guard driven like it and with the guard grounded.
  const isGuard = name => roles.objects[name] && roles.objects[name].potential === "electrode";
  described.sensors.forEach(({ name }) => {
    const own = [...readings.keys()].filter(n => readings[n].sense === name && readings[n].drive.includes(name));
    const pair = [own.find(n => readings[n].drive.some(isGuard)), own.find(n => !readings[n].drive.some(isGuard))];
    if (pair.includes(undefined)) return;
    group(`Guard of ${name} is`, ["driven", "grounded"], k => page.choose(pair[k])).forEach((button, k) => {
      const reading = readings[pair[k]];
      button.title = `Shows the reading “${reading.name}”, which drives ${reading.drive.join(", ")}; all else is grounded.`;
      button.dataset.reading = pair[k];
    });
  });

  // Covers of all sensors. They are bodies of the scene, so the page is read anew with another scene.
  if (data.covers.length) {
    const names = ["none", ...data.covers.map(cover => cover.name)];
    mark(group("Cover of the sensors", names, n => {
      history.replaceState({ cover: n, links, joints: described.links.map(link => link.at ?? null) }, "");
      location.reload();
    }), state.cover);
  }
  /** Takes all links to where they were when the page was read anew. */
  function goOn(kept) {
    kept.links.forEach(({ translation, quaternion }, n) => setLink(n, translation, quaternion));
    kept.joints.forEach((at, n) => { if (at !== null) { described.links[n].at = at; scene.setJoint(described.links[n].joint.name, at); } });
    state.poses = scene.poses();
    updateSliders();
  }
  const updateSliders = () => sliders.forEach(update => update());
  return { goOn, makeSliders, updateSliders };
}

/** Makes the buttons of the paths. */
function makePaths(page) {
  const { data, state, links, setLink, along } = page;

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
    state.dirty = true;
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
    page.makeSliders();
  }
  function leavePath() { state.path = null; stop(); buttons.forEach(button => button.setAttribute("aria-pressed", false)); page.makeSliders(); }
  const SECONDS = 7;
  function play(n) {
    choosePath(n);
    state.began = performance.now();
    state.playing = true;
    state.dirty = true;
  }
  function advance(now) {
    if (!state.playing) return;
    const last = data.paths[state.path].frames.length - 1, share = (now - state.began) / 1000 / SECONDS;
    goTo(Math.min(last, Math.max(0, share * last)));
    if (share >= 1) stop();
  }
  return { goTo, choosePath, leavePath, play, stop, advance };
}

/** Listens to the picture; what is dragged is moved. */
function listen(page) {
  const { described, view, state, poseOf, shift, turn, bodies, centreOf, hover } = page;

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
      page.leavePath();
      if (state.link !== body.link) { state.link = body.link; byId("link").value = body.link; page.makeSliders(); }
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
    state.dirty = true;
  }
  surface.addEventListener("pointerdown", grab);
  surface.addEventListener("pointermove", drag);
  for (const kind of ["pointerup", "pointercancel"]) surface.addEventListener(kind, event => { pointers.delete(event.pointerId); held = null; });
  surface.addEventListener("contextmenu", event => event.preventDefault());
  surface.addEventListener("wheel", event => { if (!view) return; event.preventDefault(); view.camera.distance *= Math.exp(event.deltaY / 900); state.dirty = true; }, { passive: false });
  const KEYS = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowDown: [0, -1, 0], ArrowUp: [0, 1, 0], PageDown: [0, 0, -1], PageUp: [0, 0, 1] };
  const TURNS = { ArrowLeft: [0, -1, 0], ArrowRight: [0, 1, 0], ArrowDown: [1, 0, 0], ArrowUp: [-1, 0, 0], PageDown: [0, 0, -1], PageUp: [0, 0, 1] };
  surface.addEventListener("keydown", event => {
    const step = KEYS[event.key];
    if (!step || state.link === null || described.links[state.link].joint) return;
    event.preventDefault();
    page.leavePath();
    if (event.shiftKey) turn(state.link, TURNS[event.key], Math.PI / 60, centreOf(state.link));
    else shift(state.link, step.map(x => 0.005 * x));
  });
  new ResizeObserver(() => { state.dirty = true; }).observe(surface);
}

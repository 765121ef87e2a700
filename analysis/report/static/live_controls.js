"use strict";
// The controls: sliders of links and joints, boundary elements on request, whether a target floats, and covers of sensors.

/** Makes the controls. Functions of other parts that they call are those of `page`. */
function makeControls(page) {
  const { data, byId, element, scene, described, roles, view, state, readings, links, setLink, whole, extent, trace, along } = page;
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
        state.changed = !isNow || state.cover > 0;
        state.reference = null;
        along.clear();
        trace.length = 0;
        page.prepare();
      });
      group.append(button);
    });
    byId("floating").append(group);
  });

  // The readings of a sensor that is driven itself, with a guard driven like it and with the guard grounded.
  const isGuard = name => roles.objects[name] && roles.objects[name].potential === "electrode";
  described.sensors.forEach(({ name }) => {
    const own = [...readings.keys()].filter(n => readings[n].sense === name && readings[n].drive.includes(name));
    const pair = [own.find(n => readings[n].drive.some(isGuard)), own.find(n => !readings[n].drive.some(isGuard))];
    if (pair.includes(undefined)) return;
    const group = element("div", "group");
    group.setAttribute("role", "group");
    group.append(element("span", "name", `Guard of ${name} is`));
    pair.forEach((n, k) => {
      const button = element("button", "", ["driven", "grounded"][k]);
      Object.assign(button, { type: "button", title: `Shows the reading “${readings[n].name}”, which drives ${readings[n].drive.join(", ")}; all else is grounded.` });
      button.dataset.reading = n;
      button.addEventListener("click", () => page.choose(n));
      group.append(button);
    });
    byId("floating").append(group);
  });

  // Covers of all sensors. They are bodies of the scene, so the page is read anew with another scene.
  if (data.covers.length) {
    const group = element("div", "group");
    group.setAttribute("role", "group");
    group.append(element("span", "name", "Cover of the sensors"));
    ["none", ...data.covers.map(cover => cover.name)].forEach((name, n) => {
      const button = element("button", "", name);
      button.type = "button";
      button.setAttribute("aria-pressed", n === state.cover);
      button.addEventListener("click", () => {
        history.replaceState({ cover: n, links, joints: described.links.map(link => link.at ?? null) }, "");
        location.reload();
      });
      group.append(button);
    });
    byId("floating").append(group);
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

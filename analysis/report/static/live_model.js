"use strict";
// The library in the page: a scene that moves and its answers, as JSON of the same form as that of the command `fringe`; where its links are.
// The picture: the bodies coloured by the charge per area, labels, and the distance sensors.

/** Opens a scene. `files` are those that it names: their paths beside the scene, and their contents in base64. */
async function openScene(text, files) {
  const library = await fringeLibrary();
  const folder = "/scene";
  library.FS.mkdir(folder);
  for (const [name, contents] of Object.entries(files)) {
    const parts = (name.startsWith("/") ? name : `${folder}/${name}`).split("/"), file = parts.pop();
    const place = parts.reduce((above, part) => {
      const here = part === ".." ? above.slice(0, above.lastIndexOf("/")) : part && part !== "." ? `${above}/${part}` : above;
      if (here && !library.FS.analyzePath(here).exists) library.FS.mkdir(here);
      return here;
    }, "");
    library.FS.writeFile(`${place}/${file}`, Uint8Array.from(atob(contents), c => c.charCodeAt(0)));
  }
  const call = (name, ...kinds) => library.cwrap(`fringe_${name}`, "string", ["number", ...kinds]);
  const page = library.cwrap("fringe_open", "number", ["string", "string"])(text, folder);
  const poses = library.cwrap("fringe_poses", "number", ["number"]), densities = library.cwrap("fringe_densities", "number", ["number", "number"]);
  const described = JSON.parse(call("describe")(page));
  if (described.refused) throw new Error(described.refused);
  const triangles = described.objects.reduce((sum, body) => sum + body.triangles.length / 9, 0);

  const capacitance = call("capacitance", "string", "number"), setPose = call("set_pose", ...Array(8).fill("number"));
  const setJoint = call("set_joint", "string", "number"), setFloating = call("set_floating", "string", "number", "number");
  const collisions = call("collisions"), distances = call("distances");
  /** Returns an action's answer; an Error with the reason if it is refused. */
  const answer = text => {
    const read = JSON.parse(text);
    if (read.refused) throw new Error(read.refused);
    return read;
  };
  return {
    described,
    setPose: (link, translation, quaternion) => answer(setPose(page, link, ...translation, ...quaternion)),
    setJoint: (joint, position) => answer(setJoint(page, joint, position)),
    setFloating: (object, isFloating, toGround) => answer(setFloating(page, object, isFloating ? 1 : 0, toGround)),
    /** The answer of a method, or {refused: the reason}. */
    capacitance: (method, rtol = 0) => JSON.parse(capacitance(page, method, rtol)),
    collisions: () => JSON.parse(collisions(page)),
    distances: () => JSON.parse(distances(page)),
    /** The pose of every link in the world: the rows of (R | t). */
    poses: () => {
      const at = poses(page) / 8;
      return described.links.map((_, n) => Array.from(library.HEAPF64.subarray(at + 12 * n, at + 12 * n + 12)));
    },
    /** Charge per area of every drawn triangle of the objects by the model, C/m² at 1 V on a sensor; null if it is refused. */
    densities: sensor => {
      const at = densities(page, sensor);
      return at ? library.HEAPF32.subarray(at / 4, at / 4 + triangles) : null;
    },
  };
}

/** Moves the links of a scene. What is moved is noted in `state`. */
function makeMotion({ scene, described, roles, state }) {
  state.poses = scene.poses();
  const links = described.links.map(link => ({ translation: [...link.translation], quaternion: [...link.quaternion] }));

  function firstLink() {
    const isLast = link => described.links.every(other => other.parent !== link);
    const carriers = described.objects.filter(body => body.link !== null && isLast(body.link));
    const carrier = carriers.find(body => roles.objects[body.name].target) || carriers[0];
    return carrier ? carrier.link : described.links.length ? described.links.length - 1 : null;
  }
  const poseOf = link => (link === null ? space.IDENTITY : state.poses[link]);
  const parentPose = link => poseOf(described.links[link].parent);

  function setLink(link, translation, quaternion) {
    links[link] = { translation, quaternion };
    scene.setPose(link, translation, quaternion);
    state.poses = scene.poses();
    state.reference = null;
    state.dirty = true;
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

  function boxOf(bodies) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const body of bodies)
      for (let k = 0; k < body.triangles.length; k += 3)
        space.placed(poseOf(body.link), body.triangles.slice(k, k + 3)).forEach((x, i) => { low[i] = Math.min(low[i], x); high[i] = Math.max(high[i], x); });
    return [low, high];
  }
  const bodies = [...described.objects, ...described.sensors], whole = boxOf(bodies);
  const extent = Math.hypot(...whole[0].map((x, i) => whole[1][i] - x));
  const centreOf = link => { const [low, high] = boxOf(bodies.filter(body => body.link === link)); return Number.isFinite(low[0]) ? low.map((x, i) => (x + high[i]) / 2) : [3, 7, 11].map(k => state.poses[link][k]); };
  return { links, firstLink, poseOf, setLink, shift, turn, bodies, whole, extent, centreOf };
}

/** Draws the scene. */
function makePicture({ scene, described, roles, view, state, readings, poseOf, bodies }) {
  const theme = {};
  function readTheme() {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["ink", "soft", "line", "paper", "model", "formula", "reduced", "reference", "body", "plate", "seen", "bad"]) theme[name] = style.getPropertyValue(`--${name}`).trim();
    theme.rgb = text => { const n = parseInt(text.slice(1), 16); return [n >> 16, (n >> 8) & 255, n & 255].map(x => x / 255); };
    theme.bodyColour = theme.rgb(theme.body);
    theme.plateColour = theme.rgb(theme.plate);
  }
  readTheme();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readTheme(); state.dirty = true; });

  // The colours span two powers of ten below the largest charge per area when the reading was chosen; contact is beyond.
  const DECADES = 2;
  let brightest = null;
  const sensorOf = reading => Math.max(0, described.sensors.findIndex(sensor => sensor.name === readings[reading].sense));
  const starts = described.objects.reduce((all, body) => [...all, all[all.length - 1] + body.triangles.length / 9], [0]);

  function colour() {
    if (!view) return;
    const densities = described.sensors.length && !state.answers.model.refused ? scene.densities(sensorOf(state.reading)) : null;
    if (!densities) {
      described.objects.forEach((body, number) => view.setShares(number, new Float32Array(starts[number + 1] - starts[number]).fill(-1)));
      return;
    }
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

  function colliding() {
    const worst = new Set();
    for (const { a, b, status } of state.geometry.pairs) if (status === "collision") { worst.add(a); worst.add(b); }
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
  function draw(isMoving) {
    if (!view) return;
    view.resize(isMoving);
    const worst = colliding(), count = described.objects.length;
    view.drawBodies((body, number) => ({ colour: number < count && roles.objects[body.name].potential !== "electrode" ? theme.bodyColour : theme.plateColour, hatched: number >= count || worst.has(body.name) || roles.objects[body.name].potential === "electrode" }), poseOf);
    view.clearOverlay();
    const text = { colour: theme.ink, ground: theme.paper };
    described.distance_sensors.forEach((eye, n) => {
      const pose = poseOf(eye.link), { apex, rim } = coneRim(eye, pose), reading = state.geometry.eyes[n];
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

  function hover(at) {
    const place = byId("hover"), under = place && view.hit(...at, poseOf);
    if (!place) return;
    const body = under && bodies[under.body], densities = under && under.body < described.objects.length && described.sensors.length ? scene.densities(sensorOf(state.reading)) : null;
    place.textContent = !body ? "" : densities ? `here on ${body.name}: ${+(densities[starts[under.body] + under.triangle] * 1e12).toPrecision(3)} pC/m²` : `here: ${body.name}`;
  }
  /** Chooses the reading whose sensor is driven. */
  function recolour() { brightest = null; state.dirty = true; }
  return { theme, colour, draw, hover, recolour };
}

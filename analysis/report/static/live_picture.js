"use strict";
// The picture: the bodies coloured by the charge per area, labels, and the distance sensors.

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

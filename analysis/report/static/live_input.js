"use strict";
// What moves links: the buttons of paths, and mouse, touch and keyboard on the picture.

/** Makes the buttons of the paths. */
function makePaths(page) {
  const { data, byId, element, state, links, setLink, along } = page;

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
  const { byId, described, view, state, poseOf, shift, turn, bodies, centreOf, hover } = page;

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

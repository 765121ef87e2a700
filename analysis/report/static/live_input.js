"use strict";
// Mouse, touch and keyboard on the picture.

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

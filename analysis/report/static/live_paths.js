"use strict";
// Paths: their buttons, and the motion of the links along them.

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

"use strict";
// Where links are, how they are moved and turned, and the extent of the scene.

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

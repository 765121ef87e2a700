"use strict";
// The library in the page: a scene that moves and its answers, as JSON of the same form as that of the command `fringe`; where its links are.

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

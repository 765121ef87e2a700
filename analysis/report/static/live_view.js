"use strict";
// Draws bodies by WebGL, and lines, labels and cones above them; finds what is under the pointer.

/** Five colours from dark to light (light to dark on a light page): brightness alone tells them apart. */
const SCALE = [[0.00, 0.13, 0.30], [0.26, 0.30, 0.42], [0.49, 0.48, 0.47], [0.74, 0.68, 0.44], [1.00, 0.92, 0.28]];

/** Tells whether WebGL is drawn without a graphics card: smooth edges, or every pixel of what moves, would then cost as much as everything else in a frame. */
function isDrawnByProcessor() {
  const probe = document.createElement("canvas").getContext("webgl"), more = probe && probe.getExtension("WEBGL_debug_renderer_info");
  const name = more ? probe.getParameter(more.UNMASKED_RENDERER_WEBGL) : "";
  if (probe) probe.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

function makeView(surface, overlay) {
  const isSlow = isDrawnByProcessor(), gl = surface.getContext("webgl", { antialias: !isSlow, alpha: true, premultipliedAlpha: false });
  if (!gl) return null;
  const pen = overlay.getContext("2d");
  const camera = { yaw: -0.9, pitch: 0.42, distance: 1, centre: [0, 0, 0] };
  let bodies = [], size = [1, 1], ratio = 1;

  // --- the program ---

  const VERTEX = `
    attribute vec3 position; attribute vec3 normal; attribute float value;
    uniform mat4 view; uniform mat4 pose; varying vec3 facing; varying float share;
    void main() { facing = mat3(pose) * normal; share = value; gl_Position = view * pose * vec4(position, 1.0); }`;
  const FRAGMENT = `
    precision mediump float;
    varying vec3 facing; varying float share;
    uniform vec3 colour; uniform vec3 sun; uniform vec3 scale[5]; uniform float hatched;
    void main() {
      vec3 base = colour;
      if (share >= 0.0) {
        float at = clamp(share, 0.0, 1.0) * 4.0;
        base = mix(scale[0], scale[1], clamp(at, 0.0, 1.0));
        base = mix(base, scale[2], clamp(at - 1.0, 0.0, 1.0));
        base = mix(base, scale[3], clamp(at - 2.0, 0.0, 1.0));
        base = mix(base, scale[4], clamp(at - 3.0, 0.0, 1.0));
      }
      if (hatched > 0.0 && mod(gl_FragCoord.x + gl_FragCoord.y, 9.0) < 2.0) base = base * 0.72;
      gl_FragColor = vec4(base * (0.68 + 0.32 * abs(dot(normalize(facing), sun))), 1.0);
    }`;

  function compiled(kind, source) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  }
  const program = gl.createProgram();
  gl.attachShader(program, compiled(gl.VERTEX_SHADER, VERTEX));
  gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, FRAGMENT));
  ["position", "normal", "value"].forEach((name, at) => gl.bindAttribLocation(program, at, name));
  gl.linkProgram(program);
  gl.useProgram(program);
  const uniform = name => gl.getUniformLocation(program, name);
  const places = { view: uniform("view"), pose: uniform("pose"), colour: uniform("colour"), sun: uniform("sun"), hatched: uniform("hatched") };
  gl.uniform3fv(uniform("scale"), SCALE.flat());
  gl.enable(gl.DEPTH_TEST);

  function filled(numbers, usage) {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, usage);
    return buffer;
  }

  function normals(triangles) {
    const result = new Float32Array(triangles.length);
    for (let t = 0; t < triangles.length; t += 9) {
      const [a, b, c] = [0, 3, 6].map(k => triangles.slice(t + k, t + k + 3));
      const normal = space.unit(space.cross(space.sum(b, -1, a), space.sum(c, -1, a)));
      for (let k = 0; k < 9; ++k) result[t + k] = normal[k % 3];
    }
    return result;
  }

  /** Takes the bodies to be drawn: {name, link, triangles (numbers in m, in the link's frame)}. */
  function setBodies(given) {
    bodies = given.map(body => ({
      ...body, count: body.triangles.length / 3,
      values: new Float32Array(body.triangles.length / 3).fill(-1),
      position: filled(new Float32Array(body.triangles), gl.STATIC_DRAW),
      normal: filled(normals(body.triangles), gl.STATIC_DRAW),
      value: filled(new Float32Array(body.triangles.length / 3).fill(-1), gl.DYNAMIC_DRAW),
    }));
  }

  /** Colours the triangles of a body: shares in [0, 1] of the scale, or −1 for the body's own colour. */
  function setShares(number, shares) {
    const body = bodies[number];
    for (let t = 0; t < shares.length; ++t) body.values.fill(shares[t], 3 * t, 3 * t + 3);
    gl.bindBuffer(gl.ARRAY_BUFFER, body.value);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, body.values);
  }

  // --- the camera ---

  const NARROW = 0.6;  // rad, half of the angle of view

  function axes() {
    const [c, s] = [Math.cos(camera.pitch), Math.sin(camera.pitch)];
    const back = [c * Math.cos(camera.yaw), c * Math.sin(camera.yaw), s];
    const right = [-Math.sin(camera.yaw), Math.cos(camera.yaw), 0];
    return { right, up: space.cross(back, right), back, eye: space.sum(camera.centre, camera.distance, back) };
  }

  function viewMatrix() {
    const { right, up, back, eye } = axes(), f = 1 / Math.tan(NARROW / 2), aspect = size[0] / size[1];
    const near = camera.distance / 50, far = camera.distance * 20, depth = (far + near) / (near - far), shift = 2 * far * near / (near - far);
    const rows = [right.map(x => x * f / Math.max(aspect, 1)), up.map(x => x * f * Math.min(aspect, 1)), back];
    const offsets = rows.map(row => -space.dot(row, eye));
    return [0, 1, 2].flatMap(i => [rows[0][i], rows[1][i], depth * back[i], -back[i]])
      .concat([offsets[0], offsets[1], depth * offsets[2] + shift, -offsets[2]]);
  }

  /** The pixel of a point in the world; null behind the eye. */
  function project(p) {
    const m = viewMatrix(), w = m[3] * p[0] + m[7] * p[1] + m[11] * p[2] + m[15];
    if (!(w > 0)) return null;
    const [x, y] = [0, 1].map(r => (m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]) / w);
    return [(x + 1) / 2 * size[0], (1 - y) / 2 * size[1]];
  }

  /** The line of sight through a pixel: {from, along}, not of length 1. */
  function sight(x, y) {
    const { right, up, back, eye } = axes(), t = Math.tan(NARROW / 2), aspect = size[0] / size[1];
    const [u, v] = [2 * x / size[0] - 1, 1 - 2 * y / size[1]];
    const along = space.sum(space.sum(back.map(b => -b), u * t * Math.max(aspect, 1), right), v * t / Math.min(aspect, 1), up);
    return { from: eye, along };
  }

  /** The nearest triangle at a pixel: {body, triangle, point in the world}, or null. */
  function hit(x, y, poses) {
    const { from, along } = sight(x, y);
    let best = null, nearest = Infinity;
    bodies.forEach((body, number) => {
      const m = poses(body.link), start = space.turnedBack(m, space.sum(from, -1, [m[3], m[7], m[11]])), way = space.turnedBack(m, along);
      const t = body.triangles;
      for (let k = 0; k < t.length; k += 9) {
        const e = [t[k + 3] - t[k], t[k + 4] - t[k + 1], t[k + 5] - t[k + 2]], f = [t[k + 6] - t[k], t[k + 7] - t[k + 1], t[k + 8] - t[k + 2]];
        const across = space.cross(way, f), volume = space.dot(e, across);
        if (Math.abs(volume) < 1e-300) continue;
        const away = [start[0] - t[k], start[1] - t[k + 1], start[2] - t[k + 2]], u = space.dot(away, across) / volume;
        if (u < 0 || u > 1) continue;
        const other = space.cross(away, e), v = space.dot(way, other) / volume, far = space.dot(f, other) / volume;
        if (v >= 0 && u + v <= 1 && far > 0 && far < nearest) { nearest = far; best = { body: number, triangle: k / 9 }; }
      }
    });
    return best && { ...best, point: space.sum(from, nearest, along) };
  }

  /** Moves the camera so that a box, [low, high], fills the picture. */
  function frame([low, high]) {
    camera.centre = low.map((x, i) => (x + high[i]) / 2);
    camera.distance = 0.62 * Math.hypot(...low.map((x, i) => high[i] - x)) / Math.tan(NARROW / 2);
  }

  // --- the picture ---

  /** Fits the pictures to their places on the page. Without a graphics card, bodies that move have half as many pixels each way. */
  function resize(isMoving) {
    const box = surface.getBoundingClientRect();
    ratio = Math.min(window.devicePixelRatio || 1, 2);
    size = [Math.max(box.width, 1), Math.max(box.height, 1)];
    for (const [canvas, share] of [[surface, isSlow && isMoving ? 0.5 : 1], [overlay, 1]]) {
      const wanted = size.map(s => Math.round(s * ratio * share));
      if (canvas.width !== wanted[0]) canvas.width = wanted[0];
      if (canvas.height !== wanted[1]) canvas.height = wanted[1];
    }
  }

  /** Draws all bodies. `style` gives each {colour: [r, g, b], hatched}, `poses` the pose of a link. */
  function drawBodies(style, poses) {
    gl.viewport(0, 0, surface.width, surface.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(places.view, false, viewMatrix());
    const { back, up } = axes();
    gl.uniform3fv(places.sun, space.unit(space.sum(back, 0.6, up)));
    bodies.forEach((body, number) => {
      const m = poses(body.link), { colour, hatched } = style(body, number);
      gl.uniformMatrix4fv(places.pose, false, [m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0, m[3], m[7], m[11], 1]);
      gl.uniform3fv(places.colour, colour);
      gl.uniform1f(places.hatched, hatched ? 1 : 0);
      [["position", 3], ["normal", 3], ["value", 1]].forEach(([name, count], at) => {
        gl.bindBuffer(gl.ARRAY_BUFFER, body[name]);
        gl.enableVertexAttribArray(at);
        gl.vertexAttribPointer(at, count, gl.FLOAT, false, 0, 0);
      });
      gl.drawArrays(gl.TRIANGLES, 0, body.count);
    });
  }

  function clearOverlay() {
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, size[0], size[1]);
  }

  /** Draws a line through points of the world. */
  function line(points, { colour, width = 2, dash = [] }) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.setLineDash(dash);
    pen.beginPath();
    points.forEach((point, k) => {
      const at = project(point);
      if (at) (k ? pen.lineTo(...at) : pen.moveTo(...at));
    });
    pen.stroke();
    pen.setLineDash([]);
  }

  /** Writes a text beside a point of the world, on a ground that keeps it readable. */
  function label(point, text, { colour, ground, bold = false }) {
    const at = project(point);
    if (!at) return;
    pen.font = `${bold ? 600 : 400} 13px system-ui, sans-serif`;
    const width = pen.measureText(text).width, x = Math.max(4, Math.min(at[0] + 7, size[0] - width - 8)), y = Math.max(16, Math.min(at[1] - 7, size[1] - 6));
    pen.fillStyle = ground;
    pen.globalAlpha = 0.8;
    pen.fillRect(x - 4, y - 13, width + 8, 18);
    pen.globalAlpha = 1;
    pen.fillStyle = colour;
    pen.fillText(text, x, y);
  }

  return { camera, axes, setBodies, setShares, resize, frame, hit, sight, project, drawBodies, clearOverlay, line, label };
}

"use strict";
// The scripts of several pages share these functions: vectors and poses, elements of HTML, and scenes that plotly draws.

/** Vectors and poses. A pose is the rows of (R | t), 12 numbers from a link's frame to the world. */
const space = {
  IDENTITY: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0],
  placed: (m, p) => [0, 4, 8].map(r => m[r] * p[0] + m[r + 1] * p[1] + m[r + 2] * p[2] + m[r + 3]),
  turned: (m, p) => [0, 4, 8].map(r => m[r] * p[0] + m[r + 1] * p[1] + m[r + 2] * p[2]),
  turnedBack: (m, p) => [0, 1, 2].map(c => m[c] * p[0] + m[4 + c] * p[1] + m[8 + c] * p[2]),
  sum: (p, factor, q) => p.map((x, i) => x + factor * q[i]),
  dot: (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2],
  cross: (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]],
  unit: p => { const length = Math.hypot(...p) || 1; return p.map(x => x / length); },
  /** The product of two quaternions (w, x, y, z). */
  product: (a, b) => [a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
                      a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]],
  turn: (axis, angle) => { const u = space.unit(axis), s = Math.sin(angle / 2); return [Math.cos(angle / 2), s * u[0], s * u[1], s * u[2]]; },
};

const byId = id => document.getElementById(id);

/** Makes an element of HTML. */
function element(tag, className, text) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
}

/** Makes the trace by which plotly draws a body of {name, faces, vertices}. */
function solid(body, colour, more) {
  const [i, j, k] = [0, 1, 2].map(corner => body.faces.map(face => face[corner]));
  const [x, y, z] = [0, 1, 2].map(axis => body.vertices.map(p => p[axis]));
  return {
    type: "mesh3d", i, j, k, x, y, z, color: colour, name: body.name, hoverinfo: "name", flatshading: true,
    lighting: { ambient: 0.62, diffuse: 0.55, specular: 0.08, roughness: 0.7, fresnel: 0.05, vertexnormalsepsilon: 0, facenormalsepsilon: 0 },
    lightposition: { x: -2000, y: -4000, z: 9000 }, hoverlabel: { namelength: -1 }, showlegend: false, ...more,
  };
}

/** How plotly draws a scene on white. */
const INK = "#24292f", SENSOR = "#0072b2", AXIS = { showbackground: false, gridcolor: "#e4e7eb", color: "#57606a", nticks: 5, tickfont: { size: 10 } };
const FONT = { family: "system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', sans-serif", size: 12, color: INK };
const QUIET = { responsive: true, displaylogo: false, displayModeBar: false };

/** Draws a scene by plotly, and as large as its place is from then on; `then` is called when it is drawn. */
function drawScene(plot, traces, scene, then) {
  const layout = { margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false, paper_bgcolor: "white", uirevision: "kept", font: FONT, scene: { dragmode: "turntable", ...scene } };
  Plotly.newPlot(plot, traces, layout, { ...QUIET, scrollZoom: true }).then(() => {
    then();
    new ResizeObserver(() => Plotly.Plots.resize(plot)).observe(plot);
  });
}

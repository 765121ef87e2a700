"use strict";
// Draws a machine and, for a probe, a reading and a threshold, the points from which the probe is noticed.
(() => {
  const data = JSON.parse(byId("data").textContent);
  const BODY = "#c3c9d0", BLIND = "#d0342c";
  const places = data.points.length;
  const unpacked = data.distances.map(text => {
    const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
    return new Uint16Array(bytes.buffer);
  });

  const centimetres = metres => `${(100 * metres).toPrecision(3)} cm`;

  /** The distances at all places for what the controls say; null where the probe cannot be held. */
  function chosen() {
    const table = unpacked[Number(byId("probe").value) * data.readings + Number(byId("reading").value)];
    const step = Number(byId("threshold").value);
    return Array.from(table.subarray(step * places, (step + 1) * places), d => (d === data.blocked ? null : d / data.per_metre));
  }

  function points(distances, which) {
    const found = { x: [], y: [], z: [], text: [], value: [] };
    distances.forEach((distance, n) => {
      if (distance === null || !which(distance)) return;
      ["x", "y", "z"].forEach((axis, k) => found[axis].push(data.points[n][k] + distance * data.normals[n][k]));
      found.value.push(100 * distance);
      found.text.push(`${data.owners[n]}: ${distance ? centimetres(distance) : "blind"}`);
    });
    return found;
  }

  const plot = byId("scene");
  const bodies = data.bodies.map(body => solid(body, data.sensors.includes(body.name) ? SENSOR : BODY));

  function draw() {
    const distances = chosen();
    const seen = points(distances, d => d > 0), blind = byId("blind").checked ? points(distances, d => d === 0) : points([], () => false);
    Plotly.restyle(plot, { x: [seen.x, blind.x], y: [seen.y, blind.y], z: [seen.z, blind.z], text: [seen.text, blind.text] }, [bodies.length, bodies.length + 1]);
    Plotly.restyle(plot, { "marker.color": [seen.value] }, [bodies.length]);
    const held = distances.filter(d => d !== null), sorted = held.filter(d => d > 0).sort((a, b) => a - b);
    const factor = data.factors[Number(byId("threshold").value)], own = data.thresholds[Number(byId("reading").value)];
    const threshold = own === null ? `${factor.toPrecision(3)} times each reading's threshold` : `${(own * factor * 1e15).toPrecision(3)} fF`;
    const median = sorted.length ? `, from ${centimetres(sorted[sorted.length >> 1])} in the median` : "";
    byId("told").textContent = `Threshold: ${threshold}. Noticed at ${sorted.length} of the ${held.length} places drawn${median}.`;
  }

  const marks = (colour, more) => ({ type: "scatter3d", mode: "markers", x: [], y: [], z: [], text: [], hoverinfo: "text", showlegend: false, ...more, marker: { size: 3, ...colour } });
  const traces = [
    ...bodies,
    marks({ color: [], colorscale: "Viridis", cmin: 0, cmax: 60, colorbar: { title: { text: "cm" }, thickness: 12, len: 0.6 }, opacity: 0.85 }),
    marks({ color: BLIND, size: 2.5 }),
  ];
  const axis = name => ({ ...AXIS, title: { text: `${name} (m)`, font: { size: 11 } } });
  for (const name of ["probe", "reading", "threshold", "blind"]) byId(name).addEventListener("input", draw);
  drawScene(plot, traces, { xaxis: axis("x"), yaxis: axis("y"), zaxis: axis("z"), aspectmode: "data", camera: { eye: { x: 0.9, y: -1.5, z: 0.6 } } }, draw);
})();

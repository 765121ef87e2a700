"use strict";
// Plots the changes of the readings along the motion, with a line at the frame that is shown.

/** Draws a plot for each reading; a click on one calls `go` with the frame. Returns what marks a frame in all of them. */
function makeReadings(data, go) {
  const place = byId("along"), PICO = 1e12;
  if (!place) return { mark: () => {} };
  const along = JSON.parse(byId("along-data").textContent);
  const STYLE = {
    model: { color: "#0072b2", dash: "solid" }, formula: { color: "#c75b00", dash: "dash" },
    reduced: { color: "#24292f", dash: "dot" }, "boundary elements": { color: "#007a57", symbol: "square-open" },
  };
  const last = data.frames.length - 1, keys = data.frames.map((_, n) => n).filter(n => n % data.every === 0);
  const sizes = values => values.map(value => (value ? Math.abs(value) * PICO : null));

  function trace(method, reading) {
    const { color, dash, symbol } = STYLE[method.name], values = method.changes[reading.name] || [], errors = method.errors[reading.name] || [];
    const isKnown = errors.some(error => error !== null), bars = { type: "data", array: sizes(errors), color, thickness: 1, width: symbol ? 4 : 0, visible: isKnown };
    // Bars at every frame would cover the line.
    if (!symbol) bars.array = bars.array.map((error, n) => (n % data.every === 0 ? error : null));
    return {
      name: method.name, x: method.frames, y: sizes(values), mode: symbol ? "markers" : "lines", error_y: bars,
      line: { color, dash, width: 2 }, marker: { color, symbol, size: 8 },
      text: method.frames.map(n => data.frames[n].name), hovertemplate: "%{text}: %{y:.4g} pF<extra>%{fullData.name}</extra>",
    };
  }
  const cursor = frame => ({ type: "line", xref: "x", yref: "paper", x0: frame, x1: frame, y0: 0, y1: 1, line: { color: "#57606a", width: 1.5 } });
  const level = reading => ({ type: "line", xref: "paper", yref: "y", x0: 0, x1: 1, y0: reading.threshold * PICO, y1: reading.threshold * PICO, line: { color: "#24292f", width: 1.5, dash: "dash" } });
  const known = along.methods.filter(method => !method.refused), every = Math.ceil(keys.length / 8);
  const plots = along.readings.map(reading => {
    const plot = element("div", "plot"), shapes = reading.threshold ? [level(reading)] : [];
    place.append(plot);
    Plotly.newPlot(plot, known.map(method => trace(method, reading)), {
      title: { text: reading.name, font: { size: 14 }, x: 0.02, xanchor: "left" }, height: 300, margin: { l: 62, r: 12, t: 34, b: 40 },
      font: FONT, paper_bgcolor: "white", plot_bgcolor: "white",
      xaxis: { range: [-0.02 * last, 1.02 * last], tickvals: keys.filter((_, n) => n % every === 0), ticktext: keys.filter((_, n) => n % every === 0).map(n => data.frames[n].name), gridcolor: "#e4e7eb" },
      yaxis: { type: "log", title: { text: "size of the change, pF" }, gridcolor: "#e4e7eb", exponentformat: "none", nticks: 6 },
      legend: { orientation: "h", x: 1, xanchor: "right", y: 1.02, yanchor: "bottom" }, shapes: [cursor(0), ...shapes],
    }, QUIET);
    plot.on("plotly_click", event => go(event.points[0].x));
    return plot;
  });
  for (const method of along.methods.filter(each => each.refused)) {
    place.append(element("p", "soft", `${method.name}: ${method.refused}.`));
  }
  return { mark: frame => plots.forEach(plot => Plotly.relayout(plot, { "shapes[0].x0": frame, "shapes[0].x1": frame })) };
}

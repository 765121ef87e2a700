// Figures follow the reader's dark theme: each colour that is meant for a white page has one for a black page.
const dark = matchMedia("(prefers-color-scheme: dark)");
const inDark = { "#24292f": "#e6edf3", "#0072B2": "#3d9be9", "#000000": "#e6edf3", "white": "#0d1117", "#e4e7eb": "#30363d", "#9aa4ae": "#6e7681" };
const themed = part =>
  typeof part === "string" ? inDark[part] ?? part
  : Array.isArray(part) ? part.map(themed)
  : part?.constructor === Object ? Object.fromEntries(Object.entries(part).map(([key, value]) => [key, themed(value)]))
  : part;
const drawInLight = window.Plotly?.newPlot;
if (dark.matches && window.Plotly) {
  const edges = { gridcolor: "#30363d", color: "#e6edf3" };
  for (const draw of ["newPlot", "react"]) {
    const inLight = Plotly[draw];
    Plotly[draw] = (element, data, layout, config) => {
      const scene = layout.scene && { xaxis: edges, yaxis: edges, zaxis: edges };
      const shown = themed(layout);
      for (const name in scene) shown.scene[name] = { ...scene[name], ...shown.scene[name] };
      const drawn = inLight(element, themed(data), shown, config);
      (typeof element === "string" ? document.getElementById(element) : element).light = [data, layout, config];
      return drawn;
    };
  }
}
dark.addEventListener("change", () => location.reload());

// Paper is white and narrower than most screens, and figures know their width only when they are drawn.
addEventListener("beforeprint", () => document.querySelectorAll(".js-plotly-plot").forEach(plot => {
  if (plot.light) drawInLight(plot, ...plot.light);
  Plotly.Plots.resize(plot);
}));

// A point that stands for a case carries the case's id, one of a page of set-ups the set-up's name.
addEventListener("DOMContentLoaded", () => document.querySelectorAll("[data-cases] .js-plotly-plot").forEach(plot =>
  plot.on("plotly_click", event => {
    const id = event.points[0].customdata;
    const place = plot.closest("[data-cases]").dataset;
    if (place.setUps && /^[0-9A-Za-z_-]+$/.test(id)) location.href = `${place.setUps}#${id}`;
    else if (/^[0-9a-f]{16}$/.test(id)) location.href = `${place.cases}/${id}/case.html`;
  })));

// Figures know their width only when they are drawn, and paper is narrower than most screens.
addEventListener("beforeprint", () => document.querySelectorAll(".js-plotly-plot").forEach(p => Plotly.Plots.resize(p)));

// A point that stands for a case carries the case's id, one of a page of set-ups the set-up's name.
addEventListener("DOMContentLoaded", () => document.querySelectorAll("[data-cases] .js-plotly-plot").forEach(plot =>
  plot.on("plotly_click", event => {
    const id = event.points[0].customdata;
    const place = plot.closest("[data-cases]").dataset;
    if (place.setUps && /^[0-9A-Za-z_-]+$/.test(id)) location.href = `${place.setUps}#${id}`;
    else if (/^[0-9a-f]{16}$/.test(id)) location.href = `${place.cases}/${id}/case.html`;
  })));

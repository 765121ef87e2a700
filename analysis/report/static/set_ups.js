"use strict";
// Shows the set-up that the address names after the #, or else the first.
(() => {
  const data = JSON.parse(byId("set-ups").textContent);
  const places = new Map(data.setUps.map((each, index) => [each.name, index]));
  const textColumns = [...document.querySelectorAll("th")].map(cell => cell.className);

  // Each triangle has its own vertices: with shared ones plotly would shade edges as if they were round.
  function mesh(body, look) {
    const corners = body.triangles.flat().map(number => body.vertices[number]);
    const every = step => body.triangles.map((_, index) => 3 * index + step);
    const [x, y, z] = [0, 1, 2].map(axis => corners.map(corner => corner[axis]));
    return { ...look, x, y, z, i: every(0), j: every(1), k: every(2) };
  }

  function draw(setUp) {
    const [x, y, z] = setUp.aspect;
    const layout = structuredClone(data.layout);
    layout.scene.aspectratio = { x, y, z };
    layout.height = byId("scene").clientHeight;
    const meshes = setUp.bodies.map((body, index) => mesh(body, data.looks[Math.min(index, data.looks.length - 1)]));
    Plotly.react("scene", meshes, layout, QUIET);
  }

  function commands(setUp) {
    const file = `${setUp.name}.toml`;
    const asked = data.commands.map(command => command.replace("FILE", file));
    return [`cat >${file} <<'END'`, (data.heads[setUp.head] + setUp.scene).trimEnd(), "END", ...asked].join("\n");
  }

  function step(link, index) {
    const there = index >= 0 && index < data.setUps.length;
    byId(link).hidden = !there;
    if (there) byId(link).href = `#${data.setUps[index].name}`;
  }

  function show() {
    const index = places.get(decodeURIComponent(location.hash.slice(1))) ?? 0;
    const setUp = data.setUps[index];
    document.title = `${setUp.family} ${setUp.name}`;
    byId("family").textContent = setUp.family;
    byId("name").textContent = setUp.name;
    byId("description").textContent = setUp.description;
    byId("choice").value = setUp.name;
    byId("findings").replaceChildren(...setUp.findings.map(text => element("p", "finding", text)));
    const rows = setUp.rows.map(cells => {
      const row = element("tr");
      row.append(...cells.map((text, column) => element("td", textColumns[column], text)));
      return row;
    });
    document.querySelector("tbody").replaceChildren(...rows);
    byId("commands").textContent = commands(setUp);
    step("previous", index - 1);
    step("next", index + 1);
    draw(setUp);
  }

  byId("choice").append(...data.setUps.map(each => element("option", "", each.name)));
  byId("choice").addEventListener("change", event => { location.hash = event.target.value; });
  addEventListener("hashchange", show);
  show();
})();

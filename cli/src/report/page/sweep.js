// What the shield would have allowed recorded drivers: a heat map for each kind and role.

function sweep({ sweep }) {
  const host = document.getElementById("panels");
  for (const panel of sweep) {
    const figure = document.createElement("figure");
    const caption = document.createElement("figcaption");
    caption.textContent = `${panel.title}, n = ${panel.steps.toLocaleString("en")}`;
    const chart = document.createElement("div");
    figure.append(caption, chart);
    host.append(figure);
    heatMap(chart, panel);
  }
  document.getElementById("sweep").hidden = false;
}

// The deeper the colour, the more is refused: logarithmic, from 1 in 10,000 to 1 in 5.
function depth(share) {
  const refused = Math.min(Math.max(1 - share, 1e-4), 0.2);
  return Math.log(refused / 1e-4) / Math.log(0.2 / 1e-4);
}

function heatMap(host, { cells, bar }) {
  const values = (i) => [...new Set(cells.map((cell) => cell[i]))].sort((a, b) => a - b);
  const [across, up] = [values(0), values(1)];
  const left = 30, bottom = 34, top = 18, width = 520, cell = [(width - left) / across.length, 31];
  const height = top + cell[1] * up.length + bottom;
  const svg = node("svg", { class: "chart", viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": caption(host) }, host);
  const x = (v) => left + across.indexOf(v) * cell[0];
  const y = (v) => height - bottom - (up.indexOf(v) + 1) * cell[1];
  for (const [acceleration, braking, share] of cells) {
    // Up to here the numbers stand out by 4.5:1, in light and in dark.
    const percent = Math.round(62 * depth(share));
    const rect = node("rect", {
      x: x(acceleration) + 1, y: y(braking) + 1, width: cell[0] - 2, height: cell[1] - 2, rx: 3,
      style: `fill:color-mix(in oklab, var(--stop) ${percent}%, var(--lane))`,
    }, svg);
    node("title", {}, rect, `the other accelerates at up to ${acceleration} m/s², the ego brakes at ${braking} m/s²: ${(100 * share).toFixed(3)} % accepted`);
    node("text", {
      class: share < bar ? "cell under" : "cell",
      x: x(acceleration) + cell[0] / 2, y: y(braking) + cell[1] / 2 + 4, "text-anchor": "middle",
    }, svg, (100 * share).toFixed(2));
  }
  // The worst-case contract.
  if (across.includes(3) && up.includes(3)) {
    node("rect", { class: "named", x: x(3) + 1, y: y(3) + 1, width: cell[0] - 2, height: cell[1] - 2, rx: 3 }, svg);
  }
  for (const v of across) node("text", { x: x(v) + cell[0] / 2, y: height - bottom + 15, "text-anchor": "middle" }, svg, v.toFixed(1));
  for (const v of up) node("text", { x: left - 8, y: y(v) + cell[1] / 2 + 4, "text-anchor": "end" }, svg, v.toFixed(0));
  node("text", { x: width, y: height - 4, "text-anchor": "end" }, svg, "hardest acceleration of the other, m/s²");
  node("text", { x: 0, y: 11, "text-anchor": "start" }, svg, "braking of the ego, m/s²");
}

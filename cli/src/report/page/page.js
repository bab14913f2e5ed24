// Fills the page from its data; a section without data stays hidden.

"use strict";

// What a test looks for: whether everything was drawn, and what went wrong.
window.addEventListener("error", (event) => {
  document.documentElement.dataset.error = event.message;
});

const report = JSON.parse(document.getElementById("data").textContent);

document.getElementById("subtitle").textContent = report.subtitle;
document.getElementById("provenance").textContent = report.provenance;
document.getElementById("verdict").textContent = report.verdict;
if (report.rows.length) {
  summary(document.getElementById("summary"), report);
  tables(document.getElementById("tables"), report);
}
if (report.cases.length) player(report);
if (report.gallery.length) gallery(report);
if (report.learning.length) learning(report);
if (report.distributions.length) distributions(report);
if (report.interventions.length) interventions(report);
if (report.sweep.length) sweep(report);
for (const id of ["results", "words"]) document.getElementById(id).hidden = report.rows.length === 0;
document.querySelectorAll("figure").forEach(saveButtons);
document.documentElement.dataset.status = "ready";

function distributions({ distributions, drivers }) {
  const find = (id) => document.getElementById(id);
  const palette = colours(drivers);
  const blocks = groupBy(distributions, (d) => d.block);
  find("block").append(...Array.from(blocks.keys(), (name) => new Option(name, name)));
  const draw = () => {
    const all = blocks.get(find("block").value).filter((d) => d.pet.length + d.ttc.length > 0);
    const block = few(all);
    // Where episodes end with the first arrival, there is no second one to wait for.
    const recorded = block.some((d) => d.pet.length) ? block[0].recorded_pet : [];
    const chart = (host, pick, limit, label, extra) => {
      const series = block.filter((d) => pick(d).length).map((d) => ({
        points: cumulative(pick(d), d.n, limit), colour: palette.get(d.driver), width: d.driver.startsWith("cede") ? 2.6 : 1.6, dash: dashes(d.driver),
      }));
      lineChart(host, { series: [...series, ...extra], x: { label, low: 0, high: limit }, y: { label: "share of episodes", low: 0, high: 1 } });
    };
    const dashed = { colour: "var(--ink)", width: 2, dash: "5 4" };
    find("pet").parentElement.hidden = recorded.length === 0;
    chart(find("pet"), (d) => d.pet, 20, "PET, s", [{ ...dashed, points: cumulative(recorded, recorded.length, 20) }]);
    chart(find("ttc"), (d) => d.ttc, 8, "smallest TTC, s", []);
    legend(find("distribution-legend"), [
      ...(recorded.length ? [{ name: "recorded", colour: "var(--ink)", dash: true }] : []),
      ...block.map((d) => ({ name: d.driver, colour: palette.get(d.driver), dash: dashes(d.driver) !== "none" })),
      ...leftOut(block, all),
    ]);
  };
  const told = distributions.find((d) => d.pet.length > 0);
  if (told) find("block").value = told.block;
  find("block").onchange = draw;
  find("distributions").hidden = false;
  draw();
}

function interventions({ interventions, map, cases }) {
  const find = (id) => document.getElementById(id);
  find("shielded").append(...interventions.map((d, i) => new Option(`${d.driver} (${d.block})`, i)));
  const own = interventions.findIndex((d) => bare(d.driver) === "cede");
  if (own >= 0) find("shielded").value = own;
  find("shield").hidden = false;
  const draw = () => {
    const { points, classes, steps, overruled } = interventions[find("shielded").value];
    const bounds = (pick) => [0, 1].map((i) => pick(...points.map(([p]) => p[i])));
    const view = new View(find("interventions"), bounds(Math.min).map((c) => c - 15), bounds(Math.max).map((c) => c + 15));
    view.clear();
    view.map(map);
    // Without a map the routes of the cases tell where the roads are.
    const routes = map.lanes.length ? [] : cases.flatMap(({ vehicles }) => vehicles.map(({ route }) => route));
    for (const route of routes) view.line(route, css("--line"), 3);
    const tints = new Map(Object.entries(REASONS).map(([name, { tint }]) => [name, css(tint)]));
    for (const [point, reason] of points) view.dot(point, 2.5, tints.get(reason));
    const share = ((100 * overruled) / steps).toFixed(2);
    find("share").textContent = `${overruled} of ${steps} steps (${share} %) were overruled.`;
    legend(find("causes"), classes.map(([name, count]) => ({
      name: `${REASONS[name].words}: ${count} steps`, colour: `var(${REASONS[name].tint})`, dot: true,
    })));
  };
  find("shielded").onchange = draw;
  draw();
}

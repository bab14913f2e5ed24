// The tables of results, one for each split, mode, end and shield.

const COLUMNS = [
  { head: "priority accuracy", key: "priority_accuracy", best: Math.max, show: (r) => share(r.priority_accuracy, r.priority_accuracy_interval) },
  { head: "length error", key: "episode_length_error", best: Math.min, show: (r) => number(r.episode_length_error, 3, r.episode_length_error_interval) },
  { head: "in s", key: "episode_length_error_s", best: Math.min, show: (r) => number(r.episode_length_error_s, 2) },
  { head: "collisions", key: "collisions", bad: (r) => r.collisions > 0, show: (r) => count(r.collisions) },
  { head: "time-outs", key: "time_outs", show: (r) => count(r.time_outs) },
  { head: "position error after 3\u00a0s,\u00a0m", key: "position_rmse_3s", best: Math.min, show: (r) => number(r.position_rmse_3s, 2) },
  { head: "SVO error, rad", key: "svo_rmse", best: Math.min, show: (r) => number(r.svo_rmse, 2) },
  { head: "TTC <\u00a01.5\u00a0s", key: "critical_ttc_share", show: (r) => percent(r.critical_ttc_share) },
  { head: "jerk, m/s³", key: "jerk_rms", show: (r) => number(r.jerk_rms, 1) },
  { head: "shielded steps", key: "shielded_steps", show: (r) => percent(r.shielded_steps) },
];

const known = (value) => value !== null && value !== undefined;

const count = (value) => [known(value) ? String(value) : ""];

function number(value, digits, interval) {
  if (!known(value)) return [""];
  if (!known(interval)) return [value.toFixed(digits)];
  const small = document.createElement("small");
  small.textContent = `[${interval.map((v) => v.toFixed(digits)).join(", ")}]`;
  return [value.toFixed(digits), small];
}

function percent(value) {
  return [known(value) ? `${(100 * value).toFixed(1)} %` : ""];
}

function share(value, interval) {
  if (!known(value)) return [""];
  const text = `${(100 * value).toFixed(1)} %`;
  if (!known(interval)) return [text];
  const small = document.createElement("small");
  small.textContent = `[${interval.map((v) => (100 * v).toFixed(1)).join(", ")}]`;
  return [text, small, whisker(value, interval)];
}

// The interval on a scale from 0 to 1.
function whisker(value, [low, high]) {
  const svg = node("svg", { class: "whisker", width: 64, height: 12, viewBox: "0 0 64 12", "aria-hidden": "true" });
  const x = (v) => 2 + 60 * v;
  node("line", { x1: 2, x2: 62, y1: 6, y2: 6, style: "stroke:var(--line)" }, svg);
  node("line", { x1: x(low), x2: x(high), y1: 6, y2: 6, style: "stroke:var(--soft)", "stroke-width": 2 }, svg);
  node("circle", { cx: x(value), cy: 6, r: 3.5, style: "fill:var(--ink)" }, svg);
  return svg;
}

function blockName(row) {
  const until = row.until === "conflict" ? "until the first arrival" : "until both have left the conflict zone";
  const mode = row.mode === "joint" ? "one driver for both vehicles" : "a driver for one vehicle at a time";
  return `${row.split}: ${row.encounters} encounters, ${mode}, ${until}, shield ${row.shield}`;
}

const blockKey = (row) => [row.split, row.mode, row.until, row.shield].join("/");

// The paper's rows that follow the protocol of a row.
const besides = (paper, row) => paper.filter((p) => p.split === row.split && row.mode === "joint" && row.until === "conflict");

function tables(host, { rows, paper }) {
  const blocks = Map.groupBy ? Map.groupBy(rows, blockKey) : groupBy(rows, blockKey);
  for (const block of blocks.values()) {
    const title = document.createElement("h3");
    title.textContent = blockName(block[0]);
    const beside = besides(paper, block[0]);
    const wrap = document.createElement("div");
    scrollable(wrap, blockName(block[0]));
    wrap.append(table(block, beside));
    host.append(title, wrap);
  }
}

// What the drivers are, in the order of the compact table.
const DRIVERS = {
  cede: "the embedded policy, trained on synthetic traffic alone; after each decision the shield may overrule it",
  replay: "repeats the recorded accelerations: the floor of every measure",
  human: "a model of a driver that yields by time gaps",
  logistic: "a logistic regression on the initial state decides who goes first",
  idm: "the intelligent driver model",
  "rule-of-the-road": "who has the right of way by the map goes first",
  "nearer-first": "who is nearer to the conflict goes first",
  "mean-speed": "everybody drives at the mean speed of the training split",
  "initial-speed": "everybody keeps the speed at the beginning",
};

const SUMMARY = [
  { head: "priority accuracy", key: "priority_accuracy", best: Math.max, show: (r) => share(r.priority_accuracy, r.priority_accuracy_interval).slice(0, 2) },
  { head: "length error", key: "episode_length_error", best: Math.min, show: (r) => number(r.episode_length_error, 3) },
  { head: "collisions", key: "collisions", bad: (r) => r.collisions > 0, show: (r) => count(r.collisions) },
  { head: "time-outs", key: "time_outs", show: (r) => count(r.time_outs) },
];

// One row a driver, without the shield beside behind it, for the first protocol of the page; then the paper's rows, which have no shield.
function summary(host, { rows, paper, seed_note }) {
  const first = rows[0];
  const same = rows.filter((r) => ["site", "split", "mode", "until"].every((key) => r[key] === first[key]));
  const shields = [...new Set(same.map((r) => r.shield))].slice(0, 2);
  const names = [...new Set(same.map((r) => r.driver))];
  const order = Object.keys(DRIVERS);
  const rank = (name) => (order.includes(name) ? order.indexOf(name) : -1);
  names.sort((a, b) => rank(a) - rank(b));
  const of = (driver, shield) => same.find((r) => r.driver === driver && r.shield === shield);
  const table = document.createElement("table");
  table.className = "summary";
  const head = table.createTHead();
  const cell = (row, text, span = 1) => {
    const th = document.createElement("th");
    th.textContent = text;
    th.colSpan = span;
    th.scope = span > 1 ? "colgroup" : "col";
    row.append(th);
  };
  const groups = head.insertRow();
  groups.insertCell();
  for (const shield of shields) cell(groups, shield === "off" ? "without the shield" : `behind the shield${shield === "on" ? "" : ` (${shield})`}`, SUMMARY.length);
  const heads = head.insertRow();
  cell(heads, "driver");
  for (const _ of shields) for (const { head } of SUMMARY) cell(heads, head);
  const body = table.createTBody();
  for (const name of names) {
    const line = body.insertRow();
    line.insertCell().textContent = name;
    for (const shield of shields) {
      const row = of(name, shield);
      for (const column of SUMMARY) {
        const td = line.insertCell();
        if (!row) continue;
        td.append(...column.show(row));
        if (column.bad?.(row)) td.className = "bad";
        const rivals = same.filter((r) => r.shield === shield && r.driver !== "replay" && known(r[column.key])).map((r) => r[column.key]);
        if (column.best && rivals.length > 1 && name !== "replay" && row[column.key] === column.best(...rivals)) td.className = "best";
      }
    }
  }
  for (const row of shields.includes("off") ? besides(paper, first) : []) {
    const line = body.insertRow();
    line.className = "paper";
    line.insertCell().textContent = row.driver;
    for (const shield of shields) for (const column of SUMMARY) line.insertCell().append(...(shield === "off" ? column.show(row) : []));
  }
  const wrap = document.createElement("div");
  scrollable(wrap, "Results by driver");
  wrap.append(table);
  const title = document.createElement("p");
  title.textContent = `${first.split}: ${first.encounters} encounters, ${first.mode === "joint" ? "one driver for both vehicles" : "a driver for one vehicle at a time"}, ${first.until === "conflict" ? "until the first arrival" : "until both have left"}. Best of each column in bold. ${seed_note}`;
  host.append(title, wrap);
  document.getElementById("who").append(...names.filter((name) => DRIVERS[name]).flatMap((name) => {
    const [dt, dd] = ["dt", "dd"].map((tag) => document.createElement(tag));
    dt.textContent = name;
    dd.textContent = DRIVERS[name];
    return [dt, dd];
  }));
}

// A box that scrolls sideways, by the keyboard too.
function scrollable(box, name) {
  box.className = "scroll";
  box.tabIndex = 0;
  box.role = "region";
  box.ariaLabel = name;
}

function groupBy(items, key) {
  const groups = new Map();
  for (const item of items) {
    const k = key(item);
    if (!groups.has(k)) groups.set(k, []);
    groups.get(k).push(item);
  }
  return groups;
}

function table(rows, paper) {
  const table = document.createElement("table");
  const all = [...rows, ...paper];
  const shown = COLUMNS.filter((c) => all.some((r) => known(r[c.key])) && !(c.key === "shielded_steps" && all.every((r) => !r.shielded_steps)));
  const head = table.createTHead().insertRow();
  for (const name of ["driver", "n", ...shown.map((c) => c.head)]) {
    const cell = document.createElement("th");
    cell.textContent = name;
    cell.scope = "col";
    head.append(cell);
  }
  const body = table.createTBody();
  for (const row of all) {
    const line = body.insertRow();
    if (paper.includes(row)) line.className = "paper";
    line.insertCell().textContent = row.driver;
    line.insertCell().textContent = row.n;
    for (const column of shown) {
      const cell = line.insertCell();
      cell.append(...column.show(row));
      if (column.bad?.(row)) cell.className = "bad";
      // The replayed record is the floor, not a competitor.
      const rivals = rows.filter((r) => r.driver !== "replay" && known(r[column.key])).map((r) => r[column.key]);
      if (column.best && rivals.length > 1 && row.driver !== "replay" && row[column.key] === column.best(...rivals)) cell.className = "best";
    }
  }
  return table;
}

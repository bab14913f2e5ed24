// Line charts as SVG, with ticks at round numbers.

const NS = "http://www.w3.org/2000/svg";

function node(name, attributes, parent, text) {
  const element = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  if (parent) parent.appendChild(element);
  return element;
}

function ticks(low, high, about) {
  const rough = (high - low) / about;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].find((m) => m * power >= rough) * power;
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9) + (step / power === 2.5 ? 1 : 0));
  return Array.from({ length: last - first + 1 }, (_, i) => {
    const value = (first + i) * step;
    return { value, label: value.toFixed(digits).replace("-", "−") };
  });
}

// series: [{ points: [[x, y], …], colour, width, dash }]; marks: [{ y, label }]; dots: [{ at: [x, y], colour, title }].
function lineChart(host, { series, x, y, marks = [], dots = [], height = 220 }) {
  const width = 520, left = 46, right = 10, top = 24, bottom = 36;
  const finite = series.flatMap((s) => s.points);
  const range = (axis, i) => {
    const values = finite.map((p) => p[i]);
    if (i === 1) values.push(...marks.map((m) => m.y));
    let low = axis.low ?? Math.min(...values), high = axis.high ?? Math.max(...values);
    if (!(high > low)) [low, high] = [low - 1, low + 1];
    const room = axis.low === undefined ? 0.05 * (high - low) : 0;
    return [low - room, axis.high === undefined && i === 1 ? high + 0.05 * (high - low) : high];
  };
  const [x0, x1] = finite.length ? range(x, 0) : [0, 1];
  const [y0, y1] = finite.length ? range(y, 1) : [0, 1];
  const px = (v) => left + ((v - x0) / (x1 - x0)) * (width - left - right);
  const py = (v) => height - bottom - ((v - y0) / (y1 - y0)) * (height - top - bottom);

  host.replaceChildren();
  const svg = node("svg", { class: "chart", viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": caption(host) }, host);
  for (const t of y.ticks ?? ticks(y0, y1, 5)) {
    node("line", { class: "grid", x1: left, x2: width - right, y1: py(t.value), y2: py(t.value) }, svg);
    node("text", { x: left - 7, y: py(t.value) + 4, "text-anchor": "end" }, svg, t.label);
  }
  for (const t of ticks(x0, x1, 7)) {
    node("line", { class: "grid", x1: px(t.value), x2: px(t.value), y1: height - bottom, y2: height - bottom + 4 }, svg);
    node("text", { x: px(t.value), y: height - bottom + 17, "text-anchor": "middle" }, svg, t.label);
  }
  node("text", { x: width - right, y: height - 5, "text-anchor": "end" }, svg, x.label);
  node("text", { x: left - 40, y: 12, "text-anchor": "start" }, svg, y.label);
  for (const mark of marks) {
    node("line", { class: "mark", x1: left, x2: width - right, y1: py(mark.y), y2: py(mark.y) }, svg);
    node("text", { x: left + 5, y: py(mark.y) - 5, "text-anchor": "start" }, svg, mark.label);
  }
  for (const s of series) {
    const path = s.points.map((p, i) => `${i ? "L" : "M"}${px(p[0]).toFixed(1)} ${py(p[1]).toFixed(1)}`).join("");
    node("path", { d: path, style: `stroke:${s.colour}`, "stroke-width": s.width ?? 1.5, "stroke-dasharray": s.dash ?? "none", "stroke-opacity": s.opacity ?? 1 }, svg);
  }
  for (const dot of dots) {
    const circle = node("circle", { cx: px(dot.at[0]).toFixed(1), cy: py(dot.at[1]).toFixed(1), r: 3.2, style: `fill:${dot.colour}` }, svg);
    node("title", {}, circle, dot.title);
  }
  const cursor = node("line", { class: "cursor", y1: top, y2: height - bottom, visibility: "hidden" }, svg);
  return {
    at(value) {
      const inside = value >= x0 && value <= x1;
      cursor.setAttribute("visibility", inside ? "visible" : "hidden");
      cursor.setAttribute("x1", px(value));
      cursor.setAttribute("x2", px(value));
    },
  };
}

// What a chart is called: the caption of its figure.
function caption(host) {
  const told = host.closest("figure")?.querySelector("figcaption");
  return told ? words(told) : "";
}

// Share of values up to x, as steps; `total` counts also those beyond every x.
function cumulative(values, total, limit) {
  const points = [[0, 0]];
  values.forEach((v, i) => {
    if (v > limit) return;
    points.push([v, i / total], [v, (i + 1) / total]);
  });
  points.push([limit, points[points.length - 1][1]]);
  return points;
}

function legend(host, entries) {
  host.replaceChildren(...entries.map(({ name, colour, dash, dot, chosen }) => {
    const span = document.createElement("span");
    const line = document.createElement("i");
    line.style.borderColor = colour;
    if (dash) line.className = "dashed";
    if (dot) line.className = "dot";
    if (chosen) span.className = "chosen";
    span.append(...(colour ? [line] : []), name);
    return span;
  }));
}

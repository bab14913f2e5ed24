// Buttons that save a figure: charts as SVG or PNG, maps as PNG.

const PROPERTIES = [
  "fill", "fill-opacity", "stroke", "stroke-width", "stroke-opacity", "stroke-dasharray", "stroke-linejoin",
  "font-family", "font-size", "font-weight", "text-anchor", "visibility",
];
// Pixels of a PNG for a unit of a chart.
const SHARP = 2;

// The chart alone, with its caption, its colours and a background.
function standalone(svg, caption) {
  const copy = svg.cloneNode(true);
  const pairs = [[svg, copy], ...Array.from(svg.querySelectorAll("*"), (element, i) => [element, copy.querySelectorAll("*")[i]])];
  for (const [from, to] of pairs) {
    const style = getComputedStyle(from);
    to.removeAttribute("class");
    to.setAttribute("style", PROPERTIES.map((name) => `${name}:${style.getPropertyValue(name)}`).join(";"));
  }
  const { width, height } = svg.viewBox.baseVal;
  const head = 26, edge = 12;
  const all = node("svg", { xmlns: NS, width: width + 2 * edge, height: height + head + edge, viewBox: `${-edge} ${-head} ${width + 2 * edge} ${height + head + edge}` });
  node("title", {}, all, caption);
  node("rect", { x: -edge, y: -head, width: width + 2 * edge, height: height + head + edge, fill: css("--panel") }, all);
  node("text", { x: 0, y: -8, style: `font:13px ${getComputedStyle(document.body).fontFamily.replaceAll('"', "'")};fill:${css("--ink")}` }, all, caption);
  copy.setAttribute("width", width);
  copy.setAttribute("height", height);
  all.append(copy);
  return all;
}

function asFile(svg) {
  return new Blob([new XMLSerializer().serializeToString(svg)], { type: "image/svg+xml" });
}

function download(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

async function painted(svg) {
  const url = URL.createObjectURL(asFile(svg));
  const image = new Image();
  image.src = url;
  await image.decode();
  const canvas = document.createElement("canvas");
  canvas.width = SHARP * svg.width.baseVal.value;
  canvas.height = SHARP * svg.height.baseVal.value;
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  URL.revokeObjectURL(url);
  return canvas;
}

// The words of a caption, without those of its buttons.
const words = (caption) => Array.from(caption.childNodes, (child) => (child.className === "save" ? "" : child.textContent)).join("").trim();

function saveButtons(figure) {
  const caption = figure.querySelector("figcaption");
  const chart = () => figure.querySelector("svg.chart"), map = figure.querySelector("canvas");
  if (!caption || !(chart() || map)) return;
  const title = words(caption);
  const told = map ? map.getAttribute("aria-label") : title;
  const name = told.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "").slice(0, 60);
  const png = async () => {
    const canvas = map ?? await painted(standalone(chart(), title));
    download(await new Promise((done) => canvas.toBlob(done)), `cede-${name}.png`);
  };
  const ways = map ? { PNG: png } : { SVG: () => download(asFile(standalone(chart(), title)), `cede-${name}.svg`), PNG: png };
  const buttons = document.createElement("span");
  buttons.className = "save";
  for (const [format, save] of Object.entries(ways)) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = format;
    button.setAttribute("aria-label", `${format}: save “${told}”`);
    button.onclick = save;
    buttons.append(button);
  }
  caption.append(buttons);
}

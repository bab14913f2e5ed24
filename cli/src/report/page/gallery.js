// The worst moments, each with a link to its replay.

const KINDS = {
  collision: "Collisions",
  "near-miss": "Near misses",
  intervention: "Hardest interventions",
  "face-off": "Face-offs",
};

function gallery({ gallery, cases }) {
  const host = document.getElementById("moments");
  for (const [kind, title] of Object.entries(KINDS)) {
    const found = gallery.filter((moment) => moment.kind === kind);
    if (!found.length) continue;
    const figure = document.createElement("figure");
    const caption = document.createElement("figcaption");
    const list = document.createElement("ol");
    caption.textContent = title;
    list.append(...found.map((moment) => {
      const item = document.createElement("li");
      const link = document.createElement("a");
      link.href = address(moment);
      link.textContent = cases[moment.case].name;
      item.append(link, `${moment.driver}: ${moment.words}`);
      return item;
    }));
    figure.append(caption, list);
    host.append(figure);
  }
  document.getElementById("gallery").hidden = false;
}

// `#case=2` links to the third case; driver and time may follow.
function address({ case: place, driver, time }) {
  return `#case=${place}&driver=${encodeURIComponent(driver)}&time=${time.toFixed(1)}`;
}

function linked() {
  const words = new URLSearchParams(location.hash.slice(1));
  const number = (name) => (words.has(name) ? Number(words.get(name)) : NaN);
  return { place: number("case"), driver: words.get("driver"), time: number("time") };
}

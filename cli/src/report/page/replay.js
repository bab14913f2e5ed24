// Episodes from above, and the same along the routes.

const STEP = 0.1;
// At least 3:1 against the panel, in light and in dark.
const PALETTE = Array.from({ length: 10 }, (_, i) => `var(--series-${i})`);
const PAPER_SIZE = [5, 2];

// Why the shield acts.
const REASONS = {
  arrival: { words: "the other may arrive before the zone is cleared", tint: "--arrival" },
  occupied: { words: "the other is in the zone", tint: "--occupied" },
  entry: { words: "no safe gap ahead of the other in its lane", tint: "--entry" },
  stop: { words: "just room to stop", tint: "--halt" },
  fallback: { words: "nothing was safe", tint: "--ink" },
  other: { words: "another reason", tint: "--soft" },
};

// A driver has one hue, behind the shield too.
const bare = (name) => name.replace(/ \+ shield.*$/, "");
function colours(names) {
  // Cede first, so that its hue does not depend on who else is there.
  const bares = [...new Set(["cede", ...names.map(bare)])];
  return new Map(names.map((name) => [name, PALETTE[bares.indexOf(bare(name)) % PALETTE.length]]));
}
const dashes = (name) => (bare(name) === name ? "none" : "7 3");

// At most six series: the chosen one, Cede, what was trained, baselines, and the record; those without a shield first.
function few(items, chosen) {
  const rank = (item) => {
    const name = bare(item.driver);
    if (item === chosen) return -2;
    if (name === "cede") return -1;
    if (name === "replay") return 4;
    return 2 * Number(name in DRIVERS) + Number(name !== item.driver);
  };
  const kept = new Set([...items].sort((a, b) => rank(a) - rank(b)).slice(0, 6));
  return items.filter((item) => kept.has(item));
}
// What a legend says of those that `few` leaves out.
const leftOut = (kept, all) => (kept.length < all.length ? [{ name: `six of ${all.length} drivers shown` }] : []);

const css = (name) => {
  // A canvas does not know light-dark(); the browser resolves it on an element.
  const probe = document.createElement("i");
  probe.style.color = `var(${name})`;
  document.body.append(probe);
  const colour = getComputedStyle(probe).color;
  probe.remove();
  return colour;
};

// Position and heading on a route at arc length s; straight on beyond its ends.
function pose(route, s) {
  let i = 0, at = 0;
  for (;;) {
    const [ax, ay] = route[i], [bx, by] = route[i + 1];
    const length = Math.hypot(bx - ax, by - ay);
    if (s <= at + length || i + 2 >= route.length) {
      const f = (s - at) / length;
      return { x: ax + f * (bx - ax), y: ay + f * (by - ay), heading: Math.atan2(by - ay, bx - ax) };
    }
    at += length;
    i += 1;
  }
}

// The value of a series at a time, between its steps.
function sample(values, t) {
  const i = Math.min(Math.max(t / STEP, 0), values.length - 1);
  const below = Math.floor(i), above = Math.min(below + 1, values.length - 1);
  return values[below] + (i - below) * (values[above] - values[below]);
}

class View {
  constructor(canvas, low, high) {
    this.canvas = canvas;
    this.low = low;
    this.high = high;
    this.fit();
  }
  fit() {
    const ratio = window.devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const [w, h] = [this.high[0] - this.low[0], this.high[1] - this.low[1]];
    this.scale = Math.min(width / w, height / h);
    const middle = [(this.low[0] + this.high[0]) / 2, (this.low[1] + this.high[1]) / 2];
    this.context = this.canvas.getContext("2d");
    const k = this.scale * ratio;
    this.context.setTransform(k, 0, 0, -k, (width * ratio) / 2 - k * middle[0], (height * ratio) / 2 + k * middle[1]);
    this.extent = { x: middle[0] - width / this.scale / 2, y: middle[1] - height / this.scale / 2, w: width / this.scale, h: height / this.scale };
  }
  clear() {
    const { x, y, w, h } = this.extent;
    this.context.fillStyle = css("--panel");
    this.context.fillRect(x, y, w, h);
  }
  trace(points, close) {
    const c = this.context;
    c.beginPath();
    points.forEach(([x, y], i) => (i ? c.lineTo(x, y) : c.moveTo(x, y)));
    if (close) c.closePath();
  }
  line(points, colour, pixels, dash = []) {
    const c = this.context;
    this.trace(points);
    c.strokeStyle = colour;
    c.lineWidth = pixels / this.scale;
    c.setLineDash(dash.map((d) => d / this.scale));
    c.stroke();
    c.setLineDash([]);
  }
  map(map) {
    const c = this.context;
    for (const lane of map.lanes) {
      this.trace(lane, true);
      c.fillStyle = css("--lane");
      c.fill();
    }
    const styles = { edge: [css("--edge"), 1.5], solid: [css("--paint"), 1.5], dashed: [css("--paint"), 1.5, [8, 8]], stop: [css("--stop"), 2.5], crosswalk: [css("--paint"), 1.5] };
    for (const { kind, points } of map.lines) this.line(points, ...styles[kind]);
  }
  vehicle({ x, y, heading }, [length, width], { fill, stroke, dash = [] }) {
    const c = this.context;
    c.save();
    c.translate(x, y);
    c.rotate(heading);
    c.beginPath();
    c.roundRect(-length / 2, -width / 2, length, width, 0.45);
    if (fill) {
      c.fillStyle = fill;
      c.fill();
      // The windscreen tells the front.
      c.fillStyle = "rgba(255, 255, 255, 0.55)";
      c.fillRect(length * 0.1, -width * 0.36, length * 0.13, width * 0.72);
    }
    if (stroke) {
      c.beginPath();
      c.roundRect(-length / 2, -width / 2, length, width, 0.45);
      c.strokeStyle = stroke;
      c.lineWidth = 1.5 / this.scale;
      c.setLineDash(dash.map((d) => d / this.scale));
      c.stroke();
      c.setLineDash([]);
    }
    c.restore();
  }
  dot([x, y], pixels, fill, stroke) {
    const c = this.context;
    c.beginPath();
    c.arc(x, y, pixels / this.scale, 0, 2 * Math.PI);
    c.fillStyle = fill;
    c.fill();
    if (stroke) {
      c.strokeStyle = stroke;
      c.lineWidth = 1.5 / this.scale;
      c.stroke();
    }
  }
}

// The surroundings of the conflict point on both routes.
function surroundings(item) {
  const near = item.vehicles.flatMap((v) => v.route).filter(([x, y]) => Math.hypot(x - item.point[0], y - item.point[1]) < 34);
  near.push(item.point);
  const bounds = (pick) => [0, 1].map((i) => pick(...near.map((p) => p[i])));
  return [bounds(Math.min).map((c) => c - 5), bounds(Math.max).map((c) => c + 5)];
}

function player(report) {
  const find = (id) => document.getElementById(id);
  const palette = colours(report.drivers);
  const trained = new Set(report.learning.map((curve) => curve.driver));
  const [caseSelect, driverSelect, slider, clock] = ["case", "driver", "time", "clock"].map(find);
  let item, drive, view, charts, horizon, playing = false, last;

  const option = (text, value) => new Option(text, value);
  caseSelect.append(...report.cases.map((c, i) => option(c.name, i)));

  function choose() {
    item = report.cases[caseSelect.value];
    const wanted = driverSelect.value;
    driverSelect.replaceChildren(...item.drives.map((d) => option(d.driver, d.driver)));
    driverSelect.value = (item.drives.find((d) => d.driver === wanted) ?? favourite(item.drives)).driver;
    drive = item.drives.find((d) => d.driver === driverSelect.value);
    horizon = STEP * (Math.max(...[...item.drives, item.record].map((d) => d.s[0].length)) - 1);
    slider.max = horizon.toFixed(1);
    slider.value = Math.min(slider.value, horizon);
    view = new View(find("scene"), ...surroundings(item));
    for (const name of document.querySelectorAll(".called")) name.textContent = item.called[0];
    find("outcome").textContent = `Recorded: ${outcome(item.record)}. ${drive.driver}: ${outcome(drive)}.${inTheWay(drive.left_out.length)}`;
    drawCharts();
    draw();
  }

  // The controller, the row that was trained last, or whoever does not merely repeat the record.
  function favourite(drives) {
    const kinds = [(d) => d.driver.startsWith("cede"), (d) => trained.has(d.driver), (d) => d.driver !== "replay"];
    return kinds.map((kind) => drives.findLast(kind)).find(Boolean) ?? drives[0];
  }

  function outcome({ first, length, end }) {
    if (end === "collision") return `collision after ${(length * STEP).toFixed(1)} s`;
    if (!first) return "nobody arrives in time";
    return `${item.called[first === "left" ? 0 : 1]} first, after ${(length * STEP).toFixed(1)} s`;
  }

  // An episode has the two vehicles alone.
  const inTheWay = (count) => count === 0 ? ""
    : ` Left out: ${count === 1 ? "a recorded vehicle" : `${count} recorded vehicles`} around, which would be in the way.`;

  const styled = (d) => ({
    colour: palette.get(d.driver),
    width: d === drive ? 2.6 : 1.3,
    opacity: d === drive ? 1 : 0.65,
    dash: dashes(d.driver),
  });
  const shown = () => few(item.drives, drive);
  const lines = (pick) => {
    const points = (d) => pick(d).map((y, k) => [k * STEP, y]);
    const others = shown().filter((d) => d !== drive);
    return [
      ...others.map((d) => ({ ...styled(d), points: points(d) })),
      { points: points(item.record), colour: "var(--ink)", width: 2, dash: "5 4" },
      { ...styled(drive), points: points(drive) },
    ];
  };

  function drawCharts() {
    const time = { label: "time, s", low: 0, high: horizon };
    // Once a vehicle is well past the conflict point, its way no longer matters.
    const until = (values, limit) => {
      const past = values.findIndex((value) => value > limit);
      return past < 0 ? values : values.slice(0, past);
    };
    const stage = (i) => ({
      series: lines((d) => until(d.s[i].map((s) => s - item.vehicles[i].conflict_s), 30)),
      dots: drive.shielded[i].filter(([k]) => drive.s[i][k] - item.vehicles[i].conflict_s <= 30).map(([k, reason, words]) => ({
        at: [k * STEP, drive.s[i][k] - item.vehicles[i].conflict_s],
        colour: `var(${REASONS[reason].tint})`,
        title: `${(k * STEP).toFixed(1)} s: ${words}`,
      })),
      x: time, y: { label: "m" }, height: 228, marks: [{ y: 0, label: "conflict point" }],
    });
    const degrees = [0, 45, 90].map((value) => ({ value, label: `${value}°` }));
    charts = [
      lineChart(find("st-left"), stage(0)),
      lineChart(find("st-other"), stage(1)),
      lineChart(find("svo"), { series: lines((d) => d.svo.map((r) => (r * 180) / Math.PI)), x: time, y: { label: "SVO", low: 0, high: 90, ticks: degrees } }),
      lineChart(find("speeds"), {
        series: [0, 1].flatMap((i) => [item.record, drive].map((d) => ({
          points: d.v[i].map((v, k) => [k * STEP, v]),
          colour: d === drive ? palette.get(drive.driver) : "var(--ink)",
          width: d === drive ? 2.2 : 1.4,
          dash: i ? "5 4" : "none",
        }))),
        x: time, y: { label: "m/s", low: 0 },
      }),
    ];
    const acted = new Set(drive.shielded.flat().map(([, reason]) => reason));
    legend(find("chart-legend"), [
      { name: "recorded", colour: "var(--ink)", dash: true },
      ...shown().map((d) => ({ name: d.driver, colour: palette.get(d.driver), chosen: d === drive, dash: dashes(d.driver) !== "none" })),
      ...leftOut(shown(), item.drives),
      ...Object.keys(REASONS).filter((name) => acted.has(name)).map((name) => ({ name: `shield: ${REASONS[name].words}`, colour: `var(${REASONS[name].tint})`, dot: true })),
    ]);
    find("why").hidden = acted.size === 0;
  }

  function draw() {
    const t = Number(slider.value);
    view.clear();
    view.map(report.map);
    if (!report.map.lanes.length) roads();
    const roles = [css("--left"), css("--other")];
    item.vehicles.forEach((v, i) => view.line(v.route, roles[i], 1.2, [4, 5]));
    for (const { appears, size, route, s } of item.around.filter((_, i) => !drive.left_out.includes(i))) {
      // Once the episode is over, everybody stays where he was.
      const since = Math.min(t, STEP * (drive.s[0].length - 1)) - appears * STEP;
      if (since < 0 || since > (s.length - 1) * STEP) continue;
      view.vehicle(pose(route, sample(s, since)), size, { fill: css("--around") });
    }
    view.dot(item.point, 4.5, css("--ink"), css("--panel"));
    item.vehicles.forEach((v, i) => {
      view.vehicle(pose(v.route, sample(item.record.s[i], t)), PAPER_SIZE, { stroke: roles[i], dash: [3, 3] });
      const now = pose(v.route, sample(drive.s[i], t));
      const overruled = acts(i, t);
      const tint = overruled && css(REASONS[overruled[1]].tint);
      view.vehicle(now, PAPER_SIZE, { fill: roles[i], stroke: tint });
      if (overruled) view.dot([now.x, now.y], 4, tint, css("--panel"));
    });
    find("why").textContent = why(t);
    clock.textContent = `${t.toFixed(1)} / ${horizon.toFixed(1)} s`;
    for (const chart of charts) chart.at(t);
  }

  // Without a map: a lane along each route.
  function roads() {
    for (const { route } of [...item.around, ...item.vehicles]) view.line(route, css("--lane"), 3.6 * view.scale);
  }

  // What the shield of vehicle i does at a time, if it acts.
  function acts(i, t) {
    const step = Math.floor(t / STEP + 1e-6);
    return drive.shielded[i].find(([k]) => k === step);
  }
  function why(t) {
    const told = item.called.flatMap((name, i) => {
      const acted = acts(i, t);
      return acted ? [`${name[0].toUpperCase()}${name.slice(1)} ${acted[2]}.`] : [];
    });
    return told.join(" ") || "The shield lets both drive as they like.";
  }

  function frame(now) {
    if (!playing) return;
    const passed = last === undefined ? 0 : ((now - last) / 1000) * Number(find("speed").value);
    last = now;
    const next = Number(slider.value) + passed;
    slider.step = "any";
    slider.value = next;
    if (next >= horizon) stop();
    draw();
    requestAnimationFrame(frame);
  }
  function stop() {
    playing = false;
    find("play").textContent = "▶";
  }
  function toggle() {
    if (playing) return stop();
    if (Number(slider.value) >= horizon - 1e-6) slider.value = 0;
    playing = true;
    last = undefined;
    find("play").textContent = "❚❚";
    requestAnimationFrame(frame);
  }

  const swatch = (colour, name, ghost) => `<span class="swatch${ghost ? " ghost" : ""}" style="${ghost ? "border-color" : "background"}:var(${colour})"></span>${name}`;
  find("scene-legend").innerHTML = swatch("--left", '<span class="called"></span>') + swatch("--other", "other") + swatch("--soft", "as recorded", true) + swatch("--around", "traffic around, as recorded: nobody reacts to it, and it reacts to nobody");
  caseSelect.onchange = () => { slider.value = 0; choose(); };
  driverSelect.onchange = choose;
  slider.oninput = () => { stop(); draw(); };
  find("play").onclick = toggle;
  window.addEventListener("resize", () => { view.fit(); draw(); });
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  document.addEventListener("keydown", (event) => {
    if (event.code === "Space" && event.target === document.body) {
      event.preventDefault();
      toggle();
    }
  });
  find("replay").hidden = false;
  // The case that the page opens with: the traffic around is out of the way, the shield acts, people went in that order too.
  const telling = (c) => {
    const driven = favourite(c.drives);
    const acts = driven.shielded.some((steps) => steps.length > 0);
    return 4 * Number(driven.left_out.length === 0) + 2 * Number(acts) + Number(driven.first === c.record.first);
  };
  const known = report.cases.filter((c) => !c.found);
  const [first] = (known.length ? known : report.cases).toSorted((a, b) => telling(b) - telling(a));
  caseSelect.value = report.cases.indexOf(first);
  choose();
  // What the address asks for; false if it asks for nothing.
  function follow() {
    const { place, driver, time } = linked();
    if (!(place in report.cases)) return false;
    caseSelect.value = place;
    slider.value = 0;
    choose();
    if (item.drives.some((d) => d.driver === driver)) {
      driverSelect.value = driver;
      choose();
    }
    if (time >= 0) slider.value = time;
    draw();
    return true;
  }
  window.addEventListener("hashchange", () => {
    if (!follow()) return;
    find("replay").scrollIntoView();
    find("play").focus();
    stop();
    if (!still) toggle();
  });
  follow();
  const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (linked().time >= 0) {
    if (!still) toggle();
  } else if (still) {
    // Somewhere in the middle there is more to see than at the start.
    slider.value = (0.6 * STEP * item.record.length).toFixed(1);
    draw();
  } else {
    toggle();
  }
}

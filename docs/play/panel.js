"use strict";
// Controls and words around the picture.

const element = id => document.getElementById(id);

function make(tag, attributes = {}, ...children) {
    const node = Object.assign(document.createElement(tag), attributes);
    node.append(...children);
    return node;
}

// Choices of which one is chosen: `options` are [value, text].
function segments(id, options, chosen, choose) {
    const group = element(id);
    [...group.querySelectorAll("label")].forEach(label => label.remove());
    for (const [value, text] of options) {
        const input = make("input", { type: "radio", name: id, value, checked: value === chosen });
        input.addEventListener("change", () => choose(value));
        group.append(make("label", {}, input, make("span", { textContent: text })));
    }
}

function chosen(id, value) {
    const input = element(id).querySelector(`input[value="${value}"]`);
    if (input) input.checked = true;
}

// The contract's sliders: field, words, unit, range, step, and which condition of docs/manual.md it is.
const SLIDERS = [
    ["egoBraking", "Its brakes achieve", "m/s²", 1.5, 7, 0.5],
    ["latency", "A command takes effect within", "s", 0, 0.3, 0.02],
    ["egoLag", "Its drivetrain and brakes lag by at most", "s", 0, 0.3, 0.05],
    ["otherAcceleration", "Others accelerate at most at", "m/s²", 1, 5, 0.5],
    ["otherMaxSpeed", "Others drive at most", "m/s", 10, 20, 1],
    ["positionError", "Sensors err by at most", "m", 0, 1, 0.1],
];

const TRUTHS = [
    ["late", "Commands act late", "latency and lag are twice what is stated"],
    ["weak", "Brakes are weak", "half of what is stated"],
    ["wild", "Others exceed their bounds", "twice the acceleration, half as much again the speed; they ram from behind as well"],
    ["blurred", "Sensors are worse", "they err by a metre more than is stated"],
];

function sliders(contract, change) {
    const place = element("contract");
    for (const [field, words, unit, min, max, step] of SLIDERS) {
        const digits = step < 0.1 ? 2 : step < 1 ? 1 : 0;
        const say = value => `${Number(value).toFixed(digits)} ${unit}`;
        const input = make("input", { type: "range", min, max, step, value: contract[field] });
        input.setAttribute("aria-label", `${words}, ${unit}`);
        const output = make("output", { textContent: say(contract[field]) });
        input.addEventListener("input", () => {
            output.textContent = say(input.value);
            change(field, Number(input.value));
        });
        place.append(make("label", { className: "slider" }, make("span", { textContent: words }), output, input));
    }
    const box = make("input", { type: "checkbox", id: "precedence" });
    box.addEventListener("change", () => change("precedence", box.checked));
    const note = make("small", { textContent: "who arrives first goes first. At an all-way stop only." });
    place.append(make("label", { className: "check", id: "courtesy" }, box,
        make("span", {}, "Others keep the rule of an all-way stop", note)));
}

function truths(change) {
    for (const [name, words, more] of TRUTHS) {
        const box = make("input", { type: "checkbox", id: `truth-${name}` });
        box.addEventListener("change", () => change(name, box.checked));
        const text = make("span", {}, words, make("small", { textContent: more }));
        element("truths").append(make("label", { className: "check" }, box, text));
    }
}

const CAUSES = { policy: "Policy", shielded: "Shield", fallback: "No guarantee" };

// The decision in words: what is decided and why, and what is wrong.
function verdict(decision) {
    const [first, ...more] = decision.text.split("; ");
    const why = {
        policy: `What the policy proposes is safe: ${signed(decision.proposal)} m/s².`,
        shielded: sentence(first.replace("shielded: ", "")) + (/near as -/.test(first) ? " Below 0 it is ahead by then." : ""),
        fallback: sentence(first.replace("fallback: ", "")),
    }[decision.cause];
    return { why, wrong: more.map(sentence).join(" ") };
}

const sentence = text => text.charAt(0).toUpperCase() + text.slice(1).replace(/-(?=[0-9])/g, "−") + ".";
const signed = value => (value < 0 ? "−" : "+") + Math.abs(value).toFixed(1);

// Writes only what has changed: the page is not laid out anew in every frame.
function write(id, text) {
    const node = element(id);
    if (node.textContent !== text) node.textContent = text;
}

class Panel {
    constructor() {
        this.marks = ["proposal", "command"].map(className => make("u", { className }));
        this.bars = Array.from({ length: GRID }, () => make("i"));
        element("options").append(...this.bars, ...this.marks);
        this.history = element("history");
        this.spoken = -Infinity; // when a screen reader was last told
    }

    show(world) {
        const { decision, ego } = world;
        if (!decision) return;
        const { why, wrong } = world.ended ? { why: ending(world), wrong: "" } : verdict(decision);
        const tone = world.ended?.how === "collision" ? "fallback" : decision.cause;
        element("verdict").dataset.tone = tone;
        write("cause", world.ended?.how === "collision" ? "Collision" : CAUSES[decision.cause]);
        write("reason", why);
        write("breach", wrong);
        write("margin", decision.noPlan ? "none" : `${decision.margin > 99 ? "> 99" : decision.margin.toFixed(1)} m`);
        write("plan", decision.go === null ? "none" : decision.go === 0 ? "brake" : `go ${(decision.go * PERIOD).toFixed(1)} s`);
        write("speed", `${(ego.speed * 3.6).toFixed(0)} km/h`);
        write("command", `command ${signed(decision.acceleration)} m/s²`);
        this.showSvo(decision.svo);
        this.showOptions(decision);
        this.tell(world, `${why} ${wrong}`, wrong ? "fallback" : tone);
    }

    showSvo(svo) {
        element("needle").style.opacity = svo ? 1 : 0;
        if (svo) {
            const degrees = svo.angle * 180 / Math.PI;
            element("needle").style.transform = `rotate(${-degrees.toFixed(1)}deg)`;
            write("svo-text", `Social value orientation towards ${svo.other}: ${degrees.toFixed(0)}°. Expects ` +
                `${signed(svo.acceleration)} m/s² of it.`);
        } else write("svo-text", "Social value orientation: nobody is left to meet.");
    }

    showOptions({ options, proposal, acceleration }) {
        const [first, last] = [options[0].acceleration, options[GRID - 1].acceleration];
        options.forEach(({ accepted }, i) => this.bars[i].classList.toggle("safe", accepted));
        [proposal, acceleration].forEach((value, i) => {
            const share = limit((value - first) / (last - first), 0, 1);
            this.marks[i].style.left = `${(2 + 96 * share).toFixed(1)}%`;
        });
    }

    // A line of the log, when what is said is something else than before.
    tell(world, words, tone) {
        const { decision } = world;
        const key = [world.ended?.how, decision.cause, decision.about, decision.breach, decision.text.split("; ")[1]].join();
        if (key === this.key) return;
        this.key = key;
        if (performance.now() > this.spoken + 4000) {
            write("spoken", `${element("cause").textContent}. ${words}`);
            this.spoken = performance.now();
        }
        const time = make("time", { textContent: `${world.time.toFixed(1)} s` });
        const line = make("li", {}, time, make("span", { textContent: words }));
        line.dataset.tone = tone;
        element("log").prepend(line);
        while (element("log").children.length > 5) element("log").lastChild.remove();
    }

    // The chart of the last 12 s.
    chart(world, colours) {
        const { canvas, c, width, height } = this.chartContext();
        const span = 12, now = world.time;
        const [low, high] = [-Math.max(world.contract.egoEmergency, 3) - 0.4, 3.4];
        const x = time => width - (now - time) / span * (width - 46) - 4;
        const y = value => 4 + (high - value) / (high - low) * (height - 22);
        c.clearRect(0, 0, canvas.width, canvas.height);
        c.font = "11px system-ui, sans-serif";
        c.lineWidth = 1;
        for (const value of [3, 0, -3]) {
            c.strokeStyle = colours.rule;
            c.fillStyle = colours.soft;
            c.beginPath();
            c.moveTo(40, y(value));
            c.lineTo(width, y(value));
            c.stroke();
            c.fillText(`${value > 0 ? "+" : value < 0 ? "−" : ""}${Math.abs(value)} m/s²`, 0, y(value) + 4);
        }
        const shown = world.history.filter(({ time }) => time > now - span);
        const steps = (of, style, thick) => {
            c.strokeStyle = style;
            c.lineWidth = thick;
            c.beginPath();
            shown.forEach(({ time, decision }) => {
                c.lineTo(x(time), y(of(decision)));
                c.lineTo(x(time + PERIOD), y(of(decision)));
            });
            c.stroke();
        };
        c.setLineDash([2, 2]);
        steps(decision => decision.proposal, colours.soft, 1.5);
        c.setLineDash([]);
        steps(decision => decision.acceleration, colours.plan, 2.5);
        for (const { time, decision } of shown) {
            c.fillStyle = { policy: colours.good, shielded: colours.warn, fallback: colours.stop }[decision.cause];
            c.fillRect(x(time), height - 10, x(time + PERIOD) - x(time) + 0.5, 8);
        }
    }

    chartContext() {
        const canvas = this.history;
        const ratio = Math.min(window.devicePixelRatio || 1, 2);
        const [width, height] = [canvas.clientWidth, canvas.clientHeight];
        if (canvas.width !== Math.round(width * ratio)) {
            [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
        }
        const c = canvas.getContext("2d");
        c.setTransform(ratio, 0, 0, ratio, 0, 0);
        return { canvas, c, width, height };
    }
}

// How the round ended, in words.
function ending(world) {
    const { how, with: other } = world.ended;
    if (how === "through") return "Through, without touching anybody.";
    const untrue = TRUTHS.filter(([name]) => world.truth[name]).map(([, words]) => words.toLowerCase());
    if (other.hidden) untrue.push(`${other.number} was hidden from the sensors`);
    if (world.contract.precedence) untrue.push("others were trusted to keep the rule of the all-way stop");
    const why = untrue.length
        ? `The contract was broken: ${untrue.join("; ")}.`
        : "The contract held: this must not happen. Please report it.";
    return `Hit by ${other.number}. ${why}`;
}

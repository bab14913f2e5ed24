"use strict";
// Puts the parts together: what is chosen, the clock, keys and pointer.

const MODES = [["auto", "Drives itself"], ["go", "Go"], ["hold", "Coast"], ["brake", "Brake"]];
const WAIT = { through: 1.4, collision: 5 }; // s of the clock on the wall until the next round

// An error is told on the page's root, where a test looks for it.
window.addEventListener("error", event => fail(event.message));
function fail(what) {
    document.documentElement.dataset.error = what;
    element("verdict").dataset.tone = "fallback";
    write("cause", "Error");
    write("reason", what);
}

class Page {
    constructor(module) {
        this.module = module;
        this.still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
        this.truth = { ...TRUTH };
        this.site = SITES[0];
        this.turn = this.site.turn;
        this.selected = 0;
        this.paused = this.still;
        this.rate = 1;
        this.rest = 0;
        this.cost = 0;
        this.panel = new Panel();
        this.view = new View(element("scene"));
        const start = new Controller(module).named(0);
        this.wanted = { ...start, egoMaxSpeed: 12, egoEmergency: 7 };
        this.accepted = this.wanted;
        this.controls();
        this.open(this.site.id);
        this.listen();
        this.goTo(new URLSearchParams(location.hash.slice(1)));
    }

    // -- what is chosen --------------------------------------------------------------------------------------------

    controls() {
        segments("sites", SITES.map(site => [site.id, site.name]), this.site.id, id => this.open(id));
        sliders(this.wanted, (field, value) => this.change(field, value));
        truths((name, on) => {
            this.truth[name] = on;
            this.showBroken();
        });
        element("pause").addEventListener("click", () => this.pause(!this.paused));
        element("again").addEventListener("click", () => this.restart());
        element("slow").addEventListener("change", event => {
            this.rate = event.target.checked ? 0.25 : 1;
        });
        element("hide").addEventListener("change", event => this.hide(event.target.checked));
        segments("modes", MODES, "auto", mode => this.drive(mode));
        this.pause(this.paused);
    }

    open(id) {
        this.site = SITES.find(site => site.id === id);
        this.turn = this.site.turn;
        const courtesy = this.site.control === "stop";
        element("courtesy").hidden = !courtesy;
        if (!courtesy && this.accepted.precedence) {
            element("precedence").checked = false;
            this.wanted = { ...this.wanted, precedence: false };
            this.accepted = { ...this.accepted, precedence: false };
        }
        const turns = Object.keys(this.site.turns).map(turn => [turn, turn === "straight" ? "straight on" : turn]);
        segments("turns", turns, this.turn, turn => {
            this.turn = turn;
            this.restart();
        });
        write("see", this.site.see);
        this.selected = 0;
        this.restart();
    }

    // A moment of a link: #site=ring&turn=left&at=6.5 stands still there. Who wants no motion gets a moment, too.
    goTo(link) {
        if (SITES.some(site => site.id === link.get("site"))) this.open(link.get("site"));
        if (link.get("turn") in this.site.turns) {
            this.turn = link.get("turn");
            this.restart();
        }
        chosen("sites", this.site.id);
        chosen("turns", this.turn);
        const at = Number(link.get("at") ?? (this.still ? 4 : 0));
        if (!(at > 0)) return;
        while (this.world.time < Math.min(at, 60) && !this.world.ended) {
            this.world.advance(TICK);
            if (this.world.history.at(-1)?.time !== this.shown) this.panel.show(this.world);
            this.shown = this.world.history.at(-1)?.time;
        }
        this.pause(true);
    }

    restart() {
        this.world = new World(this.module, this.site, this.turn, this.accepted, this.truth);
        this.endedFor = 0;
        element("log").replaceChildren();
        this.showCrowd();
    }

    // The contract with one number changed, and those that follow from it.
    change(field, value) {
        const contract = { ...this.wanted, [field]: value };
        contract.egoAcceleration = contract.egoGo = Math.min(3, contract.otherAcceleration);
        contract.egoMaxSpeed = Math.min(12, contract.otherMaxSpeed);
        contract.egoEmergency = Math.max(7, contract.egoBraking);
        this.wanted = contract;
        try {
            this.world.setContract(contract);
            this.accepted = contract;
            element("refused").hidden = true;
        } catch (error) {
            element("refused").hidden = false;
            write("refused", `Refused: ${error.message}. The contract before it stays in effect.`);
        }
        this.showBroken();
    }

    showBroken() {
        const untrue = TRUTHS.filter(([name]) => this.truth[name]).map(([, words]) => words.toLowerCase());
        const hidden = this.world.crowd.filter(other => other.hidden && other.left === null);
        if (hidden.length) untrue.push(`${hidden.map(other => other.number).join(", ")} hidden`);
        element("broken").hidden = untrue.length === 0;
        write("broken", `Contract broken: ${untrue.join("; ")}`);
    }

    // -- whoever is the visitor's ----------------------------------------------------------------------------------

    get mine() {
        return this.world.crowd[this.selected];
    }

    showCrowd() {
        this.shownNumbers = this.world.crowd.map(other => other.number).join();
        const name = other => `${other.number} ${other.kind === "pedestrian" ? "on foot" : other.kind}`;
        segments("cars", this.world.crowd.map((other, i) => [String(i), name(other)]), String(this.selected), i => this.select(Number(i)));
        this.select(this.selected);
    }

    select(seat) {
        this.selected = seat;
        chosen("cars", seat);
        this.showMine();
    }

    showMine() {
        chosen("modes", this.mine.mode === "drag" ? "hold" : this.mine.mode);
        element("hide").checked = this.mine.hidden;
        this.showBroken();
    }

    drive(mode) {
        this.mine.mode = mode;
        this.showMine();
    }

    hide(hidden) {
        this.mine.hidden = hidden;
        this.showMine();
    }

    // -- keys and pointer ------------------------------------------------------------------------------------------

    listen() {
        const scene = element("scene");
        scene.addEventListener("keydown", event => this.key(event, true));
        scene.addEventListener("keyup", event => this.key(event, false));
        scene.addEventListener("pointerdown", event => this.grab(event));
        scene.addEventListener("pointermove", event => this.pull(event));
        for (const end of ["pointerup", "pointercancel"]) scene.addEventListener(end, () => this.release());
        // A finger on a vehicle drags it; elsewhere it scrolls the page.
        scene.addEventListener("touchstart", event => this.dragged && event.preventDefault(), { passive: false });
        const renew = () => this.view.resize();
        new ResizeObserver(renew).observe(scene);
        window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", renew);
        document.addEventListener("visibilitychange", () => {
            this.last = undefined;
        });
    }

    key(event, down) {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        const driven = { ArrowUp: "go", w: "go", ArrowDown: "brake", s: "brake" }[event.key];
        const pressed = {
            " ": () => this.pause(!this.paused), r: () => this.restart(), h: () => this.hide(!this.mine.hidden),
            a: () => this.drive("auto"),
        }[event.key];
        if (driven) this.drive(down ? driven : "hold");
        else if (down && pressed) pressed();
        else if (down && this.world.crowd[Number(event.key) - 1]) this.select(Number(event.key) - 1);
        else return;
        event.preventDefault();
    }

    place(event) {
        const box = element("scene").getBoundingClientRect();
        return this.view.metres(event.clientX - box.left, event.clientY - box.top);
    }

    grab(event) {
        const [x, y] = this.place(event);
        const reach = Math.max(3.4, 26 / this.view.scale);
        const away = other => Math.hypot(other.pose[0] - x, other.pose[1] - y);
        const near = this.world.crowd.filter(other => away(other) < reach + (other.length > 6 ? 2 : 0));
        if (!near.length) return;
        const other = near.reduce((a, b) => away(a) < away(b) ? a : b);
        this.select(other.seat);
        this.dragged = other;
        element("scene").setPointerCapture(event.pointerId);
        other.mode = "drag";
        this.pull(event);
        this.showMine();
    }

    pull(event) {
        if (this.dragged) this.dragged.goal = this.world.ways[this.dragged.path].project(this.place(event));
    }

    release() {
        if (this.dragged && this.dragged.mode === "drag") this.dragged.mode = "auto";
        this.dragged = null;
        this.showMine();
    }

    pause(paused) {
        this.paused = paused;
        write("pause", paused ? "Play" : "Pause");
    }

    // -- the clock -------------------------------------------------------------------------------------------------

    frame(now) {
        const elapsed = Math.min((now - (this.last ?? now)) / 1000, 0.1);
        this.last = now;
        const began = performance.now();
        if (!this.paused) this.advance(elapsed);
        this.view.draw(this.world, this.selected, this.dragged && { other: this.dragged, goal: this.dragged.goal });
        this.panel.show(this.world);
        this.panel.chart(this.world, this.chartColours());
        this.measure(performance.now() - began, elapsed);
    }

    advance(elapsed) {
        if (this.world.ended) {
            this.endedFor += elapsed;
            if (this.endedFor > WAIT[this.world.ended.how]) this.nextRound();
            return;
        }
        this.rest += elapsed * this.rate;
        const ticks = Math.floor(this.rest / TICK);
        this.rest -= ticks * TICK;
        this.world.advance(ticks * TICK);
        if (this.dragged && !this.world.crowd.includes(this.dragged)) this.dragged = null;
        if (this.world.crowd.map(other => other.number).join() !== this.shownNumbers) this.showCrowd();
    }

    nextRound() {
        this.world.begin();
        this.dragged = null;
        this.endedFor = 0;
        this.showCrowd();
    }

    chartColours() {
        if (this.colours !== this.view.colours) {
            this.colours = this.view.colours;
            const style = getComputedStyle(document.documentElement);
            const names = ["rule", "soft", "plan", "good", "warn", "stop"];
            this.chartPalette = Object.fromEntries(names.map(name => [name, style.getPropertyValue(`--${name}`).trim()]));
        }
        return this.chartPalette;
    }

    // The mean time (ms) that a frame costs, once a second.
    measure(cost, elapsed) {
        this.cost = this.cost ? 0.95 * this.cost + 0.05 * cost : cost;
        this.sinceTold = (this.sinceTold ?? 1) + elapsed;
        if (this.sinceTold < 1) return;
        this.sinceTold = 0;
        document.documentElement.dataset.frame = this.cost.toFixed(2);
        write("cost", `A frame takes ${this.cost.toFixed(1)} ms of 16.7.`);
    }
}

async function start() {
    const page = new Page(await compileController());
    const frame = now => {
        page.frame(now);
        requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
    document.documentElement.dataset.status = "ready";
}
start().catch(error => fail(String(error)));

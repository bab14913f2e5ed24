"use strict";
// Draws the junction and what the controller knows and plans, on a canvas.

const ROAD = LANE; // half of a road's width
const KERB = 1.7; // width of the pavement

// Colours are those of the style sheet, so that light and dark are decided there alone.
function palette() {
    const style = getComputedStyle(document.documentElement);
    const names = ["grass", "grass-2", "pavement", "road", "paint", "ego", "ego-ink", "other", "other-ink", "walker",
        "zone", "reach", "plan", "warn", "stop", "canvas-ink", "canvas-paper", "glass", "tree"];
    return Object.fromEntries(names.map(name => [name, style.getPropertyValue(`--${name}`).trim()]));
}

class View {
    constructor(canvas) {
        this.canvas = canvas;
        this.context = canvas.getContext("2d");
        this.ground = document.createElement("canvas");
        this.resize();
    }

    // To be called when the canvas has another size or the colours are others.
    resize() {
        const { clientWidth, clientHeight } = this.canvas;
        this.ratio = Math.min(window.devicePixelRatio || 1, 2);
        [this.width, this.height] = [clientWidth, clientHeight];
        this.canvas.width = this.ground.width = Math.round(clientWidth * this.ratio);
        this.canvas.height = this.ground.height = Math.round(clientHeight * this.ratio);
        this.small = clientWidth < 500;
        this.colours = palette();
        this.site = null;
    }

    // From the page's pixels to metres.
    metres(x, y) {
        return [(x - this.width / 2) / this.scale, (this.height / 2 - y) / this.scale];
    }

    // A context in metres, y to the north.
    aim(context) {
        const k = this.ratio * this.scale;
        context.setTransform(k, 0, 0, -k, this.ratio * this.width / 2, this.ratio * this.height / 2);
    }

    draw(world, selected, pointer) {
        const { ways } = world;
        if (this.site !== world.site) {
            this.site = world.site;
            const shown = this.small && world.site.control !== "ring" ? 42 : 54;
            this.scale = Math.min(this.width, this.height) / shown;
            this.drawGround(world.site);
        }
        const c = this.context;
        c.setTransform(1, 0, 0, 1, 0, 0);
        c.drawImage(this.ground, 0, 0);
        this.aim(c);
        if (world.site.walks) this.zebra(c, world.layout.to);
        const about = world.decision && world.decision.about;
        const crowd = world.crowd;
        crowd.forEach(other => this.drawZones(c, world, ways, other, other.number === about));
        crowd.forEach(other => this.drawReach(c, world, ways[other.path], other));
        this.drawPlan(c, world, ways[0]);
        if (pointer) this.drawGoal(c, ways, pointer);
        crowd.forEach(other => this.drawOther(c, other, other.seat === selected, other.number === about));
        this.drawVehicle(c, world.ego, this.colours.ego, world.ego.acceleration < -0.3);
        if (world.ended?.how === "collision") this.drawHit(c, world.ego, world.ended.with);
        this.drawLabels(c, world, ways, selected, about);
    }

    // -- the ground ------------------------------------------------------------------------------------------------

    drawGround(site) {
        const c = this.ground.getContext("2d");
        const { grass, pavement, road } = this.colours;
        c.setTransform(1, 0, 0, 1, 0, 0);
        c.fillStyle = grass;
        c.fillRect(0, 0, this.ground.width, this.ground.height);
        this.aim(c);
        this.trees(c, site);
        for (const [colour, half] of [[pavement, ROAD + KERB], [road, ROAD]]) {
            c.fillStyle = colour;
            this.roads(c, site, half);
        }
        if (site.control === "ring") this.island(c);
        this.markings(c, site);
    }

    trees(c, site) {
        const random = generator(site.id.length * 77 + 5);
        for (let i = 0; i < 90; i++) {
            const [x, y, r] = [(random() - 0.5) * 130, (random() - 0.5) * 90, 1.1 + random() * 1.5];
            const clear = site.control === "ring" ? 24 : 9;
            const away = ROAD + KERB + r + 1;
            if (Math.hypot(x, y) < clear || Math.abs(x) < away) continue;
            if (Math.abs(y) < away) continue;
            c.fillStyle = this.colours["grass-2"];
            this.disc(c, x + 0.5, y - 0.5, r);
            c.fillStyle = this.colours.tree;
            this.disc(c, x, y, r);
        }
    }

    disc(c, x, y, r) {
        c.beginPath();
        c.arc(x, y, r, 0, 2 * Math.PI);
        c.fill();
    }

    // Everything that is as near as `half` to the middle of a road, corners rounded.
    roads(c, site, half) {
        const ring = site.control === "ring";
        for (const arm of site.arms) {
            c.beginPath();
            const corners = [[0, half], [100, half], [100, -half], [0, -half]];
            corners.forEach(([ahead, beside]) => c.lineTo(...onArm(arm, ahead, beside)));
            c.fill();
        }
        if (ring) this.disc(c, 0, 0, RING + half - LANE / 2 + 0.4);
        const radius = 7.5 + ROAD - half;
        const base = ring ? 13.2 + (half - ROAD) * 0.6 : half;
        const order = ["E", "N", "W", "S"];
        order.forEach((arm, i) => {
            const next = order[(i + 1) % 4];
            if (!site.arms.includes(arm) || !site.arms.includes(next)) return;
            const at = (a, b) => {
                const [p, q] = [onArm(arm, a, 0), onArm(next, b, 0)];
                return [p[0] + q[0], p[1] + q[1]];
            };
            c.beginPath();
            if (ring) {
                c.moveTo(...at(base + 8, half));
                c.quadraticCurveTo(...at(base + 1.5, half), ...at(base - 2.5, half + 4.5));
                c.lineTo(...at(half + 4.5, base - 2.5));
                c.quadraticCurveTo(...at(half, base + 1.5), ...at(half, base + 8));
            } else {
                c.moveTo(...at(half + radius, half));
                c.quadraticCurveTo(...at(half, half), ...at(half, half + radius));
            }
            // A little of the roads as well, so that no seam is seen.
            const far = ring ? base + 8 : half + radius;
            [[half - 1, far], [half - 1, half - 1], [far, half - 1]].forEach(([a, b]) => c.lineTo(...at(a, b)));
            c.fill();
        });
    }

    island(c) {
        const inner = RING - LANE / 2 - 0.4;
        c.fillStyle = this.colours.pavement;
        this.disc(c, 0, 0, inner);
        c.fillStyle = this.colours.grass;
        this.disc(c, 0, 0, inner - 1.2);
        for (const [x, y, r] of [[-2, 2, 2.4], [3, -1, 1.8], [-1, -4, 1.5], [2.6, 4, 1.3]]) {
            c.fillStyle = this.colours["grass-2"];
            this.disc(c, x + 0.5, y - 0.5, r);
            c.fillStyle = this.colours.tree;
            this.disc(c, x, y, r);
        }
    }

    line(c, arm, points, width, dash = []) {
        c.lineWidth = width;
        c.setLineDash(dash);
        c.beginPath();
        points.forEach(([ahead, beside]) => c.lineTo(...onArm(arm, ahead, beside)));
        c.stroke();
        c.setLineDash([]);
    }

    markings(c, site) {
        c.strokeStyle = c.fillStyle = this.colours.paint;
        c.lineCap = "butt";
        const ring = site.control === "ring";
        const through = site.control === "yield";
        for (const arm of site.arms) {
            const minor = site.control === "stop" || (through && (arm === "N" || arm === "S"));
            const edge = ring ? 20 : through && !minor ? 0 : 5;
            this.line(c, arm, [[edge, 0], [100, 0]], 0.16, through && !minor ? [3, 3] : []);
            if (minor) this.line(c, arm, [[4.4, 0.1], [4.4, ROAD + 0.4]], 0.5, through ? [0.6, 0.4] : []);
            if (ring) this.line(c, arm, [[18.6, 0.3], [18.6, ROAD + 0.4]], 0.45, [0.6, 0.4]);
        }
    }

    zebra(c, arm) {
        c.strokeStyle = this.colours.paint;
        for (let beside = -ROAD + 0.45; beside < ROAD; beside += 1.1) {
            this.line(c, arm, [[WALK - 1.4, beside + 0.1], [WALK + 1.4, beside + 0.1]], 0.5);
        }
    }

    // -- what the controller knows ---------------------------------------------------------------------------------

    band(c, way, from, to, width, style, alpha, cap = "butt") {
        if (to <= from) return;
        c.save();
        c.globalAlpha = alpha;
        c.strokeStyle = style;
        c.lineWidth = width;
        c.lineJoin = "round";
        c.lineCap = cap;
        c.beginPath();
        way.slice(from, to).forEach(point => c.lineTo(...point));
        c.stroke();
        c.restore();
    }

    // A stretch of the ego's way and one of the other's in which the two can touch.
    drawZones(c, world, ways, other, strong) {
        const { ego } = world;
        for (const zone of world.zones[other.path]) {
            if (ego.s > zone.egoTo || other.s > zone.otherTo) continue;
            const lane = zone.kind !== 0;
            const [from, to] = shrunk(zone.egoFrom, zone.egoTo, ego.length);
            const [otherFrom, otherTo] = shrunk(zone.otherFrom, zone.otherTo, other.length);
            const alpha = (strong ? 0.55 : 0.2) * (lane ? 0.55 : 1);
            this.band(c, ways[0], from, lane ? from + 16 : to, ego.width + 0.2, this.colours.zone, alpha);
            if (!lane) this.band(c, ways[other.path], otherFrom, otherTo, other.width + 0.2, this.colours.zone, alpha);
        }
    }

    // Where the other may be in 1, 2 and 3 s, bumpers included.
    drawReach(c, world, way, other) {
        const reach = world.reach(other);
        if (!reach) return;
        const half = other.length / 2;
        const back = reach[0][0] - half;
        [...reach].reverse().forEach(([, to], i) => {
            this.band(c, way, back, to + half, other.width + 0.3, this.colours.reach, [0.14, 0.2, 0.28][i]);
        });
        c.strokeStyle = this.colours.reach;
        for (const [, to] of reach) {
            if (to + half < way.length) this.tick(c, way, to + half, other.width / 2 + 0.35, 0.18);
        }
    }

    tick(c, way, s, half, width) {
        const [[x, y], angle] = [way.at(s), way.heading(s)];
        const [dx, dy] = [-Math.sin(angle) * half, Math.cos(angle) * half];
        c.lineWidth = width;
        c.beginPath();
        c.moveTo(x - dx, y - dy);
        c.lineTo(x + dx, y + dy);
        c.stroke();
    }

    // The plan: where the ego nominally is each half second, and the bumper's place at rest at the latest.
    drawPlan(c, world, way) {
        const { ego, planned, decision } = world;
        this.band(c, way, ego.s, way.length, 0.14, this.colours.plan, 0.35);
        if (!planned) return;
        const nose = ego.length / 2;
        const goes = planned.places[Math.min(decision.go, planned.places.length - 1)];
        this.band(c, way, ego.s + nose, Math.max(goes, ego.s) + nose, 0.75, this.colours.plan, 0.95);
        this.band(c, way, Math.max(goes, ego.s) + nose, planned.stop + nose, 0.34, this.colours.plan, 0.95);
        c.fillStyle = this.colours["canvas-paper"];
        for (let i = 4; i < planned.places.length; i += 5) {
            if (planned.places[i] <= ego.s) continue;
            this.disc(c, ...way.at(planned.places[i] + nose), 0.22);
        }
        if (planned.stop + nose < way.length - 1) {
            c.strokeStyle = this.colours.plan;
            this.tick(c, way, planned.stop + nose, 1.7, 0.42);
        }
    }

    drawGoal(c, ways, { other, goal }) {
        const [x, y] = ways[other.path].at(goal);
        c.strokeStyle = this.colours.other;
        c.lineWidth = 0.25;
        c.setLineDash([0.6, 0.4]);
        c.beginPath();
        c.arc(x, y, 1.6, 0, 2 * Math.PI);
        c.stroke();
        c.setLineDash([]);
    }

    // -- vehicles --------------------------------------------------------------------------------------------------

    drawOther(c, other, selected, strong) {
        const { colours } = this;
        c.globalAlpha = other.hidden ? 0.4 : 1;
        if (other.kind === "pedestrian") this.drawWalker(c, other);
        else this.drawVehicle(c, other, colours.other, other.acceleration < -0.5);
        c.globalAlpha = 1;
        if (!selected && !strong) return;
        const [x, y] = other.pose;
        c.strokeStyle = strong ? colours.zone : colours["canvas-ink"];
        c.lineWidth = 0.22;
        c.setLineDash(selected ? [0.9, 0.5] : []);
        c.beginPath();
        c.arc(x, y, other.length / 2 + 1, 0, 2 * Math.PI);
        c.stroke();
        c.setLineDash([]);
    }

    drawVehicle(c, { pose: [x, y, dx, dy], length, width }, colour, braking) {
        const { colours } = this;
        c.save();
        c.transform(dx, dy, -dy, dx, x, y);
        const [a, b] = [length / 2, width / 2];
        c.fillStyle = "rgb(0 0 0 / 0.22)";
        c.beginPath();
        c.roundRect(-a + 0.15, -b - 0.22, length, width, 0.5);
        c.fill();
        c.fillStyle = colour;
        c.beginPath();
        c.roundRect(-a, -b, length, width, 0.5);
        c.fill();
        c.fillStyle = colours.glass;
        c.beginPath();
        if (length < 7) {
            c.roundRect(a - 1.75, -b + 0.2, 0.75, width - 0.4, 0.2);
            c.roundRect(-a + 0.55, -b + 0.25, 0.5, width - 0.5, 0.2);
        } else {
            c.roundRect(a - 0.95, -b + 0.2, 0.55, width - 0.4, 0.15);
            c.rect(a - 2.1, -b, 0.14, width);
        }
        c.fill();
        c.fillStyle = braking ? "#ff3b30" : "#8c1d18";
        c.fillRect(-a, -b + 0.1, 0.28, 0.5);
        c.fillRect(-a, b - 0.6, 0.28, 0.5);
        c.fillStyle = "#fff6cf";
        c.fillRect(a - 0.25, -b + 0.15, 0.25, 0.4);
        c.fillRect(a - 0.25, b - 0.55, 0.25, 0.4);
        c.restore();
    }

    // A star between the two.
    drawHit(c, ego, other) {
        const [x, y] = [(ego.pose[0] + other.pose[0]) / 2, (ego.pose[1] + other.pose[1]) / 2];
        c.fillStyle = this.colours.zone;
        c.strokeStyle = this.colours["canvas-paper"];
        c.lineWidth = 0.25;
        c.beginPath();
        for (let i = 0; i < 24; i++) {
            const [angle, radius] = [i * Math.PI / 12, i % 2 ? 1.3 : 2.6];
            c.lineTo(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
        }
        c.closePath();
        c.fill();
        c.stroke();
    }

    drawWalker(c, { pose: [x, y, dx, dy], s }) {
        const swing = Math.sin(s * 4) * 0.28;
        c.save();
        c.transform(dx, dy, -dy, dx, x, y);
        c.fillStyle = this.colours["canvas-ink"];
        this.disc(c, swing, 0.22, 0.2);
        this.disc(c, -swing, -0.22, 0.2);
        c.fillStyle = this.colours.walker;
        c.beginPath();
        c.ellipse(0, 0, 0.42, 0.72, 0, 0, 2 * Math.PI);
        c.fill();
        c.fillStyle = this.colours["canvas-paper"];
        this.disc(c, 0.05, 0, 0.3);
        c.restore();
    }

    // -- words: in pixels, so that they are upright ----------------------------------------------------------------

    pixels([x, y]) {
        return [this.width / 2 + x * this.scale, this.height / 2 - y * this.scale];
    }

    drawLabels(c, world, ways, selected, about) {
        c.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
        c.textAlign = "center";
        c.textBaseline = "middle";
        c.font = "600 11px system-ui, sans-serif";
        this.taken = [];
        world.crowd.forEach(other => this.badge(c, other, other.number === about ? this.colours.zone : this.colours["canvas-ink"]));
        this.drawStopLabel(c, world, ways[0]);
        const named = world.crowd.find(other => about === null ? other.seat === selected : other.number === about);
        const reach = named && world.reach(named);
        if (reach) reach.forEach(([, to], i) => this.label(c, ways[named.path], to + named.length / 2, `${REACH_TIMES[i]} s`));
    }

    // Beside the way, to its right, if there is room.
    label(c, way, s, text) {
        if (s >= way.length) return;
        const [[x, y], angle] = [way.at(s), way.heading(s)];
        const [px, py] = this.pixels([x + Math.sin(angle) * 2.2, y - Math.cos(angle) * 2.2]);
        const free = this.taken.every(([a, b, width]) => Math.abs(a - px) > (width + 30) / 2 || Math.abs(b - py) > 17);
        if (free) this.plate(c, px, py, text, this.colours["canvas-paper"], this.colours["canvas-ink"]);
    }

    plate(c, x, y, text, paper, ink) {
        const width = c.measureText(text).width + 8;
        this.taken.push([x, y, width]);
        c.fillStyle = paper;
        c.beginPath();
        c.roundRect(x - width / 2, y - 8, width, 16, 4);
        c.fill();
        c.fillStyle = ink;
        c.fillText(text, x, y + 0.5);
    }

    badge(c, other, paper) {
        const [x, y] = this.pixels(other.pose);
        const margin = 14;
        if (x < -margin || x > this.width + margin || y < -margin || y > this.height + margin) return;
        const text = other.hidden ? `${other.number} hidden` : `${other.number}`;
        this.plate(c, x, y - (other.kind === "pedestrian" ? 17 : 0), text, paper, this.colours["canvas-paper"]);
    }

    drawStopLabel(c, world, way) {
        // In a small picture these would hide more than they say.
        if (this.small) return;
        const { planned, decision, ego } = world;
        const [x, y] = this.pixels(ego.pose);
        const beside = ego.width / 2 * this.scale + 24;
        this.plate(c, x - ego.pose[3] * beside, y - ego.pose[2] * beside, "Cede", this.colours.ego, this.colours["ego-ink"]);
        const rests = ego.speed < 0.5 && decision.go === 0;
        if (!planned || rests || planned.stop + ego.length / 2 > way.length - 1) return;
        const s = planned.stop + ego.length / 2;
        const [[a, b], angle] = [way.at(s), way.heading(s)];
        const [px, py] = this.pixels([a + Math.sin(angle) * 4.2, b - Math.cos(angle) * 4.2]);
        const text = decision.go > 0 ? `go ${(decision.go * PERIOD).toFixed(1)} s, then stops here` : "stops here";
        const half = c.measureText(text).width / 2 + 8;
        const inside = limit(px, half, this.width - half);
        this.plate(c, inside, limit(py, 12, this.height - 12), text, this.colours.plan, this.colours["ego-ink"]);
    }
}

// The stretch that bumpers touch, from arc lengths of a vehicle's centre.
function shrunk(from, to, length) {
    const [a, b] = [from + length / 2, to - length / 2];
    return a < b ? [a, b] : [(from + to) / 2 - 0.6, (from + to) / 2 + 0.6];
}

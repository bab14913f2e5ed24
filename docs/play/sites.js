"use strict";
// The junctions: where roads and ways are, who goes first, and who is there. Metres, x to the east, y to the north;
// traffic keeps to the right.

const KINDS = {
    car: { word: 0, length: 4.6, width: 1.9, speed: 9 },
    lorry: { word: 1, length: 9.0, width: 2.4, speed: 8 },
    // Given to the controller as a small, slow bicycle: the page does not use its class for people on foot.
    pedestrian: { word: 2, length: 0.7, width: 0.7, speed: 1.4 },
};

const limit = (value, low, high) => Math.min(Math.max(value, low), high);

// A polyline by arc length.
class Polyline {
    constructor(points) {
        this.points = points;
        this.arc = [0];
        for (let i = 1; i < points.length; i++) {
            const [[a, b], [c, d]] = [points[i - 1], points[i]];
            this.arc.push(this.arc[i - 1] + Math.hypot(c - a, d - b));
        }
        this.length = this.arc[this.arc.length - 1];
    }

    at(s) {
        const i = this.segment(s);
        const share = (limit(s, 0, this.length) - this.arc[i]) / (this.arc[i + 1] - this.arc[i]);
        const [[a, b], [c, d]] = [this.points[i], this.points[i + 1]];
        return [a + share * (c - a), b + share * (d - b)];
    }

    // Direction at s, as an angle.
    heading(s) {
        const i = this.segment(s);
        const [[a, b], [c, d]] = [this.points[i], this.points[i + 1]];
        return Math.atan2(d - b, c - a);
    }

    segment(s) {
        let i = 0;
        while (i < this.points.length - 2 && this.arc[i + 1] < s) i++;
        return i;
    }

    // The points from one arc length to another.
    slice(from, to) {
        const [a, b] = [limit(from, 0, this.length), limit(to, 0, this.length)];
        const inside = this.points.filter((_, i) => this.arc[i] > a && this.arc[i] < b);
        return [this.at(a), ...inside, this.at(b)];
    }

    // The arc length of the nearest place to a point.
    project([x, y]) {
        let best = [Infinity, 0];
        for (let i = 0; i + 1 < this.points.length; i++) {
            const [[a, b], [c, d]] = [this.points[i], this.points[i + 1]];
            const length = this.arc[i + 1] - this.arc[i];
            const share = limit(((x - a) * (c - a) + (y - b) * (d - b)) / (length * length), 0, 1);
            const away = Math.hypot(a + share * (c - a) - x, b + share * (d - b) - y);
            if (away < best[0]) best = [away, this.arc[i] + share * length];
        }
        return best[1];
    }
}

const LANE = 3.5; // width of a lane
const FAR = 78; // where ways begin and end
const BOX = 8; // where straight ways end before a crossing
const ARMS = { E: 0, N: 90, W: 180, S: 270 };
const radians = degrees => degrees * Math.PI / 180;

// The point that is `ahead` from the centre towards an arm and `beside` to the left of that direction.
function onArm(arm, ahead, beside) {
    const [c, s] = [Math.cos(radians(ARMS[arm])), Math.sin(radians(ARMS[arm]))];
    return [c * ahead - s * beside, s * ahead + c * beside];
}
const outwards = arm => onArm(arm, 1, 0);
const inwards = arm => onArm(arm, -1, 0);

// A cubic Bézier curve from `a` with direction `u` to `b` with direction `v`, without its first point.
function curve(a, u, b, v, share = 0.39, pieces = 14) {
    const handle = share * Math.hypot(b[0] - a[0], b[1] - a[1]);
    const c = [a[0] + handle * u[0], a[1] + handle * u[1]];
    const d = [b[0] - handle * v[0], b[1] - handle * v[1]];
    return Array.from({ length: pieces }, (_, i) => {
        const t = (i + 1) / pieces, r = 1 - t;
        return [0, 1].map(k => r * r * r * a[k] + 3 * r * r * t * c[k] + 3 * r * t * t * d[k] + t * t * t * b[k]);
    });
}

// The way from one arm to another over a crossing.
function across(from, to) {
    const [start, enter] = [onArm(from, FAR, LANE / 2), onArm(from, BOX, LANE / 2)];
    const [leave, end] = [onArm(to, BOX, -LANE / 2), onArm(to, FAR, -LANE / 2)];
    const straight = (ARMS[from] + 180) % 360 === ARMS[to];
    return straight ? [start, end] : [start, enter, ...curve(enter, inwards(from), leave, outwards(to)), end];
}

const RING = 13.5; // radius of the circulating lane's middle
const SPREAD = 25; // degrees between an arm and where its ways meet the ring

// The way from one arm to another around a roundabout, counter-clockwise.
function around(from, to) {
    const on = degrees => [RING * Math.cos(radians(degrees)), RING * Math.sin(radians(degrees))];
    const along = degrees => [-Math.sin(radians(degrees)), Math.cos(radians(degrees))];
    const first = ARMS[from] + SPREAD;
    const last = first + (((ARMS[to] - SPREAD - first) % 360) + 360) % 360;
    const [start, enter] = [onArm(from, FAR, LANE / 2), onArm(from, 25, LANE / 2)];
    const [leave, end] = [onArm(to, 25, -LANE / 2), onArm(to, FAR, -LANE / 2)];
    const pieces = Math.ceil((last - first) / 6);
    const ring = Array.from({ length: pieces }, (_, i) => on(first + (last - first) * (i + 1) / pieces));
    return [
        start, enter, ...curve(enter, inwards(from), on(first), along(first), 0.4, 10), ...ring,
        ...curve(on(last), along(last), leave, outwards(to), 0.4, 10), end,
    ];
}

// Somebody who is there when a round begins: how far along the way, at what speed; `stops` at the line for so long (s).
const someone = (kind, way, s, speed, stops = null) => ({ kind, way, s, speed, stops });

// A crossing on an arm, `x` metres from the centre.
const WALK = 12.5;
const walk = arm => [onArm(arm, WALK, 16), onArm(arm, WALK, -16)];

// `ways` of others by name, `first`: whose way goes before the ego's (all others go after it).
const SITES = [
    {
        id: "yield", name: "Two-way stop", arms: ["N", "E", "S", "W"], control: "yield", from: "S",
        turns: { left: "W", straight: "N", right: "E" }, turn: "straight", start: 48, speed: 8.5,
        see: "The road from west to east does not stop. The policy would like to cross early; the shield lets it go when it is " +
            "certain to be across before the earliest arrival of everybody on that road.",
        ways: { E: across("E", "W"), W: across("W", "E"), N: across("N", "S") },
        first: ["E", "W"],
        walks: false,
        crowd: [
            someone("car", "W", 12, 8), someone("lorry", "E", 14, 7), someone("car", "E", 29, 10), someone("car", "W", 48, 7),
        ],
    },
    {
        id: "stop", name: "All-way stop", arms: ["N", "E", "S", "W"], control: "stop", from: "S",
        turns: { left: "W", straight: "N", right: "E" }, turn: "straight", start: 48, speed: 8.5,
        see: "Everybody stops, then goes. Cede trusts nobody to wait: it goes when no car, and nobody on foot, can be where " +
            "it will be. Tick the rule of an all-way stop below, and it takes its turn.",
        ways: { N: across("N", "S"), E: across("E", "W"), W: across("W", "E") },
        first: ["N", "E", "walk"],
        walks: true,
        crowd: [
            someone("car", "N", 57, 6, 0.1), someone("car", "W", 41, 10, 3.5), someone("pedestrian", "walk", 7, 1.4),
        ],
    },
    {
        id: "ring", name: "Roundabout", arms: ["N", "E", "S", "W"], control: "ring", from: "S",
        turns: { left: "W", straight: "N", right: "E" }, turn: "straight", start: 38, speed: 7.5,
        see: "Those in the ring go first. Cede enters where the one behind has room to stop, whatever Cede has to do " +
            "ahead of it.",
        ways: { W: around("W", "E"), N: around("N", "E"), E: around("E", "S"), WN: around("W", "N") },
        first: ["W", "N", "E", "WN"],
        walks: false,
        crowd: [
            someone("car", "W", 14, 8), someone("car", "N", 47, 6), someone("car", "E", 23, 10), someone("lorry", "WN", 56, 10),
        ],
    },
    {
        id: "tee", name: "T-junction", arms: ["E", "S", "W"], control: "yield", from: "S",
        turns: { left: "W", right: "E" }, turn: "left", start: 48, speed: 8,
        see: "Cede comes from the side road and turns left, across one lane and into another, past somebody on foot. " +
            "Watch the plan: it never ends in anybody's way.",
        ways: { W: across("W", "E"), E: across("E", "W"), ES: across("E", "S") },
        first: ["W", "E", "ES", "walk"],
        walks: true,
        crowd: [
            someone("car", "W", 6, 9), someone("car", "E", 27, 9), someone("car", "ES", 5, 10), someone("pedestrian", "walk", 7, 1.4),
        ],
    },
];

// The junction of a site for one turn of the ego: the ego's path and those of all others, and who goes first.
function layout(site, turn) {
    const to = site.turns[turn];
    const way = site.control === "ring" ? around : across;
    const ways = Object.entries(site.ways).map(([name, points]) => ({ name, points, classes: [] }));
    if (site.walks) ways.push({ name: "walk", points: walk(to), classes: [] });
    // A path is for one class: as many paths of a way as there are classes on it.
    const paths = [{ ...KINDS.car, name: "ego", kind: "car", points: way(site.from, to) }];
    for (const { name, points } of ways) {
        const kinds = new Set(site.crowd.filter(one => one.way === name).map(one => one.kind));
        for (const kind of kinds) paths.push({ ...KINDS[kind], name, kind, points });
    }
    const first = paths.map(path => site.first.includes(path.name));
    return { paths, first, to, ways: paths.map(path => new Polyline(path.points)) };
}

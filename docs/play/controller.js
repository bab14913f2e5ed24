"use strict";
// The controller: the WebAssembly module that play/build.sh writes, and names for its calls (play/src/call.rs).

const Call = {
    path: 0, rightOfWay: 1, build: 2, named: 3, contract: 4, enter: 5, decide: 6, plan: 7, text: 8, zones: 9, reach: 10,
    pose: 11, line: 12, gap: 13, forget: 14, setLine: 15,
};

// Numbers of a contract in the controller's order.
const CONTRACT_FIELDS = [
    "latency", "positionError", "speedError", "egoMaxSpeed", "egoAcceleration", "egoGo", "egoBraking", "egoEmergency",
    "otherMaxSpeed", "otherAcceleration", "otherBraking", "followerReaction", "followerBraking", "egoLag",
    "egoGain", "egoDisturbance", "jitter",
];

// Words of a decision, and accelerations of the shield's grid.
const ANSWER = 18;
const GRID = 13;

async function compileController() {
    const bytes = Uint8Array.from(atob(CEDE_MODULE), c => c.charCodeAt(0));
    return WebAssembly.compile(bytes);
}

// One vehicle at one junction; the first path is the ego's.
class Controller {
    // `record`, if it is given, is told every call with its words and its answer. Call 255 is the beginning.
    constructor(module, record) {
        const { exports } = new WebAssembly.Instance(module);
        this.ask = exports.call;
        // Nothing is allocated, so the memory never moves.
        this.words = new Uint32Array(exports.memory.buffer, exports.words(), 1024);
        this.numbers = new Float32Array(exports.memory.buffer, exports.words(), 1024);
        this.record = record;
        if (record) record(255, [], 0, []);
    }

    // Writes the words of a question from place `at` on; a whole number is { word }.
    put(values, at = 0) {
        for (const value of values) {
            if (typeof value === "number") this.numbers[at] = value;
            else this.words[at] = value.word;
            at += 1;
        }
        return at;
    }

    // The number of words of the answer; throws what the controller says if it refuses.
    call(number, count) {
        const question = this.record && this.words.slice(0, count);
        const answered = this.ask(number, count);
        if (this.record) this.record(number, question, answered, this.words.slice(0, Math.max(answered, 0)));
        if (answered < 0) throw new Error(this.text());
        return answered;
    }

    text() {
        this.call(Call.text, 0);
        const bytes = new Uint8Array(this.words.buffer, this.words.byteOffset + 4, this.words[0]);
        return new TextDecoder().decode(bytes);
    }

    path({ kind, length, width, points }) {
        const count = this.put([{ word: kind }, length, width, { word: points.length }, ...points.flat()]);
        this.call(Call.path, count);
    }

    // If both arrive at once, `first` goes first.
    rightOfWay(first, second) {
        this.call(Call.rightOfWay, this.put([{ word: first }, { word: second }, { word: 0 }]));
    }

    build() {
        this.call(Call.build, 0);
    }

    // A contract by name: 0 worst case, 1 all-way stop, 2 one in which nothing is exact.
    named(which) {
        this.call(Call.named, this.put([{ word: which }]));
        const contract = Object.fromEntries(CONTRACT_FIELDS.map((field, i) => [field, this.numbers[i]]));
        return { ...contract, precedence: this.words[CONTRACT_FIELDS.length] === 1 };
    }

    setContract(contract) {
        const numbers = CONTRACT_FIELDS.map(field => contract[field]);
        this.call(Call.contract, this.put([...numbers, { word: contract.precedence ? 1 : 0 }]));
    }

    enter() {
        this.call(Call.enter, 0);
    }

    // What to do from `micros` on; `ego` is { s, speed, pose }, tracks have number, kind and path as well.
    decide(micros, ego, tracks) {
        const vehicle = ({ s, speed, pose }) => [s, speed, ...pose];
        let at = this.put([{ word: micros >>> 0 }, { word: Math.floor(micros / 2 ** 32) }, ...vehicle(ego)]);
        at = this.put([{ word: tracks.length }], at);
        for (const track of tracks) {
            const { number, kind, path } = track;
            at = this.put([{ word: number }, { word: kind }, { word: path }, ...vehicle(track)], at);
        }
        this.call(Call.decide, at);
        const decision = readDecision(this.words, this.numbers);
        decision.text = this.text();
        return decision;
    }

    // { stop, places }: where the ego is at rest at the latest, and where it nominally is period by period; or null.
    plan() {
        const count = this.call(Call.plan, 0);
        if (count === 0) return null;
        return { stop: this.numbers[0], places: [...this.numbers.subarray(1, count)] };
    }

    // Where a vehicle of `path` and one of `other` can touch.
    zones(path, other) {
        const count = this.call(Call.zones, this.put([{ word: path }, { word: other }]));
        const zones = [];
        for (let at = 0; at < count; at += 7) {
            const [egoFrom, egoTo, otherFrom, otherTo, leadFrom, leadTo] = this.numbers.subarray(at + 1, at + 7);
            zones.push({ kind: this.words[at], egoFrom, egoTo, otherFrom, otherTo, leadFrom, leadTo });
        }
        return zones;
    }

    reach(s, speed, time) {
        this.call(Call.reach, this.put([s, speed, time]));
        return [this.numbers[0], this.numbers[1]];
    }

    pose(path, s) {
        this.call(Call.pose, this.put([{ word: path }, s]));
        return [...this.numbers.subarray(0, 4)];
    }

    line(path) {
        this.call(Call.line, this.put([{ word: path }]));
        return { length: this.numbers[0], line: this.numbers[1] };
    }

    gap(first, second) {
        this.call(Call.gap, this.put([first, second].flatMap(({ pose, length, width }) => [...pose, length, width])));
        return this.numbers[0];
    }

    forget(number) {
        this.call(Call.forget, this.put([{ word: number }]));
    }
}

// The words of firmware/cortex-m/golden/src/answer.rs, the proposal, and what of the grid is accepted.
function readDecision(words, numbers) {
    const code = words[2];
    const cause = code === 0 ? "policy" : code < 10 ? "shielded" : "fallback";
    const options = [];
    for (let i = 0; i < GRID; i++) {
        const at = ANSWER + 1 + 3 * i;
        options.push({ acceleration: numbers[at], accepted: words[at + 1] === 1, margin: numbers[at + 2] });
    }
    return {
        acceleration: numbers[0],
        margin: numbers[1],
        cause,
        // Of whom the reason speaks.
        about: cause === "shielded" ? words[3] : null,
        noPlan: code === 11,
        go: words[11] === 0 ? null : words[11] - 1,
        breach: words[13] === 0 ? null : words[13] === 1 ? "ego" : words[14],
        svo: words[15] === 0 ? null : { other: words[15] - 1, angle: numbers[16], acceleration: numbers[17] },
        proposal: numbers[ANSWER],
        options,
    };
}

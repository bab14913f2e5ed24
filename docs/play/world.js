"use strict";
// What really happens: vehicles on their ways, and an actuator between the controller and the ego. The controller is told what sensors see; whether its contract holds is up to this file and to the visitor.

const PERIOD = 0.1; // s between two decisions
const TICK = 1 / 120; // s
const EXACT = 1e-6; // s that two equal times may differ by: the contract's are rounded to 32 bits
const AWAY = 5; // s until somebody comes after one who has left
const REACH_TIMES = [1, 2, 3]; // s for which reach is shown

// What is true beyond the contract: each of these breaks one of its conditions.
const TRUTH = {
    late: false, // commands take effect after twice the stated time
    weak: false, // brakes give half of what is stated
    wild: false, // others do twice what is stated
    blurred: false, // sensors err by a metre more than is stated
};

// One step of motion without going backwards.
function move(vehicle, acceleration, time) {
    const end = vehicle.speed + acceleration * time;
    if (end < 0) {
        vehicle.s += acceleration < 0 ? vehicle.speed * vehicle.speed / (-2 * acceleration) : 0;
        vehicle.speed = 0;
    } else {
        vehicle.s += (vehicle.speed + end) * time / 2;
        vehicle.speed = end;
    }
    vehicle.acceleration = acceleration;
}

// The same numbers for the same seed.
function generator(seed) {
    let state = seed >>> 0;
    return () => {
        state = state + 0x6d2b79f5 >>> 0;
        let t = Math.imul(state ^ state >>> 15, state | 1);
        t ^= t + Math.imul(t ^ t >>> 7, t | 61);
        return ((t ^ t >>> 14) >>> 0) / 4294967296;
    };
}

class World {
    constructor(module, site, turn, contract, truth, record) {
        Object.assign(this, { module, site, turn, contract, truth, record });
        this.random = generator(7);
        this.rounds = 0;
        this.begin();
    }

    // A round: the ego comes once through the junction. A controller belongs to one approach.
    begin() {
        this.time = 0;
        this.layout = layout(this.site, this.turn);
        this.ways = this.layout.ways;
        const controller = new Controller(this.module, this.record);
        this.controller = controller;
        this.layout.paths.forEach(path => controller.path({ ...path, kind: path.word }));
        this.layout.first.forEach((first, i) => {
            if (i > 0) controller.rightOfWay(first ? i : 0, first ? 0 : i);
        });
        controller.build();
        controller.setContract(this.contract);
        controller.enter();
        this.lines = this.layout.paths.map((_, i) => controller.line(i));
        // How each two ways meet; those of one way in several classes do not.
        this.meetings = this.layout.paths.map(({ name }, i) => this.layout.paths.map((other, j) =>
            name === other.name ? [] : controller.zones(i, j)));
        this.zones = this.meetings[0];
        this.ego = { path: 0, ...KINDS.car, s: this.site.start, speed: this.site.speed, acceleration: 0, name: "ego" };
        this.place(this.ego);
        this.commands = [{ from: -1, acceleration: 0 }];
        this.felt = 0;
        this.numbers = 0;
        // The first round is the one of the links to a moment; then everybody begins somewhat elsewhere.
        const shift = () => this.rounds === 0 ? 0 : 6 * (this.random() - 0.5);
        this.crowd = this.site.crowd.map((one, i) => this.join({ ...one, seat: i, s: Math.max(one.s + shift(), 0) }));
        this.rounds += 1;
        this.decision = null;
        this.planned = null;
        this.history = [];
        this.ended = null;
        this.nextDecision = 0;
    }

    place(vehicle) {
        vehicle.pose = this.controller.pose(vehicle.path, vehicle.s);
    }

    // Somebody with a new number, on one of the paths.
    join({ kind, way, s, speed, stops, seat }) {
        const path = this.layout.paths.findIndex(path => path.name === way && path.kind === kind);
        const other = {
            ...KINDS[kind], kind, way, path, s, speed, stops, seat, wanted: kind === "pedestrian" ? 1.4 : Math.max(speed, 6),
            acceleration: 0, waited: 0, number: ++this.numbers, mode: "auto", hidden: false, seen: null, left: null,
        };
        this.place(other);
        return other;
    }

    // Replaces the contract while it drives; throws what the controller says of one that it refuses.
    setContract(contract) {
        this.controller.setContract(contract);
        this.contract = contract;
    }

    // Advances by `time` (s), a whole number of ticks.
    advance(time) {
        for (let ticks = Math.round(time / TICK); ticks > 0 && !this.ended; ticks--) this.tick();
    }

    tick() {
        if (this.time >= this.nextDecision - EXACT) {
            this.decide();
            this.nextDecision += PERIOD;
        }
        for (const other of this.crowd) {
            move(other, drive(this, other), TICK);
            this.place(other);
        }
        move(this.ego, this.actuated(), TICK);
        this.ego.s = Math.min(this.ego.s, this.lines[0].length);
        this.place(this.ego);
        this.time += TICK;
        this.crowd = this.crowd.map(other => this.replaced(other));
        this.judge();
    }

    // What a sensor sees of a vehicle.
    sensed(vehicle) {
        const error = this.contract.positionError + (this.truth.blurred ? 1 : 0);
        const off = Math.sin(this.time * 1.3 + vehicle.path) * error;
        const s = limit(vehicle.s + off, 0, this.lines[vehicle.path].length);
        return { s, speed: vehicle.speed, pose: this.controller.pose(vehicle.path, s) };
    }

    decide() {
        const seen = this.crowd.filter(other => !other.hidden && other.left === null);
        const tracks = seen.map(other => ({ number: other.number, kind: other.word, path: other.path, ...this.sensed(other) }));
        tracks.forEach((track, i) => {
            seen[i].seen = { s: track.s, speed: track.speed, time: this.time };
        });
        const decision = this.controller.decide(Math.round(this.nextDecision * 1e6), this.sensed(this.ego), tracks);
        this.decision = decision;
        this.planned = this.controller.plan();
        const late = this.contract.latency * (this.truth.late ? 2 : 1);
        this.commands.push({ from: this.time + late, acceleration: decision.acceleration });
        this.history.push({ time: this.time, decision, speed: this.ego.speed });
        if (this.history.length > 400) this.history.shift();
    }

    // What the ego does in this tick: it follows the last command that has taken effect, as far as the brakes can, with a
    // first-order lag. The mean over the tick.
    actuated() {
        while (this.commands.length > 1 && this.commands[1].from <= this.time + EXACT) this.commands.shift();
        const { acceleration } = this.commands[0];
        const wanted = this.truth.weak && acceleration < 0 ? acceleration / 2 : acceleration;
        const lag = this.contract.egoLag * (this.truth.late ? 2 : 1);
        if (lag === 0) return this.felt = wanted;
        const [away, left] = [this.felt - wanted, Math.exp(-TICK / lag)];
        this.felt = wanted + away * left;
        return wanted + away * (1 - left) * lag / TICK;
    }

    // Metres in which the ego can stop, errors of its sensors and the next command included.
    stopping() {
        const { latency, egoLag, egoAcceleration, egoBraking, positionError } = this.contract;
        const time = PERIOD + latency + egoLag;
        const speed = this.ego.speed + egoAcceleration * time;
        return 2 * positionError + speed * time + speed * speed / (2 * egoBraking);
    }

    // The same one, or who comes after it when it has left.
    replaced(other) {
        const end = this.lines[other.path].length - 1;
        if (other.s < end) return other;
        if (other.left === null) {
            other.left = this.time;
            this.controller.forget(other.number);
        }
        [other.s, other.speed] = [end, 0];
        const blocked = this.crowd.some(one => one.way === other.way && one.s < 20);
        // Nobody comes into sight of an ego that is, or has planned to be, in its way, or only just out of it: duty U3 of
        // the manual.
        const { go, margin } = this.decision;
        const surprised = go !== 0 || margin < 0.02 || occupied(this, other, this.stopping() + 0.5).length > 0;
        if (blocked || surprised || this.time < other.left + AWAY) return other;
        return this.join({ ...this.site.crowd[other.seat], seat: other.seat, s: 0, speed: other.wanted });
    }

    // Collisions, and the end of the way.
    judge() {
        const hit = this.crowd.find(other => {
            const [dx, dy] = [other.pose[0] - this.ego.pose[0], other.pose[1] - this.ego.pose[1]];
            return dx * dx + dy * dy < 150 && this.controller.gap(this.ego, other) < 0;
        });
        if (hit) this.ended = { how: "collision", with: hit };
        else if (this.ego.s >= this.lines[0].length - 34) this.ended = { how: "through" };
    }

    // Where an other may be in each of the times (s) to come, as far as the controller knows; null if it never saw it.
    reach(other) {
        if (!other.seen || other.left !== null) return null;
        const { s, speed, time } = other.seen;
        return REACH_TIMES.map(ahead => this.controller.reach(s, speed, ahead + this.time - time));
    }
}

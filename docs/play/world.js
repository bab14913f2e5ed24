"use strict";
// What really happens: vehicles on their ways, drivers of the others, and an actuator between the controller and the
// ego. The controller is told what sensors see; whether its contract holds is up to this file and to the visitor.

const PERIOD = 0.1; // s between two decisions
const TICK = 1 / 120; // s
const REACH_TIMES = [1, 2, 3]; // s for which reach is shown

// What is true beyond the contract: each of these breaks one of its conditions.
const TRUTH = {
    late: false, // commands take effect after twice the stated time
    weak: false, // brakes give half of what is stated
    wild: false, // others do twice what is stated
    blurred: false, // sensors err by a metre more than is stated
};

const limit = (value, low, high) => Math.min(Math.max(value, low), high);

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
        this.numbers = 0;
        this.begin();
    }

    // A round: the ego comes once through the junction. A controller belongs to one approach.
    begin() {
        this.time = 0;
        this.layout = layout(this.site, this.turn);
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
        this.zones = this.layout.paths.map((_, i) => i === 0 ? [] : controller.zones(i));
        this.ego = { path: 0, ...KINDS.car, s: FAR - 48, speed: this.site.speed, acceleration: 0, name: "ego" };
        this.place(this.ego);
        this.commands = [{ from: -1, acceleration: 0 }];
        this.crowd = this.site.crowd.map((one, i) => this.join({ ...one, seat: i }));
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
            acceleration: 0, waited: 0, number: ++this.numbers % 1000, mode: "auto", hidden: false, seen: null,
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
        if (this.time >= this.nextDecision - 1e-9) {
            this.decide();
            this.nextDecision += PERIOD;
        }
        for (const other of this.crowd) {
            move(other, this.driver(other), TICK);
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
        const seen = this.crowd.filter(other => !other.hidden);
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

    // What the ego does now: the last command that has taken effect, as far as the brakes can.
    actuated() {
        while (this.commands.length > 1 && this.commands[1].from <= this.time + 1e-9) this.commands.shift();
        const { acceleration } = this.commands[0];
        return this.truth.weak && acceleration < 0 ? acceleration / 2 : acceleration;
    }

    // What others can do: the contract's bounds, or twice as much.
    bounds() {
        const { otherAcceleration, otherBraking, otherMaxSpeed } = this.contract;
        const wild = this.truth.wild ? 2 : 1;
        return { most: otherAcceleration * wild, least: -otherBraking, top: otherMaxSpeed * (wild > 1 ? 1.5 : 1) };
    }

    // The acceleration of somebody else, whoever drives.
    driver(other) {
        const { most, least, top } = this.bounds();
        const walks = other.kind === "pedestrian";
        const wished = {
            auto: () => this.automatic(other),
            go: () => walks ? 2 * (2.2 - other.speed) : most,
            brake: () => walks ? -4 : -6,
            hold: () => 0,
            drag: () => this.towards(other, most, least),
        }[other.mode]();
        // Who finds the ego ahead in its lane keeps behind it (C6), unless others may do anything.
        const behind = this.truth.wild ? most : this.behind(other, this.ego, this.leads(other));
        const room = (top - other.speed) / TICK;
        return limit(Math.min(wished, behind, room), least, most);
    }

    // Towards the place to which the visitor drags it.
    towards(other, most, least) {
        const distance = other.goal - other.s;
        const speed = distance > 0 ? Math.sqrt(2 * 0.6 * Math.abs(least) * distance) : 0;
        return limit((Math.min(speed, 4 * distance + 0.5) - other.speed) * 6, 0.7 * least, most);
    }

    // Metres from the other's bumper to the ego's, if the ego is ahead in a lane that both share; else null.
    leads(other) {
        for (const zone of this.zones[other.path]) {
            const lead = this.ego.s - other.s;
            const inside = this.ego.s > zone.egoFrom && this.ego.s < zone.egoTo && other.s < zone.otherTo;
            if (zone.kind !== 0 && inside && lead >= (zone.leadFrom + zone.leadTo) / 2) return lead - zone.leadTo;
        }
        return null;
    }

    // The acceleration (m/s²) that keeps a gap (m) to whoever is ahead: the intelligent driver model.
    behind(other, ahead, gap) {
        if (gap === null) return Infinity;
        const closing = other.speed - ahead.speed;
        const wanted = 1.5 + Math.max(0, other.speed * 0.9 + other.speed * closing / (2 * Math.sqrt(2 * 4)));
        return 2 * (1 - (wanted / Math.max(gap, 0.2)) ** 2);
    }

    // Drives as people do: up to a speed, behind whoever is ahead, and it stops at its line where it must.
    automatic(other) {
        if (other.kind === "pedestrian") return 2 * (other.wanted - other.speed);
        let wished = 1.8 * (1 - (other.speed / other.wanted) ** 4);
        const sameWay = this.crowd.filter(one => one !== other && one.way === other.way && one.s > other.s);
        for (const ahead of sameWay) {
            wished = Math.min(wished, this.behind(other, ahead, ahead.s - other.s - (ahead.length + other.length) / 2));
        }
        return Math.min(wished, this.lineAhead(other));
    }

    // The acceleration that stops at the line, for as long as there is a reason to.
    lineAhead(other) {
        if (other.stops === null || other.waited > other.stops) return Infinity;
        const distance = this.lines[other.path].line - 0.6 - other.s;
        if (distance < -0.5) return Infinity;
        if (other.speed < 0.2 && distance < 1.5) {
            // Waits its turn, and for the ego if that is in the way.
            if (!this.occupied(other)) other.waited += TICK;
            return -2;
        }
        const needed = other.speed * other.speed / (2 * Math.max(distance, 0.1));
        return needed > 1.6 ? -needed : Infinity;
    }

    // Whether the ego is in a zone of this one.
    occupied(other) {
        return this.zones[other.path].some(({ egoFrom, egoTo }) => this.ego.s > egoFrom && this.ego.s < egoTo);
    }

    // The same one, or who comes after it when it has left.
    replaced(other) {
        const { length } = this.lines[other.path];
        if (other.s < length - 0.5) return other;
        const blocked = this.crowd.some(one => one.way === other.way && one.s < 20);
        if (blocked) {
            [other.s, other.speed] = [length - 0.4, 0];
            return other;
        }
        this.controller.forget(other.number);
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
        if (!other.seen) return null;
        const { s, speed, time } = other.seen;
        return REACH_TIMES.map(ahead => this.controller.reach(s, speed, ahead + this.time - time));
    }
}

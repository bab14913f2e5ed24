"use strict";
// Who drives the others: the visitor, or a driver who keeps to the rules of the road.

// What others can do: the contract's bounds, or more.
function bounds({ contract, truth }) {
    const { otherAcceleration, otherBraking, otherMaxSpeed } = contract;
    return {
        most: otherAcceleration * (truth.wild ? 2 : 1),
        least: -otherBraking,
        top: otherMaxSpeed * (truth.wild ? 1.5 : 1),
    };
}

// The acceleration of somebody else, whoever drives.
function drive(world, other) {
    const { most, least, top } = bounds(world);
    const walks = other.kind === "pedestrian";
    const wished = {
        auto: () => automatic(world, other),
        go: () => walks ? 2 * (2.2 - other.speed) : most,
        brake: () => walks ? -4 : -6,
        hold: () => 0,
        drag: () => towards(other, most, least),
    }[other.mode]();
    // Who finds the ego ahead in its lane keeps behind it (C6), unless others may do anything.
    const behind = world.truth.wild ? most : follow(other, world.ego, ahead(other, world.ego, world.meetings[other.path][0]));
    const room = (top - other.speed) / TICK;
    return limit(Math.min(wished, behind, room), least, most);
}

// Towards the place to which the visitor drags it.
function towards(other, most, least) {
    const distance = other.goal - other.s;
    const speed = distance > 0 ? Math.sqrt(2 * 0.6 * Math.abs(least) * distance) : 0;
    return limit((Math.min(speed, 4 * distance + 0.5) - other.speed) * 6, 0.7 * least, most);
}

// As people drive: up to a speed, behind whoever is ahead, in turn where ways meet, and not over a line that stops.
function automatic(world, other) {
    if (other.kind === "pedestrian") return walkOn(world, other);
    let wished = Math.min(1.8 * (1 - (other.speed / other.wanted) ** 4), lineAhead(world, other));
    for (const one of world.crowd) {
        if (one === other || one.left !== null) continue;
        if (one.way !== other.way) {
            wished = Math.min(wished, meet(other, one, world.meetings[other.path][one.path]));
        } else if (one.s > other.s) {
            wished = Math.min(wished, follow(other, one, one.s - other.s - (one.length + other.length) / 2));
        }
    }
    return Math.min(wished, ...occupied(world, other).map(zone => stopBefore(other, zone.egoFrom)));
}

// On foot: at a pace, but not into a vehicle.
function walkOn(world, other) {
    const standing = world.crowd.flatMap(one => world.meetings[other.path][one.path].filter(({ otherFrom, otherTo }) =>
        one.s > otherFrom && one.s < otherTo));
    const zones = [...standing, ...occupied(world, other)];
    return Math.min(2 * (other.wanted - other.speed), ...zones.map(zone => stopBefore(other, zone.egoFrom)));
}

// The crossing zones with the ego in which the ego is, or not `before` metres from them.
function occupied({ ego, meetings }, other, before = 0) {
    return meetings[other.path][0].filter(zone => zone.kind === 0 && ego.s > zone.otherFrom - before && ego.s < zone.otherTo);
}

// The acceleration (m/s²) that keeps a gap (m) to whoever is ahead, if there is one: the intelligent driver model
// (Treiber, Hennecke and Helbing, 2000).
function follow(other, leader, gap) {
    if (gap === null) return Infinity;
    const closing = other.speed - leader.speed;
    const wanted = 1.5 + Math.max(0, other.speed * 0.9 + other.speed * closing / (2 * Math.sqrt(2 * 4)));
    return 2 * (1 - (wanted / Math.max(gap, 0.2)) ** 2);
}

// Metres to the bumper of the one that is ahead in a lane that both share, or will share; else null.
function ahead(other, one, zones) {
    for (const { kind, egoTo, otherFrom, otherTo, leadFrom, leadTo } of zones) {
        const lead = other.s - one.s;
        const inside = one.s > otherFrom && one.s < otherTo && other.s < egoTo;
        if (kind !== 0 && inside && lead < (leadFrom + leadTo) / 2) return leadFrom - lead;
    }
    return null;
}

// Of two whose ways meet, who would be there later waits, or fits in behind.
function meet(other, one, zones) {
    let wished = Infinity;
    for (const zone of zones) {
        if (other.s > zone.egoTo || one.s > zone.otherTo) continue;
        if (zone.kind !== 0) {
            const lead = other.s - one.s;
            const near = one.s > zone.otherFrom - 20 && other.s > zone.egoFrom - 20;
            if (near && lead < (zone.leadFrom + zone.leadTo) / 2) wished = Math.min(wished, follow(other, one, zone.leadFrom - lead));
        } else {
            const [mine, theirs] = [until(other, zone.egoFrom), until(one, zone.otherFrom)];
            const later = mine > theirs || mine === theirs && other.number > one.number;
            const apart = mine - theirs > 6;
            if (later && !apart && mine > 0) wished = Math.min(wished, stopBefore(other, zone.egoFrom));
        }
    }
    return wished;
}

// The time (s) to a place; 0 past it.
const until = (one, s) => Math.max(s - one.s, 0) / Math.max(one.speed, 2);

// The acceleration that stops before a place, if it is time to brake and there is room.
function stopBefore(other, s) {
    const distance = s - 0.5 - other.s;
    const needed = other.speed * other.speed / (2 * Math.max(distance, 0.05));
    if (distance < -0.4 || needed > 7) return Infinity;
    return needed > 1.6 || distance < 1 ? -needed - 0.1 : Infinity;
}

// At its line it waits for so long, and for whoever is on the crossing.
function lineAhead(world, other) {
    if (other.stops === null || other.waited > other.stops) return Infinity;
    const distance = world.lines[other.path].line - 0.6 - other.s;
    if (distance < -0.5) return Infinity;
    if (other.speed > 0.2 || distance > 1.5) return stopBefore(other, world.lines[other.path].line - 0.2);
    const crossed = world.crowd.some(one =>
        one !== other && one.kind !== "pedestrian" && Math.hypot(one.pose[0], one.pose[1]) < BOX);
    if (!crossed && !occupied(world, other).length || other.waited + TICK < other.stops) other.waited += TICK;
    return -2;
}

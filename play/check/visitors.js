// Plays the page without its picture, with visitors who do whatever a generator of random numbers says, and writes every
// call and every answer to a file: visitors.js FILE [module.js]. The host repeats them (play/examples/replay.rs).
// Nobody may be hit while the contract holds; what breaks it must be told.
"use strict";
const fs = require("fs");
const { load } = require("./page.js");

const HELD = 12, BROKEN = 4; // rounds of each way through each junction, while the contract holds and while it does not
const SECONDS = 25;

// What must be said at least once while it is untrue.
const SAID = {
    late: "the ego deviated from the command",
    weak: "the ego deviated from the command",
    wild: "exceeds the contract's motion bounds",
    blurred: "exceeds the contract's motion bounds",
};

async function main([out, file]) {
    const { compileController, Controller, World, SITES, TRUTH, generator } = load(file);
    const module = await compileController();
    const chunks = [];
    const record = (call, question, answered, answer) =>
        chunks.push(Uint32Array.from([call, question.length, ...question, answered, ...answer]));
    const named = new Controller(module).named(0);
    const random = generator(1);
    const modes = ["auto", "go", "hold", "brake", "go"];
    const tally = { held: 0, broken: 0, decisions: 0, shielded: 0, said: {}, hits: {}, wrong: [] };

    // A round in which everybody else changes its mind every second or so.
    function round(world, name) {
        while (!world.ended && world.time < SECONDS) {
            for (const other of world.crowd) if (random() < 0.08) other.mode = modes[Math.floor(random() * modes.length)];
            world.advance(0.1);
            tally.decisions += 1;
            const { cause, text } = world.decision;
            tally.shielded += cause === "shielded" ? 1 : 0;
            if (name && text.includes(SAID[name])) tally.said[name] = (tally.said[name] ?? 0) + 1;
            if (!name && /deviated|exceeds|no plan/.test(text)) tally.wrong.push(`${world.site.id} ${world.turn} at ${world.time.toFixed(1)} s: ${text}`);
        }
        tally[name ? "broken" : "held"] += 1;
        if (world.ended?.how !== "collision") return;
        if (name) tally.hits[name] = (tally.hits[name] ?? 0) + 1;
        else tally.wrong.push(`${world.site.id} ${world.turn}: hit by ${world.ended.with.way} at ${world.time.toFixed(1)} s`);
    }

    for (const name of [null, ...Object.keys(SAID)]) {
        for (const site of SITES) {
            for (const turn of Object.keys(site.turns)) {
                const contract = { ...named, egoMaxSpeed: 12, egoEmergency: 7, egoBraking: 3 + Math.floor(random() * 4),
                    positionError: random() < 0.5 ? 0 : 0.2, latency: random() < 0.5 ? 0.1 : 0.24,
                    egoLag: random() < 0.5 ? 0 : 0.2 };
                const truth = { ...TRUTH, ...(name && { [name]: true }) };
                // One round of each is enough to be repeated on the host.
                const world = new World(module, site, turn, contract, truth, record);
                round(world, name);
                world.record = undefined;
                for (let i = 1; i < (name ? BROKEN : HELD); i++) {
                    world.begin();
                    round(world, name);
                }
            }
        }
    }

    fs.writeFileSync(out, Buffer.concat(chunks.map(words => Buffer.from(words.buffer))));
    console.log(`rounds within the contract: ${tally.held}, wrong: ${tally.wrong.length}; rounds outside: ${tally.broken}, ` +
        `hits: ${JSON.stringify(tally.hits)}, decisions with a word about it: ${JSON.stringify(tally.said)}; ` +
        `decisions: ${tally.decisions}, shielded: ${tally.shielded}`);
    for (const what of tally.wrong.slice(0, 9)) console.error(`while the contract held: ${what}`);
    const unsaid = Object.keys(SAID).filter(name => !tally.said[name]);
    for (const name of unsaid) console.error(`${name}: nothing was said of it`);
    return tally.wrong.length === 0 && unsaid.length === 0 && tally.shielded > 0;
}

main(process.argv.slice(2)).then(good => process.exit(good ? 0 : 1));

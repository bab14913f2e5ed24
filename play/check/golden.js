// Asks the page's controller what the host was asked, and compares every bit of every decision. The file is that of the
// bare-metal lane (firmware/cortex-m/golden). In Node: golden.js GOLDEN.bin [module.js]; in a browser: golden(…).
"use strict";

// How many decisions there are, and how many of them differ from the host's.
async function golden({ compileController, Controller, Call, ANSWER }, words) {
    const POINTS = 8, ROUTE = 6 + 2 * POINTS, VEHICLE = 7, OTHERS = 8, QUESTION = 1 + VEHICLE * (1 + OTHERS);
    const NONE = 0x7fc00000; // no number
    const module = await compileController();
    let at = 0, steps = 0, different = 0;
    while (at < words.length) {
        const [others, count, contract] = words.subarray(at, at + 3);
        at += 3;
        const controller = new Controller(module);
        const ask = (call, question) => {
            controller.words.set(question);
            return controller.call(call, question.length);
        };
        for (let path = 0; path <= others; path++, at += ROUTE) {
            const [length, width, first, priority, line, points, ...coordinates] = words.subarray(at, at + ROUTE);
            ask(Call.path, [0, length, width, points, ...coordinates.slice(0, 2 * points)]);
            if (path > 0 && first === 1) ask(Call.rightOfWay, [0, path, priority]);
            if (path > 0 && first === 2) ask(Call.rightOfWay, [path, 0, priority]);
            if (line !== NONE) ask(Call.setLine, [path, line]);
        }
        ask(Call.build, []);
        controller.call(Call.contract, ask(Call.named, [contract]));
        ask(Call.enter, []);
        for (let step = 0; step < count; step++, at += QUESTION + ANSWER) {
            const [millis, ...vehicles] = words.subarray(at, at + QUESTION);
            const vehicle = i => vehicles.slice(VEHICLE * i, VEHICLE * (i + 1));
            const tracks = [];
            for (let i = 1; i <= OTHERS; i++) {
                const [there, ...state] = vehicle(i);
                if (there) tracks.push([1000 - 7 * i, 0, i, ...state]);
            }
            ask(Call.decide, [millis * 1000, 0, ...vehicle(0).slice(1), tracks.length, ...tracks.flat()]);
            const expected = words.subarray(at + QUESTION, at + QUESTION + ANSWER);
            steps += 1;
            different += expected.some((word, i) => word !== controller.words[i]) ? 1 : 0;
        }
    }
    return { steps, different };
}

const told = ({ steps, different }) => `decisions: ${steps}, different from the host's: ${different}`;

if (typeof require !== "undefined") {
    const [file, module] = process.argv.slice(2);
    const bytes = require("fs").readFileSync(file);
    const words = new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
    golden(require("./page.js").load(module), words).then(result => {
        console.log(told(result));
        process.exit(result.steps > 0 && result.different === 0 ? 0 : 1);
    });
}

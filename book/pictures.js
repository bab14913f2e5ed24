// Makes the pictures of README and docs anew: pictures.js CHROMIUM REPORT.html FOLDER. REPORT is the demo's report.
// FOLDER then holds play.png, replay.png and the frames film-NN.png of a drive in the playground.
"use strict";
const path = require("path");
const { pathToFileURL } = require("url");
const { Browser, sleep } = require("../play/check/chromium.js");

const play = pathToFileURL(path.join(__dirname, "../docs/play/index.html")).href;
const desktop = { width: 1400, height: 900, dark: false, ready: "document.documentElement?.dataset.status === 'ready'" };
// The drive of the film: a site of the playground, its seconds, and those between two frames.
const film = { site: "yield", from: 1.0, to: 13.0, every: 0.2 };

async function drive(browser, folder) {
    const box = "(({ left, top, width }, { bottom }) => ({ x: left, y: top, width, height: bottom - top }))" +
        "(document.getElementById('scene').getBoundingClientRect(), document.getElementById('verdict').getBoundingClientRect())";
    const frames = Math.round((film.to - film.from) / film.every) + 1;
    for (let frame = 0; frame < frames; frame++) {
        await browser.open(`${play}#site=${film.site}&at=${(film.from + frame * film.every).toFixed(1)}`, desktop);
        await sleep(0.3);
        const clip = { ...await browser.value(box), scale: 0.75 };
        await browser.picture(path.join(folder, `film-${String(frame).padStart(2, "0")}.png`), clip);
    }
}

async function main([program, report, folder]) {
    const browser = new Browser(program);
    try {
        await browser.open(`${play}#site=yield&at=4`, desktop);
        await sleep(0.5);
        await browser.picture(path.join(folder, "play.png"));
        await browser.open(pathToFileURL(path.resolve(report)).href, { ...desktop, height: 1060, still: true });
        await sleep(0.5);
        await browser.picture(path.join(folder, "replay.png"));
        await drive(browser, folder);
    } finally {
        await browser.close();
    }
}

main(process.argv.slice(2));

// Opens the page in Chromium and uses it: browser.js CHROMIUM FOLDER [AXE.js]. No error, nothing from the network, frames
// in time, keys and pointer work, what is broken is told; pictures of it are written to FOLDER.
"use strict";
const path = require("path");
const { Browser, accessible, sleep } = require("./chromium.js");

const page = path.join(__dirname, "../../docs/play/index.html");
const ready = "document.documentElement?.dataset.status === 'ready'";

const open = (browser, { link = "", ...screen }) => browser.open(`file://${page}${link}`, { ...screen, ready });

async function check(browser, folder, axe) {
    const wrong = [];
    const expect = (good, what) => {
        if (!good) wrong.push(what);
    };
    const text = id => browser.value(`document.getElementById("${id}").textContent`);
    const clean = where => browser.complaints().forEach(complaint => wrong.push(`${where}: ${complaint}`));

    // As it is on load, then used by keys, by pointer and by its controls.
    await open(browser, { width: 1400, height: 900, dark: false });
    await sleep(4);
    const frame = Number(await browser.value("document.documentElement.dataset.frame"));
    const frames = await browser.value(`new Promise(done => {
        let count = 0;
        const began = performance.now();
        const next = now => performance.now() - began > 2000 ? done(count / 2) : (count += 1, requestAnimationFrame(next));
        requestAnimationFrame(next);
    })`);
    console.log(`a frame costs ${frame.toFixed(1)} ms without a graphics card; ${frames.toFixed(0)} frames a second`);
    // How long it takes depends on the machine and what else runs there: it is told, not judged.
    expect(frame > 0, `a frame costs ${frame} ms`);
    expect(await browser.value("document.querySelectorAll('#log [data-tone=shielded]').length") > 0, "the shield did nothing on load");
    await browser.value("document.getElementById('scene').focus()");
    await browser.key("2");
    expect(await browser.value("document.querySelectorAll('#cars input')[1].checked"), "key 2 does not choose");
    await browser.key("ArrowDown");
    expect(await browser.value("document.querySelector('#modes input[value=hold]').checked"), "no key drives");
    await browser.key(" ");
    expect(await text("pause") === "Play", "the space bar does not pause");
    await browser.key(" ");
    const box = await browser.value("(({ left, top, width, height }) => [left + width / 2, top + height / 2])(document.getElementById('scene').getBoundingClientRect())");
    await browser.value("document.getElementById('again').click()");
    await sleep(2);
    // A car comes from the west: somewhere on its lane there is one to take.
    let held = false;
    for (let x = box[0] - 500; x < box[0] + 500 && !held; x += 15) {
        const at = [x, box[1] + 18];
        await browser.mouse("mousePressed", at);
        held = await browser.value("document.querySelector('#modes input[value=hold]').checked");
        if (held) await browser.mouse("mouseMoved", [x + 300, at[1]]);
        if (held) await sleep(0.3);
        await browser.mouse("mouseReleased", at);
    }
    expect(held, "no car can be dragged");
    clean("used");

    for (const name of ["late", "weak", "wild", "blurred"]) {
        await browser.value(`document.getElementById("truth-${name}").click()`);
    }
    expect(/late.*weak.*exceed.*sensors/i.test(await text("broken")), "what is broken is not told");
    for (const site of ["stop", "ring", "tee"]) {
        await browser.value(`document.querySelector('#sites input[value=${site}]').click()`);
        await sleep(2);
        clean(site);
    }
    const said = await browser.value(`new Promise(done => {
        let tries = 0;
        const look = () => /deviated|exceeds/.test(document.getElementById("log").textContent) || ++tries > 80
            ? done(tries <= 80) : setTimeout(look, 100);
        look();
    })`);
    expect(said, "a broken contract is not told");
    await browser.picture(path.join(folder, "broken.png"));
    // A contract that is refused: the rule of an all-way stop with brakes that are weaker than it asks for.
    await browser.value("document.querySelector('#sites input[value=stop]').click(); document.getElementById('precedence').click();" +
        "(input => { input.value = 2; input.dispatchEvent(new Event('input')); })(document.querySelector('#contract input'))");
    expect(/precedence\.braking = 3 is outside/.test(await text("refused")), "a contract that is refused is not told");
    clean("contract");

    for (const [width, height] of [[1400, 900], [390, 844]]) {
        for (const dark of [false, true]) {
            for (const [site, at] of [["yield", 3], ["stop", 8.5], ["ring", 3], ["tee", 6]]) {
                await open(browser, { width, height, dark, link: `#site=${site}&at=${at}` });
                await sleep(0.5);
                const wide = await browser.value("document.documentElement.scrollWidth");
                expect(wide <= width, `${wide} pixels wide on a screen of ${width}`);
                await browser.picture(path.join(folder, `${site}-${width}-${dark ? "dark" : "light"}.png`));
                clean(`${site} ${width}`);
            }
            if (axe) wrong.push(...await accessible(browser, axe, `${width} ${dark ? "dark" : "light"}`));
        }
    }
    await open(browser, { width: 1400, height: 900, dark: false, still: true });
    expect(await text("pause") === "Play", "it moves although no motion is wanted");
    clean("still");
    return wrong;
}

async function main([program, folder, axe]) {
    const browser = new Browser(program);
    try {
        const wrong = await check(browser, folder, axe);
        wrong.forEach(what => console.error(`page: ${what}`));
        return wrong.length === 0;
    } finally {
        await browser.close();
    }
}

main(process.argv.slice(2)).then(good => process.exit(good ? 0 : 1));

// Opens the page in Chromium and uses it: browser.js CHROMIUM FOLDER [AXE.js]. No error, nothing from the network, frames
// in time, keys and pointer work, what is broken is told; pictures of it are written to FOLDER.
"use strict";
const fs = require("fs");
const os = require("os");
const path = require("path");
const { spawn } = require("child_process");

const page = path.join(__dirname, "../../docs/play/index.html");
const sleep = seconds => new Promise(done => setTimeout(done, 1000 * seconds));

// A browser that is spoken to through a pipe, in Chromium's protocol for developers.
class Browser {
    constructor(program) {
        this.profile = fs.mkdtempSync(path.join(os.tmpdir(), "cede-play-"));
        const options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--remote-debugging-pipe",
            "--disable-background-networking", `--user-data-dir=${this.profile}`, "about:blank"];
        this.process = spawn(program, options, { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
        [this.next, this.waiting, this.heard] = [1, new Map(), []];
        let rest = "";
        this.process.stdio[4].on("data", data => {
            const messages = (rest + data).split("\0");
            rest = messages.pop();
            messages.map(JSON.parse).forEach(message => this.hear(message));
        });
    }

    hear(message) {
        if (!message.id) return this.heard.push(message);
        const { done, failed } = this.waiting.get(message.id);
        this.waiting.delete(message.id);
        if (message.error) failed(new Error(message.error.message));
        else done(message.result);
    }

    send(method, params = {}) {
        const id = this.next++;
        this.process.stdio[3].write(JSON.stringify({ id, method, params, sessionId: this.session }) + "\0");
        return new Promise((done, failed) => this.waiting.set(id, { done, failed }));
    }

    async open({ width, height, dark, still = false, link = "" }) {
        this.session = undefined;
        const { targetId } = await this.send("Target.createTarget", { url: "about:blank" });
        this.session = (await this.send("Target.attachToTarget", { targetId, flatten: true })).sessionId;
        for (const domain of ["Page", "Runtime", "Log", "Network"]) await this.send(`${domain}.enable`);
        await this.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: width < 500 });
        const features = [{ name: "prefers-color-scheme", value: dark ? "dark" : "light" },
            { name: "prefers-reduced-motion", value: still ? "reduce" : "no-preference" }];
        await this.send("Emulation.setEmulatedMedia", { features });
        this.heard = [];
        await this.send("Page.navigate", { url: `file://${page}${link}` });
        for (let i = 0; i < 100 && await this.value("document.documentElement?.dataset.status") !== "ready"; i++) await sleep(0.1);
    }

    async value(expression) {
        const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
        if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.text}`);
        return result.value;
    }

    async key(key) {
        for (const type of ["keyDown", "keyUp"]) await this.send("Input.dispatchKeyEvent", { type, key });
    }

    async mouse(type, [x, y]) {
        await this.send("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: 1, clickCount: 1 });
    }

    async picture(file) {
        const { data } = await this.send("Page.captureScreenshot", { format: "png" });
        fs.writeFileSync(file, Buffer.from(data, "base64"));
    }

    // What must not have happened since the page was opened.
    complaints() {
        return this.heard.flatMap(({ method, params }) => {
            if (method === "Runtime.exceptionThrown") return [params.exceptionDetails.exception?.description ?? params.exceptionDetails.text];
            if (method === "Runtime.consoleAPICalled" && params.type !== "log") return [params.args.map(arg => arg.value).join(" ")];
            if (method === "Log.entryAdded" && params.entry.level === "error") return [params.entry.text];
            const url = method === "Network.requestWillBeSent" ? params.request.url : "file:";
            return /^(file|data):/.test(url) ? [] : [`asks the network for ${url}`];
        });
    }

    async close() {
        const ended = new Promise(done => this.process.on("exit", done));
        this.session = undefined;
        this.send("Browser.close").catch(() => {});
        await Promise.race([ended, sleep(5)]);
        this.process.kill();
        fs.rmSync(this.profile, { recursive: true, force: true, maxRetries: 20, retryDelay: 100 });
    }
}

async function check(browser, folder, axe) {
    const wrong = [];
    const expect = (good, what) => {
        if (!good) wrong.push(what);
    };
    const text = id => browser.value(`document.getElementById("${id}").textContent`);
    const clean = where => browser.complaints().forEach(complaint => wrong.push(`${where}: ${complaint}`));

    // As it is on load, then used by keys, by pointer and by its controls.
    await browser.open({ width: 1400, height: 900, dark: false });
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
                await browser.open({ width, height, dark, link: `#site=${site}&at=${at}` });
                await sleep(0.5);
                const wide = await browser.value("document.documentElement.scrollWidth");
                expect(wide <= width, `${wide} pixels wide on a screen of ${width}`);
                await browser.picture(path.join(folder, `${site}-${width}-${dark ? "dark" : "light"}.png`));
                clean(`${site} ${width}`);
            }
            if (axe) wrong.push(...await accessible(browser, axe, `${width} ${dark ? "dark" : "light"}`));
        }
    }
    await browser.open({ width: 1400, height: 900, dark: false, still: true });
    expect(await text("pause") === "Play", "it moves although no motion is wanted");
    clean("still");
    return wrong;
}

// What axe finds that is serious.
async function accessible(browser, axe, where) {
    await browser.value(fs.readFileSync(axe, "utf8") + "; 0");
    const found = await browser.value("axe.run().then(({ violations }) => violations.map(v => [v.impact, v.id, v.nodes[0].html]))");
    console.log(`axe, ${where}: ${found.length} findings`);
    return found.map(([impact, id, html]) => `axe, ${where}: ${impact} ${id}: ${html}`);
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

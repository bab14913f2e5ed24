// Chromium without a window, for the checks of pages here and in book/.
"use strict";
const fs = require("fs");
const os = require("os");
const path = require("path");
const { spawn } = require("child_process");

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

    // `ready` is an expression that is true once the page is drawn.
    async open(url, { width, height, dark, still = false, ready }) {
        await this.leave();
        const { targetId } = await this.send("Target.createTarget", { url: "about:blank" });
        this.target = targetId;
        this.session = (await this.send("Target.attachToTarget", { targetId, flatten: true })).sessionId;
        for (const domain of ["Page", "Runtime", "Log", "Network"]) await this.send(`${domain}.enable`);
        await this.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: width < 500 });
        const features = [{ name: "prefers-color-scheme", value: dark ? "dark" : "light" },
            { name: "prefers-reduced-motion", value: still ? "reduce" : "no-preference" }];
        await this.send("Emulation.setEmulatedMedia", { features });
        this.heard = [];
        await this.send("Page.navigate", { url });
        for (let i = 0; i < 100 && !await this.value(ready); i++) await sleep(0.1);
    }

    // Closes the page that is open.
    async leave() {
        this.session = undefined;
        if (this.target) await this.send("Target.closeTarget", { targetId: this.target });
        this.target = undefined;
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

    // Of the screen, or of the rectangle `clip` of the page, { x, y, width, height, scale }.
    async picture(file, clip) {
        const { data } = await this.send("Page.captureScreenshot", { format: "png", clip });
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

// What axe finds that is serious.
async function accessible(browser, axe, where) {
    await browser.value(fs.readFileSync(axe, "utf8") + "; 0");
    const found = await browser.value("axe.run({ preload: false }).then(({ violations }) => violations.map(v => [v.impact, v.id, v.nodes[0].html]))");
    console.log(`axe, ${where}: ${found.length} findings`);
    return found.map(([impact, id, html]) => `axe, ${where}: ${impact} ${id}: ${html}`);
}

module.exports = { Browser, accessible, sleep };

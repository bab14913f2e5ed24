// Opens each page of the site in Chromium: site.js CHROMIUM SITE FOLDER [AXE.js]. No error, nothing from the network, as
// wide as the screen, nothing serious from axe, and each link within the site leads to what is there.
// Pictures of the first pages are written to FOLDER.
"use strict";
const fs = require("fs");
const path = require("path");
const { fileURLToPath, pathToFileURL } = require("url");
const { Browser, accessible } = require("../../play/check/chromium.js");

const ready = "document.readyState === 'complete' && document.querySelector('main h1') !== null";
const screens = [1400, 390].flatMap(width => [false, true].map(dark => ({ width, height: width > 500 ? 900 : 844, dark })));
const pictured = ["index.html", "first-hour/firmware.html", "evidence.html"];

// The pages that mdBook made of docs/, by the table of contents.
function pages(site) {
    const contents = fs.readFileSync(path.join(site, "toc.html"), "utf8");
    return [...new Set([...contents.matchAll(/href="([^"#]+\.html)"/g)].map(([, page]) => page))];
}

// Where the links and pictures of the page lead, and the places in it that links can name.
const LINKS = `({
    links: [...document.querySelectorAll("main a[href], nav a[href]")].map(a => a.href),
    pictures: [...document.images].map(image => image.src),
    places: [...document.querySelectorAll("[id]")].map(place => place.id),
})`;

// Links of `seen` (pages with what LINKS found) that lead nowhere.
function dead(seen) {
    const places = new Map([...seen].map(([url, { places }]) => [url, new Set(places)]));
    return [...seen].flatMap(([url, { links, pictures }]) => [...links, ...pictures]
        .filter(link => link.startsWith("file:"))
        .filter(link => {
            const [file, place] = link.split("#");
            const missing = place && places.has(file) && !places.get(file).has(decodeURIComponent(place));
            return missing || !fs.existsSync(fileURLToPath(file));
        })
        .map(link => `${fileURLToPath(url)}: ${link} leads nowhere`));
}

async function check(browser, site, folder, axe) {
    const wrong = [], seen = new Map();
    for (const page of pages(site)) {
        const url = pathToFileURL(path.resolve(site, page)).href;
        for (const screen of screens) {
            const where = `${page}, ${screen.width} ${screen.dark ? "dark" : "light"}`;
            await browser.open(url, { ...screen, still: true, ready });
            const wide = await browser.value("document.documentElement.scrollWidth");
            if (wide > screen.width) wrong.push(`${where}: ${wide} pixels wide`);
            if (pictured.includes(page)) await browser.picture(path.join(folder, `${page.replace("/", "-")}-${where.split(", ")[1]}.png`));
            // What axe calls moderate is mdBook's: its bar lies in no landmark.
            if (axe) wrong.push(...(await accessible(browser, axe, where)).filter(finding => /: (serious|critical) /.test(finding)));
            wrong.push(...browser.complaints().map(complaint => `${where}: ${complaint}`));
        }
        seen.set(url, await browser.value(LINKS));
    }
    const links = [...seen.values()].flatMap(({ links }) => links);
    console.log(`${seen.size} pages, ${links.length} links, ${links.filter(link => link.startsWith("file:")).length} of them within the site`);
    return [...wrong, ...dead(seen)];
}

async function main([program, site, folder, axe]) {
    const browser = new Browser(program);
    try {
        const wrong = await check(browser, site, folder, axe);
        wrong.forEach(what => console.error(`site: ${what}`));
        return wrong.length === 0;
    } finally {
        await browser.close();
    }
}

main(process.argv.slice(2)).then(good => process.exit(good ? 0 : 1));

// The page's scripts without its picture, for checks in Node.
"use strict";
const fs = require("fs");
const path = require("path");

const folder = path.join(__dirname, "../../docs/play");
const scripts = ["controller.js", "sites.js", "drivers.js", "world.js"];

// Everything that the scripts define, with the module of `file`.
function load(file = path.join(folder, "module.js")) {
    const text = [file, ...scripts.map(name => path.join(folder, name))].map(name => fs.readFileSync(name, "utf8"));
    const names = ["compileController", "Controller", "World", "SITES", "TRUTH", "Call", "ANSWER", "generator"];
    return new Function(`${text.join("\n")}\nreturn { ${names} };`)();
}

module.exports = { load };

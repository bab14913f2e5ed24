// A preprocessor of mdBook: makes links that leave docs/ lead somewhere on a site that holds docs/ alone.
// What `cargo doc` writes to target/doc is the site's api/; every other file is the repository's.
// mdBook makes a README.md an index.html, and leaves links to it as they are.
"use strict";
const { posix } = require("path");

const repository = "https://github.com/cede-rs/cede/blob/main/";
const api = "target/doc/";

// Where a link of docs/`chapter` leads on the site.
function target(chapter, link) {
    const folder = posix.dirname(chapter);
    const file = posix.normalize(posix.join("docs", folder, link));
    if (file.startsWith("docs/")) return link.replace(/(^|\/)README\.md/, "$1index.md");
    if (file.startsWith(api)) return posix.relative(folder, posix.join("api", file.slice(api.length)));
    return repository + file;
}

function rewrite({ path, content, sub_items }) {
    // Neither of other sites nor within the page.
    const links = /(\]\()([^)\s:#][^)\s:]*)/g;
    return {
        content: content.replace(links, (_, begin, link) => begin + target(path, link)),
        sub_items: sub_items.map(item),
    };
}

function item(entry) {
    return entry.Chapter?.path ? { Chapter: { ...entry.Chapter, ...rewrite(entry.Chapter) } } : entry;
}

// mdBook asks first which formats are supported: all.
if (process.argv[2] !== "supports") {
    const [, book] = JSON.parse(require("fs").readFileSync(0, "utf8"));
    process.stdout.write(JSON.stringify({ ...book, items: book.items.map(item) }));
}

// What mdBook's page leaves to be wished for by keyboard and screen reader.
"use strict";
// Wide tables and code can be scrolled by keys.
for (const wide of document.querySelectorAll(".table-wrapper, main pre > code")) wide.tabIndex = 0;
// The label that opens the table of contents is a button.
const toggle = document.getElementById("mdbook-sidebar-toggle");
if (toggle) {
    toggle.setAttribute("role", "button");
    toggle.tabIndex = 0;
    toggle.addEventListener("keydown", event => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        toggle.click();
    });
}

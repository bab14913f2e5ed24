#!/usr/bin/env bash
# The documentation as a site: it builds, each page opens in Chromium without an error, fits a telephone, passes axe-core,
# and each link within it leads somewhere. What cannot be had is skipped, and says so.
# AXE may name axe-core's axe.min.js; else that of .build/axe is taken (npm install --prefix .build/axe axe-core@4).
set -euo pipefail
cd "$(dirname "$0")/.."
skip() {
    echo "skipped: no $1 (site of the documentation)"
    [ -z "${CEDE_SKIPS:-}" ] || echo "$1 (site of the documentation)" >>"$CEDE_SKIPS"
}
if ! command -v node >/dev/null; then
    skip "Node"
    exit 0
fi
book/build.sh
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [ -z "$chromium" ]; then
    skip "Chromium"
    exit 0
fi
axe=${AXE:-.build/axe/node_modules/axe-core/axe.min.js}
[ -f "$axe" ] || { skip "axe-core" && axe=; }
mkdir -p .build/book-pictures
node book/check/site.js "$chromium" .build/book .build/book-pictures ${axe:+"$axe"}

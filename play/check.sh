#!/usr/bin/env bash
# The playground: the module that is committed in docs/play, and one that is built here, decide as the host does, bit for
# bit, on golden observations and on what visitors of the page did; nobody is hit while the contract holds; the page
# works in Chromium. Shows as well that one changed bit is found. What cannot be had is skipped, and says so.
# AXE may name axe-core's axe.min.js; else that of .build/axe is taken (npm install --prefix .build/axe axe-core@4).
set -euo pipefail
cd "$(dirname "$0")/.."
build=$PWD/.build/play
mkdir -p "$build"
exec 6>"$build/lock" # one check at a time
flock 6
unset RUSTFLAGS
export CARGO_TERM_QUIET=true
workspace=play/Cargo.toml
cargo=(cargo --config net.retry=3)

fail() {
    echo "playground: $*" >&2
    exit 1
}
skip() {
    echo "skipped: no $1 (playground)"
    [ -z "${CEDE_SKIPS:-}" ] || echo "$1 (playground)" >>"$CEDE_SKIPS"
}
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
node=$(command -v node || true)

echo "== the controller of the page, on the host"
"${cargo[@]}" fmt --manifest-path $workspace --check
if "${cargo[@]}" clippy --version >/dev/null 2>&1; then
    "${cargo[@]}" clippy --locked --manifest-path $workspace --all-targets -- -D warnings
fi
"${cargo[@]}" test --locked --release --manifest-path $workspace
"${cargo[@]}" build --locked --release --manifest-path $workspace --examples
"${cargo[@]}" run --locked --release --manifest-path firmware/cortex-m/Cargo.toml --target-dir "$build/golden" \
    -p cede-golden -- "$build"
replay=play/target/release/examples/replay

# flip FILE OUT: the file with one bit of its last word changed.
flip() {
    local size last
    cp "$1" "$2"
    size=$(stat -c %s "$1")
    last=$(tail -c 1 "$1" | od -An -tu1)
    # shellcheck disable=SC2059
    printf "\\x$(printf %02x $((last ^ 1)))" | dd of="$2" bs=1 seek=$((size - 1)) conv=notrunc status=none
}

# in_chromium GOLDEN MODULE: the golden observations, asked in a page.
in_chromium() {
    local profile page=$build/golden.html
    {
        echo "<!doctype html><meta charset=utf-8><body>…</body>"
        for script in "$2" "$PWD/docs/play/controller.js" "$PWD/play/check/golden.js"; do
            echo "<script src=\"file://$script\"></script>"
        done
        echo "<script>const bytes = Uint8Array.from(atob('$(base64 -w 0 "$1")'), c => c.charCodeAt(0));"
        echo "golden({ compileController, Controller, Call, ANSWER }, new Uint32Array(bytes.buffer))"
        echo ".then(result => { document.body.textContent = told(result); });</script>"
    } >"$page"
    profile=$(mktemp -d)
    "$chromium" --headless --no-sandbox --disable-gpu --disable-background-networking --user-data-dir="$profile" \
        --virtual-time-budget=60000 --dump-dom "file://$page" 2>/dev/null | grep -o 'decisions: .*[0-9]' || true
    rm -rf "$profile"
}

# decides MODULE: as the host does.
decides() {
    local said
    if [ -n "$node" ]; then
        node play/check/golden.js "$build/golden.bin" "$1" || fail "$1 decides otherwise; build it anew: play/build.sh"
        node play/check/visitors.js "$build/visitors.bin" "$1" || fail "$1: the page is not what it says"
        "$replay" "$build/visitors.bin" || fail "$1 decides otherwise; build it anew: play/build.sh"
    fi
    if [ -n "$chromium" ]; then
        said=$(in_chromium "$build/golden.bin" "$1")
        echo "in Chromium: $said"
        [[ $said == "decisions: 1685, different from the host's: 0" ]] || fail "$1 decides otherwise in Chromium"
    fi
}

[ -n "$node" ] || skip "Node"
[ -n "$chromium" ] || skip "Chromium"
echo "== the module in docs/play"
decides "$PWD/docs/play/module.js"
size=$(cat docs/play/* | wc -c)
echo "the page has $size bytes"
[ "$size" -le 1000000 ] || fail "more than 1,000,000 bytes"

if [ -n "$node" ]; then
    echo "== the checks can fail"
    flip "$build/golden.bin" "$build/flipped.bin"
    ! node play/check/golden.js "$build/flipped.bin" >/dev/null || fail "a changed bit in a golden decision is not found"
    flip "$build/visitors.bin" "$build/flipped.bin"
    ! "$replay" "$build/flipped.bin" >/dev/null || fail "a changed bit in an answer to a visitor is not found"
    echo "a changed bit is found"
fi

echo "== a module that is built here"
if firmware/setup.sh wasm; then
    play/build.sh "$build/module.js"
    decides "$build/module.js"
else
    skip "toolchain for wasm32-unknown-unknown"
fi

if [ -n "$node" ] && [ -n "$chromium" ]; then
    echo "== the page in Chromium"
    axe=${AXE:-.build/axe/node_modules/axe-core/axe.min.js}
    [ -f "$axe" ] || { skip "axe-core" && axe=; }
    node play/check/browser.js "$chromium" "$build" ${axe:+"$axe"}
fi

#!/usr/bin/env bash
# Builds the controller as WebAssembly and writes it into the page, as docs/play/module.js: build.sh [FILE].
# The file is committed, so that `cede play` and the page need no toolchain for WebAssembly; play/check.sh holds it to
# the sources. rustup's target is used where it is installed, else firmware/setup.sh gets Debian's compiler.
set -euo pipefail
cd "$(dirname "$0")/.."
file=${1:-docs/play/module.js}
build=$PWD/.build/wasm
target=wasm32-unknown-unknown
max_bytes=400000 # of WebAssembly; the page as a whole stays below 1 MB

firmware/setup.sh wasm
source "$build/env"
unset RUSTFLAGS
linker=$(rustc --print sysroot)/lib/rustlib/$(rustc --print host-tuple)/bin/rust-lld
export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=$linker
export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS="--remap-path-prefix=$PWD=cede -C link-arg=-zstack-size=262144 $target_flags"
[ -z "$target_compiler" ] || export RUSTC=$target_compiler
cargo rustc --quiet --locked --release --manifest-path play/Cargo.toml --target-dir "$build/target" --target $target \
    --lib --crate-type cdylib
module=$build/target/$target/release/cede_play.wasm
size=$(stat -c %s "$module")
[ "$size" -le $max_bytes ] || { echo "play: $size bytes of WebAssembly, at most $max_bytes" >&2 && exit 1; }

new=$(mktemp "$build/module.XXXXXX")
{
    echo "// The controller as WebAssembly. Written by play/build.sh; do not edit."
    echo "const CEDE_MODULE ="
    base64 -w 120 "$module" | sed 's/.*/    "&" +/'
    echo '    "";'
} >"$new"
chmod 644 "$new"
mv "$new" "$file"
echo "$size bytes of WebAssembly; $file has $(stat -c %s "$file") bytes"

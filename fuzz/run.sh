#!/usr/bin/env bash
# Feeds each reader of files with mutated seeds, guided by the coverage of its code: fuzz/run.sh [SECONDS] [TARGET...]
#
# Needs cargo-fuzz (cargo install cargo-fuzz) and a C++ compiler; any Rust will do, as no sanitizer is used: the
# readers hold no unsafe code, so what can go wrong is a panic, an overflow, time or memory. An input that makes a
# reader fail lies under fuzz/artifacts; add it to a test of that reader.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
[ $# -lt 1 ] || shift
targets=("$@")
[ $# -gt 0 ] || mapfile -t targets < <(cargo fuzz list)

cargo metadata --locked --format-version 1 --manifest-path fuzz/Cargo.toml >/dev/null # cargo-fuzz knows no --locked
cargo fuzz build --sanitizer none
mkdir -p fuzz/artifacts
for target in "${targets[@]}"; do
    corpus=fuzz/corpus/$target
    mkdir -p "$corpus"
    log=fuzz/artifacts/$target.log
    if ! cargo fuzz run --sanitizer none "$target" "$corpus" "fuzz/seeds/$target" -- \
        -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 >"$log" 2>&1; then
        tail -50 "$log" >&2
        echo "fuzz: the reader of $target fails" >&2
        exit 1
    fi
    echo "$target: $(sed -n 's/^Done \(.*\)$/\1/p' "$log")"
done

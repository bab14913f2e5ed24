#!/usr/bin/env bash
# Mutation testing of shield, zones and junction: changes one operator, constant or function at a time, and
# shows what no unit test of the controller notices (.cargo/mutants.toml says which tests run). About 2,800 mutants; one takes
# 2 s to build and up to 4 s to be caught, or 20 s if it is not (CPU time), so a whole run takes hours.
#
#   tests/mutants.sh                 all of them
#   tests/mutants.sh --shard 3/40    every 40th, in random order, a sample of all; over 40 runs all are tried
#   tests/mutants.sh --changed main  those in lines that differ from a revision
#   tests/mutants.sh --list          names them
#
# Exit status 0 only if at least 95 % of the viable ones are caught. Survivors are in .build/mutants/mutants.out;
# docs/evidence.md lists those that are known, with reasons.
set -euo pipefail
cd "$(dirname "$0")/.."
export PATH=$PWD/.build/tools/bin:$PATH
command -v cargo-mutants >/dev/null || cargo install --locked --quiet --root .build/tools cargo-mutants
out=.build/mutants
mkdir -p "$out"
arguments=()
case "${1:-}" in
--shard) arguments=(--shuffle --sharding round-robin --shard "${2:?which part, as in 3/40}") ;;
--changed)
    git diff "${2:?compared with which revision}" -- controller/src >"$out/changed.diff"
    arguments=(--in-diff "$out/changed.diff")
    ;;
--list) exec cargo mutants --package cede-controller --list ;;
'') ;;
*)
    sed -n '2,/^set/p' "$0" | sed '$d;s/^# \{0,1\}//' >&2
    exit 2
    ;;
esac
# The first failure decides: it is not made smaller, nor remembered for the next mutant, and the cases are the same for all.
export PROPTEST_MAX_SHRINK_ITERS=0 PROPTEST_DISABLE_FAILURE_PERSISTENCE=1 PROPTEST_RNG_SEED=1
# The option that ends a test program at its first failure is one that the stable library has under lock.
host=$(rustc -vV | sed -n 's/^host: //p' | tr a-z- A-Z_)
export "CARGO_TARGET_${host}_RUNNER=env RUSTC_BOOTSTRAP=1"
status=0
cargo mutants --package cede-controller --output "$out" --colors never --no-times "${arguments[@]}" || status=$?
# 0: all caught; 2: some were missed; 3: some timed out. Anything else: the run itself failed.
case $status in 0 | 2 | 3) ;; *) exit "$status" ;; esac
count() { wc -l <"$out/mutants.out/$1.txt" 2>/dev/null || echo 0; }
caught=$(($(count caught) + $(count timeout))) missed=$(count missed)
viable=$((caught + missed))
if [ "$viable" = 0 ]; then
    echo "mutants: none was viable" >&2
    exit 1
fi
echo "mutants: $caught of $viable viable ones caught ($((100 * caught / viable)) %)"
[ $((100 * caught)) -ge $((95 * viable)) ]

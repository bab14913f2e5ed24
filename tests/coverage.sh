#!/usr/bin/env bash
# Line coverage of the controller by its own tests (cargo test -p cede-controller): which lines of controller/src no test runs.
#
#   tests/coverage.sh            a table by file, the total, and the lines that are not run
#   tests/coverage.sh --least 95 exit status 1 if the total is below so many per cent
#
# Test modules do not count. Lines are in .build/coverage/lcov.info, for other programs. Needs llvm-profdata and llvm-cov 19
# or later: root on Debian gets them. Exit status 77: they cannot be had, and nothing was measured.
set -euo pipefail
cd "$(dirname "$0")/.."
least=0
case "${1:-}" in
--least) least=${2:?how many per cent} ;;
'') ;;
*)
    sed -n '2,/^set/p' "$0" | sed '$d;s/^# \{0,1\}//' >&2
    exit 2
    ;;
esac
# What Rust writes, older tools do not read.
tools() { for version in '' -22 -21 -20 -19; do
    command -v "llvm-cov$version" >/dev/null || continue
    [ "$("llvm-cov$version" --version | grep -oE 'version [0-9]+' | cut -d' ' -f2)" -ge 19 ] && echo "$version" && return
done
return 1; }
if ! tools >/dev/null && command -v apt-get >/dev/null && [ "$(id -u)" = 0 ]; then
    apt-get -qq -o DPkg::Lock::Timeout=300 update
    DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 install -y --no-install-recommends llvm-19 >/dev/null || true
fi
if ! version=$(tools); then
    echo "SKIPPED: coverage was not measured: no llvm-cov 19 or later (Debian: llvm-19)" >&2
    exit 77
fi
out=$PWD/.build/coverage
rm -rf "$out/raw"
mkdir -p "$out/raw"
export CARGO_TARGET_DIR=$out/target RUSTFLAGS='-C instrument-coverage'
cargo test --quiet -p cede-controller --lib --tests --no-run
# A raw profile for each program; of the compiler's own helpers none.
LLVM_PROFILE_FILE=$out/raw/%p-%m.profraw cargo test --quiet -p cede-controller --lib --tests >/dev/null
"llvm-profdata$version" merge --sparse "$out"/raw/*.profraw -o "$out/tests.profdata"
mapfile -t programs < <(cargo test --quiet -p cede-controller --lib --tests --no-run --message-format json |
    grep -oE '"executable":"[^"]+"' | cut -d'"' -f4 | sort -u)
objects=()
for program in "${programs[@]:1}"; do objects+=(--object "$program"); done
"llvm-cov$version" export --format lcov --instr-profile "$out/tests.profdata" "${programs[0]}" "${objects[@]}" \
    --sources controller/src >"$out/lcov.info"
# Lines of test modules are those from `#[cfg(test)]` at the margin on; files of tests are named so.
awk -v least="$least" -v root="$PWD/" '
    /^SF:/ {
        file = substr($0, 4); name = file; sub(root, "", name)
        counted = name ~ /^controller\/src\// && name !~ /\/tests(\.rs|\/)/ && name !~ /\/cover\.rs$/
        last = 1e9; number = 0
        while (counted && (getline text < file) > 0) { number++; if (text ~ /^#\[cfg\(test\)\]/ && last == 1e9) { getline next_ < file; number++; if (next_ ~ /^mod tests \{/) last = number } }
        close(file)
    }
    /^DA:/ && counted {
        split(substr($0, 4), part, ",")
        if (part[1] < last) { all[name]++; total++; if (part[2] > 0) { run[name]++; hit++ } else missed[name] = missed[name] " " part[1] }
    }
    END {
        if (!total) { print "coverage: no line was counted" > "/dev/stderr"; exit 1 }
        for (name in all) printf "%6.2f %% of %5d  %s%s\n", 100 * run[name] / all[name], all[name], name, (missed[name] ? ":" missed[name] : "") | "sort -k4"
        close("sort -k4")
        printf "%6.2f %% of %5d  controller\n", 100 * hit / total, total
        if (100 * hit / total < least) { print "coverage: below " least " %" > "/dev/stderr"; exit 1 }
    }' "$out/lcov.info"

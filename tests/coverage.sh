#!/usr/bin/env bash
# Line and branch coverage of the controller by its own tests (cargo test -p cede-controller): which lines of controller/src no
# test runs, and which branches none takes.
#
#   tests/coverage.sh            a table by file, the totals, and the lines that are not run
#   tests/coverage.sh --least 95 exit status 1 if the lines are below so many per cent
#
# Test modules do not count. All is in .build/coverage/lcov.info, for other programs. Needs llvm-profdata and llvm-cov of the
# compiler's own version or later: root on Debian gets them. Exit status 77: they cannot be had, and nothing was measured.
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
needed=$(rustc -vV | grep -oE '^LLVM version: [0-9]+' | grep -oE '[0-9]+')
tools() { for version in "" "-$needed" "-$((needed + 1))"; do
    command -v "llvm-cov$version" >/dev/null || continue
    [ "$("llvm-cov$version" --version | grep -oE 'version [0-9]+' | cut -d' ' -f2)" -ge "$needed" ] && echo "$version" && return
done
return 1; }
if ! tools >/dev/null && command -v apt-get >/dev/null && [ "$(id -u)" = 0 ]; then
    apt-get -qq -o DPkg::Lock::Timeout=300 update
    DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 install -y --no-install-recommends "llvm-$needed" >/dev/null || true
fi
if ! version=$(tools); then
    echo "SKIPPED: coverage was not measured: no llvm-cov $needed or later (Debian: llvm-$needed)" >&2
    exit 77
fi
out=$PWD/.build/coverage
rm -rf "$out/raw"
mkdir -p "$out/raw"
# Branches are counted by an option that the stable compiler has under lock.
export CARGO_TARGET_DIR=$out/target RUSTC_BOOTSTRAP=1 RUSTFLAGS='-C instrument-coverage -Z coverage-options=branch'
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
    # A branch that no run comes to counts as one that is not taken.
    /^BRDA:/ && counted {
        split(substr($0, 6), part, ",")
        if (part[1] < last) { ways[name]++; branches++; if (part[4] + 0 > 0) { taken[name]++; took++ } }
    }
    END {
        if (!total) { print "coverage: no line was counted" > "/dev/stderr"; exit 1 }
        print "   lines            branches"
        row = "%6.2f %% of %5d  %6.2f %% of %5d  %s%s\n"
        for (name in all) printf row, 100 * run[name] / all[name], all[name], ways[name] ? 100 * taken[name] / ways[name] : 100, ways[name], name, (missed[name] ? ":" missed[name] : "") | "sort -k9"
        close("sort -k9")
        printf row, 100 * hit / total, total, 100 * took / branches, branches, "controller", ""
        if (100 * hit / total < least) { print "coverage: below " least " %" > "/dev/stderr"; exit 1 }
    }' "$out/lcov.info"

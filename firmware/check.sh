#!/usr/bin/env bash
# Runs the controller on a bare Cortex-M4F under QEMU and holds it to its bars: the host's decisions
# bit for bit, flash and RAM (the linker script enforces them, too), instructions, no panic, no allocation.
# Shows as well that a planted panic, a planted allocation and one changed bit are found.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$PWD/.build/cortex-m
mkdir -p "$build"
exec 8>"$build/check.lock" # one check at a time: they share a log and golden decisions
flock 8
firmware/setup.sh
source "$build/env"
target=thumbv7em-none-eabihf
max_flash=98304
max_ram=16384

unset RUSTFLAGS
export CARGO_TERM_QUIET=true
cargo=(cargo --config net.retry=3)
workspace=firmware/cortex-m/Cargo.toml

# The host's side: observations, and its decisions.
mkdir -p "$build/golden" "$build/tampered"
"${cargo[@]}" run --locked --release --manifest-path $workspace --target-dir "$build/host" -p cede-golden -- "$build/golden"

# Lints see the host's build of the same code: they need no target, and nothing is linked.
if "${cargo[@]}" clippy --version >/dev/null 2>&1; then
    CEDE_GOLDEN=$build/golden "${cargo[@]}" clippy --locked --manifest-path $workspace --target-dir "$build/host" --workspace -- -D warnings
fi

linker=$(rustc --print sysroot)/lib/rustlib/$(rustc --print host-tuple)/bin/rust-lld
export CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER=$linker
export CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS="-C link-arg=-Tlink.x $target_flags"

# image GOLDEN_FOLDER [cargo options]: builds the image and prints where it is.
image() {
    local golden=$1
    shift
    [ -z "$target_compiler" ] || export RUSTC=$target_compiler
    CEDE_GOLDEN=$golden "${cargo[@]}" build --locked --release --manifest-path $workspace \
        --target-dir "$build/target" --target $target -p cede-cortex-m "$@" >&2 || return
    echo "$build/target/$target/release/cede-cortex-m"
}
run() {
    timeout 120 qemu-system-arm -machine mps2-an386 -nographic -icount shift=10 \
        -semihosting-config enable=on,target=native -kernel "$1" </dev/null
}
# Panicking, formatting and allocating leave these names behind.
forbidden() { arm-none-eabi-nm -C "$1" | grep -E 'panic|core::fmt|alloc::|__rust_alloc|__rg_alloc'; }
fail() {
    echo "firmware: $*" >&2
    exit 1
}

echo "== the checks can fail"
if elf=$(image "$build/golden" --features planted-panic 2>"$build/log"); then
    fail "an image with a planted panic links"
fi
grep -q cede_a_panic_is_reachable "$build/log" || { cat "$build/log" >&2; fail "the planted panic broke something else"; }
echo "a planted panic does not link"
elf=$(image "$build/golden" --features planted-allocation)
forbidden "$elf" >/dev/null || fail "a planted allocation is not found"
echo "a planted allocation is found"
cp "$build"/golden/* "$build/tampered"
size=$(stat -c %s "$build/golden/golden.bin")
last=$(tail -c 1 "$build/golden/golden.bin" | od -An -tu1)
# shellcheck disable=SC2059
printf "\\x$(printf %x $((last ^ 1)))" | dd of="$build/tampered/golden.bin" bs=1 seek=$((size - 1)) conv=notrunc status=none
elf=$(image "$build/tampered")
if run "$elf" >"$build/log"; then
    fail "one changed bit in the golden decisions is not found"
fi
grep -q "differ from the host's: 1$" "$build/log" || { cat "$build/log" >&2; fail "the changed bit broke something else"; }
echo "one changed bit is found"

echo "== Cortex-M4F (mps2-an386)"
elf=$(image "$build/golden")
if forbidden "$elf"; then
    fail "a panic or an allocation is linked"
fi
run "$elf" | tee "$build/log" || fail "the image failed"
value() { sed -n "s/^$1: //p" "$build/log"; }
# Everything in flash but the golden file: vectors, code, constants, weights, initial values.
flash=$(arm-none-eabi-size -A "$elf" | awk '$1 ~ /^\.(vector_table|text|rodata|data|gnu\.sgstubs)$/ { sum += $2 } END { print sum }')
ram=$(value "RAM to decide, bytes")
preparing=$(value "RAM to prepare a junction, bytes")
echo "flash with weights, bytes: $flash (of $max_flash)"
network=$(value "instructions of the network, most")
echo "network 22-48-48-48-4, instructions for each of its 2 x 5,856 multiplications and additions: $(awk "BEGIN { printf \"%.2f\", $network / 11712 }")"
[ "$flash" -le $max_flash ] || fail "more than $max_flash bytes of flash"
[ "$ram" -le $max_ram ] || fail "more than $max_ram bytes of RAM to decide"
[ "$preparing" -le $max_ram ] || fail "more than $max_ram bytes of RAM to prepare a junction"

firmware/capi/check.sh

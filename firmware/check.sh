#!/usr/bin/env bash
# Runs the controller on bare cores under QEMU and holds it to its bars: the host's decisions bit for bit, flash and
# RAM, instructions, no panic, no allocation; a bound on the instructions of a decision, from the disassembly.
#
#   firmware/check.sh           Cortex-M4F and rv32imafc with the policy in f32; Cortex-M4F, M3, M0+ and rv32imac with
#                               the policy in integers; an RTIC application; the C library on Cortex-M4F, M7 and M33F
#   firmware/check.sh --quick   Cortex-M4F with the policy in f32, M3 in integers, and the C library on Cortex-M4F
#
# Shows as well that a planted panic, a planted allocation and one changed bit are found.
set -euo pipefail
cd "$(dirname "$0")/.."
quick=${1:-}
case $quick in '' | --quick) ;; *) sed -n '2,/^set/p' "$0" | sed '$d;s/^# \{0,1\}//' >&2 && exit 2 ;; esac
build=$PWD/.build/cortex-m
mkdir -p "$build"
exec 8>"$build/check.lock" # one check at a time: they share a log and golden decisions
flock 8
firmware/setup.sh
source "$build/env"
source firmware/documented.sh
target=thumbv7em-none-eabihf
max_flash=98304 # of the M4F with the policy in f32
max_soft_flash=131072
max_ram=16384      # with an FPU
max_soft_ram=18432 # without: its routines need stack, too
max_instructions=265000 # derived, of a decision of the M4F with the policy in f32

unset RUSTFLAGS
export CARGO_TERM_QUIET=true
cargo=(cargo --config net.retry=3)
workspace=firmware/cortex-m/Cargo.toml

# The host's side: observations, and its decisions.
mkdir -p "$build/golden" "$build/golden-i16" "$build/golden-micromath" "$build/tampered"
"${cargo[@]}" run --locked --release --manifest-path $workspace --target-dir "$build/host" -p cede-golden -- "$build/golden"
"$build/host/release/cede-golden" "$build/golden-i16" i16
"${cargo[@]}" run --locked --release --manifest-path $workspace --target-dir "$build/host" -p cede-golden --features micromath \
    -- "$build/golden-micromath" i16

# Lints see the host's build of the same code: they need no target, and nothing is linked.
if "${cargo[@]}" clippy --version >/dev/null 2>&1; then
    CEDE_GOLDEN=$build/golden "${cargo[@]}" clippy --locked --manifest-path $workspace --target-dir "$build/host" --workspace -- -D warnings
fi

linker=$(rustc --print sysroot)/lib/rustlib/$(rustc --print host-tuple)/bin/rust-lld

# compile TARGET PROGRAM [cargo options]: builds a program of the workspace for a target and prints where it is.
compile() {
    local target=$1 program=$2 script=link.x variable
    shift 2
    [[ $target = thumb* ]] || script=riscv.x
    variable=CARGO_TARGET_$(tr 'a-z-' 'A-Z_' <<<"$target")
    export "${variable}_LINKER=$linker" "${variable}_RUSTFLAGS=-C link-arg=-T$script $target_flags"
    [ -z "$target_compiler" ] || export RUSTC=$target_compiler
    "${cargo[@]}" build --locked --release --manifest-path $workspace \
        --target-dir "$build/target" --target "$target" -p "$program" "$@" >&2 || return
    echo "$build/target/$target/release/$program"
}
# image TARGET GOLDEN_FOLDER [cargo options]: builds the image and prints where it is.
image() { CEDE_GOLDEN=$2 compile "$1" cede-cortex-m "${@:3}"; }
# run IMAGE [MACHINE] [SHIFT]: an instruction takes 2^SHIFT ns, as `Clock` in the image has it.
run() {
    local machine=${2:-mps2-an386} shift=${3:-10}
    if [ "$machine" = virt ]; then
        timeout 300 qemu-system-riscv32 -machine virt -bios none -nographic -monitor none -serial stdio \
            -icount shift="$shift" -kernel "$1" </dev/null
    else
        timeout 300 qemu-system-arm -machine "$machine" -nographic -icount shift="$shift" \
            -semihosting-config enable=on,target=native -kernel "$1" </dev/null
    fi
}
# Panicking, formatting and allocating leave these names behind.
forbidden() { arm-none-eabi-nm -C "$1" | grep -E 'panic|core::fmt|alloc::|__rust_alloc|__rg_alloc'; }
fail() {
    echo "firmware: $*" >&2
    exit 1
}

echo "== the checks can fail"
if elf=$(image $target "$build/golden" --features planted-panic 2>"$build/log"); then
    fail "an image with a planted panic links"
fi
grep -q cede_a_panic_is_reachable "$build/log" || { cat "$build/log" >&2; fail "the planted panic broke something else"; }
echo "a planted panic does not link"
elf=$(image $target "$build/golden" --features planted-allocation)
forbidden "$elf" >/dev/null || fail "a planted allocation is not found"
echo "a planted allocation is found"
cp "$build"/golden/* "$build/tampered"
size=$(stat -c %s "$build/golden/golden.bin")
last=$(tail -c 1 "$build/golden/golden.bin" | od -An -tu1)
# shellcheck disable=SC2059
printf "\\x$(printf %x $((last ^ 1)))" | dd of="$build/tampered/golden.bin" bs=1 seek=$((size - 1)) conv=notrunc status=none
elf=$(image $target "$build/tampered")
if run "$elf" >"$build/log"; then
    fail "one changed bit in the golden decisions is not found"
fi
grep -q "differ from the host's: 1$" "$build/log" || { cat "$build/log" >&2; fail "the changed bit broke something else"; }
echo "one changed bit is found"

# on NAME TARGET MACHINE SHIFT GOLDEN MOST_FLASH [cargo options]: the image decides as the host does, within the bars.
on() {
    local name=$1 target=$2 machine=$3 shift=$4 golden=$5 most=$6 elf flash ram
    shift 6
    echo "== $name ($target on $machine)"
    elf=$(image "$target" "$build/$golden" "$@")
    if forbidden "$elf"; then
        fail "a panic or an allocation is linked"
    fi
    run "$elf" "$machine" "$shift" | tee "$build/log" || fail "the image failed"
    # Everything in flash but the golden file: vectors, code, constants, weights, initial values.
    flash=$(arm-none-eabi-size -A "$elf" | awk '$1 ~ /^\.(vector_table|text|rodata|data|gnu\.sgstubs)$/ { sum += $2 } END { print sum }')
    echo "flash with weights, bytes: $flash (of $most)"
    [ "$flash" -le "$most" ] || fail "more than $most bytes of flash"
    case $target in
    thumbv7em* | riscv32imafc*) most=$max_ram ;;
    *) most=$max_soft_ram ;;
    esac
    for ram in "$(value "RAM to decide, bytes")" "$(value "RAM to prepare a junction, bytes")"; do
        [ "$ram" -le "$most" ] || fail "more than $most bytes of RAM"
        documented docs/benchmarks.md "$name" "$ram"
    done
    documented docs/benchmarks.md "$name" "$flash" "$(value "instructions of the network, most")" \
        "$(value "instructions of a decision, most")"
}
value() { sed -n "s/^$1: //p" "$build/log"; }

on "Cortex-M4F, f32" $target mps2-an386 10 golden $max_flash
network=$(value "instructions of the network, most")
echo "network 22-48-48-48-4, instructions for each of its 2 x 5,856 multiplications and additions: $(awk "BEGIN { printf \"%.2f\", $network / 11712 }")"
# derived [options]: what firmware/instructions.py derives for a decision of the image, which the clock's `ticks` calls.
derived() {
    python3 firmware/instructions.py "$build/target/$target/release/cede-cortex-m" --root 5Clock5ticks --loops firmware/loops.txt "$@" |
        sed -n 's/.*: //p'
}
if command -v python3 >/dev/null; then
    most=$(value "instructions of a decision, most") bound=$(derived)
    echo "instructions of a decision: $most the most here, $bound derived (of $max_instructions)"
    documented docs/benchmarks.md "the most that are derived, with 8 others (below)" "$bound"
    [ "$most" -le "$bound" ] || fail "a decision took more instructions than were derived"
    [ "$bound" -le $max_instructions ] || fail "more than $max_instructions instructions"
    [ "$most" -gt "$(derived --set WATCHED=1)" ] || fail "a wrong number in the table is not found"
    sed '/^loop   miss /d' firmware/loops.txt >"$build/loops.txt"
    ! derived --loops "$build/loops.txt" 2>/dev/null | grep -q . || fail "a loop that is not in the table has a bound"
    echo "a wrong number in the table of loops is found, and a loop that is not in it is refused"
else
    echo "skipped: no Python (the bound on instructions)" >&2
    [ -z "${CEDE_SKIPS:-}" ] || echo "Python (the bound on instructions)" >>"$CEDE_SKIPS"
fi
on "Cortex-M3, i16" thumbv7m-none-eabi mps2-an385 6 golden-i16 $max_soft_flash --features i16
if [ -n "$quick" ]; then
    firmware/capi/check.sh --quick
    exit
fi
on "rv32imafc, f32" riscv32imafc-unknown-none-elf virt 0 golden $max_soft_flash
on "Cortex-M4F, i16" $target mps2-an386 10 golden-i16 $max_flash --features i16
on "Cortex-M4F, i16, micromath" $target mps2-an386 10 golden-micromath $max_flash --features i16,micromath
# The M3 executes every instruction of the M0+; QEMU has no machine with an M0+ and enough flash.
on "Cortex-M0+, i16" thumbv6m-none-eabi mps2-an385 6 golden-i16 $max_soft_flash --features i16
on "rv32imac, i16" riscv32imac-unknown-none-elf virt 0 golden-i16 $max_soft_flash --features i16

echo "== an RTIC application ($target on mps2-an386)"
elf=$(compile $target cede-rtic --features planted-late)
! run "$elf" mps2-an386 6 || fail "a task that is late is not found"
elf=$(compile $target cede-rtic)
run "$elf" mps2-an386 6 || fail "the RTIC application failed"
echo "20 decisions at 10 Hz, beneath sensors at 100 Hz; a task that is late is found"

firmware/capi/check.sh

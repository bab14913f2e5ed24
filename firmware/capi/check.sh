#!/usr/bin/env bash
# The C library: header, tests, the C examples on the host (also under sanitizers) and on Cortex-M4F, M7 and M33F under
# QEMU, where they must print the same; no panic, no allocation, no function of a C library in it, and nothing global
# but the interface. Shows as well that a planted fault of each kind is found.
# Sets up what it needs (firmware/setup.sh); firmware/check.sh calls it.
set -euo pipefail
cd "$(dirname "$0")/../.."
build=$PWD/.build/capi
mkdir -p "$build"
exec 7>"$build/lock" # one check at a time
flock 7
firmware/setup.sh
source .build/cortex-m/env
unset RUSTFLAGS
export CARGO_TERM_QUIET=true
capi=firmware/capi
capi_library=$PWD/$capi/target/release/libcede.a
examples=firmware/examples/c
target=thumbv7em-none-eabihf
max_flash=114688 # with the texts of the examples
max_ecu=106496   # without
max_ram=24576
max_instructions=100000

fail() {
    echo "capi: $*" >&2
    exit 1
}

echo "== C library on the host"
cargo=(cargo --config net.retry=3)
"${cargo[@]}" test --locked --manifest-path $capi/Cargo.toml
if "${cargo[@]}" clippy --version >/dev/null 2>&1; then
    "${cargo[@]}" clippy --locked --manifest-path $capi/Cargo.toml --all-targets -- -D warnings
fi
"${cargo[@]}" build --locked --release --manifest-path $capi/Cargo.toml
host() { # host FOLDER [make's options]: the examples' output on the host
    make -s -C $examples LIBRARY="$capi_library" OUT="$1" "${@:2}" all
    for program in first crossing ecu; do "$1/$program" >"$1/$program.txt" || fail "$program: status $?"; done
}
host "$build/plain"
host "$build/sanitized" SANITIZE=1
for program in first crossing; do cmp "$build/plain/$program.txt" "$build/sanitized/$program.txt"; done
if command -v g++ >/dev/null; then
    g++ -std=c++17 -Wall -Wextra -Wpedantic -Werror -I$capi/include $capi/tests/wrapper.cpp \
        "$capi_library" -o "$build/plain/wrapper"
    "$build/plain/wrapper"
fi
echo "the examples print the same with and without sanitizers: $(wc -l <"$build/plain/crossing.txt") lines"

# library FOLDER [cargo's options]: builds it for the target.
library() { bare_compiler=$target_compiler bare_flags=$target_flags $capi/bare.sh $target "$build/$1" "${@:2}" >/dev/null; }
nm() { arm-none-eabi-nm -C "$build/$1/cede.o"; }
undefined() { nm "$1" | grep ' U '; }
panics() { nm "$1" | grep -E 'panic|core::fmt'; }
allocations() { nm "$1" | grep -E 'alloc::|__rust_alloc|__rg_alloc|\b(malloc|calloc|realloc|free)$'; }
# What the controller takes from its own, portable library.
ours='libm::math::(sqrt::|generic::sqrt::|tanhf::|expm1f::|atanf::|atan2f::)'
mathematics='libm::math::|compiler_builtins::math|\b(sin|cos|tan|a?sinh?|acosh?|atanh?|tanh|exp2?|expm1|log(2|10|1p)?|pow|fmod?|fma|sqrt|cbrt|hypot|floor|ceil|round|trunc|rint)f?$'
mathematical() { nm "$1" | grep -E "$mathematics" | grep -vE "$ours"; }
others() { arm-none-eabi-nm "$build/$1/cede.o" | awk '$2 ~ /^[A-TV-Z]$/ { print $3 }' | grep -vxFf "$build/$1/interface"; }

echo "== the checks can fail"
library planted --features planted-panic
undefined planted >/dev/null && panics planted >/dev/null || fail "a planted panic is not found"
library planted --features planted-allocation
allocations planted >/dev/null || fail "a planted allocation is not found"
library planted --features planted-libm
mathematical planted >/dev/null || fail "a planted mathematical function is not found"
sed -i 1d "$build/planted/interface"
others planted >/dev/null || fail "a symbol that is not in the interface is not found"
echo "a planted panic, allocation, mathematical function and symbol are found"

echo "== C library on the target"
library m4f
for wrong in undefined panics allocations mathematical others; do
    ! $wrong m4f || fail "$wrong: not to be in the library"
done

# run NAME MACHINE PROGRAM CORE FPU [options]: builds an example and runs it; its status is that of the example.
run() {
    local image=$build/$1/$3 machine=$2 program=$3 core=$4 fpu=$5 sources
    sources=("$examples/$program.c" $examples/text.c $examples/cortex-m/start.c)
    [ "$program" != ecu ] || sources+=($examples/task.c)
    shift 5
    arm-none-eabi-gcc -std=c99 -O2 -Wall -Wextra -Wpedantic -Werror -ffp-contract=off -mthumb -mcpu="$core" -mfpu="$fpu" \
        -mfloat-abi=hard -ffreestanding -fno-tree-loop-distribute-patterns -ffunction-sections -fdata-sections \
        -I$capi/include -I$examples "${sources[@]}" "$build/m4f/libcede.a" -nostdlib -T $examples/cortex-m/mps2.ld \
        -Wl,--gc-sections,-z,noexecstack,--wrap=cede_approach_decide "$@" -o "$image.elf" || fail "$program does not link"
    timeout 120 qemu-system-arm -machine "$machine" -nographic -icount shift=10 \
        -semihosting-config enable=on,target=native -kernel "$image.elf" </dev/null >"$image.txt"
}

# on NAME MACHINE CORE FPU TICK [options]: the examples print there what they print on the host, within the bars.
# The library is the same one; TICK is what the machine's clock takes for a tick, in ns.
on() {
    local name=$1 machine=$2 core=$3 fpu=$4 tick=$5 program status flash ram instructions
    shift 5
    mkdir -p "$build/$name"
    for program in first crossing ecu; do
        status=0
        run "$name" "$machine" $program "$core" "$fpu" -DTICK_NS="$tick" "$@" || status=$?
        [ $status = 0 ] || { cat "$build/$name/$program.txt" >&2; fail "$program on $name: status $status"; }
        sed '/^measured: /d' "$build/$name/$program.txt" | cmp - "$build/plain/$program.txt" ||
            fail "$program on $name prints something else"
        measured() { sed -n "s/^measured: $1: //p" "$build/$name/$program.txt"; }
        flash=$(arm-none-eabi-size "$build/$name/$program.elf" | awk 'NR == 2 { print $1 + $2 }')
        ram=$(measured "RAM with stack, bytes")
        instructions=$(measured "instructions of a decision, most")
        echo "$name, $program: as on the host; flash $flash, RAM $ram, of it stack $(measured "stack, bytes") bytes;" \
            "a decision takes up to $instructions instructions"
        [ "$flash" -le $max_flash ] || fail "more than $max_flash bytes of flash"
        [ $program != ecu ] || [ "$flash" -le $max_ecu ] || fail "more than $max_ecu bytes of flash without texts"
        [ "$ram" -le $max_ram ] || fail "more than $max_ram bytes of RAM"
        [ "$instructions" -le $max_instructions ] || fail "more than $max_instructions instructions"
    done
}
mkdir -p "$build/mode"
for mode in 0x00400000 0x00800000 0x00c00000 0x01000000; do # up, down, to zero; subnormal numbers flushed
    status=0
    run mode mps2-an386 crossing cortex-m4 fpv4-sp-d16 -DTICK_NS=40 -DFPSCR=${mode}u || status=$?
    [ $status = 7 ] || fail "FPSCR $mode: status $status"
done
echo "each wrong mode of the FPU is found"
on m4f mps2-an386 cortex-m4 fpv4-sp-d16 40
on m7 mps2-an500 cortex-m7 fpv5-sp-d16 40
on m33f mps2-an505 cortex-m33 fpv5-sp-d16 50 -Wl,--defsym=flash_at=0x10000000,--defsym=ram_at=0x38000000

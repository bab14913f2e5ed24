#!/usr/bin/env bash
# The C library: header, tests, the C examples on the host (also under sanitizers) and on Cortex-M4F, M7 and M33F under
# QEMU, where they must print the same; no panic, no allocation, no function of a C library in it, and nothing global
# but the interface; injected faults and updates have the outcomes that are stated; a bound on the stack by the graph of calls;
# the tasks under operating systems; the CAN example. Shows as well that a planted fault of each kind is found.
# With --quick not on M7 and M33F.
# $FREERTOS_KERNEL may name a FreeRTOS kernel, V11: the C task is run under it then.
# Sets up what it needs (firmware/setup.sh); firmware/check.sh calls it.
set -euo pipefail
cd "$(dirname "$0")/../.."
quick=${1:-}
build=$PWD/.build/capi
mkdir -p "$build"
exec 7>"$build/lock" # one check at a time
flock 7
firmware/setup.sh
source .build/cortex-m/env
source firmware/documented.sh
unset RUSTFLAGS
export CARGO_TERM_QUIET=true
capi=firmware/capi
capi_library=$PWD/$capi/target/release/libcede.a
examples=firmware/examples/c
assets=controller/assets
target=thumbv7em-none-eabihf
max_flash=118272 # with the texts of the examples
max_ecu=109056   # without
max_ram=24576
max_stack=8192 # derived, of an ECU's task
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
    for program in first crossing ecu faults updating; do "$1/$program" >"$1/$program.txt" || fail "$program: status $?"; done
    for program in faults updating; do
        sed "/^measured: /d" "$1/$program.txt" | diff "$examples/$program.txt" - || fail "$program on the host has other outcomes than $program.txt"
    done
    [ $(($("$1/answer" $assets/embedded.cede))) = "$(sed -n 's/^#define CEDE_EMBEDDED_ANSWER //p' $capi/include/cede.h)" ] ||
        fail "answer prints another one than CEDE_EMBEDDED_ANSWER"
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
LIBRARY=$capi_library firmware/examples/can/check.sh

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

# link IMAGE PROGRAM CORE FPU [options]: links an example with the library of the target; LIBRARY names another one.
link() {
    local image=$1 program=$2 core=$3 fpu=$4 sources
    sources=("$examples/$program.c" $examples/text.c $examples/cortex-m/start.c)
    case $program in
        ecu) sources+=($examples/task.c $examples/vehicle.c) ;;
        updating) sources+=($examples/update.c) ;;
    esac
    shift 4
    arm-none-eabi-gcc -std=c99 -O2 -Wall -Wextra -Wpedantic -Werror -ffp-contract=off -mthumb -mcpu="$core" -mfpu="$fpu" \
        -mfloat-abi=hard -ffreestanding -fno-tree-loop-distribute-patterns -ffunction-sections -fdata-sections \
        -I$capi/include -I$examples "-DWEIGHTS=\"$assets/embedded.cede\"" "-DWEIGHTS_I16=\"$assets/embedded-i16.cede\"" \
        "${sources[@]}" "${LIBRARY:-$build/m4f/libcede.a}" -nostdlib -T $examples/cortex-m/mps2.ld \
        -Wl,--gc-sections,-z,noexecstack "$@" -o "$image" || fail "$program does not link"
}
emulate() { # emulate MACHINE IMAGE [QEMU's options]
    timeout 300 qemu-system-arm -machine "$1" -nographic -semihosting-config enable=on,target=native \
        -kernel "$2" "${@:3}" </dev/null
}
# run NAME MACHINE PROGRAM CORE FPU [options]: links an example and runs it, measured; its status is that of the example.
run() {
    local image=$build/$1/$3
    link "$image.elf" "$3" "$4" "$5" -Wl,--wrap=cede_approach_decide "${@:6}"
    emulate "$2" "$image.elf" -icount shift=10 >"$image.txt" # an instruction takes 1024 ns
}
# outcomes NAME [options]: what injected faults and updates are answered by on the target is what is stated.
outcomes() {
    local program image
    mkdir -p "$build/$1"
    for program in faults updating; do
        image=$build/$1/$program
        link "$image.elf" $program cortex-m4 fpv4-sp-d16 -Wl,--defsym=ram_bytes=0x20000 "${@:2}"
        emulate mps2-an386 "$image.elf" >"$image.txt" || return
        sed "/^measured: /d" "$image.txt" | diff $examples/$program.txt - || return
    done
}

echo "== the checks can fail"
library planted --features planted-panic
undefined planted >/dev/null && panics planted >/dev/null || fail "a planted panic is not found"
library planted --features planted-allocation
allocations planted >/dev/null || fail "a planted allocation is not found"
library planted --features planted-unsealed
! LIBRARY=$build/planted/libcede.a outcomes planted >"$build/log" 2>&1 || fail "objects whose checksum nobody looks at are not found"
# It goes as far as the objects, and there it sees what must not be, or ends in a hard fault.
grep -q 'weights, unnoticed' "$build/planted/faults.txt" &&
    ! grep -q 'every one found by cede_approach_decide' "$build/planted/faults.txt" ||
    { cat "$build/log" "$build/planted/faults.txt" >&2; fail "something else is found"; }
library planted --features planted-libm
mathematical planted >/dev/null || fail "a planted mathematical function is not found"
sed -i 1d "$build/planted/interface"
others planted >/dev/null || fail "a symbol that is not in the interface is not found"
echo "a planted panic, allocation, mathematical function and symbol, and a missing checksum are found"

echo "== C library on the target"
library m4f
for wrong in undefined panics allocations mathematical others; do
    ! $wrong m4f || fail "$wrong: not to be in the library"
done

outcomes m4f
echo "injected faults and updates have the outcomes that are stated: $(wc -l <$examples/faults.txt) and" \
    "$(wc -l <$examples/updating.txt) lines"

# bounds PROGRAM [options]: what firmware/stack.py derives.
# The zones of a junction call one of two closures for each pair of pieces, and one of two for each pair of turns; there is
# no other call through a register.
bounds() {
    python3 firmware/stack.py --calls 'near_pieces=zone(s|_with_itself)28_.*closure' \
        --calls 'turns_with=zone(11meet_stages|4band4Band15widen_by_stages)28_.*closure' "$@"
}
if command -v python3 >/dev/null; then
    echo "== stack, by the graph of calls, bytes"
    # planted C: a program whose stack has no bound that can be derived.
    planted() {
        arm-none-eabi-gcc -O1 -fno-optimize-sibling-calls -mthumb -mcpu=cortex-m4 -ffreestanding -nostdlib -Wl,-ereset -x c - \
            -o "$build/planted.elf" <<<"$1"
        ! bounds "$build/planted.elf" --root reset >/dev/null 2>&1 || fail "a stack without a bound has one: $1"
    }
    planted 'int reset(int n) { return n ? 2 + 3 * reset(n / 2) : 0; }'
    planted 'int (*volatile f)(int); int reset(int n) { return f(n) + 1; }'
    planted 'void g(char *); void reset(int n) { char a[n]; g(a); } void g(char *a) { __asm__("" :: "r"(a)); }'
    echo "a recursion, a call by a pointer and an array of unknown length are refused"
    arm-none-eabi-ld "$build/m4f/named.o" -e cede_abi_version -o "$build/m4f/named.elf"
    mapfile -t roots < <(sed 's/^/--root=/' "$build/m4f/interface")
    bounds "$build/m4f/named.elf" "${roots[@]}" | sort -t: -k2 -n -r | head -n 8 | tee "$build/m4f/bounds"
    while IFS=': ' read -r function bytes; do documented docs/integration.md "\`$function\`" "$bytes"; done <"$build/m4f/bounds"
    # Measured as it is below, so that the two can be compared.
    LIBRARY=$build/m4f/named.o link "$build/m4f/ecu-named.elf" ecu cortex-m4 fpv4-sp-d16 -DTICK_NS=40 \
        -Wl,--wrap=cede_approach_decide
    derived=$(bounds "$build/m4f/ecu-named.elf" --root reset --path | tee "$build/m4f/stack" | sed -n 's/^reset: //p')
    [ -n "$derived" ] || fail "the stack of ecu has no bound"
    echo "ecu, from reset on: $derived (of $max_stack)"
    [ "$derived" -le $max_stack ] || fail "more than $max_stack bytes of stack"
else
    echo "skipped: no Python (the bound on the stack)" >&2
    [ -z "${CEDE_SKIPS:-}" ] || echo "Python (the bound on the stack)" >>"$CEDE_SKIPS"
fi

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
        if [ "$name" = m4f ]; then
            documented docs/integration.md "flash, weights and example included" "$flash"
            documented docs/integration.md "RAM, all objects and the stack" "$ram"
            documented docs/integration.md "of it stack" "$(measured "stack, bytes")"
            documented docs/integration.md "instructions of \`cede_approach_decide\`, the most of this run, one other" "$instructions"
        fi
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
[ -n "$quick" ] || on m7 mps2-an500 cortex-m7 fpv5-sp-d16 40
[ -n "$quick" ] || on m33f mps2-an505 cortex-m33 fpv5-sp-d16 50 -Wl,--defsym=flash_at=0x10000000,--defsym=ram_at=0x38000000
if [ -n "${derived:-}" ]; then
    painted=$(sed -n 's/^measured: stack, bytes: //p' "$build/m4f/ecu.txt")
    echo "stack of ecu: $painted bytes were touched, $derived are derived"
    [ "$painted" -le "$derived" ] || fail "more stack was touched than was derived"
fi

echo "== under FreeRTOS"
freertos=firmware/examples/freertos
flags=(-std=c99 -O2 -ffp-contract=off -mthumb -mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard -ffreestanding
    -fno-tree-loop-distribute-patterns -ffunction-sections -fdata-sections -I$freertos)
strict=(-Wall -Wextra -Wpedantic -Werror)
arm-none-eabi-gcc "${flags[@]}" "${strict[@]}" -I$freertos/declared -I$capi/include -fsyntax-only $freertos/main.c
echo "the task compiles with the declarations of FreeRTOS that it uses"
if [ -n "${FREERTOS_KERNEL:-}" ]; then
    kernel=$FREERTOS_KERNEL
    port=$kernel/portable/GCC/ARM_CM4F
    mkdir -p "$build/freertos"
    objects=()
    compile() { # compile SOURCE [options]
        objects+=("$build/freertos/$(basename "$1" .c).o")
        arm-none-eabi-gcc "${flags[@]}" -I"$kernel/include" -I"$port" -I$freertos/freestanding "${@:2}" -c "$1" -o "${objects[-1]}"
    }
    for source in "$kernel/tasks.c" "$kernel/list.c" "$port/port.c"; do compile "$source"; done
    compile $freertos/main.c "${strict[@]}" -I$capi/include
    for source in task vehicle text cortex-m/start; do compile $examples/$source.c "${strict[@]}" -I$examples -I$capi/include; done
    arm-none-eabi-gcc "${flags[@]}" "${objects[@]}" "$build/m4f/libcede.a" -nostdlib -T $examples/cortex-m/mps2.ld \
        -Wl,--gc-sections,-z,noexecstack,--defsym=ram_bytes=0x8000 -o "$build/freertos/image.elf"
    emulate mps2-an386 "$build/freertos/image.elf" -icount shift=6 || fail "the task under FreeRTOS: status $?"
    echo "20 periods under FreeRTOS, beneath a task with another rounding mode"
else
    echo "skipped: no FreeRTOS kernel (FREERTOS_KERNEL)" >&2
    [ -z "${CEDE_SKIPS:-}" ] || echo "FreeRTOS kernel (FREERTOS_KERNEL)" >>"$CEDE_SKIPS"
fi

#!/usr/bin/env bash
# Sets up what a lane needs that builds for another target, and leaves the rest of the machine as it is:
# setup.sh cortex-m (the default) or setup.sh wasm, in .build/cortex-m or .build/wasm.
#
# What is already installed is used: rustup's target, QEMU, the GNU tools. What is missing comes from
# Debian's packages (root on Debian; downloaded and unpacked, not installed): no toolchain is fetched.
# At the end .build/LANE/env holds the variables that firmware/check.sh or play/build.sh reads.
#
# Whatever is unpacked or built appears under its final name only when it is whole, so an interrupted
# set-up is begun again; the name holds the packages' versions.
set -euo pipefail
shopt -s inherit_errexit nullglob
cd "$(dirname "$0")/.."
lane=${1:-cortex-m}
build=$PWD/.build/$lane
case $lane in
    cortex-m) targets=(thumbv7em-none-eabihf thumbv7m-none-eabi thumbv6m-none-eabi
        riscv32imafc-unknown-none-elf riscv32imac-unknown-none-elf) ;;
    wasm) targets=(wasm32-unknown-unknown) ;;
    *) echo "usage: firmware/setup.sh [cortex-m|wasm]" >&2 && exit 2 ;;
esac
rust_version=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
libraries=x86_64-linux-gnu # Debian's folder of the host's libraries

fail() {
    echo "firmware/setup.sh: $*" >&2
    exit 1
}
has_targets() {
    local target
    for target in "${targets[@]}"; do [ -d "$(rustc --print target-libdir --target "$target" 2>/dev/null)" ] || return; done
}
at_least() { printf '%s\n%s\n' "$1" "$2" | sort -VC; } # WANTED VERSION

# One set-up at a time; the others wait. What a killed one has left is removed.
mkdir -p "$build"
exec 9>"$build/lock"
flock 9
rm -rf "$build"/new.*
new=$(mktemp -d "$build/new.XXXXXX")
trap 'rm -rf "$new"' EXIT

packages=()
has_targets || packages+=(rustc-web rust-web-src)
if [ $lane = cortex-m ]; then
    command -v qemu-system-arm >/dev/null || packages+=(qemu-system-arm)
    command -v qemu-system-riscv32 >/dev/null || packages+=(qemu-system-misc)
    command -v arm-none-eabi-nm >/dev/null || packages+=(binutils-arm-none-eabi)
    command -v arm-none-eabi-gcc >/dev/null || packages+=(gcc-arm-none-eabi) # for the example in C; without a C library
fi

# An index of the set-up's own: the machine's may be stale, or another program may be writing it.
apt=(-o "Dir::State::lists=$new/lists" -o "Dir::Cache=$new/cache" -o APT::Sandbox::User=root
    -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3)

# fetch: downloads the packages, checks their versions, unpacks them as $build/tools+NAME=VERSION+...
fetch() {
    command -v apt-get >/dev/null && [ "$(id -u)" = 0 ] || fail "${packages[*]} are missing, and only root on" \
        "Debian can unpack them here; the targets come with: rustup target add ${targets[*]};" \
        "cortex-m needs QEMU for Arm and RISC-V, GNU binutils and GCC for arm-none-eabi, too"
    echo "fetching ${packages[*]}"
    mkdir -p "$new/lists/partial" "$new/cache/archives/partial" "$new/tools/bin"
    apt-get -qq "${apt[@]}" update >/dev/null

    local package version versioned=()
    for package in "${packages[@]}"; do
        version=$(apt-cache "${apt[@]}" policy "$package" | sed -n 's/^  Candidate: //p')
        [ -n "$version" ] && [ "$version" != "(none)" ] || fail "the package index has no $package"
        versioned+=("$package=$version")
    done
    check_rust "${versioned[@]}"
    apt-get -qq "${apt[@]}" install -y --download-only --no-install-recommends "${versioned[@]}" >/dev/null

    local deb
    for deb in "$new"/cache/archives/*.deb; do dpkg -x "$deb" "$new/tools"; done
    wrap cortex-rustc rustc
    local core
    for core in arm riscv32; do wrap qemu-system-$core qemu-system-$core -L '"$root/usr/share/qemu"'; done
    for package in nm size objdump objcopy ld ar as gcc; do wrap arm-none-eabi-$package arm-none-eabi-$package; done
    works "$new/tools" || fail "what was unpacked does not start"

    # An epoch's colon would split LD_LIBRARY_PATH.
    tools=$build/tools$(printf '+%s' "${versioned[@]/=*:/=}")
    local old
    for old in "$build"/tools+*; do mv "$old" "$new"; done
    mv "$new/tools" "$tools"
}

# check_rust NAME=VERSION...: the compiler is new enough, and the sources are its own.
check_rust() {
    local package compiler= sources=
    for package in "$@"; do
        case $package in
            rustc-web=*) compiler=${package#*=} ;;
            rust-web-src=*) sources=${package#*=} ;;
        esac
    done
    [ "$compiler" = "$sources" ] || fail "rustc-web is $compiler but rust-web-src is $sources"
    [ -z "$compiler" ] || at_least "$rust_version" "$compiler" || fail "Cede needs Rust $rust_version," \
        "the package index has rustc-web $compiler; with rustup: rustup target add ${targets[*]}"
}

# wrap NAME PROGRAM [OPTIONS]: a script that starts an unpacked program with the libraries beside it.
wrap() {
    local script=$new/tools/bin/$1 program=usr/bin/$2
    shift 2
    [ -x "$new/tools/$program" ] || return 0
    cat >"$script" <<END
#!/bin/sh
root=\${0%/*}/..
LD_LIBRARY_PATH=\$root/usr/lib/$libraries:\$root/lib/$libraries:\$root/usr/lib exec "\$root/$program" "\$@" $*
END
    chmod +x "$script"
}

# works FOLDER: its programs start, and its compiler, if it has one, is new enough and has its sources.
works() {
    local program compiler=$1/bin/cortex-rustc version
    for program in "$1"/bin/*; do "$program" --version >/dev/null 2>&1 || return; done
    [ -e "$compiler" ] || return 0
    version=$("$compiler" --version | cut -d' ' -f2)
    at_least "$rust_version" "$version" && [ -e "$1/usr/src/rustc-$version/library/core/src/lib.rs" ]
}

# unpacked: prints the folder of an earlier set-up that has all packages and works.
unpacked() {
    local folder package
    for folder in "$build"/tools+*; do
        for package in "${packages[@]}"; do [[ $folder+ == *+"$package"=* ]] || continue 2; done
        ! works "$folder" || { echo "$folder" && return; }
    done
}

# build_core TARGET: Debian has no core for it; it is built once, from the same version's sources.
build_core() {
    local target=$1 compiler=$tools/bin/cortex-rustc version library lib=$new/sysroot/lib/rustlib/$1/lib core_options=()
    [[ $target != thumb* ]] || core_options=(--cfg thumb)
    version=$("$compiler" --version | cut -d' ' -f2)
    library=$tools/usr/src/rustc-$version/library
    echo "building core $version for $target, which takes one to two minutes"
    mkdir -p "$lib"
    core() {
        RUSTC_BOOTSTRAP=1 "$compiler" --edition=2024 --crate-type lib --target $target --sysroot "$new/sysroot" \
            --out-dir "$lib" -C opt-level=3 -C codegen-units=1 -C panic=abort -C embed-bitcode=yes \
            -Z force-unstable-if-unmarked --cap-lints allow "$@"
    }
    core --crate-name core "$library/core/src/lib.rs"
    local feature features=()
    for feature in compiler-builtins default mem unstable-intrinsics; do
        features+=(--cfg "feature=\"$feature\"")
    done
    core --crate-name compiler_builtins "${features[@]}" "${core_options[@]}" --cfg f16_enabled --cfg f128_enabled \
        --cfg intrinsics_enabled --cfg arch_enabled --cfg optimizations_enabled \
        "$library/compiler-builtins/compiler-builtins/src/lib.rs"
    compiles "$new/sysroot" "$target" || fail "the core that was built is of no use: $(cat "$new/log")"
    rm -rf "$sysroot/lib/rustlib/$target"
    mkdir -p "$sysroot/lib/rustlib"
    mv "$new/sysroot/lib/rustlib/$target" "$sysroot/lib/rustlib/$target"
}

# compiles SYSROOT TARGET: its core is whole. A static library takes in every object of core and compiler_builtins.
compiles() {
    [ -d "$1/lib/rustlib/$2" ] || return
    echo '#![no_std] #[panic_handler] fn panic(_: &core::panic::PanicInfo) -> ! { loop {} }' |
        "$tools/bin/cortex-rustc" --crate-name probe --crate-type staticlib --target "$2" --sysroot "$1" \
            -C panic=abort -o "$new/probe.a" - >"$new/log" 2>&1
}

tools= compiler= flags=
if [ ${#packages[@]} -gt 0 ]; then
    tools=$(unpacked)
    [ -n "$tools" ] || fetch
fi
if ! has_targets; then
    compiler=$tools/bin/cortex-rustc
    sysroot=$tools/sysroot
    for target in "${targets[@]}"; do compiles "$sysroot" "$target" || build_core "$target"; done
    flags=--sysroot=$sysroot
fi

cat >"$new/env" <<END
export PATH=${tools:+$(printf %q "$tools/bin"):}\$PATH
target_compiler=$(printf %q "$compiler")
target_flags=$(printf %q "$flags")
END
mv "$new/env" "$build/env"

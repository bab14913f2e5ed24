#!/usr/bin/env bash
# Sets up what the Cortex-M lane needs, in .build/cortex-m, and leaves the rest of the machine as it is.
#
# What is already installed is used: rustup's target, QEMU, the GNU tools. What is missing comes from
# Debian's packages (root on Debian 12; downloaded and unpacked, not installed): no toolchain is fetched.
# At the end .build/cortex-m/env holds the variables that firmware/check.sh reads.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$PWD/.build/cortex-m
root=$build/root
target=thumbv7em-none-eabihf
rm -rf "$build/bin"
mkdir -p "$build/bin" "$build/debs/partial"

has_target() { [ -d "$(rustc --print target-libdir --target $target 2>/dev/null)" ]; }

packages=()
has_target || packages+=(rustc-web rust-web-src)
command -v qemu-system-arm >/dev/null || packages+=(qemu-system-arm)
command -v arm-none-eabi-nm >/dev/null || packages+=(binutils-arm-none-eabi)

# The stamp names what was unpacked, so a machine that gains or loses a tool is set up anew.
stamp="$build/unpacked ${packages[*]}"
if [ ${#packages[@]} -gt 0 ] && [ ! -e "${stamp// /+}" ]; then
    echo "fetching ${packages[*]}"
    apt=(apt-get -qq -o "Dir::Cache::archives=$build/debs" -o "APT::Sandbox::User=root")
    fetch=("${apt[@]}" install -y --download-only --no-install-recommends "${packages[@]}")
    "${fetch[@]}" >/dev/null 2>&1 || { "${apt[@]}" update >/dev/null && "${fetch[@]}" >/dev/null; }
    rm -rf "$root" && mkdir -p "$root"
    for deb in "$build"/debs/*.deb; do dpkg -x "$deb" "$root"; done
    rm -f "$build"/debs/*.deb
    : >"${stamp// /+}"
fi

# A wrapper for each unpacked program, because its libraries are unpacked as well.
libraries=$root/usr/lib/x86_64-linux-gnu:$root/lib/x86_64-linux-gnu:$root/usr/lib
wrap() {
    local name=$1 program=$root/usr/bin/$2
    shift 2
    printf '#!/bin/sh\nLD_LIBRARY_PATH=%q exec %q "$@" %s\n' "$libraries" "$program" "$*" >"$build/bin/$name"
    chmod +x "$build/bin/$name"
}
for program in arm-none-eabi-nm arm-none-eabi-size arm-none-eabi-objdump; do
    [ ! -x "$root/usr/bin/$program" ] || wrap $program $program
done
[ ! -x "$root/usr/bin/qemu-system-arm" ] || wrap qemu-system-arm qemu-system-arm -L "$root/usr/share/qemu"

compiler= flags=
if ! has_target; then
    wrap cortex-rustc rustc
    compiler=$build/bin/cortex-rustc
    version=$("$compiler" --version | cut -d' ' -f2)
    sysroot=$build/sysroot-$version
    lib=$sysroot/lib/rustlib/$target/lib
    # Debian has no core for this target: it is built once, from the same version's sources.
    if [ ! -e "$lib/done" ]; then
        echo "building core $version for $target"
        rm -rf "$sysroot" && mkdir -p "$lib"
        library=$root/usr/src/rustc-$version/library
        core() {
            RUSTC_BOOTSTRAP=1 "$compiler" --edition=2024 --crate-type lib --target $target --sysroot "$sysroot" \
                --out-dir "$lib" -C opt-level=3 -C codegen-units=1 -C panic=abort -C embed-bitcode=yes \
                -Z force-unstable-if-unmarked --cap-lints allow "$@"
        }
        core --crate-name core "$library/core/src/lib.rs"
        features=()
        for feature in compiler-builtins default mem unstable-intrinsics; do
            features+=(--cfg "feature=\"$feature\"")
        done
        core --crate-name compiler_builtins "${features[@]}" --cfg thumb --cfg f16_enabled --cfg f128_enabled \
            --cfg intrinsics_enabled --cfg arch_enabled --cfg optimizations_enabled \
            "$library/compiler-builtins/compiler-builtins/src/lib.rs"
        : >"$lib/done"
    fi
    flags="--sysroot=$sysroot"
fi

cat >"$build/env" <<END
export PATH=$(printf %q "$build/bin"):\$PATH
cortex_compiler=$(printf %q "$compiler")
cortex_flags=$(printf %q "$flags")
END

#!/usr/bin/env bash
# Builds the C library for a core without an operating system, and makes one object of it in which nothing but the
# interface is global. Prints where libcede.a is; beside it is what it was made of.
#
#   bare.sh TARGET FOLDER [cargo options]   for example: bare.sh thumbv7em-none-eabihf build
#
# $cross is the prefix of the GNU tools, and $bare_compiler and $bare_flags may name a compiler and its flags for a
# target that rustup does not have; without $bare_compiler those of firmware/setup.sh are taken, where it has run.
set -euo pipefail
usage() { sed -n '2,/^set/p' "$0" | sed '$d;s/^# \{0,1\}//'; }
case ${1:-} in -h | --help) usage && exit ;; esac
[ $# -ge 2 ] || { usage >&2 && exit 2; }
target=$1
folder=$2
shift 2
here=$(cd "$(dirname "$0")" && pwd)
cross=${cross:-arm-none-eabi-}
setup=$here/../../.build/cortex-m/env
if [ -z "${bare_compiler+set}" ] && [ -e "$setup" ]; then
    source "$setup"
    bare_compiler=$target_compiler bare_flags=$target_flags
fi
if [ -z "${bare_compiler:-}" ] && [ ! -d "$(rustc --print target-libdir --target "$target")" ]; then
    echo "bare.sh: no core for $target: rustup target add $target, or firmware/setup.sh" >&2
    exit 1
fi

mkdir -p "$folder"
[ -z "${bare_compiler:-}" ] || export RUSTC=$bare_compiler
variable=CARGO_TARGET_$(tr 'a-z-' 'A-Z_' <<<"$target")_RUSTFLAGS
export "$variable=${bare_flags:-}"
# As a static library alone: beside an rlib it would not be optimised as a whole.
cargo rustc --lib --crate-type staticlib --release --locked --manifest-path "$here/Cargo.toml" --no-default-features \
    --features embedded-policy,core-sqrt --target "$target" --target-dir "$folder/../cargo" "$@" >&2

# Of a static library C sees every symbol: Rust's memcpy and sqrtf, its panic handler, those of another Rust library.
grep -oE '^[^#* /].*\bcede_[a-z0-9_]+\(' "$here/include/cede.h" | grep -oE 'cede_[a-z0-9_]+\($' | tr -d '(' | sort -u >"$folder/interface"
mapfile -t roots < <(sed 's/^/--undefined=/' "$folder/interface")
"${cross}ld" -r --gc-sections "${roots[@]}" "$folder/../cargo/$target/release/libcede.a" -o "$folder/whole.o"
# Beside it the same with the names of its functions, for a look at the graph of calls.
"${cross}objcopy" --keep-global-symbols="$folder/interface" "$folder/whole.o" "$folder/named.o"
"${cross}objcopy" --strip-unneeded "$folder/named.o" "$folder/cede.o"
rm -f "$folder/libcede.a"
"${cross}ar" rcsD "$folder/libcede.a" "$folder/cede.o"
echo "$folder/libcede.a"

#!/usr/bin/env bash
# Packs a release, for this machine's target, and publishes nothing:
#
#   ./release.sh [FOLDER]     from the commit with the tag vVERSION (FOLDER: .build/release)
#   ./release.sh --dry-run    from the work tree as it is
#   ./release.sh --check      says whether all files name one version, and packs nothing
#
# FOLDER then holds the crates for crates.io, the Python wheel, the program `cede` with its manual pages and
# completions, the C library with its headers, and SHA256SUMS. Needs a C compiler, Python 3.9 and PyPI.
set -euo pipefail
cd "$(dirname "$0")"
source .ci/publishable.sh

fail() {
    echo "release: $*" >&2
    exit 1
}
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml)
target=$(rustc --print host-tuple)

# names PATTERN FILE...: each file names this version where PATTERN (of sed) matches.
names() {
    local pattern=$1 file found
    shift
    for file; do
        found=$(sed -n "s/$pattern/\1/p" "$file" | sort -u)
        [ "$found" = "$version" ] || fail "$file names version ${found:-(none)}, Cargo.toml $version"
    done
}
names '^version = "\(.*\)"' firmware/capi/Cargo.toml firmware/cortex-m/Cargo.toml play/Cargo.toml python/Cargo.toml
names '^cede-.* path = .* version = "\([^"]*\)".*' Cargo.toml
names '^version: \(.*\)' CITATION.cff
names '.*--version \([0-9.]*\).*' testing/ci/github.yml
grep -q "^## \[$version\]" CHANGELOG.md || fail "CHANGELOG.md has no heading [$version]"
echo "version $version"

folder=.build/release dirty=()
case ${1:-} in
    --check) exit 0 ;;
    --dry-run) dirty=(--allow-dirty) ;;
    -*) fail "no option $1; there are --dry-run and --check" ;;
    *)
        folder=${1:-$folder}
        [ -z "$(git status --porcelain)" ] || fail "the work tree has changes; --dry-run packs them"
        [ "$(git describe --tags --exact-match 2>/dev/null)" = "v$version" ] ||
            fail "this commit has no tag v$version; --dry-run needs none"
        ;;
esac
rm -rf "$folder"
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

# archive NAME: packs the folder NAME in .build/packing; the same bytes for the same files.
archive() {
    tar -C .build/packing --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$(git log -1 --format=%ct)" \
        -cf - "$1" | gzip -n9 >"$folder/$1.tar.gz"
}
rm -rf .build/packing
own=cede-$version-$target library=libcede-$version-$target
mkdir -p ".build/packing/$own/completions" ".build/packing/$library/"{lib,include}

echo "== crates"
package --quiet "${dirty[@]}"
for name in "${publishable[@]}"; do cp ".build/package/package/$name-$version.crate" "$folder"; done

echo "== program"
cargo build --locked --release --quiet --package cede
cp target/release/cede README.md CHANGELOG.md LICENSE-* ".build/packing/$own"
target/release/cede man --quiet --out ".build/packing/$own/man"
for shell in bash zsh fish; do target/release/cede completions "$shell" >".build/packing/$own/completions/cede.$shell"; done
archive "$own"

echo "== C library"
cargo build --locked --release --quiet --manifest-path firmware/capi/Cargo.toml
cp firmware/capi/target/release/libcede.a ".build/packing/$library/lib"
cp firmware/capi/include/cede.h{,pp} ".build/packing/$library/include"
cp docs/integration.md LICENSE-* ".build/packing/$library"
archive "$library"

echo "== Python wheel"
venv=.build/python-package
[ -x $venv/bin/python ] || python3 -m venv $venv
$venv/bin/python -m pip --disable-pip-version-check --quiet install 'maturin>=1.9,<2'
$venv/bin/maturin build --locked --release --quiet --manifest-path python/Cargo.toml --out "$folder"

(cd "$folder" && sha256sum -- * >SHA256SUMS)
rm -rf .build/packing
echo "== $folder"
(cd "$folder" && du -h --apparent-size -- *)

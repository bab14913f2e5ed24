#!/usr/bin/env bash
# Trains the embedded policy again, in integers too, and compares the files with the committed ones, byte for byte. Fails if
# they differ. A file names the version of cede that trained it: with a new version it is made anew, and the weights stay.
#
#   tests/retrain.sh            compares
#   tests/retrain.sh --update   replaces the committed files
#
# Forty seconds on two cores after compilation. The same bits on any number of threads.
set -euo pipefail
cd "$(dirname "$0")/.."
assets=controller/assets
case ${1:-} in
    "" | --update) ;;
    *) sed -n '2,8s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
esac

new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT
cede=(cargo run --locked --release --quiet --package cede --)
"${cede[@]}" train apg --data synthetic --encounters 3000 --data-seed 1 --settings $assets/embedded.toml \
    --claims $assets/embedded.claims.toml --seed 0 --out "$new/embedded.cede"
"${cede[@]}" export --weights "$new/embedded.cede" --quantise i16 --out "$new/embedded-i16.cede"
for file in embedded.cede embedded.txt embedded-i16.cede; do
    if [ "${1:-}" = --update ]; then cp "$new/$file" $assets/; fi
    cmp "$new/$file" "$assets/$file"
done
echo "retrain: the committed files, byte for byte"

#!/usr/bin/env bash
# prepare_instance.sh v1 CATEGORY ONNX VNNLIB: nothing is prepared, but what cannot be read is refused here.
set -euo pipefail
[ "${1:-}" = v1 ] || { echo "unknown version of the interface: ${1:-none}" >&2; exit 1; }
for file in "$3" "$4"; do
    [ -r "$file" ] || { echo "cannot read $file" >&2; exit 1; }
done

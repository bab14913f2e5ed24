#!/usr/bin/env bash
# run_instance.sh v1 CATEGORY ONNX VNNLIB RESULTS TIMEOUT: the first line of RESULTS is sat, unsat, timeout, unknown or
# error; a witness follows sat.
set -uo pipefail
[ "${1:-}" = v1 ] || { echo "unknown version of the interface: ${1:-none}" >&2; exit 1; }
nnv=$(dirname "$0")/../../target/release/nnv
"$nnv" --onnx "$3" --vnnlib "$4" --timeout "$6" >"$5" || {
    echo error >"$5"
    exit 1
}

#!/usr/bin/env bash
# The CAN example: database, header and manual agree, and a left turn is driven through the frames on the host.
# cantools comes from PyPI into a virtual environment under .build/. Without Python it is skipped, and says so.
# Shows as well that a changed database is found. LIBRARY names the C library; firmware/capi/check.sh calls it.
set -euo pipefail
cd "$(dirname "$0")/../../.."
here=firmware/examples/can
build=$PWD/.build/can
header=firmware/capi/include/cede.h
manual=docs/integration.md
library=${LIBRARY:-firmware/capi/target/release/libcede.a}

fail() {
    echo "can: $*" >&2
    exit 1
}

if ! python3 -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then
    echo "skipped: no Python 3.10 with venv (firmware/examples/can)" >&2
    [ -z "${CEDE_SKIPS:-}" ] || echo "Python 3.10 with venv (firmware/examples/can)" >>"$CEDE_SKIPS"
    exit 0
fi
[ -x "$build/venv/bin/python" ] || python3 -m venv "$build/venv"
python=$build/venv/bin/python
"$python" -m pip --disable-pip-version-check --quiet install 'cantools>=40'

"$python" $here/check.py $here/cede.dbc $header $manual
# planted SED: a changed database is refused.
planted() {
    sed "$1" $here/cede.dbc >"$build/planted.dbc"
    ! cmp -s "$build/planted.dbc" $here/cede.dbc || fail "nothing is planted by $1"
    ! "$python" $here/check.py "$build/planted.dbc" $header $manual >/dev/null 2>&1 || fail "not found: $1"
}
planted 's/cede_track.number/cede_track.name/'        # a field that does not exist
planted 's/\[-1|100\]/[0|100]/'                       # a range that is too small
planted 's/"SHIELDED"/"SHIELD"/'                      # a choice with another name
planted 's/SG_ x : 0|21@1+/SG_ x : 0|20@1+/'          # a range that does not fit
planted 's/SG_ speed : 16|14@1+/SG_ speed : 15|14@1+/' # signals that overlap
echo "a wrong field, range, choice, length and place are found"

"$python" -m cantools generate_c_source --database-name cede_can --use-float --use-round --output-directory "$build" \
    $here/cede.dbc >/dev/null
cc=(gcc -std=c99 -O2 -Wall -Wextra -Wpedantic -Werror -ffp-contract=off -Ifirmware/capi/include -I"$build")
"${cc[@]}" $here/test.c $here/can.c "$build/cede_can.c" "$library" -Wl,--gc-sections -lm -o "$build/test"
"$build/test"

#!/usr/bin/env bash
# Builds the wheel of `cede` in a virtual environment of its own under .build/, and runs its checks: format and
# lints of Rust and Python, licences, types against the module, tests, the first example of docs/python.md.
# Without Python it is skipped, and says so. stable-baselines3's checker runs if CEDE_SB3=1: torch is large.
set -euo pipefail
cd "$(dirname "$0")/.."
venv=$PWD/.build/python-package
skip() {
    echo "skipped: no $1" >&2
    [ -z "${CEDE_SKIPS:-}" ] || echo "$1" >>"$CEDE_SKIPS"
}

if ! python3 -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 9))' 2>/dev/null; then
    skip "Python 3.9 with venv (python/check.sh)"
    exit 0
fi
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
pip=("$venv/bin/python" -m pip --disable-pip-version-check --quiet install)
"${pip[@]}" 'maturin>=1.9,<2' 'ruff>=0.14' 'mypy>=1.18'

cargo fmt --manifest-path python/Cargo.toml --check
cargo clippy --locked --release --manifest-path python/Cargo.toml -- -D warnings
if cargo deny --version >/dev/null 2>&1; then
    cargo deny --locked --manifest-path python/Cargo.toml --config deny.toml check --hide-inclusion-graph licenses bans sources
else
    skip "cargo-deny (licences of the Python package)"
fi
"$venv/bin/ruff" check python
"$venv/bin/ruff" format --check python

rm -rf .build/wheels
"$venv/bin/maturin" build --locked --release --quiet --manifest-path python/Cargo.toml --out .build/wheels
wheel=(.build/wheels/cede-*.whl)
"${pip[@]}" --force-reinstall --no-deps "${wheel[0]}"
"${pip[@]}" "${wheel[0]}[test]"
[ "${CEDE_SB3:-0}" != 1 ] || "${pip[@]}" stable-baselines3
# What the stub says is there is there, and the other way round.
(cd .build && "$venv/bin/stubtest" cede._cede --ignore-missing-stub)
"$venv/bin/python" -m pytest -q -rs python/tests -c python/pyproject.toml

# The first example of the documentation, as it is printed there.
awk '/^```python$/ {inside = 1; next} /^```$/ && inside {exit} inside' docs/python.md >.build/first_example.py
"$venv/bin/python" .build/first_example.py

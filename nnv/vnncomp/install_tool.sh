#!/usr/bin/env bash
# install_tool.sh v1: builds `nnv` with the Rust toolchain that is on the search path, or installs one.
set -euo pipefail
[ "${1:-}" = v1 ] || { echo "unknown version of the interface: ${1:-none}" >&2; exit 1; }
cd "$(dirname "$0")/../.."
command -v cargo >/dev/null || {
    curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh -s -- -y --profile minimal
    . "$HOME/.cargo/env"
}
cargo build --locked --release --package cede-nnv --features cli

#!/usr/bin/env bash
# Makes the site of the documentation in .build/book: docs/ by mdBook (cargo install mdbook), the playground, and the API
# reference that `cargo doc --workspace --no-deps` has made. Needs Node.
set -euo pipefail
cd "$(dirname "$0")/.."
mdbook=$(command -v mdbook || echo .build/tools/bin/mdbook)
"$mdbook" build book
rm -rf .build/book/api
if [ -d target/doc ]; then
    cp -r target/doc .build/book/api
else
    echo "without the API reference: cargo doc --workspace --no-deps" >&2
fi

#!/usr/bin/env bash
# Makes docs/play.png, docs/replay.png and docs/drive.gif anew, from the playground and the demo of this work tree.
# Needs Chromium, Node and ImageMagick (Debian: chromium nodejs imagemagick).
set -euo pipefail
cd "$(dirname "$0")/.."
frames=.build/pictures
rm -rf $frames
mkdir -p $frames
cargo run --locked --release --quiet
node book/pictures.js "$(command -v chromium || command -v google-chrome)" out/report.html $frames
for name in play replay; do convert $frames/$name.png -strip -colors 256 -define png:compression-level=9 "PNG8:docs/$name.png"; done
convert -delay 20 -loop 0 $frames/film-*.png +dither -colors 48 -layers optimize docs/drive.gif
ls -l docs/play.png docs/replay.png docs/drive.gif

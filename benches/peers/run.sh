#!/usr/bin/env bash
# Runs Stone Soup on the very detections that trackloom gets, and prints time and quality of both.
#   benches/peers/run.sh [TARGETS] [SEEDS]      default: 100 targets, 3 seeds
# Stone Soup comes from PyPI into an environment of its own below the cache directory.
set -euo pipefail
cd "$(dirname "$0")/../.."
targets=${1:-100}
seeds=${2:-3}
cache=${XDG_CACHE_HOME:-$HOME/.cache}/trackloom
mkdir -p "$cache"
[ -x "$cache/peers/bin/python" ] || python3 -m venv "$cache/peers"
"$cache/peers/bin/pip" install --quiet 'stonesoup==1.9.1' 'numpy==2.4.6' 'scipy==1.17.1'
cargo build --quiet --release
bin=${CARGO_TARGET_DIR:-target}/release/trackloom
exec "$cache/peers/bin/python" benches/peers/compare.py "$bin" "$targets" "$seeds"

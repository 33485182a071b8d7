#!/usr/bin/env bash
# Runs Stone Soup on the very detections that trackloom gets, and prints time and quality of both.
#   benches/peers/run.sh [TARGETS] [FIRST_SEED] [LAST_SEED] [every-way]      default: 100 targets, seeds 1 to 3
# With `every-way`, Stone Soup does each method in every way it knows, else in its plain one.
# Stone Soup comes from PyPI into an environment of its own below the cache directory.
set -euo pipefail
cd "$(dirname "$0")/../.."
cache=${XDG_CACHE_HOME:-$HOME/.cache}/trackloom
mkdir -p "$cache"
[ -x "$cache/peers/bin/python" ] || python3 -m venv "$cache/peers"
"$cache/peers/bin/pip" install --quiet 'stonesoup==1.9.1' 'numpy==2.4.6' 'scipy==1.17.1'
bin=$(cargo bench --quiet -p trackloom-domain --bench peers --no-run --message-format=json |
    sed -n 's/.*"executable":"\([^"]*\)".*/\1/p' | tail -n 1)
# One process, one thread on either side.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=1
exec "$cache/peers/bin/python" benches/peers/compare.py "$bin" "${1:-100}" "${2:-1}" "${3:-3}" "${@:4}"

#!/usr/bin/env bash
# Runs motrics and TrackEval on the very boxes that trackloom gets, and prints the time of CLEAR + Identity + HOTA of all.
#   benches/peers/metrics.sh [FOLDER] [COPIES...]      default: $TRACKLOOM_DATA/mot-tud/TUD-Campus, 1 10 50 copies
# FOLDER holds gt.txt and test.txt in MOTChallenge text. Both peers come from PyPI into an environment of their own below
# the cache directory.
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=${1:-${TRACKLOOM_DATA:?name a folder with gt.txt and test.txt, or set TRACKLOOM_DATA}/mot-tud/TUD-Campus}
copies=("${@:2}")
[ ${#copies[@]} -gt 0 ] || copies=(1 10 50)
cache=${XDG_CACHE_HOME:-$HOME/.cache}/trackloom
mkdir -p "$cache"
[ -x "$cache/peers-metrics/bin/python" ] || python3 -m venv "$cache/peers-metrics"
"$cache/peers-metrics/bin/pip" install --quiet 'motrics==0.3.0' 'trackeval==1.3.0' 'numpy==2.4.6' 'scipy==1.17.1'
# One thread on either side, and each number of copies in a process of its own: what a run before has left of the C library's
# memory changes the times by up to 60 %.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=1
for count in "${copies[@]}"; do
    cargo bench --quiet --locked -p trackloom-domain --bench metrics -- "$folder" "$count" |
        "$cache/peers-metrics/bin/python" benches/peers/metrics.py "$folder" "$count"
done

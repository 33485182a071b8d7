#!/bin/sh
# Keeps the artefacts of a running service in an S3-compatible store on this machine, and lets that store go away.
# Usage: tests/s3/run.sh [path of a trackloom program built with the feature s3]; without one it is built.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
program=${1:-}
cache=${XDG_CACHE_HOME:-$HOME/.cache}/trackloom/s3-venv

if [ -z "$program" ]; then
    (cd "$root" && cargo build --quiet --features s3)
    program=${CARGO_TARGET_DIR:-$root/target}/debug/trackloom
fi

# The environment is made again when the pins change.
if ! cmp -s "$root/tests/s3/requirements.txt" "$cache/requirements.txt"; then
    rm -rf "$cache"
    mkdir -p "$(dirname "$cache")"
    python3 -m venv "$cache"
    "$cache/bin/pip" install --quiet --disable-pip-version-check --requirement "$root/tests/s3/requirements.txt"
    cp "$root/tests/s3/requirements.txt" "$cache/requirements.txt"
fi

"$cache/bin/python" "$root/tests/s3/session.py" "$program"
echo "artefacts in a bucket: ok"

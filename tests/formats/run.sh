#!/bin/sh
# What another program reads of the files that trackloom writes: ASTERIX by libasterix.
# Usage: tests/formats/run.sh
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
cache=${TRACKLOOM_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/trackloom}/formats-venv
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The environment is made again when the pins change.
if ! cmp -s "$root/tests/formats/requirements.txt" "$cache/requirements.txt"; then
    rm -rf "$cache"
    mkdir -p "$(dirname "$cache")"
    python3 -m venv "$cache"
    "$cache/bin/pip" install --quiet --disable-pip-version-check --requirement "$root/tests/formats/requirements.txt"
    cp "$root/tests/formats/requirements.txt" "$cache/requirements.txt"
fi

cd "$root"
TRACKLOOM_ASTERIX_OUT=$work cargo test --quiet --locked --workspace --features s3,parquet --test domain -- \
    asterix::judges::files_for_other_programs
"$cache/bin/python" tests/formats/read_asterix.py "$work"

#!/usr/bin/env bash
# What other programs read of the files that trackloom writes: ASTERIX by libasterix, the others by the programs that they are for.
# Usage: tests/formats/run.sh PROGRAM
set -euo pipefail
program=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
cache=${TRACKLOOM_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/trackloom}/formats-venv
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The environment is made again when the pins change. They name all that is needed: two packages are installed for their schemas alone.
if ! cmp -s "$root/tests/formats/requirements.txt" "$cache/requirements.txt"; then
    rm -rf "$cache"
    mkdir -p "$(dirname "$cache")"
    python3 -m venv "$cache"
    "$cache/bin/pip" install --quiet --disable-pip-version-check --no-deps --requirement "$root/tests/formats/requirements.txt"
    cp "$root/tests/formats/requirements.txt" "$cache/requirements.txt"
fi

cd "$root"
TMPDIR=$work "$cache/bin/python" tests/formats/outputs.py "$program"
TRACKLOOM_ASTERIX_OUT=$work cargo test --quiet --locked --workspace --features s3,parquet --test domain -- \
    asterix::judges::files_for_other_programs
"$cache/bin/python" tests/formats/read_asterix.py "$work"

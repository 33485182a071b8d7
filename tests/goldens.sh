#!/usr/bin/env bash
# Two builds of trackloom, the same jobs: is every `result` and every artefact the same, byte for byte?
#   tests/goldens.sh COMMIT              builds that commit and the present tree, both in the dev profile
#   tests/goldens.sh --binaries OLD NEW  compares what is built already
# With TRACKLOOM_DATA the recordings, too. Exit code 1: something differs.
# The program of a commit is kept below ${TRACKLOOM_GOLDENS:-~/.cache/trackloom/goldens}.
set -euo pipefail
root=$(realpath "$(dirname "$0")/..")
export PYTHONDONTWRITEBYTECODE=1

if [ $# = 3 ] && [ "$1" = --binaries ]; then
    exec "$root/tests/goldens/compare.py" "$2" "$3"
fi
if [ $# != 1 ]; then
    sed -n '2,6s/^# \?//p' "$0" >&2
    exit 2
fi

cd "$root"
. tests/goldens/of_commit.sh

build() { # TARGET_DIRECTORY
    CARGO_TARGET_DIR=$1 cargo test "${everything[@]}" --no-run --test processes >&2 &&
        echo "$1/debug/trackloom"
}

old=$(program_of trackloom "$1" build)
new=$(build "${CARGO_TARGET_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}/trackloom/target}")
tests/goldens/compare.py "$old" "$new"

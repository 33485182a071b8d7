#!/usr/bin/env bash
# What every associator and the oracle cost, in u, before and now: two builds of the benchmark `association` take turns.
#   benches/own_u.sh COMMIT              builds the benchmark of that commit and of the present tree
#   benches/own_u.sh --binaries OLD NEW  runs what is built already
# Exit code 1: something costs more than 5 % more.
# The benchmark of a commit is kept below ${TRACKLOOM_GOLDENS:-~/.cache/trackloom/goldens}.
set -euo pipefail
root=$(realpath "$(dirname "$0")/..")

if [ $# = 3 ] && [ "$1" = --binaries ]; then
    exec "$root/benches/own_u.py" "$2" "$3"
fi
if [ $# != 1 ]; then
    sed -n '2,6s/^# \?//p' "$0" >&2
    exit 2
fi

cd "$root"
. tests/goldens/of_commit.sh

build() { # TARGET_DIRECTORY
    CARGO_TARGET_DIR=$1 cargo bench "${everything[@]}" --no-run --bench association 2>&1 |
        tee /dev/stderr | sed -n 's/.*Executable .*(\(.*\))$/\1/p'
}

old=$(program_of association "$1" build)
new=$(build "${CARGO_TARGET_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}/trackloom/target}")
benches/own_u.py "$old" "$new"

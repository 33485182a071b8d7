#!/usr/bin/env bash
# Two builds of trackloom, the same jobs: is every `result` and every artefact the same, byte for byte?
#   tests/goldens.sh COMMIT             builds that commit and the present tree, both in the dev profile
#   tests/goldens.sh --binaries OLD NEW compares what is built already
# With TRACKLOOM_DATA the recordings, too. Exit code 1: something differs.
# The old program is kept by its commit below ${TRACKLOOM_GOLDENS:-~/.cache/trackloom/goldens}, so it is built once.
set -euo pipefail
cd "$(dirname "$0")/.."
export PYTHONDONTWRITEBYTECODE=1

if [ $# = 3 ] && [ "$1" = --binaries ]; then
    exec tests/goldens/compare.py "$2" "$3"
fi
if [ $# != 1 ]; then
    sed -n '2,6s/^# \?//p' "$0" >&2
    exit 2
fi
commit=$(git rev-parse --verify "$1^{commit}")

cache=${XDG_CACHE_HOME:-$HOME/.cache}/trackloom
goldens=${TRACKLOOM_GOLDENS:-$cache/goldens}
mkdir -p "$goldens"

# As tests/run builds, so that nothing is compiled twice.
build() { # TARGET_DIRECTORY
    CARGO_TARGET_DIR=$1 cargo test --locked --workspace --features s3,parquet --no-run --test processes
}

old=$goldens/trackloom-$commit
if [ ! -x "$old" ]; then
    # A target directory of its own: one that two checkouts share takes the files of one for those of the other.
    tree=$(mktemp -d)
    trap 'git worktree remove --force "$tree"' EXIT
    git worktree add --quiet --detach "$tree" "$commit"
    (cd "$tree" && TRACKLOOM_SKIP_DASHBOARD=1 build "$goldens/target")
    cp "$goldens/target/debug/trackloom" "$old"
fi
target=${CARGO_TARGET_DIR:-$cache/target}
build "$target"
tests/goldens/compare.py "$old" "$target/debug/trackloom"

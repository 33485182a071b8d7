#!/bin/sh
# Drives the dashboard of the real service in Chromium: each file of tests has a service of its own,
# and as many files run beside each other as there are cores, up to four; a file that fails so is run
# once more alone.
#   TRACKLOOM_BIN          the binary (default: the release build of this checkout)
#   TRACKLOOM_SCREENSHOTS  where pictures of every view go (default: a temporary folder, named at the end)
#   CHROMIUM               the browser (default: /usr/bin/chromium)
# Arguments are files of tests (default: all).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
TRACKLOOM_BIN=${TRACKLOOM_BIN:-$here/../../target/release/trackloom}
TRACKLOOM_SCREENSHOTS=${TRACKLOOM_SCREENSHOTS:-$(mktemp -d)}
TRACKLOOM_SCRATCH=$(mktemp -d)
export TRACKLOOM_BIN TRACKLOOM_SCREENSHOTS TRACKLOOM_SCRATCH
trap 'rm -rf "$TRACKLOOM_SCRATCH"' EXIT

cd "$here"
if ! cmp -s package-lock.json node_modules/.installed-lock.json; then
    npm ci --ignore-scripts --no-audit --no-fund
    cp package-lock.json node_modules/.installed-lock.json
fi

cores=$(nproc)
[ "$cores" -le 4 ] || cores=4
[ $# -gt 0 ] || set -- *.test.mjs
# The output of a file comes whole, when it has ended.
printf '%s\n' "$@" | xargs -P "$cores" -I{} sh -c '
    node --test "$1" >"$TRACKLOOM_SCRATCH/$1.out" 2>&1 || echo "$1" >>"$TRACKLOOM_SCRATCH/failed"
    cat "$TRACKLOOM_SCRATCH/$1.out"' one {}
# A machine with too much to do can be late for a browser: what failed beside others is run alone.
status=0
for file in $(cat "$TRACKLOOM_SCRATCH/failed" 2>/dev/null); do
    printf '== %s failed beside others and is run alone\n' "$file"
    node --test "$file" || status=1
done
[ "$status" = 0 ] || tail -n 20 "$TRACKLOOM_SCRATCH"/*.log >&2
echo "pictures of every view: $TRACKLOOM_SCREENSHOTS"
exit "$status"

#!/bin/sh
# Drives the dashboard of the real service in Chromium.
#   TRACKLOOM_BIN          the binary (default: the release build of this checkout)
#   TRACKLOOM_SCREENSHOTS  where pictures of every view go (default: a temporary folder, named at the end)
#   CHROMIUM               the browser (default: /usr/bin/chromium)
set -eu
here=$(cd "$(dirname "$0")" && pwd)
bin=${TRACKLOOM_BIN:-$here/../../target/release/trackloom}
scratch=$(mktemp -d)
pictures=${TRACKLOOM_SCREENSHOTS:-$(mktemp -d)}
server=
stop() {
    if [ -n "$server" ]; then
        kill "$server" 2>/dev/null || true
        wait "$server" 2>/dev/null || true
    fi
    rm -rf "$scratch"
}
trap stop EXIT

cd "$here"
if ! cmp -s package-lock.json node_modules/.installed-lock.json; then
    npm ci --ignore-scripts --no-audit --no-fund
    cp package-lock.json node_modules/.installed-lock.json
fi

"$bin" serve --listen 127.0.0.1:0 --data "$scratch/data" >"$scratch/out" 2>"$scratch/log" &
server=$!
address=
for _ in $(seq 150); do
    address=$(sed -n '1s/^trackloom listening on //p' "$scratch/out")
    [ -n "$address" ] && break
    kill -0 "$server" 2>/dev/null || { cat "$scratch/log" >&2; exit 1; }
    sleep 0.1
done
[ -n "$address" ] || { echo "the service did not start within 15 s" >&2; cat "$scratch/log" >&2; exit 1; }

status=0
TRACKLOOM_URL=$address TRACKLOOM_BIN=$bin TRACKLOOM_SCREENSHOTS=$pictures node --test --test-concurrency=1 . || status=$?
[ "$status" = 0 ] || { echo "--- log of the service" >&2; tail -50 "$scratch/log" >&2; }
echo "pictures of every view: $pictures"
exit "$status"

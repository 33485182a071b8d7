#!/bin/sh
# Runs what README, docs/*.md and the API document tell a user to run, against a running service.
# Usage: tests/docs/run.sh PROGRAM
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
program=$(realpath "$1")
work=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill "$server" 2>/dev/null || true; rm -rf "$work"' EXIT

"$program" serve --listen 127.0.0.1:0 --data "$work/data" >"$work/server.log" 2>&1 &
server=$!
tries=0
until grep -q "^trackloom listening on " "$work/server.log"; do
    tries=$((tries + 1))
    if [ "$tries" -gt 100 ] || ! kill -0 "$server" 2>/dev/null; then
        cat "$work/server.log"
        echo "the service did not start" >&2
        exit 1
    fi
    sleep 0.2
done
address=$(sed -n 's/^trackloom listening on //p' "$work/server.log" | head -n 1)
TMPDIR=$work python3 "$root/tests/docs/run.py" "$program" "$address" "$root/openapi/openapi.json" "$root/README.md" "$root"/docs/*.md

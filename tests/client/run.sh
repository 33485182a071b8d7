#!/bin/sh
# Generates a Python client from openapi/openapi.json and plays a session with it against a running service.
# Usage: tests/client/run.sh [path of the trackloom program]; without one it is built.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
program=${1:-}
cache=${XDG_CACHE_HOME:-$HOME/.cache}/trackloom/client-venv
work=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill "$server" 2>/dev/null || true; rm -rf "$work"' EXIT

if [ -z "$program" ]; then
    (cd "$root" && cargo build --quiet)
    program=${CARGO_TARGET_DIR:-$root/target}/debug/trackloom
fi

# The environment is made again when the pins change.
if ! cmp -s "$root/tests/client/requirements.txt" "$cache/requirements.txt"; then
    rm -rf "$cache"
    mkdir -p "$(dirname "$cache")"
    python3 -m venv "$cache"
    "$cache/bin/pip" install --quiet --disable-pip-version-check --requirement "$root/tests/client/requirements.txt"
    cp "$root/tests/client/requirements.txt" "$cache/requirements.txt"
fi

"$cache/bin/openapi-python-client" generate --path "$root/openapi/openapi.json" --config "$root/tests/client/config.yaml" \
    --meta none --output-path "$work/trackloom_client" >"$work/generate.log" 2>&1 || { cat "$work/generate.log"; exit 1; }
# A warning means that an operation or a schema was left out.
if grep -i -E "warning|skipping|missing|unable|error" "$work/generate.log"; then
    cat "$work/generate.log"
    echo "the generator left something out" >&2
    exit 1
fi
expected=$(grep -c '"operationId"' "$root/openapi/openapi.json")
generated=$(find "$work/trackloom_client/api" -name '*.py' ! -name '__init__.py' | wc -l)
if [ "$expected" -ne "$generated" ]; then
    echo "the document has $expected operations, the client $generated" >&2
    exit 1
fi

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

PYTHONPATH=$work "$cache/bin/python" "$root/tests/client/session.py" "$address"

kill -TERM "$server"
wait "$server" || { echo "the service did not stop cleanly" >&2; exit 1; }
server=
echo "generated client: ok"

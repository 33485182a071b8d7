# What the scripts of this folder share: where things are kept, the tools, and a service to talk to. Sourced, not run.
client=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$client/../.." && pwd)
cache=${TRACKLOOM_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/trackloom}/client
work=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill "$server" 2>/dev/null || true; rm -rf "$work"' EXIT

install_python() { # Into $cache/venv, made again when the pins change.
    if ! cmp -s "$client/requirements.txt" "$cache/venv/requirements.txt"; then
        rm -rf "$cache/venv"
        mkdir -p "$cache"
        python3 -m venv "$cache/venv"
        "$cache/venv/bin/pip" install --quiet --disable-pip-version-check --requirement "$client/requirements.txt"
        cp "$client/requirements.txt" "$cache/venv/requirements.txt"
    fi
    export PATH=$cache/venv/bin:$PATH
}

install_node() { # Into $cache/node, made again when the lock changes.
    if ! cmp -s "$client/package-lock.json" "$cache/node/installed"; then
        rm -rf "$cache/node"
        mkdir -p "$cache/node"
        cp "$client/package.json" "$client/package-lock.json" "$client/.npmrc" "$cache/node"
        (cd "$cache/node" && npm ci --silent)
        cp "$client/package-lock.json" "$cache/node/installed"
    fi
    export PATH=$cache/node/node_modules/.bin:$PATH
}

start_server() { # PROGRAM: sets $address
    "$1" serve --listen 127.0.0.1:0 --data "$work/data" >"$work/server.log" 2>&1 &
    server=$!
    local tries=0
    until grep -qs "^trackloom listening on " "$work/server.log"; do
        tries=$((tries + 1))
        if [ "$tries" -gt 100 ] || ! kill -0 "$server" 2>/dev/null; then
            cat "$work/server.log"
            echo "the service did not start" >&2
            return 1
        fi
        sleep 0.2
    done
    address=$(sed -n 's/^trackloom listening on //p' "$work/server.log" | head -n 1)
}

stop_server() {
    kill -TERM "$server"
    wait "$server" || { cat "$work/server.log"; echo "the service did not stop cleanly" >&2; return 1; }
    server=
    rm -rf "$work/data" "$work/server.log"
}

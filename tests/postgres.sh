#!/usr/bin/env bash
# A PostgreSQL of its own in a directory: tests/postgres.sh start DIR PORT | stop DIR | drop DIR
# `stop` is as hard as a crash; `start` takes up again what is there; `drop` stops it and removes the directory.
set -euo pipefail
command=$1 directory=$2 port=${3:-}

bin=$(dirname "$(readlink -f "$(command -v postgres || ls /usr/lib/postgresql/*/bin/postgres | sort -V | tail -n 1)")")
# PostgreSQL refuses to run as root.
as_user() {
    if [ "$(id -u)" = 0 ]; then (cd / && setpriv --reuid=postgres --regid=postgres --clear-groups "$@"); else "$@"; fi
}

case $command in
start)
    if [ ! -e "$directory/PG_VERSION" ]; then
        mkdir -p "$directory"
        [ "$(id -u)" != 0 ] || chown postgres "$directory"
        chmod 700 "$directory"
        as_user "$bin/initdb" --pgdata="$directory" --username=trackloom --auth=trust --encoding=UTF8 --no-sync >/dev/null
    fi
    # Nobody needs the data after a power failure; a crash of the server alone loses nothing without fsync either.
    as_user "$bin/pg_ctl" start --wait --silent --pgdata="$directory" --log="$directory/log" \
        --options="-h 127.0.0.1 -p $port -k $directory -c fsync=off -c max_connections=200" >/dev/null
    ;;
stop) as_user "$bin/pg_ctl" stop --wait --silent --mode=immediate --pgdata="$directory" >/dev/null ;;
drop)
    as_user "$bin/pg_ctl" stop --wait --silent --mode=immediate --pgdata="$directory" >/dev/null || true
    rm -rf "$directory"
    ;;
*)
    echo "unknown command '$command'" >&2
    exit 2
    ;;
esac

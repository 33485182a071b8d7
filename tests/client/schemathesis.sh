#!/usr/bin/env bash
# Asks a running service what the API document says may be asked, and what it says may not, and compares the answers with
# the document. The statuses are those that an operation lists: the ranges 4XX and 5XX would excuse everything.
# Usage: tests/client/schemathesis.sh PROGRAM [CASES]; 20 000 cases take minutes. A short run leaves out the cases at the edges of every
# schema, which are thirty thousand.
set -euo pipefail
# shellcheck source=tests/client/support.sh
. "$(dirname "$0")/support.sh"
program=$1
cases=${2:-20000}

phases=examples,fuzzing,stateful
[ "$cases" -lt 1000 ] || phases=examples,coverage,fuzzing,stateful
install_python
start_server "$program"
operations=$(python "$client/strict_document.py" "$address" "$client/data" "$work/openapi.json")
(cd "$work" && schemathesis --config-file "$client/schemathesis.toml" run openapi.json --url "$address" --no-color --phases "$phases" \
    --max-examples $(((cases + operations - 1) / operations)) --seed 1 --generation-database none --workers 2 >"$work/log") ||
    { cat "$work/log" "$work/server.log"; exit 1; }
sed -n '/^Test cases:/,/passed/p' "$work/log"
stop_server

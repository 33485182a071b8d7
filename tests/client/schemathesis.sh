#!/usr/bin/env bash
# Asks a running service what the API document says may be asked, and what it says may not, and compares the answers with
# the document. The statuses are those that an operation lists: the ranges 4XX and 5XX would excuse everything.
# Usage: tests/client/schemathesis.sh PROGRAM [CASES]; 20 000 cases take minutes.
set -euo pipefail
# shellcheck source=tests/client/support.sh
. "$(dirname "$0")/support.sh"
program=$1
cases=${2:-20000}

install_python
python - "$root/openapi/openapi.json" "$work/openapi.json" <<'P'
import json, sys
document = json.load(open(sys.argv[1]))
operations = [operation for path in document["paths"].values() for operation in path.values()]
for operation in operations:
    operation["responses"] = {status: answer for status, answer in operation["responses"].items() if "X" not in status}
json.dump(document, open(sys.argv[2], "w"))
P
operations=$(grep -o '"operationId"' "$work/openapi.json" | wc -l)
start_server "$program"
(cd "$work" && schemathesis --config-file "$client/schemathesis.toml" run openapi.json --url "$address" --no-color \
    --max-examples $(((cases + operations - 1) / operations)) --seed 1 --generation-database none --workers 2)
stop_server

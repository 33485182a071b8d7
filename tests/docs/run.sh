#!/usr/bin/env bash
# Runs what README, docs/*.md and the API document tell a user to run, against a running service.
# Usage: tests/docs/run.sh PROGRAM
set -euo pipefail
program=$(realpath "$1")
# shellcheck source=tests/client/support.sh
. "$(dirname "$0")/../client/support.sh"

install_python
codespell --ignore-words-list nees,mot,tung "$root/README.md" "$root"/docs/*.md "$root"/docs/decisions/*.md
start_server "$program"
TMPDIR=$work python3 "$root/tests/docs/run.py" "$program" "$address" "$root/openapi/openapi.json" "$root/README.md" "$root"/docs/*.md
"$root/tests/docs/deploy.py" "$program" "$address"
stop_server

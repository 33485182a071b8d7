#!/usr/bin/env bash
# tests/soak.sh [KILLS [KILLS_ON_POSTGRESQL]]: builds the program, then kills its processes without warning that often (100 and 20 when
# not said) while jobs run: on a file, then as a server with two workers on a PostgreSQL of its own.
set -euo pipefail
cd "$(dirname "$0")/.."
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}/trackloom/target}
cargo build --locked --features s3,parquet
tests/soak.py "$CARGO_TARGET_DIR/debug/trackloom" "${1:-100}"
tests/soak.py "$CARGO_TARGET_DIR/debug/trackloom" "${2:-20}" postgres

#!/usr/bin/env bash
# tests/soak.sh [ROUNDS]: the campaign of many processes that are killed, stopped and cut off from their database, again and again (50 times when
# not said), each time compared with the result of one process on a file. tests/run does it once.
set -euo pipefail
cd "$(dirname "$0")/.."
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}/trackloom/target}
TRACKLOOM_SOAK=${1:-50} cargo test --locked --features s3,parquet --test processes many:: -- --nocapture

#!/usr/bin/env bash
# tests/fuzz.sh [N]: changes N small files (a million when not said) at random and reads each in every format, with overflow checks but
# optimised. A failure names the change: TRACKLOOM_FUZZ_FROM=I TRACKLOOM_FUZZ=1 does it again.
set -euo pipefail
cd "$(dirname "$0")/.."
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}/trackloom/target}
export TRACKLOOM_FUZZ=${1:-1000000}
time cargo test --locked --workspace --features s3,parquet --test domain -- --nocapture fuzz::

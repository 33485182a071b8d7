#!/usr/bin/env bash
# Kills a server without warning while scans are pushed into its live sessions, 1000 times or as often as is said, and checks that no
# acknowledged scan is lost, none is taken twice, and tracks and events are those of a session that was never killed.
#   tests/sessions.sh [KILLS]
set -euo pipefail
cd "$(dirname "$0")/.."
kills=${1:-1000}
# Half of them in a session that drops late scans, half in one that replays them.
export TRACKLOOM_SESSION_KILLS=$((kills / 2))
cargo test --locked --workspace --features s3,parquet --test processes -- --nocapture sessions::a_session_that_is_killed

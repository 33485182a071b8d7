#!/bin/sh
# Judges a tracker for a build server: fails where a limit of the job is not met, or where a number is significantly worse than in
# the baseline. Without a baseline the result becomes it.
#   check.sh JOB BASELINE OUT     TRACKLOOM is the program (default: trackloom)
set -eu
job=$1 baseline=$2 out=$3
trackloom=${TRACKLOOM:-trackloom}
mkdir -p "$out"
status=0
"$trackloom" run "$job" --out "$out/result" --junit "$out/limits.xml" --markdown "$out/limits.md" || status=$?
if [ ! -e "$out/result/report.json" ]; then
    exit "$status"
fi
if [ ! -e "$baseline/report.json" ]; then
    # What does not meet its limits is nobody's baseline.
    [ "$status" = 0 ] || exit "$status"
    mkdir -p "$baseline"
    cp "$out"/result/* "$baseline"
fi
"$trackloom" compare "$baseline" "$out/result" --fail-if-worse --junit "$out/compare.xml" --markdown "$out/compare.md" || status=$?
exit "$status"

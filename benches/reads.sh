#!/usr/bin/env bash
# benches/reads.sh BIN [SECONDS]: answers a second of a running service to 16 connections, as wrk counts them: a job, a small report and the list
# beside /healthz of the same run. Needs wrk.
set -euo pipefail
bin=$1 seconds=${2:-5}
folder=$(mktemp -d)
"$bin" serve --listen 127.0.0.1:0 --data "$folder/data" >"$folder/said" 2>"$folder/log" &
server=$!
trap 'kill $server; wait $server 2>/dev/null; rm -rf "$folder"' EXIT
until grep -q listening "$folder/said"; do sleep 0.05; done
url=$(sed 's/.* on //' "$folder/said")
body='{"input": {"source": "preset", "preset": "liang2009-10"}}'
id=$(curl -sS -H 'Prefer: wait=30' -H 'Content-Type: application/json' -d "$body" "$url/v1/jobs/evaluate" |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["id"])')
rate() { wrk -t1 -c16 -d"${seconds}s" "$url$1" | sed -n 's/^Requests.sec: *//p'; }
base=$(rate /healthz)
printf '%-28s %10s  %s\n' route 'per second' '/ healthz'
for route in /healthz "/v1/jobs/$id" "/v1/jobs/$id/report" '/v1/jobs?limit=50' /v1/methods; do
    found=$(rate "$route")
    printf '%-28s %10.0f  %.2f\n' "${route/$id/ID}" "$found" "$(python3 -c "print($found / $base)")"
done

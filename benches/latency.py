#!/usr/bin/env python3
"""From the submission of a small job to its report, over one connection: benches/latency.py TRACKLOOM [JOBS [DIRECTORY]]

Each job is liang2009-10 with another seed, waited for with `Prefer: wait`; then its report is read. DIRECTORY is where the data directory
is made: on a disk, or on a tmpfs."""

import http.client
import json
import re
import statistics
import subprocess
import sys
import tempfile
import time


def main():
    program, jobs = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    with tempfile.TemporaryDirectory(dir=sys.argv[3] if len(sys.argv) > 3 else None) as data:
        command = [program, "serve", "--listen", "127.0.0.1:0", "--data", data]
        server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        try:
            port = int(re.search(r":(\d+)$", server.stdout.readline().strip())[1])
            measure(http.client.HTTPConnection("127.0.0.1", port), jobs)
        finally:
            server.terminate()
            server.wait()


def measure(connection, jobs):
    times = {"to the end": [], "to the report": []}
    for seed in range(-20, jobs):
        body = json.dumps({"seed": seed + 20, "input": {"source": "preset", "preset": "liang2009-10"}})
        since = time.perf_counter()
        job = ask(connection, "POST", "/v1/jobs/evaluate", body)
        ended = time.perf_counter()
        if job["state"] != "succeeded":
            raise SystemExit(f"the job did not succeed: {job}")
        ask(connection, "GET", f"/v1/jobs/{job['id']}/report")
        if seed >= 0:
            times["to the end"].append(1e3 * (ended - since))
            times["to the report"].append(1e3 * (time.perf_counter() - since))
    for what, values in times.items():
        values.sort()
        p99 = values[min(len(values) - 1, int(0.99 * len(values)))]
        print(f"{what}: median {statistics.median(values):.1f} ms, p99 {p99:.1f} ms, worst of {len(values)} {values[-1]:.1f} ms")


def ask(connection, method, path, body=None):
    connection.request(method, path, body, {"content-type": "application/json", "prefer": "wait=30"})
    answer = connection.getresponse()
    text = answer.read()
    if answer.status not in (200, 202):
        raise SystemExit(f"{method} {path}: {answer.status} {text.decode()}")
    return json.loads(text)


main()

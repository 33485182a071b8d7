#!/usr/bin/env python3
"""Whether the time of a refusal tells anything of a key: benches/keys.py TRACKLOOM [ROUNDS]

Asks in turns, over one connection, with: no key, a short guess, a key of another master key with an id that exists, one with an id that does not,
and a key whose last digit is wrong. Prints the median of each, and the largest difference between any two in standard errors."""

import http.client
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time

MASTER = "0123456789abcdef0123456789abcdef"


def main():
    program, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 4000
    with tempfile.TemporaryDirectory() as data:
        command = [program, "serve", "--listen", "127.0.0.1:0", "--data", data]
        environment = {**os.environ, "TRACKLOOM_MASTER_KEY": MASTER, "RUST_LOG": "error"}
        server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
        port = int(re.search(r":(\d+)$", server.stdout.readline().strip())[1])
        try:
            measure(http.client.HTTPConnection("127.0.0.1", port), rounds)
        finally:
            server.terminate()
            server.wait()


def ask(connection, method, path, key, body=None):
    headers = {"content-type": "application/json"}
    if key is not None:
        headers["authorization"] = f"Bearer {key}"
    connection.request(method, path, body, headers)
    answer = connection.getresponse()
    return answer.status, answer.read()


def measure(connection, rounds):
    _, made = ask(connection, "POST", "/v1/keys", MASTER, json.dumps({"name": "x", "actions": ["read"]}))
    key = json.loads(made)["key"]
    prefix, own, mac = key.split("_")
    wrong_mac, nobody = "0" * 64, "0" * 32
    last = "1" if key[-1] == "0" else "0"
    guesses = {
        "a short guess": "guess",
        "an id that exists": f"{prefix}_{own}_{wrong_mac}",
        "an id that does not": f"{prefix}_{nobody}_{wrong_mac}",
        "the last digit wrong": key[:-1] + last,
    }
    times = {name: [] for name in guesses}
    for _ in range(rounds):
        for name, guess in guesses.items():
            since = time.perf_counter()
            status, _ = ask(connection, "GET", "/v1/jobs", guess)
            times[name].append(1e6 * (time.perf_counter() - since))
            assert status == 401
    for name, values in times.items():
        print(f"{name}: median {statistics.median(values):.1f} us")
    means = {}
    for name, values in times.items():
        values = sorted(values)[: int(0.9 * len(values))]
        means[name] = (statistics.mean(values), statistics.stdev(values) / len(values) ** 0.5)
    pairs = [(a, b) for a in means for b in means if a < b]
    worst = max(abs(means[a][0] - means[b][0]) / (means[a][1] ** 2 + means[b][1] ** 2) ** 0.5 for a, b in pairs)
    spread = max(means.values())[0] - min(means.values())[0]
    print(f"means of the fastest nine tenths differ by {spread:.2f} us at most, {worst:.1f} standard errors")


main()

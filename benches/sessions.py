#!/usr/bin/env python3
"""Live sessions on loopback: benches/sessions.py TRACKLOOM push|ten|long [DIRECTORY]

push   2000 scans of 200 detections to 200 tracks, one after the other, each beside a sync of as many bytes on the same disk; then the
       same recording as a job, for the time of the tracker alone.
ten    ten such sessions at 10 scans a second each for 60 s, while jobs run.
long   a million scans to 200 tracks: memory on the way, then SIGKILL, and the time until the tracks are told again, byte for byte.

DIRECTORY is where the data directory is made."""

import http.client
import json
import math
import os
import random
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time

TARGETS = 200
SIGMA_M = 10.0


def main():
    program, section = sys.argv[1], sys.argv[2]
    with tempfile.TemporaryDirectory(dir=sys.argv[3] if len(sys.argv) > 3 else None) as data:
        server = Server(program, data)
        try:
            {"push": push, "ten": ten, "long": long}[section](server, data)
        finally:
            server.process.terminate()
            server.process.wait()


class Server:
    def __init__(self, program, data):
        self.command = [program, "serve", "--listen", "127.0.0.1:0", "--data", data]
        self.start()

    def start(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.port = int(re.search(r":(\d+)$", self.process.stdout.readline().strip())[1])

    def connect(self):
        return http.client.HTTPConnection("127.0.0.1", self.port, timeout=300)

    def memory_mb(self):
        with open(f"/proc/{self.process.pid}/status") as status:
            return int(re.search(r"VmRSS:\s+(\d+)", status.read())[1]) / 1024


def ask(connection, method, path, body=None, kind="application/json"):
    connection.request(method, path, body, {"content-type": kind, "prefer": "wait=30"})
    answer = connection.getresponse()
    text = answer.read()
    if answer.status not in (200, 201, 202):
        raise SystemExit(f"{method} {path}: {answer.status} {text.decode()[:2000]}")
    return json.loads(text)


def session(connection, p_d, max_missed=5):
    sensor = {"sensor_id": "radar", "sigma_x_m": SIGMA_M, "sigma_y_m": SIGMA_M, "p_d": p_d, "clutter_per_m2": 1e-9}
    tracker = {"initial_speed_sigma_mps": 10.0, "max_missed": max_missed}
    associator = {"method": "global_nearest_neighbour"}
    made = ask(connection, "POST", "/v1/sessions", json.dumps({"sensors": [sensor], "associator": associator, "tracker": tracker}))
    return f"/v1/sessions/{made['id']}"


class Scene:
    """Targets that go round in circles, so that they never leave: 100 m and more apart on a grid."""

    def __init__(self, seed):
        self.draw = random.Random(seed)
        self.seen_of = 1

    def scan(self, index, period_s):
        """As JSON; of all targets, or of one in `seen_of`."""
        time_s, detections = index * period_s, []
        for target in range(index % self.seen_of, TARGETS, self.seen_of):
            if self.draw.random() < 0.05:
                continue
            phase = target + time_s / 60.0
            x_m = 1500.0 * (target % 15) + 300.0 * math.cos(phase) + self.draw.gauss(0.0, SIGMA_M)
            y_m = 1500.0 * (target // 15) + 300.0 * math.sin(phase) + self.draw.gauss(0.0, SIGMA_M)
            detections.append(f'{{"x_m":{x_m:.2f},"y_m":{y_m:.2f}}}')
        while len(detections) < TARGETS // self.seen_of:
            detections.append(f'{{"x_m":{self.draw.uniform(-1e3, 2.2e4):.2f},"y_m":{self.draw.uniform(-1e3, 2.2e4):.2f}}}')
        return f'{{"sensor_id":"radar","sequence":{index},"time_s":{time_s:.3f},"detections":[{",".join(detections)}]}}'


def spread(values_ms):
    values = sorted(values_ms)
    p99 = values[min(len(values) - 1, int(0.99 * len(values)))]
    return f"p50 {statistics.median(values):.2f} ms, p99 {p99:.2f} ms, worst of {len(values)} {values[-1]:.2f} ms"


def push(server, data):
    connection, scene = server.connect(), Scene(1)
    path = session(connection, 0.95)
    scans = [scene.scan(index, 1.0) for index in range(2100)]
    file = os.open(os.path.join(data, "sync"), os.O_WRONLY | os.O_CREAT)
    pushed_ms, synced_ms = [], []
    for index, scan in enumerate(scans):
        since = time.perf_counter()
        ask(connection, "POST", f"{path}/scans", scan)
        pushed = time.perf_counter()
        os.write(file, scan.encode())
        os.fdatasync(file)
        synced = time.perf_counter()
        if index >= 100:
            pushed_ms.append(1e3 * (pushed - since))
            synced_ms.append(1e3 * (synced - pushed))
    tracks = ask(connection, "GET", path)["live"]
    print(f"tracks {tracks['tracks']}, confirmed {tracks['confirmed']}")
    print(f"push: {spread(pushed_ms)}")
    print(f"sync of as many bytes: {spread(synced_ms)}")
    closed = ask(connection, "POST", f"{path}/close")
    while ask(connection, "GET", f"/v1/jobs/{closed['job_id']}")["state"] in ("queued", "running"):
        pass
    report = ask(connection, "GET", f"/v1/jobs/{closed['job_id']}/report")
    print(f"the same as a job: {json.dumps(report['timing'])}")


def ten(server, data):
    sessions, seconds = 10, 60
    connection = server.connect()
    paths = [session(connection, 0.95) for _ in range(sessions)]
    scans = [Scene(seed) for seed in range(sessions)]
    scans = [[scene.scan(index, 0.1) for index in range(10 * seconds)] for scene in scans]
    taken_ms, late_ms, ended = [[] for _ in paths], [[] for _ in paths], threading.Event()
    jobs = []

    def feed(number):
        own, begun = server.connect(), time.perf_counter() + 0.01 * number
        for index, scan in enumerate(scans[number]):
            due = begun + 0.1 * index
            time.sleep(max(0.0, due - time.perf_counter()))
            since = time.perf_counter()
            late_ms[number].append(1e3 * (since - due))
            ask(own, "POST", f"{paths[number]}/scans", scan)
            taken_ms[number].append(1e3 * (time.perf_counter() - since))

    def work():
        own, seed = server.connect(), 0
        while not ended.is_set():
            seed += 1
            body = {"seed": seed, "input": {"source": "preset", "preset": "liang2009-100"}}
            job = ask(own, "POST", "/v1/jobs/evaluate", json.dumps(body))
            while job["state"] in ("queued", "running"):
                job = ask(own, "GET", f"/v1/jobs/{job['id']}")
            jobs.append(job)

    worker = threading.Thread(target=work)
    feeds = [threading.Thread(target=feed, args=(number,)) for number in range(sessions)]
    for thread in [worker, *feeds]:
        thread.start()
    for thread in feeds:
        thread.join()
    ended.set()
    worker.join()
    print(f"{sessions} sessions, {10 * seconds} scans each in {seconds} s, {len(jobs)} jobs beside them")
    print(f"push: {spread([value for values in taken_ms for value in values])}")
    print(f"behind the clock of the feed: {spread([value for values in late_ms for value in values])}")
    print(f"memory {server.memory_mb():.0f} MB")


def long(server, data):
    count, batch = int(os.environ.get("SCANS", "1000000")), 500
    connection, scene = server.connect(), Scene(1)
    scene.seen_of = 10
    path = session(connection, 0.1, max_missed=20)
    since = time.perf_counter()
    for first in range(0, count, batch):
        lines = "\n".join(scene.scan(index, 0.1) for index in range(first, first + batch))
        ask(connection, "POST", f"{path}/scans", lines, "application/x-ndjson")
        if first % (count // 10) == 0:
            live = ask(connection, "GET", path)["live"]
            print(f"{first + batch} scans, {live['tracks']} tracks, {server.memory_mb():.0f} MB, {time.perf_counter() - since:.0f} s", flush=True)
    before = json.dumps(ask(connection, "GET", f"{path}/tracks"))
    live = ask(connection, "GET", path)["live"]
    print(f"{live['counts']['scans']} scans, {live['tracks']} tracks, {server.memory_mb():.0f} MB, {time.perf_counter() - since:.0f} s")
    server.process.send_signal(signal.SIGKILL)
    server.process.wait()
    killed = time.perf_counter()
    server.start()
    after = json.dumps(ask(server.connect(), "GET", f"{path}/tracks"))
    print(f"tracks told again {time.perf_counter() - killed:.2f} s after the kill, {'the same' if after == before else 'OTHERS'}, {server.memory_mb():.0f} MB")
    if after != before:
        raise SystemExit(1)


main()
